//! Equal answers from other units, mountings, files and times, and from incomplete telemetry.

use super::*;
use crate::shared::shipped;
use poinsot::{IdentifyRequest, identify};
use poinsot_telemetry::{Channel, Source as File};
use std::path::PathBuf;

/// The vehicle in other units: one new kg is `kg` old ones smaller, and so on.
struct Units {
    kg: f64,
    m: f64,
    s: f64,
}

impl Units {
    fn model(&self, model: &Model) -> Model {
        let Self { kg, m, s } = *self;
        let mut out = model.clone();
        for body in &mut out.bodies {
            body.nominal.mass *= kg;
            body.nominal.p_BoBcm_B *= m;
            body.nominal.I_BBcm_B *= kg * m * m;
        }
        for joint in &mut out.joints {
            joint.p_PoCo_P *= m;
        }
        for wheel in &mut out.wheels {
            wheel.spin_inertia *= kg * m * m;
        }
        for sensor in &mut out.sensors {
            let unit = self.of(sensor.kind.word());
            sensor.noise_covariance = sensor.noise_covariance.map(|c| c * unit * unit);
            sensor.p_BoS_B *= m;
        }
        assert!(out.thrusters.is_empty() && s > 0.0);
        out
    }

    fn of(&self, what: &str) -> f64 {
        match what {
            "gyro" => 1.0 / self.s,
            "velocity" => self.m / self.s,
            "position" => self.m,
            _ => 1.0,
        }
    }

    fn table(&self, mut table: Table) -> Table {
        for c in &mut table.channels {
            c.time_s = c.time_s.iter().map(|t| t * self.s).collect();
            let unit = match c.name.as_str() {
                n if n.starts_with("omega_") || n.ends_with("_rad_s") => 1.0 / self.s,
                n if n.starts_with("v_") => self.m / self.s,
                n if n.starts_with("r_") => self.m,
                _ => 1.0,
            };
            c.values.iter_mut().for_each(|x| *x *= unit);
        }
        table
    }
}

#[test]
fn prop_other_units_same_answer() {
    let units = Units {
        kg: 1.0e3,
        m: 1.0e-3,
        s: 10.0,
    };
    let mut truth = with_wheels(known_arm(21));
    truth.sensors = sensors(1.0e-5);
    let (flight, ..) = drifting(&truth, 21);
    let table = noisy(fly(&truth, &flight), 21, 1.0e-5);
    let asked = off_nominal(&truth, 0.1);
    for method in METHODS {
        let here = ask(&asked, vec![table.clone()], method);
        let there = ask(
            &units.model(&asked),
            vec![units.table(table.clone())],
            method,
        );
        assert_eq!(here.estimate.status, there.estimate.status);
        let (a, b) = (&here.estimate.bodies[0], &there.estimate.bodies[0]);
        let size = truth.bodies[0].nominal.radius_of_gyration();
        let mass = truth.bodies[0].nominal.mass;
        let tensor = mass * size * size;
        let mut worst: f64 = 0.0;
        let mut same = |x: &Number, y: &Number, unit: f64, natural: f64| {
            let off = y.value.unwrap() / unit - x.value.unwrap();
            worst = worst.max(off.abs() / natural);
            let sigma = y.sigma.unwrap() / unit / x.sigma.unwrap() - 1.0;
            assert!(sigma.abs() < 1.0e-6, "{method}: sigma {sigma:.1e}");
        };
        same(&a.mass, &b.mass, units.kg, mass);
        for k in 0..3 {
            same(&a.com[k], &b.com[k], units.m, size);
        }
        for k in 0..6 {
            let unit = units.kg * units.m * units.m;
            same(&a.inertia[k], &b.inertia[k], unit, tensor);
        }
        println!("{method}: {worst:.1e}");
        assert!(worst < 1.0e-9, "{method}: {worst:.1e}");
    }
}

