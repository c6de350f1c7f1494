//! Uncertainty of the known numbers.
//!
//! One table gives the uncertainty by where a number comes from, a drawing unless the model says otherwise; a model file may
//! declare another one, or none at all (`exact = true`). The figures are engineering judgement; each has its reason beside it.

use poinsot_spatial::Vector3;

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
    /// Whether some table has no source, so that its known numbers are assumed to come from a drawing.
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
}

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
