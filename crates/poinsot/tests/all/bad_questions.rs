//! A problem in other units, and incomplete problems: equal answers, correct sigmas, or an error.

use poinsot::case::{Case, parse_case, read_case};
use poinsot::simulate::simulate_case;
use poinsot::{Identified, Question, identify_tables};
use poinsot_identify::{BodyEstimate, Number, Status};
use poinsot_model::{Model, MomentumKnowledge, SensorKind, printed_unit, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};

fn example(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../data")
        .join(path)
}

fn ask(model: &Model, table: &Table, method: &str) -> Identified {
    identify_tables(model.clone(), vec![table.clone()], &request(method)).unwrap()
}

fn request(method: &str) -> Question {
    Question::by(method)
}

/// Samples of the declared sensors only, as when a file is read.
fn flown(case: &Case, model: &Model) -> Table {
    let mut table = simulate_case(case, model).unwrap().table;
    for (kind, prefix) in [(SensorKind::Position, "r_"), (SensorKind::Velocity, "v_")] {
        if model.sensors_of(kind).next().is_none() {
            table.channels.retain(|c| !c.name.starts_with(prefix));
        }
    }
    table
}

/// A simulated example case, with nominal errors of a few percent.
fn simulated(case: &str) -> (Model, Table) {
    let case = read_case(&example(case)).unwrap();
    let mut model = read_model(&case.model).unwrap();
    let table = flown(&case, &model);
    for body in model.bodies.iter_mut().filter(|b| b.estimate.any()) {
        if body.estimate.mass {
            body.nominal.mass *= 1.04;
        }
        if body.estimate.inertia {
            body.nominal.I_BBcm_B *= 1.06;
        }
    }
    (model, table)
}

/// Units of mass, length and time, as multiples of kg, m and s.
#[derive(Clone, Copy, Debug)]
struct Units {
    kg: f64,
    m: f64,
    s: f64,
}

impl Units {
    /// Factor from SI to these units.
    fn of(&self, mass: i32, length: i32, time: i32) -> f64 {
        self.kg.powi(-mass) * self.m.powi(-length) * self.s.powi(-time)
    }

    fn of_unit(&self, unit: &str) -> f64 {
        match unit {
            "" | "1" | "rad" => 1.0,
            "rad/s" => self.of(0, 0, -1),
            "rad/s2" | "rad/s^2" => self.of(0, 0, -2),
            "m" => self.of(0, 1, 0),
            "m/s" => self.of(0, 1, -1),
            "m/s2" | "m/s^2" => self.of(0, 1, -2),
            "N" => self.of(1, 1, -2),
            "N m" | "Nm" | "N*m" => self.of(1, 2, -2),
            other => panic!("unit {other}"),
        }
    }

    fn table(&self, table: &Table) -> Table {
        let mut scaled = table.clone();
        for channel in &mut scaled.channels {
            let (time, value) = (self.of(0, 0, 1), self.of_unit(&channel.unit));
            channel.time_s = channel
                .time_s
                .iter()
                .map(|t| t * time)
                .collect::<Vec<_>>()
                .into();
            channel.values.iter_mut().for_each(|x| *x *= value);
        }
        scaled
    }

    fn model(&self, model: &Model) -> Model {
        let mut scaled = model.clone();
        let length = self.of(0, 1, 0);
        for body in &mut scaled.bodies {
            body.nominal.mass *= self.of(1, 0, 0);
            body.nominal.p_BoBcm_B *= length;
            body.nominal.I_BBcm_B *= self.of(1, 2, 0);
        }
        for joint in &mut scaled.joints {
            joint.p_PoCo_P *= length;
        }
        for wheel in &mut scaled.wheels {
            wheel.spin_inertia *= self.of(1, 2, 0);
        }
        for thruster in &mut scaled.thrusters {
            thruster.p_BoT_B *= length;
        }
        for sensor in &mut scaled.sensors {
            sensor.p_BoS_B *= length;
            let unit = self.of_unit(printed_unit(sensor.kind.unit(false)));
            sensor.quantisation *= unit;
            if let Some(covariance) = &mut sensor.noise_covariance {
                *covariance *= unit * unit;
            }
        }
        scaled
    }
}

/// The ten numbers of a body, with the factors from SI to the units.
fn numbers(body: &BodyEstimate, units: Units) -> Vec<(Number, f64)> {
    let mut list = vec![(body.mass, units.of(1, 0, 0))];
    list.extend(body.com.map(|n| (n, units.of(0, 1, 0))));
    list.extend(body.inertia.map(|n| (n, units.of(1, 2, 0))));
    list
}

/// Largest difference of values and sigmas, relative to the largest of their kind.
fn largest_difference(si: &Identified, other: &Identified, units: Units) -> f64 {
    let mut worst: f64 = 0.0;
    for (a, b) in si.estimate.bodies.iter().zip(&other.estimate.bodies) {
        let pairs = numbers(a, units).into_iter().zip(numbers(b, units));
        let kinds: Vec<_> = pairs.collect();
        for range in [0..1, 1..4, 4..10] {
            let size = |pick: fn(&Number) -> Option<f64>| {
                let all = kinds[range.clone()].iter();
                all.filter_map(|((n, f), _)| pick(n).map(|x| (x * f).abs()))
                    .fold(1e-300, f64::max)
            };
            for pick in [(|n: &Number| n.value) as fn(&Number) -> Option<f64>, |n| {
                n.sigma
            }] {
                let scale = size(pick);
                for ((n, factor), (m, _)) in &kinds[range.clone()] {
                    match (pick(n), pick(m)) {
                        (Some(x), Some(y)) => worst = worst.max((x * factor - y).abs() / scale),
                        (None, None) => {}
                        other => panic!("{units:?}: {other:?}"),
                    }
                }
            }
        }
    }
    worst
}

