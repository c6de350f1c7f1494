use super::NuisanceFile;
use crate::vehicle::RandomTorque;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// External forces and torques. The default is free fall.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EnvironmentFile {
    /// "none" (default) or "point_mass".
    pub gravity: Option<Gravity>,
    /// Gravitational parameter of the attracting body, m3/s2. Required with, and only with, "point_mass".
    #[schemars(extend("x-only" = {"gravity": ["point_mass"]}, "x-only-code" = "E0106", "x-required" = {"gravity": ["point_mass"]}, "exclusiveMinimum" = 0))]
    pub gm_m3_s2: Option<f64>,
    /// Whether the gravity-gradient torque is included. Needs gravity = "point_mass". Default false.
    #[schemars(extend("x-only" = {"gravity": ["point_mass"]}, "x-only-code" = "E0106"))]
    pub gravity_gradient: Option<bool>,
    /// Reference orbit for the gravity gradient, where no columns orbit_x orbit_y orbit_z give it.
    #[schemars(extend("x-only" = {"gravity_gradient": [true]}, "x-only-code" = "E0106"))]
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
    pub random_torque: Option<RandomTorque>,
}

/// Kepler elements in the inertial axes N.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OrbitFile {
    /// Semi-major axis, m.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub semi_major_axis_m: Option<f64>,
    /// Eccentricity, from 0 to below 1. Default 0.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1, "x-advice" = "give an ellipse, or the positions as columns orbit_x orbit_y orbit_z"))]
    pub eccentricity: Option<f64>,
    /// Inclination to the xy plane of N, rad. Default 0.
    #[schemars(extend("minimum" = -PI, "maximum" = PI))]
    pub inclination_rad: Option<f64>,
    /// Right ascension of the ascending node from x of N, rad. Default 0.
    #[schemars(extend("minimum" = -TAU, "maximum" = TAU))]
    pub raan_rad: Option<f64>,
    /// Argument of periapsis from the node, rad. Default 0.
    #[schemars(extend("minimum" = -TAU, "maximum" = TAU))]
    pub argument_of_periapsis_rad: Option<f64>,
    /// True anomaly at the epoch, rad. Default 0.
    #[schemars(extend("minimum" = -TAU, "maximum" = TAU))]
    pub true_anomaly_rad: Option<f64>,
    /// Epoch in the count of the telemetry's time column, in seconds, for example Unix seconds; with dates, seconds
    /// since the first sample. Default: where the times of the run begin to count.
    pub epoch_s: Option<f64>,
}

/// Gravity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Gravity {
    /// Free fall.
    None,
    /// A point mass at the origin of the inertial frame.
    PointMass,
}
