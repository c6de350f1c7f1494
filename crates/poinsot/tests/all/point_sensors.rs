//! Accelerometers and velocity increments, from model to answer.

use crate::points;
use crate::vehicle;

use poinsot::{Error, identify_tables};
use poinsot_identify::{Source, Status};
use poinsot_model::{EstimateSet, Model, Nuisance, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table};
use poinsot_testkit::rigid_body::{AsymmetricTop, Spin};
use points::{add_point, push, with_point};
use std::sync::Arc;
use vehicle::*;

/// A coasting body and its accelerometer in closed form: `f = alpha x r + w x (w x r)` relative to the mass centre,
/// with the torque-free top for `w` and Euler's equation for `alpha`.
fn coasting(model: &Model, place: Vector3) -> Table {
    let body = model.bodies[0].nominal;
    let I = body.I_BBcm_B;
    let start = Spin {
        R_NB: turned(Vector3::new(0.3, -0.2, 0.5)),
        w_NB_B: Vector3::new(0.2, -0.35, 0.15),
    };
    let top = AsymmetricTop::new(&I, &start).unwrap();
    let times: Arc<[f64]> = (0..=300).map(|k| 0.1 * f64::from(k)).collect();
    let r = place - body.p_BoBcm_B;
    let (mut rates, mut forces, mut attitudes) = (Vec::new(), Vec::new(), Vec::new());
    for t in times.iter() {
        let spin = top.at(*t);
        let w = spin.w_NB_B;
        let alpha = I.try_inverse().unwrap() * (-w.cross(&(I * w)));
        rates.push(w);
        forces.push(alpha.cross(&r) + w.cross(&w.cross(&r)));
        let R = nalgebra::Rotation3::from_matrix_unchecked(spin.R_NB);
        attitudes.push(nalgebra::UnitQuaternion::from_rotation_matrix(&R));
    }
    let mut table = Table::default();
    push(&mut table, "omega", times.clone(), &rates);
    push(&mut table, "acc", times.clone(), &forces);
    for (k, axis) in ["x", "y", "z", "w"].into_iter().enumerate() {
        table.channels.push(Channel {
            name: format!("q_{axis}"),
            time_s: times.clone(),
            values: attitudes.iter().map(|q| q.coords[k]).collect(),
            ..Channel::default()
        });
    }
    table
}

#[test]
fn exact_coasting_accelerometer_shows_the_mass_centre() {
    let place = Vector3::new(0.4, -0.3, 0.6);
    let mut truth = with_point(tree(3, ""), (SensorKind::Accelerometer, 0, place), 1.0e-7);
    truth
        .sensors
        .retain(|s| !matches!(s.kind, SensorKind::Velocity | SensorKind::Position));
    truth.bodies[0].estimate = EstimateSet::ALL;
    let table = coasting(&truth, place);
    let nominal = off_nominal(&truth, 0.05);
    let answer = ask(&nominal, vec![table.clone()], "auto").estimate;
    let com = answer.bodies[0].com;
    for (k, n) in com.iter().enumerate() {
        let error = n.value.unwrap() - truth.bodies[0].nominal.p_BoBcm_B[k];
        println!(
            "com {k}: off by {error:.1e} m, sigma {:.1e}",
            n.sigma.unwrap()
        );
        assert_eq!(n.source, Source::Data);
        assert!(error.abs() < 1.0e-8);
    }
    // No known force or momentum: mass and inertia are undetermined, and not guessed.
    assert_eq!(answer.status, Status::Partial);
    assert_eq!(answer.bodies[0].mass.value, None);
    assert!(answer.bodies[0].inertia.iter().all(|n| n.value.is_none()));

    let blind = without(table, &["acc_"]);
    let mut model = nominal;
    model
        .sensors
        .retain(|s| s.kind != SensorKind::Accelerometer);
    let answer = ask(&model, vec![blind], "auto").estimate;
    assert!(answer.bodies[0].com.iter().all(|n| n.value.is_none()));
}

