use super::NuisanceFile;
use schemars::JsonSchema;
use serde::Deserialize;

/// External forces and torques. The default is free fall.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EnvironmentFile {
    /// "none" (default) or "point_mass".
    pub gravity: Option<Gravity>,
    /// Gravitational parameter of the attracting body, m3/s2. Required with, and only with, "point_mass".
    pub gm_m3_s2: Option<f64>,
    /// Whether the gravity-gradient torque is included. Needs gravity = "point_mass". Default false.
    pub gravity_gradient: Option<bool>,
    /// Reference orbit for the gravity gradient, where no columns orbit_x orbit_y orbit_z give it.
    pub orbit: Option<OrbitFile>,
    /// Constant torque in body axes, N m: "none" (default), "estimate", or { sigma_N_m = x }.
    pub disturbance_torque: Option<NuisanceFile>,
    /// Constant torque in inertial axes, N m: "none" (default), "estimate", or { sigma_N_m = x }.
    pub disturbance_torque_inertial: Option<NuisanceFile>,
    /// Torque of drag in body axes, -c |w| w with one coefficient an axis, kg m2: "none" (default), "estimate", or
    /// { sigma_kg_m2 = x }.
    pub drag_torque: Option<NuisanceFile>,
    /// Random torque about the mass centre, alike about every inertial axis, with its sigma and correlation time
    /// (Gauss-Markov), for example air or outgassing. None by default.
    pub random_torque: Option<RandomTorqueFile>,
}

/// A random torque.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(crate) struct RandomTorqueFile {
    /// One sigma about each axis, N m.
    pub sigma_N_m: f64,
    /// Correlation time, to 1/e, s.
    pub correlation_s: f64,
}

/// Kepler elements in the inertial axes N.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OrbitFile {
    /// Semi-major axis, m.
    #[schemars(required)]
    pub semi_major_axis_m: Option<f64>,
    /// Eccentricity, from 0 to below 1. Default 0.
    pub eccentricity: Option<f64>,
    /// Inclination to the xy plane of N, rad. Default 0.
    pub inclination_rad: Option<f64>,
    /// Right ascension of the ascending node from x of N, rad. Default 0.
    pub raan_rad: Option<f64>,
    /// Argument of periapsis from the node, rad. Default 0.
    pub argument_of_periapsis_rad: Option<f64>,
    /// True anomaly at the epoch, rad. Default 0.
    pub true_anomaly_rad: Option<f64>,
    /// Epoch in the count of the telemetry's time column, in seconds, for example Unix seconds; with dates, seconds
    /// since the first sample. Default: where the times of the run begin to count.
    pub epoch_s: Option<f64>,
}

/// Gravity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Gravity {
    /// Free fall.
    None,
    /// A point mass at the origin of the inertial frame.
    PointMass,
}
