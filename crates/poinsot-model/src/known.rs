//! How well the numbers are known that nobody asks for.
//!
//! One table gives the uncertainty by where a number comes from; a model file may declare another one, or none at all
//! (`exact = true`). The figures are engineering judgement; each has its reason beside it.

use crate::vehicle::{Model, Nuisance, SensorKind};
use poinsot_spatial::{Matrix3, Vector3};

/// Where the numbers of a table come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Origin {
    /// A drawing or a computer model.
    #[default]
    Cad,
    /// A measurement of the part.
    Measured,
}

impl Origin {
    /// The word of the model file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Cad => "cad",
            Self::Measured => "measured",
        }
    }
}

/// One number, or one vector or tensor, of the model; the index is that of its table in the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum KnownNumber {
    /// Mass of a body; uncertainty relative.
    Mass(usize),
    /// Mass centre of a body, m.
    MassCentre(usize),
    /// Central inertia of a body; uncertainty of element ij relative to `sqrt(I_ii I_jj)`.
    Inertia(usize),
    /// Spin inertia of a wheel; uncertainty relative.
    SpinInertia(usize),
    /// Spin axis of a wheel: turns about its two tilt axes, rad.
    WheelAxis(usize),
    /// Origin of a joint in its parent, m.
    JointOrigin(usize),
    /// Axis of a joint: turns about the two directions across it, rad.
    JointAxis(usize),
    /// Force of a thruster; uncertainty relative.
    Force(usize),
    /// Direction of a thruster's force: turns about the two directions across it, rad.
    ForceDirection(usize),
    /// Position of a thruster, m.
    ForcePosition(usize),
    /// Orientation of a sensor against the body's axes, rad.
    Mounting(usize),
}

/// Uncertainty of one known number: the same for each of its components.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// Which number.
    pub number: KnownNumber,
    /// One sigma, in the unit of [`KnownNumber`]; above zero.
    pub sigma: f64,
}

/// How well the known numbers of a model are known. The default: all of them exactly.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Knowledge {
    /// Uncertain numbers; every other one is exact.
    pub uncertain: Vec<Uncertain>,
    /// Whether some table says nothing of its source, so that its known numbers are taken as exact.
    pub assumed: bool,
    /// How far an answer may be from nominal: a factor of masses and principal moments, and as many radii of gyration of a
    /// mass centre; `None`: [`NOMINAL_WITHIN`].
    pub nominal_within: Option<f64>,
}

/// How far an answer may be from nominal unless the model says otherwise. Who knows a vehicle well enough to name its bodies
/// knows their masses within a factor of three.
pub const NOMINAL_WITHIN: f64 = 3.0;

/// Correlation of two spin inertias of wheels with the same nominal one: they come from one drawing or one test stand.
pub const LIKE_WHEELS: f64 = 0.7;

impl KnownNumber {
    /// One sigma by where the number comes from.
    pub fn usual_sigma(self, origin: Origin) -> f64 {
        let [measured, cad] = match self {
            // A balance resolves 0.1 %. Drawings miss harness, glue and paint: 3 % (ECSS-E-ST-10C and AIAA S-120A ask for a
            // growth allowance of 2 to 5 % on designed parts).
            Self::Mass(_) => [1.0e-3, 0.03],
            // A three-point table finds 1 mm; the mass missing from a drawing sits off the centre.
            Self::MassCentre(_) => [1.0e-3, 5.0e-3],
            // A torsion pendulum is good to 1 to 2 %; inertia errs by mass and by its distribution.
            Self::Inertia(_) => [0.015, 0.10],
            // A run-down or pendulum test of a rotor; a rotor is one turned part.
            Self::SpinInertia(_) => [3.0e-3, 0.02],
            // Alignment by a mirror; machined brackets.
            Self::WheelAxis(_) => [0.5e-3, 3.0e-3],
            // Laser tracker; tolerances of machining.
            Self::JointOrigin(_) => [1.0e-4, 5.0e-4],
            Self::JointAxis(_) => [2.0e-4, 1.0e-3],
            // Thrust stand; data sheet.
            Self::Force(_) => [0.02, 0.05],
            Self::ForceDirection(_) => [5.0e-3, 10.0e-3],
            Self::ForcePosition(_) => [1.0e-3, 3.0e-3],
            // Theodolite on alignment cubes; machined interfaces.
            Self::Mounting(_) => [1.0e-4, 3.0e-3],
        };
        match origin {
            Origin::Measured => measured,
            Origin::Cad => cad,
        }
    }

    /// How many components it has.
    pub fn components(self) -> usize {
        match self {
            Self::Mass(_) | Self::SpinInertia(_) | Self::Force(_) => 1,
            Self::WheelAxis(_) | Self::JointAxis(_) | Self::ForceDirection(_) => 2,
            Self::Inertia(_) => 6,
            _ => 3,
        }
    }

