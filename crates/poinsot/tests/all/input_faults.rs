//! Planted and recovered errors of inputs: offsets, lags, tilted wheels, torques constant in N.

use crate::vehicle;

use nalgebra::{Quaternion, UnitQuaternion};
use poinsot::{Identified, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{EstimateSet, Model, Nuisance, SensorKind};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::{Channel, Table};
use std::sync::Arc;
use vehicle::*;

fn found(answer: &Identified, name: &str) -> f64 {
    let list = &answer.estimate.nuisance;
    let n = list.iter().find(|n| n.name == name);
    let n = n.unwrap_or_else(|| unreachable!("no {name}"));
    println!("{name} = {:?} +- {:?}", n.number.value, n.number.sigma);
    n.number.value.unwrap()
}

fn shift(table: &mut Table, prefix: &str, by: f64) {
    for c in table
        .channels
        .iter_mut()
        .filter(|c| c.name.starts_with(prefix))
    {
        c.time_s = c.time_s.iter().map(|t| t + by).collect();
    }
}

/// A sensor of joints, wheels or thrusters that is exact except for the given errors.
fn reader(kind: SensorKind, of: Vec<usize>) -> poinsot_model::Sensor {
    let mut sensor = sensor(kind, 1.0);
    sensor.noise_covariance = None;
    sensor.of = of;
    sensor
}

#[test]
fn exact_offsets_of_moving_joints_come_back() {
    let mut truth = known_arm(11);
    let mut encoder = reader(SensorKind::JointPosition, vec![0, 1]);
    encoder.bias = Nuisance::Estimate;
    truth.sensors.push(encoder);
    let flight = Flight {
        rate_hz: 20.0,
        ..moving(&truth, 4)
    };
    let mut table = fly(&truth, &flight);
    let planted = [0.02, -0.013];
    for (k, offset) in planted.into_iter().enumerate() {
        let name = format!("joint{}_rad", k + 1);
        channel(&mut table, &name)
            .values
            .iter_mut()
            .for_each(|q| *q += offset);
    }
    let answer = ask(&off_nominal(&truth, 0.03), vec![table], "auto");
    for (k, offset) in planted.into_iter().enumerate() {
        let error = found(&answer, &format!("joint{}.offset", k + 1)) - offset;
        assert!(error.abs() < 1.0e-6, "{error:e}");
    }
    assert_eq!(answer.estimate.status, Status::Converged);
    assert!(worst_error(&answer, &truth, 0) < 1.0e-5);
}

#[test]
fn exact_tilted_wheels_come_back() {
    let model = with_wheels(tree(12, ""));
    let mut truth = model.clone();
    let planted = [[0.01, -0.02], [0.005, 0.015], [-0.012, 0.003]];
    for (wheel, tilt) in truth.wheels.iter_mut().zip(planted) {
        let across = wheel.tilt_axes();
        let a = wheel.axis_B;
        wheel.axis_B =
            (a + across[0].cross(&a) * tilt[0] + across[1].cross(&a) * tilt[1]).normalize();
    }
    let flight = Flight {
        rate_hz: 20.0,
        ..moving(&truth, 6)
    };
    let table = fly(&truth, &flight);
    // Declared noise, because the interpolation error of wheels is large compared with exact rates.
    let mut asked = off_nominal(&model, 0.03);
    asked.sensors = sensors(1.0e-5);
    for wheel in &mut asked.wheels {
        wheel.misalignment = Nuisance::Estimate;
    }
    let answer = ask(&asked, vec![table], "auto");
    for (k, tilt) in planted.into_iter().enumerate() {
        for (i, expected) in tilt.into_iter().enumerate() {
            let error =
                found(&answer, &format!("wheel{}.misalignment_{}", k + 1, i + 1)) - expected;
            assert!(error.abs() < 1.0e-5, "{error:e}");
        }
    }
    // The mass of a rigid body without thrusters is not identifiable; the wheels set the scale of its inertia.
    let body = &answer.estimate.bodies[0];
    let I = truth.bodies[0].nominal.I_BBcm_B;
    for (k, element) in poinsot_identify::TENSOR.into_iter().enumerate() {
        let error = body.inertia[k].value.unwrap() - I[element];
        assert!(error.abs() < 1.0e-5 * I.trace(), "{error:e}");
    }
}

/// Planted scale errors and nonorthogonality of a gyro are recovered.
#[test]
fn exact_a_gyro_whose_axes_are_not_square_comes_back() {
    let mut truth = with_wheels(known_arm(17));
    truth.sensors = sensors(1.0e-5);
    let flight = Flight {
        rate_hz: 20.0,
        ..moving(&truth, 6)
    };
    let mut table = fly(&truth, &flight);
    let (yz, xz, xy) = (3.0e-3, -2.0e-3, 4.0e-3);
    let error = Matrix3::new(0.01, xy, xz, xy, -0.02, yz, xz, yz, 0.015);
    let axes = ["omega_x", "omega_y", "omega_z"];
    for k in 0..channel(&mut table, "omega_x").values.len() {
        let w = Vector3::from(axes.map(|n| channel(&mut table, n).values[k]));
        let read = w + error * w;
        for (axis, name) in axes.into_iter().enumerate() {
            channel(&mut table, name).values[k] = read[axis];
        }
    }
    let mut asked = off_nominal(&truth, 0.03);
    for s in asked
        .sensors
        .iter_mut()
        .filter(|s| s.kind == SensorKind::Gyro)
    {
        s.scale = Nuisance::Estimate;
        s.nonorthogonality = Nuisance::Estimate;
    }
    let answer = ask(&asked, vec![table], "auto");
    for (pair, planted) in [("yz", yz), ("xz", xz), ("xy", xy)] {
        let name = format!("gyro.nonorthogonality_{pair}");
        assert!((found(&answer, &name) - planted).abs() < 1.0e-6);
    }
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        assert!((found(&answer, &format!("gyro.scale_{axis}")) - error[(k, k)]).abs() < 1.0e-6);
    }
    assert_eq!(answer.estimate.status, Status::Converged);
    assert!(worst_error(&answer, &truth, 0) < 1.0e-5);
}

