//! Uncertainty of the known numbers.
//!
//! One table gives the uncertainty by the source of a number; the default source is a drawing. A model file may
//! declare another uncertainty, or none (`exact = true`). The figures are engineering judgement, each with its reason.

use crate::posterior::Posterior;
use poinsot_spatial::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the known numbers of a table come from: it sets how uncertain they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(rename = "SourceFile")]
pub enum Origin {
    /// A drawing or a computer model.
    #[default]
    Cad,
    /// A measurement of the part.
    Measured,
}

/// One known number, vector or tensor of the model; the index is that in its table.
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
    /// Spin axis of a wheel: rotations about its two tilt axes, rad.
    WheelAxis(usize),
    /// Origin of a joint in its parent, m.
    JointOrigin(usize),
    /// Axis of a joint: rotations about the two directions across it, rad.
    JointAxis(usize),
    /// Force of a thruster; uncertainty relative.
    Force(usize),
    /// Direction of a thruster's force: rotations about the two directions across it, rad.
    ForceDirection(usize),
    /// Position of a thruster, m.
    ForcePosition(usize),
    /// Specific impulse of a thruster; uncertainty relative.
    SpecificImpulse(usize),
    /// Place from which a thruster's propellant comes, m.
    PropellantPlace(usize),
    /// Orientation of a sensor relative to body axes, rad.
    Mounting(usize),
}

/// Uncertainty of one known number, equal for its components.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// The number.
    pub number: KnownNumber,
    /// One sigma, in the unit of [`KnownNumber`]; above zero.
    pub sigma: f64,
}

/// Uncertainty of the known numbers of a model. Default: all are exact.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Knowledge {
    /// Uncertain numbers; all others are exact.
    pub uncertain: Vec<Uncertain>,
    /// Whether a table has no source, so that its known numbers are assumed to come from a drawing.
    pub assumed: bool,
    /// Allowed deviation of an estimate from nominal: a factor for masses and principal moments, a multiple of the
    /// radius of gyration for a mass centre; `None`: [`NOMINAL_WITHIN`].
    pub nominal_within: Option<f64>,
    /// Correlation of the errors of two thrusters' known forces.
    pub thrust_correlation: f64,
    /// What an earlier answer told of the unknown numbers; no file declares it.
    pub posterior: Option<Posterior>,
}

impl Knowledge {
    /// Correlation of the errors of two numbers of this kind with equal nominal values.
    pub fn correlation(&self, number: KnownNumber) -> f64 {
        match number {
            KnownNumber::SpinInertia(_) => LIKE_WHEELS,
            KnownNumber::Force(_) => self.thrust_correlation,
            _ => 0.0,
        }
    }
}

/// Default allowed factor between estimate and nominal: the masses of a modelled vehicle are known within a factor of
/// three.
pub const NOMINAL_WITHIN: f64 = 3.0;

/// Correlation of two spin inertias with equal nominal values: they come from one drawing or test stand.
pub const LIKE_WHEELS: f64 = 0.7;

impl KnownNumber {
    /// Default sigma by source.
    pub fn usual_sigma(self, origin: Origin) -> f64 {
        let [measured, cad] = match self {
            // A balance resolves 0.1 %. Drawings omit harness, glue and paint: 3 % (ECSS-E-ST-10C and AIAA S-120A
            // require a growth allowance of 2 to 5 % on designed parts).
            Self::Mass(_) => [1.0e-3, 0.03],
            // A three-point table resolves 1 mm; mass missing in a drawing is off centre.
            Self::MassCentre(_) => [1.0e-3, 5.0e-3],
            // A torsion pendulum is accurate to 1 to 2 %; drawings err in mass and its distribution.
            Self::Inertia(_) => [0.015, 0.10],
            // Run-down or pendulum test of the rotor; a rotor is one machined part.
            Self::SpinInertia(_) => [3.0e-3, 0.02],
            // Mirror alignment; machined brackets.
            Self::WheelAxis(_) => [0.5e-3, 3.0e-3],
            // Laser tracker; machining tolerances.
            Self::JointOrigin(_) => [1.0e-4, 5.0e-4],
            Self::JointAxis(_) => [2.0e-4, 1.0e-3],
            // Thrust stand; data sheet.
            Self::Force(_) => [0.02, 0.05],
            Self::ForceDirection(_) => [5.0e-3, 10.0e-3],
            Self::ForcePosition(_) => [1.0e-3, 3.0e-3],
            // Thrust stand with a flow meter; data sheet, which pulses and cold starts do not reach.
            Self::SpecificImpulse(_) => [0.01, 0.05],
            // The mean of what a tank loses: known for a bladder, not for propellant that moves freely.
            Self::PropellantPlace(_) => [5.0e-3, 0.02],
            // Theodolite on alignment cubes; machined interfaces.
            Self::Mounting(_) => [1.0e-4, 3.0e-3],
        };
        match origin {
            Origin::Measured => measured,
            Origin::Cad => cad,
        }
    }

    /// List of tables of the model file, index in it (of a body: in the model), and key of the uncertainty.
    pub(crate) fn key(self) -> (&'static str, usize, &'static str) {
        match self {
            Self::Mass(k) => ("body", k, "mass"),
            Self::MassCentre(k) => ("body", k, "com_m"),
            Self::Inertia(k) => ("body", k, "inertia"),
            Self::JointOrigin(k) => ("joint", k, "origin_m"),
            Self::JointAxis(k) => ("joint", k, "axis_rad"),
            Self::SpinInertia(k) => ("wheel", k, "spin_inertia"),
            Self::WheelAxis(k) => ("wheel", k, "axis_rad"),
            Self::Force(k) => ("thruster", k, "force"),
            Self::ForceDirection(k) => ("thruster", k, "direction_rad"),
            Self::ForcePosition(k) => ("thruster", k, "position_m"),
            Self::SpecificImpulse(k) => ("thruster", k, "specific_impulse"),
            Self::PropellantPlace(k) => ("thruster", k, "propellant_m"),
            Self::Mounting(k) => ("sensor", k, "mounting_rad"),
        }
    }

    /// Number of components.
    pub fn components(self) -> usize {
        match self {
            Self::Mass(_) | Self::SpinInertia(_) | Self::Force(_) | Self::SpecificImpulse(_) => 1,
            Self::WheelAxis(_) | Self::JointAxis(_) | Self::ForceDirection(_) => 2,
            Self::Inertia(_) => 6,
            _ => 3,
        }
    }
}

/// Two directions across a unit vector: the coordinate axis most perpendicular to it, orthogonalised, and the one that
/// completes the triad.
///
/// ```
/// use poinsot_model::across;
/// use poinsot_spatial::Vector3;
///
/// // Across z: x, and y to complete the triad.
/// assert_eq!(across(&Vector3::z()), [Vector3::x(), Vector3::y()]);
/// ```
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
