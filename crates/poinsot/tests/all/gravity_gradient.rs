//! The gravity gradient as information: no thruster, no slew.

use crate::vehicle;

use poinsot::identify_tables;
use poinsot_dynamics::{Start, StartVelocity};
use poinsot_identify::{Estimate, Status};
use poinsot_model::{EstimateSet, Model, Nuisance, Orbit, SensorKind, Wheel};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::{
    Channel, MemoryColumns, Part, ReadOptions, Table, TimeMap, Values, read_parts,
};
use std::sync::Arc;
use vehicle::*;

const GM: f64 = 3.986004418e14;

fn low_orbit() -> Orbit {
    Orbit {
        semi_major_axis: 7.0e6,
        eccentricity: 0.0,
        inclination: 0.9,
        raan: 0.4,
        argument_of_periapsis: 0.2,
        true_anomaly: -0.3,
        epoch: None,
    }
}

fn in_orbit(mut model: Model) -> Model {
    model.environment.point_mass_gm = Some(GM);
    model.environment.gravity_gradient = true;
    model.environment.orbit = Some(low_orbit());
    // Realistic noise: with less, round-off of the integration would count as signal.
    model.sensors = [SensorKind::Gyro, SensorKind::Attitude]
        .map(|kind| sensor(kind, 1.0e-6))
        .to_vec();
    model
}

/// One rigid body with unknown inertia.
fn satellite(seed: u64) -> Model {
    let mut model = tree(seed, "");
    model.bodies[0].estimate = EstimateSet {
        inertia: true,
        ..EstimateSet::default()
    };
    model
}

fn coast(model: &Model, w_NB_B: Vector3) -> Flight {
    let mut flight = moving(model, 5);
    flight.start = Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::zeros(),
            w_NB_B,
        },
        ..flight.start
    };
    flight.duration_s = 3000.0;
    flight.rate_hz = 0.2;
    flight
}

fn push(table: &mut Table, name: &str, time_s: &Arc<[f64]>, values: Vec<f64>) {
    table.channels.push(Channel {
        name: name.to_owned(),
        time_s: time_s.clone(),
        values,
        ..Channel::default()
    });
}

fn inertia(answer: &Estimate) -> Option<Matrix3> {
    let mut I = Matrix3::zeros();
    for (k, (i, j)) in poinsot_identify::TENSOR.into_iter().enumerate() {
        I[(i, j)] = answer.bodies[0].inertia[k].value?;
        I[(j, i)] = I[(i, j)];
    }
    Some(I)
}