/// An arm with declared sensors for joints, wheels and `more`, and its motion.
fn read_everywhere(noise: f64, more: &[SensorKind]) -> (Model, Table) {
    let mut truth = with_thrusters(with_wheels(known_arm(13)));
    truth.sensors = sensors(noise);
    let joints = reader(SensorKind::JointPosition, vec![0, 1]);
    let wheels = reader(SensorKind::WheelSpeed, vec![0, 1, 2]);
    truth.sensors.extend([joints, wheels]);
    let more = more.iter().map(|kind| reader(*kind, vec![0, 1, 2]));
    truth.sensors.extend(more);
    let flight = Flight {
        rate_hz: 10.0,
        ..moving(&truth, 14)
    };
    let table = fly(&truth, &flight);
    (truth, table)
}

/// Every sensor is 2 ms late, thrusters act 5 ms late; the remaining error is second order in the lag.
#[test]
fn exact_lags_of_all_sensors_come_back() {
    let lag = 2.0e-3;
    let (truth, clean) = read_everywhere(1.0e-5, &[SensorKind::Thrust]);
    let cases = [
        (SensorKind::Velocity, "v_", lag),
        (SensorKind::Position, "r_", lag),
        (SensorKind::JointPosition, "joint", lag),
        (SensorKind::WheelSpeed, "wheel", lag),
        (SensorKind::Thrust, "thr", -5.0e-3),
    ];
    for (kind, prefix, by) in cases {
        let mut table = clean.clone();
        shift(&mut table, prefix, by);
        let mut asked = off_nominal(&truth, 0.02);
        for s in asked.sensors.iter_mut().filter(|s| s.kind == kind) {
            s.lag = Nuisance::Estimate;
        }
        let answer = ask(&asked, vec![table], "auto");
        let error = found(&answer, &format!("{}.lag", kind.word())) - by.abs();
        assert!(error.abs() < 2.0e-5, "{}: {error:e}", kind.word());
        let worst = worst_error(&answer, &truth, 0);
        println!("{}: numbers of the base off by {worst:.1e}", kind.word());
        assert!(worst < 5.0e-4, "{}: {worst:e}", kind.word());
    }
}