#[test]
fn prop_other_units_of_mass_length_and_time_give_the_same_answer() {
    for case in ["cases/stsat3_spin.toml", "cases/tug_thrusters.toml"] {
        let (model, table) = simulated(case);
        for method in ["linear", "auto"] {
            let si = ask(&model, &table, method);
            for units in [
                Units {
                    kg: 1e-3,
                    m: 1e-2,
                    s: 1.0,
                },
                Units {
                    kg: 0.45359237,
                    m: 0.3048,
                    s: 60.0,
                },
                Units {
                    kg: 1e6,
                    m: 37.0,
                    s: 0.1,
                },
            ] {
                let other = ask(&units.model(&model), &units.table(&table), method);
                assert_eq!(si.estimate.status, other.estimate.status);
                let worst = largest_difference(&si, &other, units);
                println!("{case} {method} {units:?}: {worst:.1e}");
                assert!(worst < 1e-9, "{case} {method} {units:?}: {worst:e}");
            }
        }
    }
}

/// One rigid body, unknown momentum, no attitude sensor: N is the body frame at the start. The answer states it and
/// does not depend on the initial attitude.
#[test]
fn prop_without_attitude_the_answer_does_not_depend_on_where_the_body_pointed() {
    let text = std::fs::read_to_string(example("cases/stsat3_spin.toml")).unwrap();
    let mut answers = Vec::new();
    for q in [
        "[0.1, -0.2, 0.05, 0.9733961166965892]",
        "[0.0, 0.0, 0.0, 1.0]",
    ] {
        // The same motion in body axes, with another N.
        let changed = text.replace("[0.1, -0.2, 0.05, 0.9733961166965892]", q);
        let case = parse_case(&example("cases/stsat3_spin.toml"), changed).unwrap();
        let model = read_model(&case.model).unwrap();
        let mut table = flown(&case, &model);
        table.channels.retain(|c| !c.name.starts_with("q_"));
        let found = ask(&model, &table, "auto");
        assert!(
            found
                .repairs()
                .iter()
                .any(|r| r.contains("attitude integrated from the gyro")),
            "{:?}",
            found.repairs()
        );
        answers.push((model, found));
    }
    for (model, found) in &answers {
        assert_eq!(found.estimate.status, Status::Converged);
        let truth = model.bodies[0].nominal.I_BBcm_B;
        let at = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
        for (n, at) in found.estimate.bodies[0].inertia.iter().zip(at) {
            let z = (n.value.unwrap() - truth[at]) / n.sigma.unwrap();
            assert!(z.abs() < 4.0, "{at:?}: {z}");
        }
    }
}

/// Momentum given in N is undefined if no attitude relates the body to N.
#[test]
fn cli_known_momentum_without_attitude_is_no_confident_wrong_number() {
    let case = read_case(&example("cases/stsat3_spin.toml")).unwrap();
    let mut model = read_model(&case.model).unwrap();
    let mut table = simulate_case(&case, &model).unwrap().table;
    table.channels.retain(|c| !c.name.starts_with("q_"));
    model.momentum.angular = MomentumKnowledge::Known(Vector3::new(0.02, -0.05, 0.08));
    let truth = model.bodies[0].nominal.I_BBcm_B;
    match identify_tables(model, vec![table], &request("auto")) {
        Err(error) => assert!(error.to_string().starts_with("E0307"), "{error}"),
        Ok(found) => {
            let inertia = &found.estimate.bodies[0].inertia;
            let z = [0, 2, 5].map(|k| {
                let i = [0, 1, 2][[0, 2, 5].iter().position(|x| *x == k).unwrap()];
                inertia[k]
                    .value
                    .map(|v| (v - truth[(i, i)]) / inertia[k].sigma.unwrap())
            });
            assert!(
                z.iter().all(|z| z.is_none_or(|z| z.abs() < 5.0)),
                "confident and wrong: {z:?} sigma, {:?}",
                found.estimate.status
            );
        }
    }
}

/// Velocity in N without attitude.
#[test]
fn cli_velocity_without_attitude_is_no_confident_wrong_number() {
    let (model, table) = simulated("cases/tug_thrusters.toml");
    let turn = nalgebra::UnitQuaternion::from_euler_angles(0.5, -0.4, 0.9);
    let mut turned = table.clone();
    turned.channels.retain(|c| !c.name.starts_with("q_"));
    for prefix in ["v", "r"] {
        let at: Vec<usize> = ["x", "y", "z"]
            .iter()
            .filter_map(|k| {
                turned
                    .channels
                    .iter()
                    .position(|c| c.name == format!("{prefix}_{k}"))
            })
            .collect();
        let [x, y, z] = at[..] else { continue };
        for k in 0..turned.channels[x].values.len() {
            let of = |c: usize| turned.channels[c].values[k];
            let v = turn * Vector3::new(of(x), of(y), of(z));
            for (c, value) in [x, y, z].into_iter().zip(v.iter()) {
                turned.channels[c].values[k] = *value;
            }
        }
    }
    let case = read_case(&example("cases/tug_thrusters.toml")).unwrap();
    let truth = read_model(&case.model).unwrap().bodies[0].nominal.mass;
    match identify_tables(model, vec![turned], &request("auto")) {
        Err(error) => assert!(error.to_string().starts_with("E03"), "{error}"),
        Ok(found) => {
            let mass = &found.estimate.bodies[0].mass;
            let z = mass.value.map(|v| (v - truth) / mass.sigma.unwrap());
            assert!(
                z.is_none_or(|z| z.abs() < 5.0),
                "confident and wrong: {z:?} sigma"
            );
        }
    }
}
