use super::rows::WheelUncertaintyFile;
use super::{NuisanceFile, Sigmas};
use crate::knowledge::Origin;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An axisymmetric rotor. The inertia of its body contains the rotor as if locked.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelFile {
    /// Name, unique among wheels.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// Name of the host body.
    #[schemars(required, extend("x-names" = "body"))]
    pub body: Option<String>,
    /// Spin axis in the host body's axes.
    #[schemars(required)]
    pub axis: Option<[f64; 3]>,
    /// Inertia of the rotor about its spin axis, kg m2.
    #[schemars(required, extend("exclusiveMinimum" = 0))]
    pub spin_inertia_kg_m2: Option<f64>,
    /// true: the wheel stands still where telemetry has no column for it. Default: such telemetry is refused.
    pub at_rest: Option<bool>,
    /// Whether the spin inertia is unknown. Default false.
    pub estimate: Option<bool>,
    /// Small tilt of the spin axis about the two directions across it: "none" (default), "estimate", or
    /// { sigma_rad = x }.
    pub misalignment: Option<NuisanceFile>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<Origin>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    #[schemars(with = "Option<WheelUncertaintyFile>")]
    pub uncertainty: Option<Sigmas>,
}
