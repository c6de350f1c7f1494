//! Vehicles of generic geometry, their noise-free motion in memory, and their identification.
#![allow(dead_code)]

use nalgebra::{Rotation3, UnitQuaternion};
use poinsot::{Identified, Question, identify_tables};
use poinsot_dynamics::{
    Firing, Fourier, JointMotion, MotionSample, PiecewisePolynomial, Plan, Start, StartVelocity,
    Tolerance, Tree, WheelMotion,
};
use poinsot_model::{
    Body, Environment, EstimateSet, Joint, JointKind, Model, Momentum, Nuisance, Sensor,
    SensorKind, TelemetryMap, Thruster, Wheel,
};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use poinsot_telemetry::{Channel, Source, Table};
use std::sync::Arc;

/// Declared noise of all sensors, SI: small, so that every direction above round-off is identifiable.
pub const NOISE: f64 = 1.0e-9;

/// Deterministic random numbers (Steele, Lea and Flood 2014, SplitMix64).
pub struct Dice(u64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform between two bounds.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Components uniform between plus and minus `size`.
    pub fn vector(&mut self, size: f64) -> Vector3 {
        Vector3::from_fn(|_, _| self.between(-size, size))
    }

    /// Normal with mean zero and sigma one (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.between(1.0e-300, 1.0).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.between(0.0, 1.0)).cos()
    }

    /// A unit vector away from every coordinate axis.
    pub fn direction(&mut self) -> Vector3 {
        loop {
            let v = self.vector(1.0);
            let u = v.normalize();
            if v.norm() > 0.1 && u.amax() < 0.9 {
                return u;
            }
        }
    }

    pub fn rotation(&mut self) -> UnitQuaternion<f64> {
        let turn = self.direction() * self.between(0.5, 2.5);
        UnitQuaternion::from_scaled_axis(turn)
    }

    fn index(&mut self, below: usize) -> usize {
        (self.next() % below as u64) as usize
    }
}

/// A body of positive mass density: inertia `tr(S) 1 - S` of a random second moment S.
fn properties(dice: &mut Dice, mass: f64, size: f64) -> MassProperties {
    let spread = Vector3::from_fn(|_, _| dice.between(0.5, 1.0) * size);
    let R = dice.rotation().to_rotation_matrix().into_inner();
    let S = R * Matrix3::from_diagonal(&spread.component_mul(&spread)) * R.transpose() * mass;
    MassProperties {
        mass,
        p_BoBcm_B: dice.vector(0.6 * size),
        I_BBcm_B: Matrix3::identity() * S.trace() - S,
    }
}

/// A tree with one joint per letter: r revolute, p prismatic. All bodies are unknown; parents are random.
pub fn tree(seed: u64, joints: &str) -> Model {
    let mut dice = Dice::new(seed);
    let base = properties(&mut dice, 30.0, 0.8);
    let mut model = Model {
        name: format!("tree {seed} {joints}"),
        bodies: vec![body("bus", base, None)],
        joints: Vec::new(),
        wheels: Vec::new(),
        modes: Vec::new(),
        thrusters: Vec::new(),
        sensors: sensors(NOISE),
        momentum: Momentum::default(),
        environment: Environment::default(),
        telemetry: TelemetryMap::default(),
        knowledge: poinsot_model::Knowledge::default(),
        notes: Vec::new(),
    };
    for (k, letter) in joints.chars().enumerate() {
        let parent = dice.index(model.bodies.len());
        let mass = dice.between(12.0, 20.0);
        let link = properties(&mut dice, mass, 0.6);
        model
            .bodies
            .push(body(&format!("link{}", k + 1), link, Some(k)));
        let R_PC_zero = dice.rotation().to_rotation_matrix().into_inner();
        let axis_C = dice.direction();
        model.joints.push(Joint {
            name: format!("joint{}", k + 1),
            kind: match letter {
                'p' => JointKind::Prismatic,
                _ => JointKind::Revolute,
            },
            parent,
            child: k + 1,
            p_PoCo_P: dice.vector(0.8),
            R_PC_zero,
            axis_C,
            locked_at: None,
            spring_damper: None,
            spring_unknown: Vec::new(),
        });
    }
    model
}