/// Thrusters of known force and a sensor at a point: as informative as position and velocity.
fn replaces_position_and_velocity(at: (SensorKind, usize, Vector3), noise: f64, seed: u64) {
    let truth = with_point(with_thrusters(known_arm(seed)), at, noise);
    let flight = Flight {
        rate_hz: 40.0,
        ..moving(&truth, seed + 3)
    };
    let mut table = fly(&truth, &flight);
    add_point(&mut table, &truth, &flight, at);
    let mut model = off_nominal(&truth, 0.05);
    model
        .sensors
        .retain(|s| !matches!(s.kind, SensorKind::Velocity | SensorKind::Position));
    let answer = ask(&model, vec![rotation_only(table)], "auto");
    assert_eq!(answer.estimate.status, Status::Converged);
    let error = worst_error(&answer, &truth, 0);
    println!("worst of the ten numbers off by {error:.1e}");
    assert!(error < 1.0e-6, "{error:e}");
}

#[test]
fn exact_accelerometer_of_a_link_replaces_position_and_velocity() {
    let at = (SensorKind::Accelerometer, 2, Vector3::new(0.1, 0.2, -0.3));
    replaces_position_and_velocity(at, 1.0e-6, 5);
}

#[test]
fn exact_velocity_increments_replace_velocity() {
    let kind = SensorKind::VelocityIncrement;
    let at = (kind, 1, Vector3::new(-0.2, 0.1, 0.3));
    replaces_position_and_velocity(at, 1.0e-7, 6);
}

/// Planted bias, scale, misalignment and lag are recovered.
#[test]
fn exact_faults_of_an_accelerometer_come_back() {
    let at = (SensorKind::Accelerometer, 0, Vector3::new(0.3, 0.2, -0.4));
    let mut truth = with_point(with_thrusters(known_arm(7)), at, 1.0e-7);
    let flight = Flight {
        rate_hz: 40.0,
        ..moving(&truth, 10)
    };
    let mut table = fly(&truth, &flight);
    add_point(&mut table, &truth, &flight, at);
    let bias = Vector3::new(0.02, -0.01, 0.03);
    let turn = poinsot_spatial::skew(&Vector3::new(2.0e-3, -1.0e-3, 3.0e-3));
    let scale = Vector3::new(1.01, 0.98, 1.005);
    let axes = ["acc_x", "acc_y", "acc_z"];
    for k in 0..channel(&mut table, "acc_x").values.len() {
        let f = Vector3::from(axes.map(|n| channel(&mut table, n).values[k]));
        let read = scale.component_mul(&f) + turn * f + bias;
        for (axis, name) in axes.into_iter().enumerate() {
            channel(&mut table, name).values[k] = read[axis];
        }
    }
    let own = truth.sensors.last_mut().unwrap();
    own.bias = Nuisance::Estimate;
    own.scale = Nuisance::Estimate;
    own.misalignment = Nuisance::Estimate;
    let answer = ask(&off_nominal(&truth, 0.03), vec![table], "auto");
    let found = |what: &str, k: usize| {
        let name = format!("accelerometer.{what}_{}", ["x", "y", "z"][k]);
        let list = &answer.estimate.nuisance;
        let n = list.iter().find(|n| n.name == name).unwrap();
        n.number.value.unwrap()
    };
    let given = [2.0e-3, -1.0e-3, 3.0e-3];
    for k in 0..3 {
        assert!((found("bias", k) - bias[k]).abs() < 1.0e-6);
        assert!((found("scale", k) - scale[k] + 1.0).abs() < 1.0e-5);
        assert!((found("misalignment", k) - given[k]).abs() < 1.0e-5);
    }
    assert_eq!(answer.estimate.status, Status::Converged);
}

fn refused(model: &Model, table: Table) -> Error {
    let request = request("auto");
    match identify_tables(model.clone(), vec![table], &request) {
        Err(error) => error,
        Ok(_) => unreachable!("the question was answered"),
    }
}

#[test]
fn unit_an_accelerometer_needs_noise_and_its_bias_needs_columns() {
    let at = (SensorKind::Accelerometer, 0, Vector3::zeros());
    let truth = with_point(tree(4, ""), at, 1.0e-6);
    let flight = moving(&truth, 3);
    let table = fly(&truth, &flight);
    let mut asked = truth.clone();
    asked.sensors.last_mut().unwrap().bias = Nuisance::Estimate;
    let text = refused(&asked, table.clone()).to_string();
    assert!(text.contains("E0305") && text.contains("acc_x"), "{text}");
    let mut silent = truth.clone();
    silent.sensors.last_mut().unwrap().noise_covariance = None;
    let mut read = table;
    add_point(&mut read, &truth, &flight, at);
    let text = refused(&silent, read).to_string();
    assert!(
        text.contains("E0302") && text.contains("noise_m_s2"),
        "{text}"
    );
}