    /// Name of a component, as results write it.
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
            Self::Inertia(k) => of(
                body(k),
                &format!("inertia_{}", ELEMENT_NAMES[component % 6]),
            ),
            Self::SpinInertia(k) => of(wheel(k), "spin_inertia"),
            Self::WheelAxis(k) => of(wheel(k), &format!("axis_{across}")),
            Self::JointOrigin(k) => of(joint(k), &format!("origin_{axis}")),
            Self::JointAxis(k) => of(joint(k), &format!("axis_{across}")),
            Self::Force(k) => of(thruster(k), "force"),
            Self::ForceDirection(k) => of(thruster(k), &format!("direction_{across}")),
            Self::ForcePosition(k) => of(thruster(k), &format!("position_{axis}")),
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
            Self::MassCentre(_) | Self::JointOrigin(_) | Self::ForcePosition(_) => "m",
            _ => "rad",
        }
    }

    /// Value of a component in the model; zero for small turns, one for a factor.
    pub fn value(self, model: &Model, component: usize) -> f64 {
        let value = || match self {
            Self::Mass(k) => Some(model.bodies.get(k)?.nominal.mass),
            Self::MassCentre(k) => Some(model.bodies.get(k)?.nominal.p_BoBcm_B[component % 3]),
            Self::Inertia(k) => {
                Some(model.bodies.get(k)?.nominal.I_BBcm_B[ELEMENTS[component % 6]])
            }
            Self::SpinInertia(k) => Some(model.wheels.get(k)?.spin_inertia),
            Self::JointOrigin(k) => Some(model.joints.get(k)?.p_PoCo_P[component % 3]),
            Self::ForcePosition(k) => Some(model.thrusters.get(k)?.p_BoT_B[component % 3]),
            Self::Force(_) => Some(1.0),
            _ => None,
        };
        value().unwrap_or(0.0)
    }

    /// One sigma of a component in its unit, of an uncertainty as declared.
    pub fn absolute(self, model: &Model, component: usize, sigma: f64) -> f64 {
        match self {
            Self::Mass(_) | Self::SpinInertia(_) => sigma * self.value(model, 0).abs(),
            Self::Inertia(k) => {
                let (i, j) = ELEMENTS[component % 6];
                let I = model
                    .bodies
                    .get(k)
                    .map_or(Matrix3::zeros(), |b| b.nominal.I_BBcm_B);
                sigma * (I[(i, i)] * I[(j, j)]).max(0.0).sqrt()
            }
            _ => sigma,
        }
    }

    /// Whether the model takes it as known: it is neither estimated nor given an error of its own.
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
            Self::Mounting(k) => model.sensors.get(k).map(|s| {
                let own = match s.kind {
                    SensorKind::Attitude => s.bias,
                    _ => s.misalignment,
                };
                own == Nuisance::Known && reference_of(model, s.body) != Some(k)
            }),
        };
        known().unwrap_or(false)
    }

    /// Changes a component of the model by `change`, in its unit. Turns are about the directions across the axes of `nominal`.
    /// Force and mounting are no numbers of the model: they act on what is read, and the model stays as it is.
    pub fn shift(self, nominal: &Model, model: &mut Model, component: usize, change: f64) {
        match self {
            Self::Mass(k) => {
                if let Some(b) = model.bodies.get_mut(k) {
                    b.nominal.mass += change;
                }
            }
            Self::MassCentre(k) => {
                if let Some(b) = model.bodies.get_mut(k) {
                    b.nominal.p_BoBcm_B[component % 3] += change;
                }
            }
            Self::Inertia(k) => {
                if let Some(b) = model.bodies.get_mut(k) {
                    let (i, j) = ELEMENTS[component % 6];
                    b.nominal.I_BBcm_B[(i, j)] += change;
                    if i != j {
                        b.nominal.I_BBcm_B[(j, i)] += change;
                    }
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
            Self::Force(_) | Self::Mounting(_) => {}
        }
    }
}

/// Elements of a tensor, and their names, in the order of results.
const ELEMENTS: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
const ELEMENT_NAMES: [&str; 6] = ["xx", "xy", "yy", "xz", "yz", "zz"];

/// The two directions across a unit vector: the coordinate axis most across it, made square to it, and the one that
/// completes the triad.
pub fn across(a: &Vector3) -> [Vector3; 2] {
    let least = (0..3).fold(
        0,
        |best, k| if a[k].abs() < a[best].abs() { k } else { best },
    );
    let mut e = Vector3::zeros();
    e[least] = 1.0;
    let first = (e - a * a.dot(&e)).normalize();
    [first, a.cross(&first)]
}

/// A unit vector after a small turn about one of the directions across the nominal one.
fn turned(a: &Vector3, nominal: &Vector3, component: usize, angle: f64) -> Vector3 {
    (a + across(nominal)[component % 2].cross(nominal) * angle).normalize()
}

/// The sensor whose axes are those of its body: a body has no other marks. The first gyro, else the first tracker, else
/// the first accelerometer.
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
    /// Every number that a model holds beside its names, whether it is asked for or known.
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
        for k in 0..self.thrusters.len() {
            all.extend([
                KnownNumber::Force(k),
                KnownNumber::ForceDirection(k),
                KnownNumber::ForcePosition(k),
            ]);
        }
        let sensors = self.sensors.iter().enumerate();
        let turning = sensors.filter(|(_, s)| s.turns());
        all.extend(turning.map(|(k, _)| KnownNumber::Mounting(k)));
        all
    }

    /// The same model with every known number uncertain as the table says for one origin.
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