/// Wheels hold the attitude of a body in N and absorb the gravity-gradient torque, known in closed form. On a circular
/// orbit `u = p cos a + q sin a`, `a' = n`, and the integral of `h_w' = 3 n^2 u x I u` has sines and cosines of 2a.
/// The body never rotates, yet four combinations of its inertia are determined: with the orbit normal w, `I_pq`,
/// `I_pp - I_qq`, `I_pw` and `I_qw`. A multiple of the identity causes no torque, and neither does `I_ww`, because u
/// stays in the plane.
#[test]
fn exact_held_attitude_shows_four_combinations() {
    let mut truth = in_orbit(satellite(7));
    for (k, axis) in [Vector3::x(), Vector3::y(), Vector3::z()]
        .into_iter()
        .enumerate()
    {
        truth.wheels.push(Wheel {
            name: format!("w{k}"),
            body: 0,
            axis_B: axis,
            spin_inertia: 0.05,
            at_rest: false,
            estimate: false,
            misalignment: Nuisance::Known,
        });
    }
    let orbit = low_orbit();
    let n = (GM / orbit.semi_major_axis.powi(3)).sqrt();
    let I = truth.bodies[0].nominal.I_BBcm_B;
    // The body keeps the axes of N: u at argument of latitude 0 and 90 degrees.
    let (so, co) = orbit.raan.sin_cos();
    let (si, ci) = orbit.inclination.sin_cos();
    let (p, q) = (
        Vector3::new(co, so, 0.0),
        Vector3::new(-so * ci, co * ci, si),
    );
    let a0 = orbit.argument_of_periapsis + orbit.true_anomaly;
    let (pp, qq) = (p.cross(&(I * p)), q.cross(&(I * q)));
    let pq = p.cross(&(I * q)) + q.cross(&(I * p));
    // Antiderivative of u x I u over a.
    let upto = |a: f64| {
        pp * (0.5 * a + 0.25 * (2.0 * a).sin())
            + qq * (0.5 * a - 0.25 * (2.0 * a).sin())
            + pq * (0.5 * a.sin().powi(2))
    };
    let times: Arc<[f64]> = (0..=200).map(|k| 10.0 * f64::from(k)).collect();
    let mut table = Table::default();
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        push(
            &mut table,
            &format!("omega_{axis}"),
            &times,
            vec![0.0; times.len()],
        );
        let h = |t: &f64| (upto(a0 + n * t) - upto(a0))[k] * 3.0 * n;
        let speed = times.iter().map(|t| 20.0 + h(t) / 0.05).collect();
        push(&mut table, &format!("w{k}_rad_s"), &times, speed);
    }
    for (axis, value) in [("x", 0.0), ("y", 0.0), ("z", 0.0), ("w", 1.0)] {
        push(
            &mut table,
            &format!("q_{axis}"),
            &times,
            vec![value; times.len()],
        );
    }
    let answer = ask(&off_nominal(&truth, 0.1), vec![table.clone()], "auto").estimate;
    let found = &answer.identifiability;
    assert_eq!(
        (found.parameters, found.rank),
        (6, 4),
        "{:?}",
        found.sigmas_natural
    );
    // Differences of moments and products are determined; each is compared with the truth.
    for c in &found.determined {
        let expected: f64 = c
            .coefficients
            .iter()
            .map(|(name, x)| {
                let element = name.rsplit('_').next().unwrap();
                let at = ["xx", "xy", "yy", "xz", "yz", "zz"]
                    .iter()
                    .position(|e| *e == element)
                    .unwrap();
                x * I[poinsot_identify::TENSOR[at]]
            })
            .sum();
        println!("{}: {:.9} of {expected:.9}", c.text, c.value);
        assert!((c.value - expected).abs() < 1.0e-5 * I.trace());
    }
    // In free fall nothing depends on the inertia.
    let mut free = off_nominal(&truth, 0.1);
    free.environment = Default::default();
    let answer = ask(&free, vec![table], "auto").estimate;
    assert_ne!(answer.status, Status::Converged);
}

/// Gravity is proportional to mass: a coasting body determines the ratios of its inertia but never their scale
/// (equivalence principle), even with the gradient. The gradient gives these ratios for a body that starts at rest,
/// which in free fall determines nothing.
#[test]
fn exact_coasting_from_rest_shows_ratios_and_no_scale() {
    let truth = in_orbit(satellite(8));
    let table = rotation_only(fly(&truth, &coast(&truth, Vector3::zeros())));
    let answer = ask(&off_nominal(&truth, 0.05), vec![table], "auto").estimate;
    assert_eq!(
        answer.identifiability.rank, 5,
        "{:?}",
        answer.identifiability.sigmas_natural
    );
    assert!(inertia(&answer).is_none());
    let mut free = truth.clone();
    free.environment = Default::default();
    let table = rotation_only(fly(&free, &coast(&free, Vector3::zeros())));
    let answer = ask(&off_nominal(&free, 0.05), vec![table], "auto").estimate;
    assert_eq!(answer.identifiability.rank, 0);
}

