//! The checked vehicle: in SI, names resolved to indices.

use crate::knowledge::{Knowledge, across};
pub use poinsot_dynamics::propagation::{Mode, SpringNumber};
pub use poinsot_dynamics::{
    Axes, ErrorKey, Nuisance, Orbit, Sensor, SensorKind, SlowError, SpringDamper, printed_unit,
};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3};
use poinsot_telemetry::{STANDARD_GRAVITY, TelemetryMap};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A checked vehicle: a tree of bodies with joints, wheels, thrusters and sensors.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// Name of the vehicle.
    pub name: String,
    /// Bodies; the first is the base, and parents come before children.
    pub bodies: Vec<Body>,
    /// Joints in the order of the file; each belongs to one child body.
    pub joints: Vec<Joint>,
    /// Momentum wheels and geared rotors.
    pub wheels: Vec<Wheel>,
    /// Thrusters.
    pub thrusters: Vec<Thruster>,
    /// Flexible modes: panels, booms, propellant that moves.
    pub modes: Vec<FlexibleMode>,
    /// Sensors with their declared noise.
    pub sensors: Vec<Sensor>,
    /// Knowledge of the initial momentum.
    pub momentum: Momentum,
    /// Forces and torques of the environment.
    pub environment: Environment,
    /// Map from telemetry columns to channels.
    pub telemetry: TelemetryMap,
    /// Uncertainty of the known numbers.
    pub knowledge: Knowledge,
    /// Changes and notes of the reader; never an error.
    pub notes: Vec<String>,
}

/// One rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name, unique among bodies.
    pub name: String,
    /// Mass properties: true if known, nominal if unknown.
    pub nominal: MassProperties,
    /// Of a body whose tensor is unknown: as it was given, where that is not physical and the nearest that is stands in its place.
    pub given: Option<MassProperties>,
    /// Which of them are unknown.
    pub estimate: EstimateSet,
    /// One-sigma prior of the nominal values, if declared.
    pub prior: Option<Prior>,
    /// Index into [`Model::joints`] of the joint whose child is this body; `None` for the base.
    pub joint: Option<usize>,
}

/// Which mass properties of a body are unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct EstimateSet {
    /// Mass.
    pub mass: bool,
    /// Centre of mass.
    pub com: bool,
    /// Inertia tensor.
    pub inertia: bool,
}

impl EstimateSet {
    /// Names of what is unknown.
    pub fn words(&self) -> Vec<&'static str> {
        asked([
            ("mass", self.mass),
            ("com", self.com),
            ("inertia", self.inertia),
        ])
    }

    /// Whether a number is unknown, by its place among the ten mass properties.
    pub fn has(&self, number: usize) -> bool {
        match number {
            0 => self.mass,
            1..=3 => self.com,
            _ => self.inertia,
        }
    }

    /// Everything unknown.
    pub const ALL: Self = Self {
        mass: true,
        com: true,
        inertia: true,
    };

    /// Whether anything is unknown.
    pub fn any(&self) -> bool {
        self.mass || self.com || self.inertia
    }
}

/// One sigma of the nominal values of a body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "PriorFile", extend("x-code" = "E0117"))]
pub struct Prior {
    /// One sigma of the mass, kg.
    #[serde(rename = "mass_kg")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass: Option<f64>,
    /// One sigma of each component of the mass centre, m.
    #[serde(rename = "com_m")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub com: Option<f64>,
    /// One sigma of each element of the central inertia, kg m2.
    #[serde(rename = "inertia_kg_m2")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub inertia: Option<f64>,
    /// Relative sigma of the entropic prior on the whole body, no unit: 0.1 for a body known to about a
    /// tenth. It keeps the body physical.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub entropic: Option<f64>,
    /// Time in which the body may change by as much as the prior, s: the on-board filter takes its numbers as a random walk, whose
    /// covariance after this time is that of the prior. `identify` takes them as constant.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub forget_s: Option<f64>,
}

impl Prior {
    /// One sigma of a number, by its place among [`poinsot_spatial::MASS_PROPERTY_NAMES`].
    pub fn sigma(&self, number: usize) -> Option<f64> {
        match number {
            0 => self.mass,
            1..=3 => self.com,
            _ => self.inertia,
        }
    }
}

/// Kind of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "JointType")]
pub enum JointKind {
    /// Rotation about its axis; position in rad.
    Revolute,
    /// Translation along its axis; position in m.
    Prismatic,
    /// Rigid.
    Fixed,
}

impl JointKind {
    /// Name in the model file.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Fixed => "fixed",
        }
    }
}

/// A joint between parent P and child C; the child's frame origin Co lies in the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, unique among joints.
    pub name: String,
    /// Kind.
    pub kind: JointKind,
    /// Index of the parent body.
    pub parent: usize,
    /// Index of the child body.
    pub child: usize,
    /// Position of the child's origin relative to the parent's at joint position zero, in P, m.
    pub p_PoCo_P: Vector3,
    /// Rotation from C to P at joint position zero.
    pub R_PC_zero: Matrix3,
    /// Unit axis in C (the same components in P before `R_PC_zero` is applied); zero for a fixed joint.
    pub axis_C: Vector3,
    /// Position at which the joint is locked where telemetry has no column for it, rad or m; `None`: not declared.
    pub locked_at: Option<f64>,
    /// Spring and damper, if any. They move the joint where no column measures it and no position locks it.
    pub spring_damper: Option<SpringDamper>,
    /// Which of its numbers are unknown.
    pub spring_unknown: Vec<SpringNumber>,
}

