use super::{InertiaFile, Which};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A flexible mode of a body: a panel, a boom, propellant that moves. Mass-normalised: with the body held, its kinetic energy is
/// half the square of its amplitude's rate. The numbers of the body contain the appendage at rest. At most 6.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModeFile {
    /// Name, unique among modes.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// Name of the body that carries it.
    #[schemars(required, extend("x-names" = "body"))]
    pub body: Option<String>,
    /// Natural frequency with the body held, Hz.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub frequency_Hz: Option<f64>,
    /// Share of critical damping with the body held, from 0 to below 1. Default 0.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1, "x-advice" = "give 0.005 for half a per cent"))]
    pub damping_ratio: Option<f64>,
    /// Linear momentum per rate of the amplitude, in the body's axes, kg^1/2. Default zero.
    pub translation_kg05: Option<[f64; 3]>,
    /// Angular momentum about the origin of the body's frame per rate of the amplitude, in the body's axes, kg^1/2 m. Default zero.
    pub rotation_kg05_m: Option<[f64; 3]>,
    /// Slope of the inertia tensor over the amplitude, about the vehicle's mass centre, in the body's axes, kg^1/2 m. Default zero.
    pub inertia_slope_kg05_m: Option<SlopeFile>,
    /// false (default): the numbers are known. true: all are unknown and the numbers nominal.
    /// Or a list of what is unknown.
    pub estimate: Option<Which<ModeParameter>>,
}

/// A panel on a hinge with a spring: a mode of its body, which contains the panel where the spring has no torque. Small angles.
#[allow(non_snake_case)]
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PanelFile {
    /// Name of its mode, unique among modes.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// Name of the body that carries it.
    #[schemars(required, extend("x-names" = "body"))]
    pub body: Option<String>,
    /// A point of the hinge from the origin of the body's frame, m.
    #[schemars(required)]
    pub hinge_m: Option<[f64; 3]>,
    /// Direction of the hinge, in the body's axes.
    #[schemars(required)]
    pub axis: Option<[f64; 3]>,
    /// Mass of the panel, kg.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
    /// Its mass centre from the point of the hinge, in the body's axes, m.
    #[schemars(required)]
    pub com_m: Option<[f64; 3]>,
    /// Its inertia about its mass centre, in the body's axes, kg m2.
    #[schemars(required)]
    pub inertia_kg_m2: Option<InertiaFile>,
    /// Stiffness of the hinge, N m/rad.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub stiffness_N_m_per_rad: Option<f64>,
    /// Damping of the hinge, N m s/rad; not negative. Default 0.
    #[schemars(extend("minimum" = 0))]
    pub damping_N_m_s_per_rad: Option<f64>,
    /// What of its mode is unknown, as of a mode.
    pub estimate: Option<Which<ModeParameter>>,
}

/// Propellant that moves against a spring: a mode of its body for each direction, named after the tank and the axis. The body
/// contains the propellant at rest. Small displacements.
#[allow(non_snake_case)]
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TankFile {
    /// Name, unique among tanks.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// Name of the body that carries it.
    #[schemars(required, extend("x-names" = "body"))]
    pub body: Option<String>,
    /// Where the moving mass rests, from the origin of the body's frame, m.
    #[schemars(required)]
    pub position_m: Option<[f64; 3]>,
    /// Mass that moves, kg.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
    /// Stiffness of its spring, N/m.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub stiffness_N_per_m: Option<f64>,
    /// Damping, N s/m; not negative. Default 0.
    #[schemars(extend("minimum" = 0))]
    pub damping_N_s_per_m: Option<f64>,
    /// The only direction in which it moves, in the body's axes. Default: along all three axes.
    pub axis: Option<[f64; 3]>,
    /// What of its modes is unknown, as of a mode.
    pub estimate: Option<Which<ModeParameter>>,
}

/// A symmetric tensor by elements, kg^1/2 m.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SlopeFile {
    /// Element xx. Default 0.
    pub xx: Option<f64>,
    /// Element yy. Default 0.
    pub yy: Option<f64>,
    /// Element zz. Default 0.
    pub zz: Option<f64>,
    /// Element xy. Default 0.
    pub xy: Option<f64>,
    /// Element xz. Default 0.
    pub xz: Option<f64>,
    /// Element yz. Default 0.
    pub yz: Option<f64>,
}

/// A group of numbers of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ModeParameter {
    /// The frequency.
    Frequency,
    /// The damping ratio.
    Damping,
    /// The participation in translation.
    Translation,
    /// The participation in rotation.
    Rotation,
    /// The slope of the inertia.
    InertiaSlope,
}
