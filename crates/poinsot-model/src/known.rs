//! The known numbers of a model: names, values and small changes.

use crate::knowledge::{KnownNumber, Origin, Uncertain, across};
use crate::vehicle::{Model, Nuisance, Propellant, SensorKind};
use poinsot_spatial::{MassProperties, Matrix3, TENSOR, Vector3, tensor_name};

impl KnownNumber {
    /// Name of a component in results.
    pub fn name(self, model: &Model, component: usize) -> String {
        let of = |list: Option<&str>, what: &str| format!("{}.{what}", list.unwrap_or("?"));
        let body = |k: usize| model.bodies.get(k).map(|b| b.name.as_str());
        let wheel = |k: usize| model.wheels.get(k).map(|w| w.name.as_str());
        let joint = |k: usize| model.joints.get(k).map(|j| j.name.as_str());
        let thruster = |k: usize| model.thrusters.get(k).map(|t| t.name.as_str());
        let axis = ["x", "y", "z"][component % 3];
        let across = component + 1;
        match self {
            Self::Mass(k) => of(body(k), "mass"),
            Self::MassCentre(k) => of(body(k), &format!("com_{axis}")),
            Self::Inertia(k) => of(body(k), &format!("inertia_{}", tensor_name(component))),
            Self::SpinInertia(k) => of(wheel(k), "spin_inertia"),
            Self::WheelAxis(k) => of(wheel(k), &format!("axis_{across}")),
            Self::JointOrigin(k) => of(joint(k), &format!("origin_{axis}")),
            Self::JointAxis(k) => of(joint(k), &format!("axis_{across}")),
            Self::Force(k) => of(thruster(k), "force"),
            Self::ForceDirection(k) => of(thruster(k), &format!("direction_{across}")),
            Self::ForcePosition(k) => of(thruster(k), &format!("position_{axis}")),
            Self::SpecificImpulse(k) => of(thruster(k), "specific_impulse"),
            Self::PropellantPlace(k) => of(thruster(k), &format!("propellant_{axis}")),
            Self::Mounting(k) => {
                let sensor = model.sensors.get(k).map(|s| s.name.as_str());
                of(sensor, &format!("mounting_{axis}"))
            }
        }
    }

