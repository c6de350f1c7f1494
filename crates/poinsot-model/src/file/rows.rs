//! Rows of the table of keys whose values are read by name: sigmas, and noise in the unit of a channel.
#![expect(dead_code, reason = "rows for the schema; their values are in maps")]

use schemars::JsonSchema;

// A number above zero.
#[derive(JsonSchema)]
#[schemars(inline, extend("exclusiveMinimum" = 0))]
pub(crate) struct Positive(f64);

// A number from zero to below one.
#[derive(JsonSchema)]
#[schemars(inline, extend("minimum" = 0, "exclusiveMaximum" = 1, "x-advice" = "give a share (0.01 for 1 %), metres or radians as the key says"))]
pub(crate) struct Share(f64);

// A number that is positive and whose square is.
#[derive(JsonSchema)]
#[schemars(inline, extend("exclusiveMinimum" = 0, "minimum" = 1e-100, "x-advice" = "give the noise of a real instrument"))]
pub(crate) struct Sigma(f64);

// A quantisation step.
#[derive(JsonSchema)]
#[schemars(inline, extend("exclusiveMinimum" = 0, "minimum" = 1e-100, "x-advice" = "give that of a real instrument"))]
pub(crate) struct Step(f64);

/// One sigma of the known numbers of a body; 0: exact.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
pub(crate) struct BodyUncertaintyFile {
    /// Of the mass, relative, no unit: 0.01 for 1 %.
    mass: Option<Share>,
    /// Of each component of the mass centre, m.
    com_m: Option<Share>,
    /// Of the inertia, no unit: element ij relative to sqrt(I_ii I_jj).
    inertia: Option<Share>,
}

/// One sigma of the numbers of a joint; 0: exact.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
pub(crate) struct JointUncertaintyFile {
    /// Of each component of the origin, m.
    origin_m: Option<Share>,
    /// Of a turn of the axis, rad.
    axis_rad: Option<Share>,
}

/// One sigma of the known numbers of a wheel; 0: exact.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
pub(crate) struct WheelUncertaintyFile {
    /// Of the spin inertia, relative, no unit.
    spin_inertia: Option<Share>,
    /// Of a turn of the spin axis, rad.
    axis_rad: Option<Share>,
}

/// One sigma of the known numbers of a thruster; 0: exact.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
pub(crate) struct ThrusterUncertaintyFile {
    /// Of the force, relative, no unit.
    force: Option<Share>,
    /// Of a turn of its direction, rad.
    direction_rad: Option<Share>,
    /// Of each component of its position, m.
    position_m: Option<Share>,
    /// Of its specific impulse, relative, no unit. Needs specific_impulse_s.
    #[schemars(extend("x-needs" = "specific_impulse_s"))]
    specific_impulse: Option<Share>,
    /// Of each component of the place of its propellant, m. Needs specific_impulse_s.
    #[schemars(extend("x-needs" = "specific_impulse_s"))]
    propellant_m: Option<Share>,
}

/// One sigma of the mounting of a sensor; 0: exact.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
pub(crate) struct SensorUncertaintyFile {
    /// Of a turn about each axis, rad.
    mounting_rad: Option<Share>,
}

/// One sigma about the nominal value; exactly one key, in the unit of the number.
#[derive(JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
#[allow(non_snake_case)]
pub(crate) struct SigmaFile {
    /// One sigma of a scale factor, no unit.
    sigma: Option<Positive>,
    /// One sigma, rad.
    sigma_rad: Option<Positive>,
    /// One sigma, rad/s.
    sigma_rad_s: Option<Positive>,
    /// One sigma, m.
    sigma_m: Option<Positive>,
    /// One sigma, m/s.
    sigma_m_s: Option<Positive>,
    /// One sigma, m/s2.
    sigma_m_s2: Option<Positive>,
    /// One sigma, N.
    sigma_N: Option<Positive>,
    /// One sigma, N m.
    sigma_N_m: Option<Positive>,
    /// One sigma of a coefficient of drag, kg m2.
    sigma_kg_m2: Option<Positive>,
    /// One sigma of a lag, s.
    sigma_s: Option<Positive>,
}
