//! The known numbers of a model: names, values and small changes.

use crate::knowledge::{KnownNumber, Origin, Uncertain, across};
use crate::vehicle::{Model, Nuisance, Propellant, SensorKind};
use poinsot_spatial::{MassProperties, Matrix3, TENSOR, Vector3, tensor_name};

/// A step of a known number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundStep {
    /// In the number's unit.
    pub size: f64,
    /// As results write it.
    pub words: &'static str,
}

impl KnownNumber {
    /// Name of a component in results.
    pub fn name(self, model: &Model, component: usize) -> String {
        let (table, k, key) = self.key();
        let part = match table {
            "body" => model.bodies.get(k).map(|b| &b.name),
            "joint" => model.joints.get(k).map(|j| &j.name),
            "wheel" => model.wheels.get(k).map(|w| &w.name),
            "thruster" => model.thrusters.get(k).map(|t| &t.name),
            _ => model.sensors.get(k).map(|s| &s.name),
        };
        let part = part.map_or("?", String::as_str);
        let what = key.trim_end_matches("_m").trim_end_matches("_rad");
        match self.components() {
            1 => format!("{part}.{what}"),
            2 => format!("{part}.{what}_{}", component + 1),
            3 => format!("{part}.{what}_{}", ["x", "y", "z"][component % 3]),
            _ => format!("{part}.{what}_{}", tensor_name(component)),
        }
    }