#[test]
fn exact_gyro_bias_is_found() {
    let truth = known_arm(22);
    let mut asked = off_nominal(&truth, 0.1);
    asked.sensors[0].bias = Nuisance::Estimate;
    let (flight, ..) = drifting(&truth, 22);
    let mut table = fly(&truth, &flight);
    let bias = [2.0e-3, -1.0e-3, 3.0e-3];
    for (axis, b) in ["x", "y", "z"].into_iter().zip(bias) {
        let column = channel(&mut table, &format!("omega_{axis}"));
        column.values.iter_mut().for_each(|w| *w += b);
    }
    let answer = ask(&asked, vec![table.clone()], "maximum_likelihood");
    assert_found(&answer, &truth, 1.0e-5, "biased gyro");
    for (axis, b) in ["x", "y", "z"].into_iter().zip(bias) {
        let found = nuisance(&answer, &format!("gyro.bias_{axis}"));
        println!("bias {axis}: {:?}", found.value);
        assert!((found.value.unwrap() - b).abs() < 1.0e-7);
        assert_eq!(found.source, Source::Data);
    }
    // The linear rows are first order in the bias at the nominal numbers: exact if these are the true ones.
    asked.bodies = truth.bodies.clone();
    let answer = ask(&asked, vec![table], "linear");
    for (axis, b) in ["x", "y", "z"].into_iter().zip(bias) {
        let found = nuisance(&answer, &format!("gyro.bias_{axis}"));
        println!("linear bias {axis}: {:?}", found.value);
        assert!((found.value.unwrap() - b).abs() < 1.0e-8);
    }
}

/// Position and velocity sensors far from the base origin, at different places.
#[test]
fn exact_sensors_may_sit_anywhere_on_the_base() {
    let mut truth = known_arm(28);
    let (flight, ..) = drifting(&truth, 28);
    let mut table = fly(&truth, &flight);
    let (p_BoR_B, p_BoV_B) = (Vector3::new(0.7, -0.4, 0.2), Vector3::new(-0.5, 0.3, 0.9));
    for k in 0..table.channels[0].values.len() {
        let mut read = |names: [&str; 3]| {
            Vector3::from_iterator(names.map(|n| channel(&mut table, n).values[k]))
        };
        let q = read(["q_x", "q_y", "q_z"]);
        let w_NB_B = read(["omega_x", "omega_y", "omega_z"]);
        let q_w = channel(&mut table, "q_w").values[k];
        let R_NB =
            nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::from_parts(q_w, q));
        for (name, shift) in [("r", R_NB * p_BoR_B), ("v", R_NB * w_NB_B.cross(&p_BoV_B))] {
            for (axis, by) in ["x", "y", "z"].into_iter().zip(shift.iter()) {
                channel(&mut table, &format!("{name}_{axis}")).values[k] += by;
            }
        }
    }
    for sensor in &mut truth.sensors {
        match sensor.kind {
            SensorKind::Position => sensor.p_BoS_B = p_BoR_B,
            SensorKind::Velocity => sensor.p_BoS_B = p_BoV_B,
            _ => {}
        }
    }
    for method in METHODS {
        let answer = ask(&off_nominal(&truth, 0.1), vec![table.clone()], method);
        assert_found(&answer, &truth, tolerance(method), method);
    }
}

#[test]
fn exact_what_is_missing_is_derived_and_said() {
    let mut truth = known_arm(23);
    truth.sensors = sensors(1.0e-4);
    let (flight, ..) = drifting(&truth, 23);
    let whole = fly(&truth, &flight);
    for (prefixes, words) in [
        (vec!["r_"], "position integrated from velocity"),
        (vec!["v_"], "velocity differentiated from position"),
        (vec!["joint1_rad_s"], "rate of joint1 differentiated"),
    ] {
        for method in METHODS {
            let table = without(whole.clone(), &prefixes);
            let answer = ask(&off_nominal(&truth, 0.1), vec![table], method);
            assert!(repaired(&answer, words), "{:?}", answer.repairs());
            assert_found(&answer, &truth, 2.0e-3, &format!("{prefixes:?} {method}"));
        }
    }
    let all = ask(&truth, vec![whole], "linear");
    // Of which point the velocity is, no record tells.
    let mut said = all.repairs();
    said.retain(|text| !text.starts_with("assumed: velocity and position refer"));
    assert!(said.is_empty(), "{said:?}");
}

#[test]
fn exact_an_attitude_that_nobody_measured_is_not_taken_for_the_identity() {
    let mut truth = known_arm(26);
    truth.sensors = sensors(1.0e-4);
    let (flight, ..) = drifting(&truth, 26);
    let table = without(fly(&truth, &flight), &["q_"]);
    for method in METHODS {
        // Velocity in N is hardly informative without attitude: a refusal, a rejection or the true values are
        // accepted.
        let asked = off_nominal(&truth, 0.1);
        let Ok(answer) = identify_tables(asked, vec![table.clone()], &request(method)) else {
            continue;
        };
        let e = &answer.estimate;
        println!(
            "{method}: {:?}, trustworthy {}",
            e.status,
            e.covariance_trustworthy()
        );
        if e.status == Status::Converged && e.covariance_trustworthy() {
            assert_found(&answer, &truth, 2.0e-3, method);
        } else {
            assert!(!e.warnings().is_empty());
        }
    }
}