impl Joint {
    /// Position where nothing moves it, rad or m: where it is locked, at the rest of its spring, or zero.
    pub fn standing_at(&self) -> f64 {
        let rest = self.spring_damper.map(|s| s.rest);
        self.locked_at.or(rest).unwrap_or(0.0)
    }

    /// Whether it is prismatic.
    pub fn slides(&self) -> bool {
        self.kind == JointKind::Prismatic
    }

    /// The numbers of its spring and damper, where it has one.
    pub fn spring_numbers(&self) -> impl Iterator<Item = (SpringNumber, f64)> {
        let each = self.spring_damper.into_iter();
        each.flat_map(|mut spring| SpringNumber::ALL.map(|n| (n, *n.of(&mut spring))))
    }

    /// Whether its spring and damper move it, where no column measures it.
    pub fn is_passive(&self) -> bool {
        self.spring_damper.is_some() && self.locked_at.is_none()
    }
}

/// An axisymmetric rotor on a body; the body's inertia includes the locked rotor.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheel {
    /// Name, unique among wheels.
    pub name: String,
    /// Index of the host body.
    pub body: usize,
    /// Unit spin axis in the host body's axes.
    pub axis_B: Vector3,
    /// Spin inertia Js, kg m2.
    pub spin_inertia: f64,
    /// Whether the spin inertia is unknown.
    pub estimate: bool,
    /// Whether it stands still where telemetry has no column for it.
    pub at_rest: bool,
    /// Unknown small tilt angles of the spin axis, rad, about the two directions of [`Self::tilt_axes`].
    pub misalignment: Nuisance,
}

impl Wheel {
    /// The two tilt directions across the spin axis, in host axes: the coordinate axis most perpendicular to it,
    /// orthogonalised, and the one that completes `axis, first, second` to a right-handed triad.
    pub fn tilt_axes(&self) -> [Vector3; 2] {
        across(&self.axis_B)
    }
}

/// A flexible mode of a body: its nominal numbers, and which of them are unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct FlexibleMode {
    /// Name, unique among modes.
    pub name: String,
    /// The numbers.
    pub mode: Mode,
    /// Which of them are unknown.
    pub estimate: ModeEstimate,
}

/// Which numbers of a mode are unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ModeEstimate {
    /// Frequency.
    pub frequency: bool,
    /// Damping ratio.
    pub damping: bool,
    /// Participation in translation.
    pub translation: bool,
    /// Participation in rotation.
    pub rotation: bool,
    /// Slope of the inertia.
    pub inertia_slope: bool,
}

impl ModeEstimate {
    /// Names of what is unknown.
    pub fn words(&self) -> Vec<&'static str> {
        asked([
            ("frequency", self.frequency),
            ("damping", self.damping),
            ("translation", self.translation),
            ("rotation", self.rotation),
            ("inertia slope", self.inertia_slope),
        ])
    }
}

/// A thruster on a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Thruster {
    /// Name, unique among thrusters.
    pub name: String,
    /// Index of the host body.
    pub body: usize,
    /// Position of the nozzle relative to the body's origin, in B, m.
    pub p_BoT_B: Vector3,
    /// Unit direction of the force on the body, in B.
    pub direction_B: Vector3,
    /// Whether it is off where telemetry has no column for it.
    pub never_fires: bool,
    /// Knowledge of the factor between declared and true thrust.
    pub scale: Nuisance,
    /// Propellant that it uses up; `None`: its mass is neglected.
    pub propellant: Option<Propellant>,
}

/// Propellant of a thruster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Propellant {
    /// Specific impulse, s.
    pub specific_impulse: f64,
    /// Where the propellant comes from, relative to the body's origin, in B, m.
    pub p_BoF_B: Vector3,
}

impl Propellant {
    /// What the thruster uses up, as the kernels take it.
    pub fn flow(&self) -> poinsot_dynamics::Propellant {
        poinsot_dynamics::Propellant {
            used: 1.0 / (STANDARD_GRAVITY * self.specific_impulse),
            p_BoF_B: self.p_BoF_B,
        }
    }
}

/// Knowledge of a momentum vector at the first sample, in N.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum MomentumKnowledge {
    /// Unknown.
    #[default]
    Estimate,
    /// Known, N s or N m s.
    Known(Vector3),
}

/// Knowledge of the initial momentum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Momentum {
    /// Linear momentum, N s.
    pub linear: MomentumKnowledge,
    /// Angular momentum about the system mass centre, N m s.
    pub angular: MomentumKnowledge,
}