    /// Unit of its components in results.
    pub fn unit(self) -> &'static str {
        match self.key().2 {
            "mass" => "kg",
            "inertia" | "spin_inertia" => "kg m2",
            "force" => "1",
            "specific_impulse" => "s",
            key => key.rsplit('_').next().unwrap_or_default(),
        }
    }

    /// Value of a component in the model; zero for small rotations, one for a factor.
    pub fn value(self, model: &Model, component: usize) -> f64 {
        let value = || match self {
            Self::Mass(k) => Some(model.bodies.get(k)?.nominal.mass),
            Self::MassCentre(k) => Some(model.bodies.get(k)?.nominal.p_BoBcm_B[component % 3]),
            Self::Inertia(k) => Some(model.bodies.get(k)?.nominal.I_BBcm_B[TENSOR[component % 6]]),
            Self::SpinInertia(k) => Some(model.wheels.get(k)?.spin_inertia),
            Self::JointOrigin(k) => Some(model.joints.get(k)?.p_PoCo_P[component % 3]),
            Self::ForcePosition(k) => Some(model.thrusters.get(k)?.p_BoT_B[component % 3]),
            Self::SpecificImpulse(k) => Some(propellant_of(model, k)?.specific_impulse),
            Self::PropellantPlace(k) => Some(propellant_of(model, k)?.p_BoF_B[component % 3]),
            Self::Force(_) => Some(1.0),
            _ => None,
        };
        value().unwrap_or(0.0)
    }

    /// Sigma of a component in its unit, from the declared uncertainty.
    pub fn absolute(self, model: &Model, component: usize, sigma: f64) -> f64 {
        match self {
            Self::Mass(_) | Self::SpinInertia(_) | Self::SpecificImpulse(_) => {
                sigma * self.value(model, 0).abs()
            }
            Self::Inertia(k) => {
                let (i, j) = TENSOR[component % 6];
                let body = model.bodies.get(k);
                let I = body.map_or_else(Matrix3::zeros, |b| b.nominal.I_BBcm_B);
                sigma * (I[(i, i)] * I[(j, j)]).max(0.0).sqrt()
            }
            _ => sigma,
        }
    }

    /// A step of a component in round units, and its words in results: one per cent, one millimetre or one milliradian.
    pub fn round_step(self, model: &Model, component: usize) -> RoundStep {
        let (size, words) = match self.unit() {
            "m" => (1.0e-3, "1 mm"),
            "rad" => (1.0e-3, "1 mrad"),
            _ => (self.absolute(model, component, 1.0e-2), "1 %"),
        };
        RoundStep { size, words }
    }

    /// Whether the number is known: neither estimated nor with its own error parameter.
    pub fn is_known(self, model: &Model) -> bool {
        let body = |k: usize| model.bodies.get(k).filter(|b| b.nominal.mass > 0.0);
        let (wheel, joint) = (|k| model.wheels.get(k), |k| model.joints.get(k));
        let thruster = |k| model.thrusters.get(k);
        match self {
            Self::Mass(k) => body(k).is_some_and(|b| !b.estimate.mass),
            Self::MassCentre(k) => body(k).is_some_and(|b| !b.estimate.com),
            Self::Inertia(k) => body(k).is_some_and(|b| !b.estimate.inertia),
            // The momentum is measured: the number has no effect on it.
            Self::SpinInertia(k) => {
                wheel(k).is_some_and(|w| !w.estimate && !model.telemetry.has_momentum(&w.name))
            }
            Self::WheelAxis(k) => wheel(k).is_some_and(|w| w.misalignment == Nuisance::Known),
            Self::JointOrigin(k) => joint(k).is_some(),
            Self::JointAxis(k) => joint(k).is_some_and(|j| j.axis_C != Vector3::zeros()),
            Self::Force(k) => thruster(k).is_some_and(|t| t.scale == Nuisance::Known),
            Self::ForceDirection(k) | Self::ForcePosition(k) => thruster(k).is_some(),
            Self::SpecificImpulse(k) | Self::PropellantPlace(k) => {
                propellant_of(model, k).is_some()
            }
            Self::Mounting(k) => model.sensors.get(k).is_some_and(|s| {
                let own = match s.kind {
                    kind if kind.is_rotation() => s.bias,
                    _ => s.misalignment,
                };
                own == Nuisance::Known && reference_of(model, s.body) != Some(k)
            }),
        }
    }

    /// Changes a component of the mass, mass centre or inertia of a body by `change`: kg, m, kg m2. Other numbers leave it as it
    /// is.
    pub fn shift_body(self, body: &mut MassProperties, component: usize, change: f64) {
        match self {
            Self::Mass(_) => body.mass += change,
            Self::MassCentre(_) => body.p_BoBcm_B[component % 3] += change,
            Self::Inertia(_) => {
                let (i, j) = TENSOR[component % 6];
                body.I_BBcm_B[(i, j)] += change;
                if i != j {
                    body.I_BBcm_B[(j, i)] += change;
                }
            }
            _ => {}
        }
    }

    /// Changes a component of the model by `change`, in its unit. Rotations are about the directions across the axes
    /// of `nominal`. Force and mounting are not numbers of the model: they act on measurements, and the model is
    /// unchanged.
    pub fn shift(self, nominal: &Model, model: &mut Model, component: usize, change: f64) {
        let turn = |a: Option<&mut Vector3>, nominal: Option<&Vector3>| {
            if let Some((a, nominal)) = a.zip(nominal) {
                let about = across(nominal)[component % 2];
                *a = (*a + about.cross(nominal) * change).normalize();
            }
        };
        let (bodies, joints) = (&mut model.bodies, &mut model.joints);
        let (wheels, thrusters) = (&mut model.wheels, &mut model.thrusters);
        let number = match self {
            Self::Mass(k) | Self::MassCentre(k) | Self::Inertia(k) => {
                let body = bodies.get_mut(k).into_iter();
                return body.for_each(|b| self.shift_body(&mut b.nominal, component, change));
            }
            Self::WheelAxis(k) => {
                let of = nominal.wheels.get(k).map(|w| &w.axis_B);
                return turn(wheels.get_mut(k).map(|w| &mut w.axis_B), of);
            }
            Self::JointAxis(k) => {
                let of = nominal.joints.get(k).map(|j| &j.axis_C);
                return turn(joints.get_mut(k).map(|j| &mut j.axis_C), of);
            }
            Self::ForceDirection(k) => {
                let of = nominal.thrusters.get(k).map(|t| &t.direction_B);
                return turn(thrusters.get_mut(k).map(|t| &mut t.direction_B), of);
            }
            Self::SpinInertia(k) => wheels.get_mut(k).map(|w| &mut w.spin_inertia),
            Self::JointOrigin(k) => joints.get_mut(k).map(|j| &mut j.p_PoCo_P[component % 3]),
            Self::ForcePosition(k) => thrusters.get_mut(k).map(|t| &mut t.p_BoT_B[component % 3]),
            Self::SpecificImpulse(k) => {
                propellant_of_mut(model, k).map(|p| &mut p.specific_impulse)
            }
            Self::PropellantPlace(k) => {
                propellant_of_mut(model, k).map(|p| &mut p.p_BoF_B[component % 3])
            }
            Self::Force(_) | Self::Mounting(_) => None,
        };
        if let Some(number) = number {
            *number += change;
        }
    }
}