#[test]
fn exact_gyro_and_wheels_alone_give_the_inertia() {
    let mut truth = with_wheels(tree(27, ""));
    truth.sensors = sensors(1.0e-6);
    truth.bodies[0].estimate = EstimateSet {
        inertia: true,
        ..EstimateSet::default()
    };
    let (flight, ..) = drifting(&truth, 27);
    let table = without(fly(&truth, &flight), &["q_", "r_", "v_"]);
    for method in METHODS {
        let asked = off_nominal(&truth, 0.1);
        let answer = ask(&asked, vec![table.clone()], method);
        assert!(repaired(&answer, "attitude integrated from the gyro"));
        assert_eq!(answer.estimate.status, Status::Converged);
        assert_found(&answer, &truth, WHEELS, method);
    }
}

#[test]
fn exact_a_slow_star_tracker_gives_the_same_answer() {
    let truth = known_arm(24);
    let (flight, ..) = drifting(&truth, 24);
    let slow = thinned(fly(&truth, &flight), "q_", 5);
    for method in METHODS {
        let answer = ask(&off_nominal(&truth, 0.1), vec![slow.clone()], method);
        assert_found(&answer, &truth, 1.0e-5, method);
        assert_eq!(answer.estimate.status, Status::Converged);
    }
}

#[test]
fn exact_two_files_of_one_segment_are_one_file() {
    let text =
        std::fs::read_to_string(shipped().join("stsat3/multiaxis/telemetry_noisy.csv")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    // Columns 0 to 7 are time, attitude and gyro; then the wheels.
    let part = |name: &str, keep: &dyn Fn(usize) -> bool| {
        let rows: Vec<String> = text
            .lines()
            .take(1001)
            .map(|row| {
                let cells = row.split(',').enumerate().filter(|(k, _)| keep(*k));
                cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
            })
            .collect();
        let path = folder.path().join(name);
        std::fs::write(&path, rows.join("\n") + "\n").unwrap();
        path
    };
    let whole = part("whole.csv", &|_| true);
    let rates = part("rates.csv", &|k| k < 8);
    let wheels = part("wheels.csv", &|k| k == 0 || k >= 8);
    let answer = |files: Vec<PathBuf>| {
        let request = IdentifyRequest {
            model: shipped().join("stsat3/model.toml"),
            segments: vec![files],
            ..IdentifyRequest::default()
        };
        identify(&request).unwrap()
    };
    let (one, two) = (answer(vec![whole]), answer(vec![rates, wheels]));
    assert_eq!(two.inputs[0].len(), 2);
    assert_eq!(one.estimate.bodies, two.estimate.bodies);
    assert_eq!(one.estimate.covariance, two.estimate.covariance);
}

/// A file of one sensor with its own times, between those of the others.
#[test]
fn exact_attitude_at_times_of_its_own() {
    let truth = known_arm(25);
    let (flight, ..) = drifting(&truth, 25);
    let fast = Flight {
        rate_hz: 60.0,
        ..flight.clone()
    };
    let fine = fly(&truth, &fast);
    // Attitude at 4 Hz, shifted by 1/60 s from the other sensors at 20 Hz.
    let shift = |c: &Channel, from: usize, every: usize| Channel {
        time_s: c.time_s.iter().copied().skip(from).step_by(every).collect(),
        values: c.values.iter().copied().skip(from).step_by(every).collect(),
        ..c.clone()
    };
    let table = Table {
        channels: fine
            .channels
            .iter()
            .map(|c| match c.name.starts_with("q_") {
                true => shift(c, 1, 15),
                false => shift(c, 0, 3),
            })
            .collect(),
        sources: vec![File {
            path: "two sensors".to_owned(),
            ..fine.sources[0].clone()
        }],
        ..Table::default()
    };
    let answer = ask(&off_nominal(&truth, 0.1), vec![table], "maximum_likelihood");
    assert_found(&answer, &truth, 1.0e-4, "attitude beside");
}