pub fn body(name: &str, nominal: MassProperties, joint: Option<usize>) -> Body {
    Body {
        given: None,
        name: name.to_owned(),
        nominal,
        estimate: EstimateSet::ALL,
        prior: None,
        joint,
    }
}

/// Gyro, attitude, velocity and position on the base, all with one sigma in SI.
pub fn sensors(sigma: f64) -> Vec<Sensor> {
    [
        SensorKind::Gyro,
        SensorKind::Attitude,
        SensorKind::Velocity,
        SensorKind::Position,
    ]
    .into_iter()
    .map(|kind| sensor(kind, sigma))
    .collect()
}

pub fn sensor(kind: SensorKind, sigma: f64) -> Sensor {
    Sensor {
        slow: Vec::new(),
        name: kind.word().to_owned(),
        kind,
        body: 0,
        seen_from: 0,
        noise_covariance: Some(Matrix3::identity() * sigma * sigma),
        quantisation: 0.0,
        bias: Nuisance::Known,
        scale: Nuisance::Known,
        misalignment: Nuisance::Known,
        nonorthogonality: Nuisance::Known,
        lag: Nuisance::Known,
        R_BS: Matrix3::identity(),
        p_BoS_B: Vector3::zeros(),
        reference_N: None,
        of: Vec::new(),
    }
}

/// Three wheels on the base, not aligned with each other or the axes.
pub fn with_wheels(mut model: Model) -> Model {
    let mut dice = Dice::new(77);
    for k in 0..3 {
        model.wheels.push(Wheel {
            name: format!("wheel{}", k + 1),
            body: 0,
            axis_B: dice.direction(),
            spin_inertia: 0.05,
            at_rest: false,
            estimate: false,
            misalignment: Nuisance::Known,
        });
    }
    model
}

/// Three thrusters on the base with force and moment.
pub fn with_thrusters(mut model: Model) -> Model {
    let mut dice = Dice::new(99);
    for k in 0..3 {
        model.thrusters.push(Thruster {
            name: format!("thr{}", k + 1),
            body: 0,
            p_BoT_B: dice.vector(1.0),
            direction_B: dice.direction(),
            never_fires: false,
            scale: Nuisance::Known,
            propellant: None,
        });
    }
    model
}

/// Motion in one segment.
#[derive(Clone)]
pub struct Flight {
    pub plan: Plan,
    pub start: Start,
    pub duration_s: f64,
    pub rate_hz: f64,
}

/// Motion of a joint in a flight.
#[derive(Clone, Copy, PartialEq)]
pub enum Drive {
    Moves,
    Stands(f64),
}

/// A tumbling flight: joints as given, wheels along splines, thrusters one after the other.
pub fn flight(model: &Model, seed: u64, drives: &[Drive]) -> Flight {
    let mut dice = Dice::new(seed ^ 0x5eed);
    let duration_s = 20.0;
    let coordinates = Tree::new(model).coordinates;
    let mut plan = Plan::hold(model);
    for ((motion, &joint), drive) in plan.joints.iter_mut().zip(&coordinates).zip(drives) {
        let size = match model.joints[joint].kind {
            JointKind::Prismatic => 0.3,
            _ => 0.6,
        };
        let driven = match drive {
            Drive::Stands(position) => JointMotion::locked(*position),
            Drive::Moves => {
                let mut list = || (0..3).map(|_| dice.between(-size, size)).collect();
                JointMotion::Fourier(Fourier {
                    offset: 0.2,
                    base_frequency_hz: 0.05,
                    sine: list(),
                    cosine: list(),
                })
            }
        };
        *motion = driven.into();
    }
    for wheel in &mut plan.wheels {
        let times: Vec<f64> = (0..6).map(|k| 4.0 * f64::from(k)).collect();
        let speeds: Vec<f64> = times.iter().map(|_| dice.between(-150.0, 150.0)).collect();
        *wheel = WheelMotion::Speed(PiecewisePolynomial::cubic_clamped(&times, &speeds).unwrap());
    }
    for thruster in 0..model.thrusters.len() {
        let on = 2.0 + 5.0 * thruster as f64;
        plan.firings.push(Firing {
            thruster,
            on,
            off: on + 3.0,
            force: dice.between(4.0, 8.0),
        });
    }
    Flight {
        plan,
        start: Start {
            R_NB: dice.rotation(),
            p_NoBo_N: dice.vector(3.0),
            velocity: StartVelocity::Twist {
                v_NBo_N: dice.vector(0.3),
                w_NB_B: dice.vector(0.3),
            },
        },
        duration_s,
        rate_hz: 10.0,
    }
}