/// Forces and torques of the environment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Environment {
    /// Gravitational parameter of the attracting body, m3/s2; `None` = free fall.
    pub point_mass_gm: Option<f64>,
    /// Whether gravity-gradient torque acts.
    pub gravity_gradient: bool,
    /// Reference orbit, if the file has its elements; telemetry may have its positions instead.
    pub orbit: Option<Orbit>,
    /// Whether a constant disturbance torque in body axes is unknown.
    pub disturbance_torque: Nuisance,
    /// Whether a constant disturbance torque in inertial axes is unknown.
    pub disturbance_torque_inertial: Nuisance,
    /// Random torque about the mass centre, if declared.
    pub random_torque: Option<RandomTorque>,
    /// Whether a drag torque `-c |w| w` is unknown, with one coefficient c per axis of the base, kg m2.
    pub drag_torque: Nuisance,
}

/// A random torque about the mass centre, with equal statistics about every axis of N: a Gauss-Markov process.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "RandomTorqueFile", extend("x-code" = "E0118"))]
#[allow(non_snake_case)]
pub struct RandomTorque {
    /// One sigma about each axis, N m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sigma_N_m: f64,
    /// Correlation time, to 1/e, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub correlation_s: f64,
}

impl Model {
    /// Unit of a sensor as a key suffix: `rad_s`.
    pub fn unit_of(&self, sensor: &Sensor) -> &'static str {
        let read = sensor.of.first().and_then(|j| self.joints.get(*j));
        sensor.kind.unit(read.is_some_and(Joint::slides))
    }

    /// Name of the joint, wheel or thruster at an index of a sensor's `of`.
    pub fn measured(&self, sensor: &Sensor, k: usize) -> Option<&str> {
        match sensor.kind {
            SensorKind::WheelSpeed => self.wheels.get(k).map(|w| w.name.as_str()),
            SensorKind::Thrust => self.thrusters.get(k).map(|t| t.name.as_str()),
            _ => self.joints.get(k).map(|j| j.name.as_str()),
        }
    }

    /// Where a body is on the base if only fixed joints lie between: rotation from its axes to those of the base, and its origin, m.
    fn fixed_to_base(&self, body: usize) -> Option<(Matrix3, Vector3)> {
        let (mut R, mut p, mut at) = (Matrix3::identity(), Vector3::zeros(), body);
        for _ in 0..self.bodies.len() {
            let Some(joint) = self.bodies.get(at)?.joint else {
                return Some((R, p));
            };
            let joint = self.joints.get(joint)?;
            if joint.kind != JointKind::Fixed {
                return None;
            }
            p = joint.p_PoCo_P + joint.R_PC_zero * p;
            R = joint.R_PC_zero * R;
            at = joint.parent;
        }
        None
    }

    /// Takes the sensors of links that are fixed to the base as sensors of the base, where they measure the same; returns which.
    pub(crate) fn seat_sensors(&mut self) -> Vec<usize> {
        let own = |s: &Sensor| s.body != 0 && !s.kind.is_scalar() && !s.kind.is_relative();
        let mut seated = Vec::new();
        for k in 0..self.sensors.len() {
            let Some(body) = Some(&self.sensors[k]).filter(|s| own(s)).map(|s| s.body) else {
                continue;
            };
            let Some((R, p)) = self.fixed_to_base(body) else {
                continue;
            };
            let sensor = &mut self.sensors[k];
            (sensor.R_BS, sensor.p_BoS_B) = (R * sensor.R_BS, p + R * sensor.p_BoS_B);
            sensor.body = 0;
            seated.push(k);
        }
        seated
    }

    /// Index of the body with this name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|b| b.name == name)
    }

    /// The joint that carries a body; `None` for the base.
    pub fn joint_of(&self, body: &Body) -> Option<&Joint> {
        self.joints.get(body.joint?)
    }

    /// Index of the joint with this name.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|j| j.name == name)
    }

    /// The joints that move, in the order of their coordinates.
    pub fn moving_joints(&self) -> impl Iterator<Item = &Joint> {
        let joints = self.joints.iter();
        joints.filter(|j| j.kind != JointKind::Fixed)
    }

    /// The ten nominal parameters of each body.
    pub fn nominal_parameters(&self) -> Vec<InertialParameters> {
        self.bodies.iter().map(|b| b.nominal.parameters()).collect()
    }

    /// Spin inertia of each wheel, kg m2.
    pub fn spin_inertias(&self) -> Vec<f64> {
        self.wheels.iter().map(|w| w.spin_inertia).collect()
    }

    /// Index of the wheel with this name.
    pub fn wheel(&self, name: &str) -> Option<usize> {
        self.wheels.iter().position(|w| w.name == name)
    }

    /// Index of the thruster with this name.
    pub fn thruster(&self, name: &str) -> Option<usize> {
        self.thrusters.iter().position(|t| t.name == name)
    }

    /// Sensors of one kind, in the order of the file.
    pub fn sensors_of(&self, kind: SensorKind) -> impl Iterator<Item = &Sensor> {
        self.sensors.iter().filter(move |s| s.kind == kind)
    }
}

/// Those that are asked for.
pub(crate) fn asked<P, const N: usize>(all: [(P, bool); N]) -> Vec<P> {
    all.into_iter().filter(|n| n.1).map(|n| n.0).collect()
}