    /// Unit of its components in results.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Mass(_) => "kg",
            Self::Inertia(_) | Self::SpinInertia(_) => "kg m2",
            Self::Force(_) => "1",
            Self::SpecificImpulse(_) => "s",
            Self::MassCentre(_)
            | Self::JointOrigin(_)
            | Self::ForcePosition(_)
            | Self::PropellantPlace(_) => "m",
            _ => "rad",
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
                let I = model
                    .bodies
                    .get(k)
                    .map_or(Matrix3::zeros(), |b| b.nominal.I_BBcm_B);
                sigma * (I[(i, i)] * I[(j, j)]).max(0.0).sqrt()
            }
            _ => sigma,
        }
    }

    /// Whether the number is known: neither estimated nor with its own error parameter.
    pub fn is_known(self, model: &Model) -> bool {
        let known = || match self {
            Self::Mass(k) => model
                .bodies
                .get(k)
                .map(|b| !b.estimate.mass && b.nominal.mass > 0.0),
            Self::MassCentre(k) => model
                .bodies
                .get(k)
                .map(|b| !b.estimate.com && b.nominal.mass > 0.0),
            Self::Inertia(k) => model
                .bodies
                .get(k)
                .map(|b| !b.estimate.inertia && b.nominal.mass > 0.0),
            Self::SpinInertia(k) => model.wheels.get(k).map(|w| !w.estimate),
            Self::WheelAxis(k) => model
                .wheels
                .get(k)
                .map(|w| w.misalignment == Nuisance::Known),
            Self::JointOrigin(k) => model.joints.get(k).map(|_| true),
            Self::JointAxis(k) => model.joints.get(k).map(|j| j.axis_C != Vector3::zeros()),
            Self::Force(k) => model.thrusters.get(k).map(|t| t.scale == Nuisance::Known),
            Self::ForceDirection(k) | Self::ForcePosition(k) => {
                model.thrusters.get(k).map(|_| true)
            }
            Self::SpecificImpulse(k) | Self::PropellantPlace(k) => {
                Some(propellant_of(model, k).is_some())
            }
            Self::Mounting(k) => model.sensors.get(k).map(|s| {
                let own = match s.kind {
                    kind if kind.is_rotation() => s.bias,
                    _ => s.misalignment,
                };
                own == Nuisance::Known && reference_of(model, s.body) != Some(k)
            }),
        };
        known().unwrap_or(false)
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
        match self {
            Self::Mass(k) | Self::MassCentre(k) | Self::Inertia(k) => {
                if let Some(body) = model.bodies.get_mut(k) {
                    self.shift_body(&mut body.nominal, component, change);
                }
            }
            Self::SpinInertia(k) => {
                if let Some(w) = model.wheels.get_mut(k) {
                    w.spin_inertia += change;
                }
            }
            Self::WheelAxis(k) => {
                if let (Some(w), Some(of)) = (model.wheels.get_mut(k), nominal.wheels.get(k)) {
                    w.axis_B = turned(&w.axis_B, &of.axis_B, component, change);
                }
            }
            Self::JointOrigin(k) => {
                if let Some(j) = model.joints.get_mut(k) {
                    j.p_PoCo_P[component % 3] += change;
                }
            }
            Self::JointAxis(k) => {
                if let (Some(j), Some(of)) = (model.joints.get_mut(k), nominal.joints.get(k)) {
                    j.axis_C = turned(&j.axis_C, &of.axis_C, component, change);
                }
            }
            Self::ForceDirection(k) => {
                let of = nominal.thrusters.get(k);
                if let (Some(t), Some(of)) = (model.thrusters.get_mut(k), of) {
                    t.direction_B = turned(&t.direction_B, &of.direction_B, component, change);
                }
            }
            Self::ForcePosition(k) => {
                if let Some(t) = model.thrusters.get_mut(k) {
                    t.p_BoT_B[component % 3] += change;
                }
            }
            Self::SpecificImpulse(k) => {
                if let Some(p) = propellant_of_mut(model, k) {
                    p.specific_impulse += change;
                }
            }
            Self::PropellantPlace(k) => {
                if let Some(p) = propellant_of_mut(model, k) {
                    p.p_BoF_B[component % 3] += change;
                }
            }
            Self::Force(_) | Self::Mounting(_) => {}
        }
    }
}

fn propellant_of(model: &Model, thruster: usize) -> Option<&Propellant> {
    model.thrusters.get(thruster)?.propellant.as_ref()
}

fn propellant_of_mut(model: &mut Model, thruster: usize) -> Option<&mut Propellant> {
    model.thrusters.get_mut(thruster)?.propellant.as_mut()
}

/// A unit vector after a small rotation about one of the directions across the nominal one.
fn turned(a: &Vector3, nominal: &Vector3, component: usize, angle: f64) -> Vector3 {
    (a + across(nominal)[component % 2].cross(nominal) * angle).normalize()
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
        let mut all = Vec::new();
        for k in 0..self.bodies.len() {
            all.extend([
                KnownNumber::Mass(k),
                KnownNumber::MassCentre(k),
                KnownNumber::Inertia(k),
            ]);
        }
        for k in 0..self.joints.len() {
            all.extend([KnownNumber::JointOrigin(k), KnownNumber::JointAxis(k)]);
        }
        for k in 0..self.wheels.len() {
            all.extend([KnownNumber::SpinInertia(k), KnownNumber::WheelAxis(k)]);
        }
        for (k, thruster) in self.thrusters.iter().enumerate() {
            all.extend([
                KnownNumber::Force(k),
                KnownNumber::ForceDirection(k),
                KnownNumber::ForcePosition(k),
            ]);
            if thruster.propellant.is_some() {
                all.extend([
                    KnownNumber::SpecificImpulse(k),
                    KnownNumber::PropellantPlace(k),
                ]);
            }
        }
        let sensors = self.sensors.iter().enumerate();
        let turning = sensors.filter(|(_, s)| s.turns());
        all.extend(turning.map(|(k, _)| KnownNumber::Mounting(k)));
        all
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