/// All joints moving.
pub fn moving(model: &Model, seed: u64) -> Flight {
    flight(model, seed, &vec![Drive::Moves; model.joints.len()])
}

/// Exact measurements of a flight: attitude, rate, position, velocity, joints, wheels, thrusters.
pub fn fly(model: &Model, flight: &Flight) -> Table {
    let rows = (flight.duration_s * flight.rate_hz).round() as usize;
    let times: Vec<f64> = (0..=rows).map(|k| k as f64 / flight.rate_hz).collect();
    let vehicle = poinsot_dynamics::Flight::new(model, &flight.plan, Tolerance::default()).unwrap();
    let mut samples: Vec<MotionSample> = Vec::new();
    vehicle
        .run(&flight.start, &times, |s| samples.push(s.clone()))
        .unwrap();
    let time_s: Arc<[f64]> = times.into();
    let mut channels = Vec::new();
    let mut add = |name: String, read: &dyn Fn(&MotionSample) -> f64| {
        channels.push(Channel {
            name,
            time_s: time_s.clone(),
            values: samples.iter().map(read).collect(),
            ..Channel::default()
        });
    };
    for (k, axis) in ["x", "y", "z", "w"].into_iter().enumerate() {
        add(format!("q_{axis}"), &|s| s.R_NB.coords[k]);
    }
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        add(format!("omega_{axis}"), &|s| s.w_NB_B[k]);
        add(format!("r_{axis}"), &|s| s.p_NoBo_N[k]);
        add(format!("v_{axis}"), &|s| s.v_NBo_N[k]);
    }
    let tree = Tree::new(model);
    for (k, &at) in tree.coordinates.iter().enumerate() {
        let joint = &model.joints[at];
        let unit = match joint.kind {
            JointKind::Prismatic => "m",
            _ => "rad",
        };
        add(format!("{}_{unit}", joint.name), &|s| s.q[k]);
        add(format!("{}_{unit}_s", joint.name), &|s| s.rates[k]);
    }
    for (k, wheel) in model.wheels.iter().enumerate() {
        add(format!("{}_rad_s", wheel.name), &|s| s.wheel_speed[k]);
    }
    for (k, thruster) in model.thrusters.iter().enumerate() {
        add(format!("{}_N", thruster.name), &|s| s.thrust[k]);
    }
    Table {
        channels,
        sources: vec![Source {
            path: model.name.clone(),
            sha256: String::new(),
            rows: rows + 1,
            time_s: [0.0, flight.duration_s],
        }],
        ..Table::default()
    }
}

/// The table without channels with these prefixes.
pub fn without(mut table: Table, prefixes: &[&str]) -> Table {
    table
        .channels
        .retain(|c| !prefixes.iter().any(|p| c.name.starts_with(p)));
    table
}

/// Only gyro, attitude and inputs.
pub fn rotation_only(table: Table) -> Table {
    without(table, &["r_", "v_"])
}

