use schemars::JsonSchema;
use serde::Deserialize;

/// Where the known numbers of a table come from: it sets how uncertain they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SourceFile {
    /// A measurement of the part.
    Measured,
    /// A drawing or a computer model.
    Cad,
}

/// One sigma of the known numbers of a body; 0: exact.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyUncertaintyFile {
    /// Of the mass, relative, no unit: 0.01 for 1 %.
    pub mass: Option<f64>,
    /// Of each component of the mass centre, m.
    pub com_m: Option<f64>,
    /// Of the inertia, no unit: element ij relative to sqrt(I_ii I_jj).
    pub inertia: Option<f64>,
}

/// One sigma of the numbers of a joint; 0: exact.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointUncertaintyFile {
    /// Of each component of the origin, m.
    pub origin_m: Option<f64>,
    /// Of a turn of the axis, rad.
    pub axis_rad: Option<f64>,
}

/// One sigma of the known numbers of a wheel; 0: exact.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelUncertaintyFile {
    /// Of the spin inertia, relative, no unit.
    pub spin_inertia: Option<f64>,
    /// Of a turn of the spin axis, rad.
    pub axis_rad: Option<f64>,
}

/// One sigma of the known numbers of a thruster; 0: exact.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ThrusterUncertaintyFile {
    /// Of the force, relative, no unit.
    pub force: Option<f64>,
    /// Of a turn of its direction, rad.
    pub direction_rad: Option<f64>,
    /// Of each component of its position, m.
    pub position_m: Option<f64>,
    /// Of its specific impulse, relative, no unit. Needs specific_impulse_s.
    pub specific_impulse: Option<f64>,
    /// Of each component of the place of its propellant, m. Needs specific_impulse_s.
    pub propellant_m: Option<f64>,
}

/// One sigma of the mounting of a sensor; 0: exact.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SensorUncertaintyFile {
    /// Of a turn about each axis, rad.
    pub mounting_rad: Option<f64>,
}
