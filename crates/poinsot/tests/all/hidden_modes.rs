//! Flexible appendages that no model declares: the table of `docs/validation/flexible.md`.
//!
//! The truth is an exact multibody motion: panels on hinges, sliding masses and pendulums, each with spring and damper. The model for
//! identification is one rigid body. What is stated is the inertia of the undeformed vehicle, which the test adds up by itself.

use crate::tables;
use poinsot::case::parse_case;
use poinsot::trials::Study;
use poinsot::{Question, identify_tables};
use poinsot_identify::Estimate;
use poinsot_model::parse_model;
use poinsot_testkit::{Matrix3, Vector3};
use rayon::prelude::*;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};
use std::fmt::Write;
use std::path::Path;

/// A body on a spring.
struct Appendage {
    joint: &'static str,
    origin_m: [f64; 3],
    axis: [f64; 3],
    mass_kg: f64,
    com_m: [f64; 3],
    inertia_kg_m2: [f64; 3],
    stiffness: f64,
    damping: f64,
}

/// A vehicle, its rate at the start, and its appendages.
struct Vehicle {
    name: &'static str,
    spin_rad_s: f64,
    appendages: Vec<Appendage>,
}

const BUS_KG: f64 = 146.0;
const BUS: [f64; 3] = [13.9, 17.0, 19.9];
const BUS_PRODUCTS: [f64; 3] = [0.09, 0.13, 0.59];
const TORQUES: &str = r#"
[[wheel_motion]]
wheel = "wheel1"
time_s = [0.0, 12.0, 24.0, 120.0, 130.0, 140.0]
torque_N_m = [0.05, -0.05, 0, -0.04, 0.04, 0]
interpolation = "constant"

[[wheel_motion]]
wheel = "wheel2"
time_s = [40.0, 53.0, 66.0, 120.0, 131.0, 142.0]
torque_N_m = [0.05, -0.05, 0, 0.03, -0.03, 0]
interpolation = "constant"

[[wheel_motion]]
wheel = "wheel3"
time_s = [80.0, 91.0, 102.0, 150.0, 163.0, 176.0]
torque_N_m = [0.06, -0.06, 0, 0.05, -0.05, 0]
interpolation = "constant"
"#;

fn panel(y: f64, axis: [f64; 3], stiffness: f64) -> Appendage {
    Appendage {
        joint: "revolute",
        origin_m: [0.0, 0.4 * y, 0.0],
        axis,
        mass_kg: 4.0,
        com_m: [0.0, 0.5 * y, 0.0],
        inertia_kg_m2: [0.34, 0.12, 0.46],
        stiffness,
        damping: 0.02,
    }
}

fn tank(at: [f64; 3], axis: [f64; 3], stiffness: f64) -> Appendage {
    Appendage {
        joint: "prismatic",
        origin_m: at,
        axis,
        mass_kg: 3.0,
        com_m: [0.0; 3],
        inertia_kg_m2: [0.01, 0.01, 0.01],
        stiffness,
        damping: 0.08,
    }
}

fn pendulum() -> Appendage {
    Appendage {
        joint: "revolute",
        origin_m: [0.1, 0.0, 0.6],
        axis: [0.0, 1.0, 0.0],
        mass_kg: 3.0,
        com_m: [0.0, 0.0, -0.25],
        inertia_kg_m2: [0.012, 0.012, 0.01],
        stiffness: 1.0,
        damping: 0.004,
    }
}

fn vehicles() -> Vec<Vehicle> {
    let vehicle = |name, spin_rad_s, appendages| Vehicle {
        name,
        spin_rad_s,
        appendages,
    };
    let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    vec![
        vehicle("pendulum", 0.0, vec![pendulum()]),
        vehicle("one panel", 0.0, vec![panel(1.0, x, 8.0)]),
        vehicle(
            "two panels",
            0.0,
            vec![panel(1.0, x, 8.0), panel(-1.0, z, 20.0)],
        ),
        vehicle(
            "two tanks",
            0.0,
            vec![
                tank([0.3, 0.0, 0.5], x, 15.0),
                tank([0.5, 0.2, -0.4], z, 30.0),
            ],
        ),
        vehicle("spinner, pendulum", 0.1, vec![pendulum()]),
        vehicle("rigid", 0.0, vec![]),
    ]
}

impl Vehicle {
    fn text(&self) -> String {
        let [xx, yy, zz] = BUS;
        let [xy, xz, yz] = BUS_PRODUCTS;
        let mut text = format!(
            "schema = \"poinsot.model/1\"\nname = \"{}\"\nexact = true\n[[body]]\nname = \"bus\"\nmass_kg = {BUS_KG}\ncom_m = [0.0, 0.0, 0.0]\ninertia_kg_m2 = {{ xx = {xx}, yy = {yy}, zz = {zz}, xy = {xy}, xz = {xz}, yz = {yz} }}\n",
            self.name
        );
        for (k, a) in self.appendages.iter().enumerate() {
            let [xx, yy, zz] = a.inertia_kg_m2;
            let slides = a.joint == "prismatic";
            let (stiffness, damping) = match slides {
                true => ("stiffness_N_per_m", "damping_N_s_per_m"),
                false => ("stiffness_N_m_per_rad", "damping_N_m_s_per_rad"),
            };
            write!(
                text,
                "[[body]]\nname = \"part{k}\"\nmass_kg = {}\ncom_m = {:?}\ninertia_kg_m2 = {{ xx = {xx}, yy = {yy}, zz = {zz} }}\n[[joint]]\nname = \"spring{k}\"\ntype = \"{}\"\nparent = \"bus\"\nchild = \"part{k}\"\norigin_m = {:?}\naxis = {:?}\nspring_damper = {{ {stiffness} = {:?}, {damping} = {:?} }}\n",
                a.mass_kg, a.com_m, a.joint, a.origin_m, a.axis, a.stiffness, a.damping
            )
            .unwrap();
        }
        text + SENSORS
    }