/// The vehicle with nominal errors of a few percent.
pub fn off_nominal(model: &Model, share: f64) -> Model {
    let mut dice = Dice::new(4711);
    let mut off = model.clone();
    for body in off.bodies.iter_mut().filter(|b| b.estimate.any()) {
        let asked = body.estimate;
        let given = &mut body.nominal;
        let mut factor = || 1.0 + dice.between(-share, share);
        if asked.mass {
            given.mass *= factor();
        }
        if asked.com {
            given.p_BoBcm_B *= factor();
        }
        if asked.inertia {
            given.I_BBcm_B *= factor();
        }
    }
    off
}

pub fn request(method: &str) -> Question {
    Question::by(method)
}

pub fn ask(model: &Model, tables: Vec<Table>, method: &str) -> Identified {
    identify_tables(model.clone(), tables, &request(method)).unwrap()
}

/// Largest error of a body's ten numbers, relative to its mass, size and inertia.
pub fn worst_error(answer: &Identified, truth: &Model, body: usize) -> f64 {
    let found = &answer.estimate.bodies[body];
    let true_body = &truth.bodies[body].nominal;
    let length = true_body.radius_of_gyration();
    let scale = true_body.mass * length * length;
    let mut worst = (found.mass.value.unwrap() - true_body.mass).abs() / true_body.mass;
    for k in 0..3 {
        let error = found.com[k].value.unwrap() - true_body.p_BoBcm_B[k];
        worst = worst.max(error.abs() / length);
    }
    for (k, element) in poinsot_identify::TENSOR.into_iter().enumerate() {
        let error = found.inertia[k].value.unwrap() - true_body.I_BBcm_B[element];
        worst = worst.max(error.abs() / scale);
    }
    worst
}

/// A rotation matrix from a rotation vector.
pub fn turned(v: Vector3) -> Matrix3 {
    Rotation3::new(v).into_inner()
}

/// One channel of a table, mutable.
pub fn channel<'a>(table: &'a mut Table, name: &str) -> &'a mut Channel {
    table.channels.iter_mut().find(|c| c.name == name).unwrap()
}

/// Keeps every n-th sample of channels with this prefix.
pub fn thinned(mut table: Table, prefix: &str, every: usize) -> Table {
    for c in &mut table.channels {
        if c.name.starts_with(prefix) {
            c.time_s = c.time_s.iter().copied().step_by(every).collect();
            c.values = c.values.iter().copied().step_by(every).collect();
        }
    }
    table
}

/// Adds white noise of one sigma to gyro, position and velocity, and a rotation of the same size to the attitude.
pub fn noisy(mut table: Table, seed: u64, sigma: f64) -> Table {
    let mut dice = Dice::new(seed);
    for name in [
        "omega_x", "omega_y", "omega_z", "r_x", "r_y", "r_z", "v_x", "v_y", "v_z",
    ] {
        if let Some(c) = table.channels.iter_mut().find(|c| c.name == name) {
            c.values
                .iter_mut()
                .for_each(|x| *x += sigma * dice.normal());
        }
    }
    let rows = channel(&mut table, "q_x").values.len();
    for k in 0..rows {
        let parts = ["q_w", "q_x", "q_y", "q_z"];
        let [w, x, y, z] = parts.map(|n| channel(&mut table, n).values[k]);
        let q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let small = Vector3::from_fn(|_, _| sigma * dice.normal());
        let q = q * UnitQuaternion::from_scaled_axis(small);
        for (name, value) in parts.into_iter().zip([q.w, q.i, q.j, q.k]) {
            channel(&mut table, name).values[k] = value;
        }
    }
    table
}

/// An unknown base with known links: an arm of two revolute joints.
pub fn known_arm(seed: u64) -> Model {
    let mut model = tree(seed, "rr");
    for body in &mut model.bodies[1..] {
        body.estimate = EstimateSet::default();
    }
    model
}
