use super::rows::ThrusterUncertaintyFile;
use super::{NuisanceFile, Sigmas};
use crate::knowledge::Origin;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A thruster.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThrusterFile {
    /// Name, unique among thrusters.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// Name of the host body.
    #[schemars(required, extend("x-names" = "body"))]
    pub body: Option<String>,
    /// Position of the nozzle from the origin of the body's frame, m.
    #[schemars(required)]
    pub position_m: Option<[f64; 3]>,
    /// Direction of the force on the body, in its axes.
    #[schemars(required)]
    pub force_direction: Option<[f64; 3]>,
    /// true: the thruster is off where telemetry has no column for it. Default: such telemetry is refused.
    pub never_fires: Option<bool>,
    /// Factor between declared and true thrust: "none" (default: exact), "estimate", or { sigma = x }.
    pub scale: Option<NuisanceFile>,
    /// Specific impulse, s: the body loses mass as the thruster fires. Without it no mass is lost.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub specific_impulse_s: Option<f64>,
    /// Place in the body from which the propellant comes, m; without it the body's nominal mass centre. Needs specific_impulse_s.
    #[schemars(extend("x-needs" = "specific_impulse_s"))]
    pub propellant_m: Option<[f64; 3]>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<Origin>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    #[schemars(with = "Option<ThrusterUncertaintyFile>")]
    pub uncertainty: Option<Sigmas>,
}