/// A wheel of known momentum sets the scale; the orbit is given by elements or columns.
#[test]
fn exact_tumble_with_a_wheel_gives_the_whole_tensor() {
    let truth = in_orbit(with_wheels(satellite(9)));
    let flight = coast(&truth, Vector3::new(2.0e-3, -3.0e-3, 1.0e-3));
    let mut flight = Flight {
        duration_s: 1500.0,
        rate_hz: 0.1,
        ..flight
    };
    for (k, wheel) in flight.plan.wheels.iter_mut().enumerate() {
        *wheel = poinsot_dynamics::WheelMotion::constant(1.0 + k as f64);
    }
    let mut table = rotation_only(fly(&truth, &flight));
    let model = off_nominal(&truth, 0.05);
    let scale = truth.bodies[0].nominal.I_BBcm_B;
    let error = |answer: &Estimate| (inertia(answer).unwrap() - scale).norm() / scale.norm();
    let by_elements = ask(&model, vec![table.clone()], "auto");
    assert_eq!(by_elements.estimate.status, Status::Converged);
    println!("by elements: {:.1e}", error(&by_elements.estimate));
    assert!(error(&by_elements.estimate) < 1.0e-7);

    let times = table.channels[0].time_s.clone();
    let orbit: Vec<Vector3> = times
        .iter()
        .map(|t| poinsot_dynamics::orbit_state(GM, &low_orbit(), *t).0)
        .collect();
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let values = orbit.iter().map(|r| r[k]).collect();
        push(&mut table, &format!("orbit_{axis}"), &times, values);
    }
    let mut by_columns = model.clone();
    by_columns.environment.orbit = None;
    let answer = ask(&by_columns, vec![table.clone()], "auto");
    println!("by columns: {:.1e}", error(&answer.estimate));
    assert!(error(&answer.estimate) < 1.0e-7);

    // Without the gradient the model is rejected.
    let mut without_gradient = model.clone();
    without_gradient.environment = Default::default();
    let wrong = ask(&without_gradient, vec![table.clone()], "auto").estimate;
    assert!(!wrong.covariance_trustworthy(), "{:?}", wrong.warnings());

    // Neither columns nor elements: an error.
    let blind = without(table.clone(), &["orbit_"]);
    let text = match identify_tables(by_columns, vec![blind], &request("auto")) {
        Err(error) => error.to_string(),
        Ok(_) => unreachable!("answered without an orbit"),
    };
    assert!(text.contains("E0301") && text.contains("orbit_x"), "{text}");
    let refused = identify_tables(model, vec![table], &request("linear"));
    assert_eq!(refused.err().map_or("", |e| e.code()), "E0001");
}

/// The same record in four counts of time, with the epoch of the elements in that count, gives one answer.
#[test]
fn exact_the_epoch_of_the_orbit_is_in_the_count_of_the_telemetry() {
    let mut truth = in_orbit(with_wheels(satellite(9)));
    let mut plain = Flight {
        duration_s: 1500.0,
        rate_hz: 0.1,
        ..coast(&truth, Vector3::new(2.0e-3, -3.0e-3, 1.0e-3))
    };
    for (k, wheel) in plain.plan.wheels.iter_mut().enumerate() {
        *wheel = poinsot_dynamics::WheelMotion::constant(1.0 + k as f64);
    }
    let table = rotation_only(fly(&truth, &plain));
    let unix = 1_773_512_340.0;
    // Zero of the count; epoch of its numbers, if declared; epoch of the elements in the file.
    let counts = [
        (0.0, None, None),
        (unix, None, None),
        (unix, None, Some(unix)),
        (unix, Some("unix"), Some(unix)),
        (
            unix - 315_964_800.0,
            Some("gps"),
            Some(unix - 315_964_800.0),
        ),
    ];
    let answers = counts.map(|(zero, counted_from, epoch)| {
        truth.environment.orbit = Some(Orbit {
            epoch,
            ..low_orbit()
        });
        let table = counted(&table, zero, counted_from);
        let answer = ask(&off_nominal(&truth, 0.05), vec![table], "auto");
        assert_eq!(answer.estimate.status, Status::Converged);
        inertia(&answer.estimate).unwrap()
    });
    for other in &answers {
        assert!((other - answers[0]).norm() < 1.0e-9 * answers[0].norm());
    }
    // An epoch in 1970 beside Unix times is a mistake.
    truth.environment.orbit = Some(Orbit {
        epoch: Some(12.5),
        ..low_orbit()
    });
    let table = counted(&table, unix, Some("unix"));
    let refused = identify_tables(truth, vec![table], &request("auto")).err();
    let text = refused.unwrap().to_string();
    assert!(text.contains("E0305") && text.contains("12.5"), "{text}");
}

/// The record as columns whose time counts from `zero`.
fn counted(table: &Table, zero: f64, epoch: Option<&str>) -> Table {
    let times = table.channels[0].time_s.iter().map(|t| t + zero);
    let column = |name: &str, values: Vec<f64>| (name.to_owned(), Values::Numbers(values));
    let mut columns = vec![column("time_s", times.collect())];
    let channels = table.channels.iter();
    columns.extend(channels.map(|c| column(&c.name, c.values.clone())));
    let mut options = ReadOptions::default();
    options.map.all.time = Some(TimeMap {
        column: "time_s".to_owned(),
        epoch: epoch.map(str::to_owned),
        ..TimeMap::default()
    });
    let name = "<arrays>".to_owned();
    let part = Part::Memory(Arc::new(MemoryColumns { name, columns }));
    read_parts(&[part], &options).unwrap()
}
