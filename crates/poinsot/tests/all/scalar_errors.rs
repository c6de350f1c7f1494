//! Scales and biases of the sensors of joints and wheels: simulated, found, named.

use crate::vehicle::*;
use poinsot::case::{Case, parse_case};
use poinsot::simulate::simulate_trial;
use poinsot::{Identified, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{Model, Nuisance, Sensor, SensorKind, parse_model};
use poinsot_telemetry::Table;
use poinsot_testkit::vehicles::tug_with_arm;
use std::path::Path;

fn reader(kind: SensorKind, of: Vec<usize>) -> Sensor {
    let mut sensor = sensor(kind, 1.0);
    sensor.noise_covariance = None;
    sensor.of = of;
    sensor
}

fn found(answer: &Identified, name: &str) -> f64 {
    let list = &answer.estimate.nuisance;
    let n = list.iter().find(|n| n.name == name);
    let n = n.unwrap_or_else(|| unreachable!("no {name}"));
    println!("{name} = {:?} +- {:?}", n.number.value, n.number.sigma);
    n.number.value.unwrap()
}

fn change(table: &mut Table, name: &str, to: impl Fn(f64) -> f64) {
    let values = &mut channel(table, name).values;
    values.iter_mut().for_each(|x| *x = to(*x));
}

/// An arm with a sensor of position and one of rate for both joints, and its motion.
fn arm(errors: bool) -> (Model, Table) {
    let mut truth = known_arm(11);
    let mut encoder = reader(SensorKind::JointPosition, vec![0, 1]);
    let mut tachometer = reader(SensorKind::JointRate, vec![0, 1]);
    if errors {
        encoder.scale = Nuisance::Estimate;
        tachometer.scale = Nuisance::Estimate;
        tachometer.bias = Nuisance::Estimate;
    }
    truth.sensors.extend([encoder, tachometer]);
    let flight = Flight {
        rate_hz: 20.0,
        ..moving(&truth, 4)
    };
    let table = fly(&truth, &flight);
    (truth, table)
}

/// A sample is `(1 + scale) truth + bias`, of positions and of rates.
#[test]
fn exact_scales_of_joint_sensors_and_biases_of_rates_come_back() {
    let (truth, mut table) = arm(true);
    let planted = [[0.02, -0.01, 3.0e-3], [-0.03, 0.005, -2.0e-3]];
    for (k, [position, rate, bias]) in planted.into_iter().enumerate() {
        change(&mut table, &format!("joint{}_rad", k + 1), |q| {
            (1.0 + position) * q
        });
        change(&mut table, &format!("joint{}_rad_s", k + 1), |w| {
            (1.0 + rate) * w + bias
        });
    }
    let answer = ask(&off_nominal(&truth, 0.03), vec![table], "auto");
    for (k, values) in planted.into_iter().enumerate() {
        for (what, value) in ["position_scale", "rate_scale", "rate_bias"]
            .into_iter()
            .zip(values)
        {
            let error = found(&answer, &format!("joint{}.{what}", k + 1)) - value;
            assert!(error.abs() < 1.0e-6, "{what}: {error:e}");
        }
    }
    assert_eq!(answer.estimate.status, Status::Converged);
    assert!(worst_error(&answer, &truth, 0) < 1.0e-5);
}

/// Undeclared, each is named with its joint and value.
#[test]
fn exact_a_scale_of_a_joint_sensor_is_named_with_its_joint() {
    let (mut truth, clean) = arm(false);
    for s in &mut truth.sensors[..4] {
        s.noise_covariance = Some(poinsot_spatial::Matrix3::identity() * 1.0e-8);
    }
    for (column, name) in [
        ("joint2_rad", "a scale error of the position of joint2"),
        ("joint1_rad_s", "a scale error of the rate of joint1"),
    ] {
        let mut table = clean.clone();
        change(&mut table, column, |x| 1.05 * x);
        let answer = ask(&off_nominal(&truth, 0.02), vec![table], "auto");
        let all = answer.estimate.diagnostics.unwrap();
        let first = all.suspects.first().unwrap();
        println!("{first:?}");
        assert_eq!(first.name, name);
        assert!((first.values[0].value - 0.05).abs() < 5.0e-3);
    }
}

/// Only spin inertia times speed acts: a tachometer that measures `(1 + s)` of the speed makes `1 / (1 + s)` of the inertia.
#[test]
fn exact_a_scale_of_a_tachometer_is_a_spin_inertia() {
    let mut truth = with_wheels(known_arm(13));
    truth.sensors = sensors(1.0e-5);
    truth
        .sensors
        .push(reader(SensorKind::WheelSpeed, vec![0, 1, 2]));
    let mut table = fly(&truth, &moving(&truth, 14));
    let scale = 0.03;
    change(&mut table, "wheel2_rad_s", |w| (1.0 + scale) * w);
    let mut asked = off_nominal(&truth, 0.02);
    asked.wheels[1].estimate = true;
    let answer = ask(&asked, vec![table], "auto");
    let expected = truth.wheels[1].spin_inertia / (1.0 + scale);
    let error = found(&answer, "wheel2.spin_inertia") / expected - 1.0;
    assert!(error.abs() < 1.0e-4, "{error:e}");
    assert!(worst_error(&answer, &truth, 0) < 5.0e-4);
}

/// A tug with an arm and five wheels.
fn tug() -> Model {
    let mut text = tug_with_arm().text();
    for (k, axis) in [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.6, 0.8, 0.0],
        [0.0, 0.6, 0.8],
    ]
    .iter()
    .enumerate()
    {
        text += &format!(
            "\n[[wheel]]\nname = \"w{k}\"\nbody = \"bus\"\naxis = {axis:?}\nspin_inertia_kg_m2 = 0.02\n"
        );
    }
    for (name, kind, noise, more) in [
        ("gyro", "gyro", "noise_rad_s = 1e-5", ""),
        ("star", "attitude", "noise_rad = 2e-5", ""),
        ("speed", "velocity", "noise_m_s = 1e-4", ""),
        (
            "encoder",
            "joint_position",
            "noise_rad = 1e-4",
            "scale = \"estimate\"\n",
        ),
        ("tacho", "wheel_speed", "noise_rad_s = 1e-2", ""),
    ] {
        text += &format!("\n[[sensor]]\nname = \"{name}\"\ntype = \"{kind}\"\n{noise}\n{more}");
    }
    parse_model(&text, "tug.toml").unwrap()
}