fn propellant_of(model: &Model, thruster: usize) -> Option<&Propellant> {
    model.thrusters.get(thruster)?.propellant.as_ref()
}

fn propellant_of_mut(model: &mut Model, thruster: usize) -> Option<&mut Propellant> {
    model.thrusters.get_mut(thruster)?.propellant.as_mut()
}

/// The sensor that defines the axes of its body: the first gyro, otherwise the first star tracker, otherwise the first
/// accelerometer.
fn reference_of(model: &Model, body: usize) -> Option<usize> {
    let kinds = [
        SensorKind::Gyro,
        SensorKind::Attitude,
        SensorKind::Accelerometer,
    ];
    let first = |kind: SensorKind| {
        let mut all = model.sensors.iter();
        all.position(|s| s.kind == kind && s.body == body)
    };
    kinds.into_iter().find_map(first)
}

impl Model {
    /// Every number of a model, requested or known.
    pub fn known_numbers(&self) -> Vec<KnownNumber> {
        use KnownNumber as N;
        let bodies = 0..self.bodies.len();
        let bodies = bodies.flat_map(|k| [N::Mass(k), N::MassCentre(k), N::Inertia(k)]);
        let joints = 0..self.joints.len();
        let joints = joints.flat_map(|k| [N::JointOrigin(k), N::JointAxis(k)]);
        let wheels = 0..self.wheels.len();
        let wheels = wheels.flat_map(|k| [N::SpinInertia(k), N::WheelAxis(k)]);
        let thrusters = self.thrusters.iter().enumerate();
        let thrusters = thrusters.flat_map(|(k, thruster)| {
            let force = [N::Force(k), N::ForceDirection(k), N::ForcePosition(k)];
            let propellant = [N::SpecificImpulse(k), N::PropellantPlace(k)];
            let propellant = thruster.propellant.is_some().then_some(propellant);
            force.into_iter().chain(propellant.into_iter().flatten())
        });
        let sensors = self.sensors.iter().enumerate().filter(|(_, s)| s.turns());
        let sensors = sensors.map(|(k, _)| N::Mounting(k));
        let rigid = bodies.chain(joints).chain(wheels);
        rigid.chain(thrusters).chain(sensors).collect()
    }

    /// The model with every known number uncertain by the defaults of one source.
    pub fn with_usual_uncertainty(mut self, origin: Origin) -> Self {
        let usual = |number: KnownNumber| Uncertain {
            number,
            sigma: number.usual_sigma(origin),
        };
        self.knowledge.uncertain = self.known_numbers().into_iter().map(usual).collect();
        self
    }

    /// Uncertain numbers that are known and not exact.
    pub fn uncertain(&self) -> impl Iterator<Item = &Uncertain> {
        let all = self.knowledge.uncertain.iter();
        all.filter(|u| u.sigma > 0.0 && u.number.is_known(self))
    }
}