/// An undeclared lag of 20 ms: the diagnosis names it first, with its sensor.
#[test]
fn exact_lags_of_20_ms_are_named_with_their_sensor() {
    let (truth, clean) = read_everywhere(1.0e-4, &[]);
    for (prefix, what) in [
        ("joint", "a lag of the joints"),
        ("wheel", "a lag of the wheels"),
        ("r_", "a lag of the position"),
        ("v_", "a lag of the velocity"),
    ] {
        let mut table = clean.clone();
        shift(&mut table, prefix, 0.02);
        let answer = ask(&off_nominal(&truth, 0.02), vec![table], "auto");
        let found = answer.estimate.diagnostics.unwrap();
        let first = found.suspects.first().unwrap();
        println!("{prefix}: {first:?}");
        assert_eq!(first.name, what);
        let lag = first.values[0].value;
        assert!((lag - 0.02).abs() < 0.002, "{prefix}: {lag}");
    }
}

/// Each wheel's tachometer has an offset of its own.
#[test]
fn exact_biases_of_wheel_speeds_come_back() {
    let (truth, mut table) = read_everywhere(1.0e-5, &[]);
    let planted = [0.5, -0.3, 0.2];
    for (k, bias) in planted.into_iter().enumerate() {
        let name = format!("wheel{}_rad_s", k + 1);
        let values = &mut channel(&mut table, &name).values;
        values.iter_mut().for_each(|w| *w += bias);
    }
    let mut asked = off_nominal(&truth, 0.02);
    for s in asked
        .sensors
        .iter_mut()
        .filter(|s| s.kind == SensorKind::WheelSpeed)
    {
        s.bias = Nuisance::Estimate;
    }
    let answer = ask(&asked, vec![table], "auto");
    for (k, bias) in planted.into_iter().enumerate() {
        let error = found(&answer, &format!("wheel{}.speed_bias", k + 1)) - bias;
        assert!(error.abs() < 1.0e-3, "{error:e}");
    }
    let worst = worst_error(&answer, &truth, 0);
    println!("numbers of the base off by {worst:.1e}");
    assert!(worst < 5.0e-4, "{worst:e}");
}

/// An undeclared offset of one tachometer: the diagnosis names it first, with its wheel and value.
#[test]
fn exact_a_bias_of_a_wheel_speed_is_named_with_its_wheel() {
    let (truth, mut table) = read_everywhere(1.0e-4, &[]);
    let values = &mut channel(&mut table, "wheel2_rad_s").values;
    values.iter_mut().for_each(|w| *w += 5.0);
    let answer = ask(&off_nominal(&truth, 0.02), vec![table], "auto");
    let found = answer.estimate.diagnostics.unwrap();
    let first = found.suspects.first().unwrap();
    println!("{first:?}");
    assert_eq!(first.name, "a bias of the speed of wheel2");
    assert!((first.values[0].value - 5.0).abs() < 0.1);
}