    /// Mass and inertia about the mass centre of the undeformed vehicle.
    fn undeformed(&self) -> (f64, Vector3, Matrix3) {
        let [xx, yy, zz] = BUS;
        let [xy, xz, yz] = BUS_PRODUCTS;
        let bus = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let parts = self.appendages.iter().map(|a| {
            let at = Vector3::from(a.origin_m) + Vector3::from(a.com_m);
            let own = Matrix3::from_diagonal(&Vector3::from(a.inertia_kg_m2));
            (a.mass_kg, at, own)
        });
        let all: Vec<_> = [(BUS_KG, Vector3::zeros(), bus)]
            .into_iter()
            .chain(parts)
            .collect();
        let mass: f64 = all.iter().map(|p| p.0).sum();
        let centre: Vector3 = all.iter().map(|p| p.1 * p.0).sum::<Vector3>() / mass;
        let about = |(m, at, own): &(f64, Vector3, Matrix3)| {
            let r = at - centre;
            own + (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * *m
        };
        (mass, centre, all.iter().map(about).sum())
    }

    /// One rigid body with nominal numbers a tenth off.
    fn model_text(&self) -> String {
        let (mass, centre, I) = self.undeformed();
        format!(
            "schema = \"poinsot.model/1\"\nname = \"rigid\"\nexact = true\n[[body]]\nname = \"bus\"\nmass_kg = {mass}\ncom_m = {:?}\ninertia_kg_m2 = {{ xx = {}, yy = {}, zz = {} }}\nestimate = [\"inertia\"]\n{SENSORS}",
            centre.as_slice(),
            I[(0, 0)] * 0.9,
            I[(1, 1)] * 1.1,
            I[(2, 2)] * 0.95
        )
    }

    fn study(&self) -> Study {
        let start = match self.spin_rad_s {
            0.0 => "momentum_zero = true".to_owned(),
            rate => format!("omega_rad_s = [0.0, 0.0, {rate}]"),
        };
        let case = format!(
            "schema = \"poinsot.case/1\"\nmodel = \"truth.toml\"\nduration_s = 200.0\n[initial]\n{start}\n{TORQUES}\n[output]\nrate_hz = 5\nsensors_only = true\nseed = 3\n"
        );
        let case = parse_case(Path::new("case.toml"), case).unwrap();
        let truth = parse_model(&self.text(), "truth.toml").unwrap();
        let model = parse_model(&self.model_text(), "model.toml").unwrap();
        Study::of_case(&case, &truth, model).unwrap()
    }
}

const SENSORS: &str = r#"
[[wheel]]
name = "wheel1"
body = "bus"
axis = [1.0, 0.0, 0.0]
spin_inertia_kg_m2 = 0.002
[[wheel]]
name = "wheel2"
body = "bus"
axis = [0.0, 1.0, 0.0]
spin_inertia_kg_m2 = 0.002
[[wheel]]
name = "wheel3"
body = "bus"
axis = [0.0, 0.0, 1.0]
spin_inertia_kg_m2 = 0.002
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1.0e-5
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 3.0e-5
[[sensor]]
name = "tachometers"
type = "wheel_speed"
noise_rad_s = 0.01
[momentum]
linear_N_s = "estimate"
angular_N_m_s = "estimate"
"#;

/// Errors of the six elements of the inertia in their sigmas.
fn errors(estimate: &Estimate, truth: &Matrix3) -> Vec<f64> {
    let elements = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
    let numbers = estimate.bodies[0].inertia.iter().zip(elements);
    numbers
        .filter_map(|(n, at)| Some((n.value? - truth[at]) / n.sigma?))
        .collect()
}

fn modes(estimate: &Estimate) -> usize {
    let of = |n: &&poinsot_identify::NamedNumber| n.name.ends_with(".frequency");
    estimate.nuisance.iter().filter(of).count()
}

fn row(vehicle: &Vehicle, trials: u64) {
    let (_, _, truth) = vehicle.undeformed();
    let study = vehicle.study();
    let model = parse_model(&vehicle.model_text(), "model.toml").unwrap();
    let all: Vec<Estimate> = (0..trials)
        .into_par_iter()
        .map(|trial| identify_tables(model.clone(), study.draw(trial).0, &Question::default()))
        .map(|answer| answer.unwrap().estimate)
        .collect();
    let answered: Vec<&Estimate> = all.iter().filter(|e| e.passes()).collect();
    let z: Vec<f64> = answered.iter().flat_map(|e| errors(e, &truth)).collect();
    let count = z.len().max(1) as f64;
    let rms = (z.iter().map(|z| z * z).sum::<f64>() / count).sqrt();
    let largest = z.iter().fold(0.0_f64, |m, z| m.max(z.abs()));
    let outside = z.iter().filter(|z| z.abs() > 1.96).count();
    let found: Vec<usize> = answered.iter().map(|e| modes(e)).collect();
    tables::row(&[
        vehicle.name.to_owned(),
        trials.to_string(),
        answered.len().to_string(),
        format!(
            "{:?} to {:?}",
            found.iter().min().unwrap_or(&0),
            found.iter().max().unwrap_or(&0)
        ),
        format!("{rms:.2}"),
        format!("{:.1} %", 100.0 * (1.0 - outside as f64 / count)),
        format!("{largest:.1}"),
    ]);
    if std::env::var_os("POINSOT_WHY").is_some() {
        for e in all.iter().filter(|e| !e.passes()) {
            println!("{:?}", e.warnings());
        }
    }
    let Some(expected) = Some(vehicle.appendages.len()).filter(|_| trials > 0) else {
        return;
    };
    assert!(
        largest < 5.0,
        "{}: an answer is {largest:.1} sigma off",
        vehicle.name
    );
    let share = Binomial::new(0.9, trials).unwrap();
    assert!(
        share.cdf(answered.len() as u64) > 1.0e-4,
        "{}: {} answered",
        vehicle.name,
        answered.len()
    );
    let noise = ChiSquared::new(count).unwrap();
    assert!(
        noise.sf(rms * rms * count) > 1.0e-4,
        "{}: rms {rms:.2}",
        vehicle.name
    );
    if expected == 0 {
        assert_eq!(found.iter().max(), Some(&0), "a rigid vehicle has a mode");
    }
}

fn heading() {
    tables::heading(&[
        "vehicle",
        "trials",
        "answered",
        "modes",
        "rms z",
        "within 95 %",
        "largest z",
    ]);
}

#[test]
fn stat_hidden_modes_are_found_and_the_inertia_is_that_of_the_undeformed_vehicle() {
    heading();
    for vehicle in vehicles() {
        row(&vehicle, tables::trials(1));
    }
}

/// A periodic disturbance of constant amplitude in the rate: its frequency, harmonics and size.
struct Disturbance {
    name: &'static str,
    frequency_Hz: f64,
    harmonics: &'static [(f64, f64)],
    size_rad_s: f64,
}

const DISTURBANCES: [Disturbance; 3] = [
    Disturbance {
        name: "imbalance",
        frequency_Hz: 0.7,
        harmonics: &[(1.0, 1.0)],
        size_rad_s: 2.0e-5,
    },
    Disturbance {
        name: "alias of 3.3 Hz",
        frequency_Hz: 3.3,
        harmonics: &[(1.0, 1.0)],
        size_rad_s: 2.0e-5,
    },
    Disturbance {
        name: "limit cycle",
        frequency_Hz: 0.08,
        harmonics: &[(1.0, 1.0), (3.0, -0.11), (5.0, 0.04)],
        size_rad_s: 1.0e-4,
    },
];

/// The rate about x of a rigid vehicle with a disturbance of some phase.
fn disturb(tables: &mut [poinsot_telemetry::Table], of: &Disturbance, phase: f64) {
    let channels = tables.iter_mut().flat_map(|t| &mut t.channels);
    for channel in channels.filter(|c| c.name == "omega_x") {
        for (value, t) in channel.values.iter_mut().zip(channel.time_s.iter()) {
            let angle = std::f64::consts::TAU * of.frequency_Hz * t + phase;
            let waves = of.harmonics.iter().map(|(n, a)| a * (n * angle).sin());
            *value += of.size_rad_s * waves.sum::<f64>();
        }
    }
}

/// A disturbance of constant amplitude is no mode: no answer with one is reliable.
#[test]
fn stat_disturbances_of_constant_amplitude_are_not_taken_for_modes() {
    let vehicle = &vehicles()[5];
    let study = vehicle.study();
    let model = parse_model(&vehicle.model_text(), "model.toml").unwrap();
    tables::heading(&["disturbance", "trials", "with a mode", "of them reliable"]);
    for of in &DISTURBANCES {
        let trials = tables::trials(3);
        let all: Vec<Estimate> = (0..trials)
            .into_par_iter()
            .map(|trial| {
                let mut tables = study.draw(trial).0;
                disturb(&mut tables, of, trial as f64);
                let answer = identify_tables(model.clone(), tables, &Question::default());
                answer.unwrap().estimate
            })
            .collect();
        let found = all.iter().filter(|e| modes(e) > 0);
        let reliable = found.clone().filter(|e| e.passes()).count();
        tables::row(&[
            of.name.to_owned(),
            trials.to_string(),
            found.count().to_string(),
            reliable.to_string(),
        ]);
        assert_eq!(reliable, 0, "{}", of.name);
    }
}