/// A case of the tug; what follows goes to the sensors.
fn case(sensors: &str) -> Case {
    let mut text = "schema = \"poinsot.case/1\"\nmodel = \"tug.toml\"\nduration_s = 20.0\n[initial]\nomega_rad_s = [0.1, -0.15, 0.2]\n\
        [[joint_motion]]\njoint = \"elbow\"\ninterpolation = \"fourier\"\nbase_frequency_hz = 0.1\nsine_rad = [0.8]\ncosine_rad = [0.3]\n"
        .to_owned();
    for k in 0..5 {
        text += &format!(
            "[[wheel_motion]]\nwheel = \"w{k}\"\ntime_s = [0.0, 20.0]\nspeed_rad_s = [{}.0, 50.0]\n",
            20 * k
        );
    }
    text += &format!("[output]\nrate_hz = 5.0\nseed = 7\nsensors_only = true\n{sensors}");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    parse_case(&folder.join("tug.toml"), text).unwrap()
}

/// One trial in twenty exceeds two sigma; the mean square of 30 errors in sigmas is one within 0.26 (one sigma).
#[test]
fn stat_the_scale_of_a_simulated_encoder_is_found_within_its_sigma() {
    let (model, planted) = (tug(), 0.013);
    let case = case(&format!(
        "[[output.sensor]]\nname = \"encoder\"\nscale = [{planted}]\n"
    ));
    let error = |trial: u64| {
        let made = simulate_trial(&case, &model, trial).unwrap();
        assert_eq!(made.truth.nuisance["elbow.position_scale"].value, planted);
        let answer = identify_tables(model.clone(), vec![made.table], &request("auto")).unwrap();
        assert_eq!(answer.estimate.status, Status::Converged);
        let n = answer
            .estimate
            .nuisance
            .iter()
            .find(|n| n.name == "elbow.position_scale");
        let n = n.unwrap().number;
        (n.value.unwrap() - planted) / n.sigma.unwrap()
    };
    let errors: Vec<f64> = (0..30).map(error).collect();
    let mean = errors.iter().map(|e| e * e).sum::<f64>() / 30.0;
    println!("mean square {mean:.2}");
    assert!((0.4..1.9).contains(&mean), "{mean}");
}

#[test]
fn unit_truth_has_every_error_of_joints_and_wheels_by_its_address_in_estimates() {
    let made = simulate_trial(
        &case(
            "[[output.sensor]]\nname = \"tacho\"\nbias_rad_s = [0.1, 0.2, 0.3, 0.4, 0.5]\nscale = [0.0, 0.0, 0.0, 0.0, 0.02]\nlag_s = 0.05\n",
        ),
        &tug(),
        0,
    )
    .unwrap();
    let value = |address: &str| made.truth.nuisance.get(address).map(|n| n.value);
    for k in 0..5 {
        let address = format!("w{k}.speed_bias_rad_s");
        assert_eq!(
            value(&address),
            Some(0.1 * f64::from(k + 1)).map(|x| (10.0 * x).round() / 10.0)
        );
    }
    assert_eq!(value("w4.speed_scale"), Some(0.02));
    assert_eq!(value("w3.speed_scale"), None);
    assert_eq!(value("tacho.lag_s"), Some(0.05));
    assert_eq!(value("elbow.offset_rad"), Some(0.0));
    let speed = made
        .table
        .channels
        .iter()
        .find(|c| c.name == "w4_rad_s")
        .unwrap();
    // 80 rad/s at the start, with 2 % and 0.5 rad/s on it.
    assert!((speed.values[0] - 82.1).abs() < 0.05 && (speed.time_s[0] - 0.05).abs() < 1.0e-12);
}

/// The whole vehicle is given at the angles that are true, not at those that are read.
#[test]
fn exact_the_whole_vehicle_at_the_true_angles() {
    let (mut truth, mut table) = arm(false);
    let whole = |answer: &Identified| {
        let (body, position) = answer.estimate.system.clone().unwrap();
        let all = [std::slice::from_ref(&body.mass), &body.com, &body.inertia].concat();
        (
            all.iter().map(|n| n.value.unwrap()).collect::<Vec<f64>>(),
            position,
        )
    };
    let right = whole(&ask(
        &off_nominal(&truth, 0.03),
        vec![table.clone()],
        "auto",
    ));
    for sensor in &mut truth.sensors {
        if sensor.kind == SensorKind::JointPosition {
            (sensor.bias, sensor.scale) = (Nuisance::Estimate, Nuisance::Estimate);
        }
    }
    change(&mut table, "joint1_rad", |q| 1.02 * q + 0.1);
    let found = whole(&ask(&off_nominal(&truth, 0.03), vec![table], "auto"));
    for (a, b) in [(found.0, right.0), (found.1, right.1)] {
        for (a, b) in a.into_iter().zip(b) {
            assert!((a - b).abs() < 1.0e-5 * (1.0 + b.abs()), "{a} {b}");
        }
    }
}