/// A body with a wheel of constant speed under a constant torque in N. It is integrated by fourth-order Runge-Kutta
/// with steps of a millisecond: Euler's equation and `q' = q w / 2`, without code of the program.
fn pushed(I: &Matrix3, h_w: &Vector3, T_N: &Vector3) -> Table {
    let inverse = I.try_inverse().unwrap();
    let slope = |q: &Quaternion<f64>, w: &Vector3| {
        let R = UnitQuaternion::from_quaternion(*q);
        let alpha = inverse * (R.inverse() * T_N - w.cross(&(I * w + h_w)));
        (q * Quaternion::from_imag(*w) * 0.5, alpha)
    };
    let mut q = Quaternion::new(0.8, 0.3, -0.2, 0.4).normalize();
    let mut w = Vector3::new(0.03, -0.05, 0.04);
    let (mut rates, mut attitudes) = (vec![w], vec![q]);
    let h = 1.0e-3;
    for k in 1..=40_000 {
        let (q1, w1) = slope(&q, &w);
        let (q2, w2) = slope(&(q + q1 * (0.5 * h)), &(w + w1 * (0.5 * h)));
        let (q3, w3) = slope(&(q + q2 * (0.5 * h)), &(w + w2 * (0.5 * h)));
        let (q4, w4) = slope(&(q + q3 * h), &(w + w3 * h));
        q = (q + (q1 + (q2 + q3) * 2.0 + q4) * (h / 6.0)).normalize();
        w += (w1 + (w2 + w3) * 2.0 + w4) * (h / 6.0);
        if k % 100 == 0 {
            rates.push(w);
            attitudes.push(q);
        }
    }
    let time_s: Arc<[f64]> = (0..rates.len()).map(|k| 0.1 * k as f64).collect();
    let mut table = Table::default();
    let mut add = |name: String, values: Vec<f64>| {
        table.channels.push(Channel {
            name,
            time_s: time_s.clone(),
            values,
            ..Channel::default()
        });
    };
    for (k, axis) in ["x", "y", "z", "w"].into_iter().enumerate() {
        add(
            format!("q_{axis}"),
            attitudes.iter().map(|q| q.coords[k]).collect(),
        );
    }
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        add(
            format!("omega_{axis}"),
            rates.iter().map(|w| w[k]).collect(),
        );
    }
    for k in 0..3 {
        add(
            format!("wheel{}_rad_s", k + 1),
            vec![60.0 - 20.0 * k as f64; rates.len()],
        );
    }
    table
}

#[test]
fn exact_torque_fixed_in_inertial_axes_comes_back() {
    let mut truth = with_wheels(tree(15, ""));
    truth
        .sensors
        .retain(|s| matches!(s.kind, SensorKind::Gyro | SensorKind::Attitude));
    truth.bodies[0].estimate = EstimateSet {
        inertia: true,
        ..EstimateSet::default()
    };
    let I = truth.bodies[0].nominal.I_BBcm_B;
    let speeds = [60.0, 40.0, 20.0];
    let h_w: Vector3 = truth
        .wheels
        .iter()
        .zip(speeds)
        .map(|(wheel, speed)| wheel.axis_B * (wheel.spin_inertia * speed))
        .sum();
    let T_N = Vector3::new(4.0e-3, -2.0e-3, 3.0e-3);
    let table = pushed(&I, &h_w, &T_N);
    let mut asked = off_nominal(&truth, 0.03);
    asked.environment.disturbance_torque_inertial = Nuisance::Estimate;
    let answer = ask(&asked, vec![table], "auto");
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let error = found(&answer, &format!("environment.torque_inertial_{axis}")) - T_N[k];
        assert!(error.abs() < 1.0e-8, "{error:e}");
    }
    assert_eq!(answer.estimate.status, Status::Converged);
}

#[test]
fn unit_a_fault_that_nobody_estimates_is_refused() {
    let mut model: Model = tree(16, "");
    let table = fly(&model, &moving(&model, 2));
    let velocity = model
        .sensors
        .iter_mut()
        .find(|s| s.kind == SensorKind::Velocity);
    velocity.unwrap().bias = Nuisance::Estimate;
    let text = match identify_tables(model, vec![table], &request("auto")) {
        Err(error) => error.to_string(),
        Ok(_) => unreachable!("a bias of the velocity was ignored"),
    };
    assert!(text.contains("E0305") && text.contains("bias"), "{text}");
}
