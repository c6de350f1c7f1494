use super::{NuisanceFile, SourceFile, WheelUncertaintyFile};
use schemars::JsonSchema;
use serde::Deserialize;

/// An axisymmetric rotor. The inertia of its body contains the rotor as if locked.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelFile {
    /// Name, unique among wheels.
    #[schemars(required)]
    pub name: Option<String>,
    /// Name of the host body.
    #[schemars(required)]
    pub body: Option<String>,
    /// Spin axis in the host body's axes.
    #[schemars(required)]
    pub axis: Option<[f64; 3]>,
    /// Inertia of the rotor about its spin axis, kg m2.
    #[schemars(required)]
    pub spin_inertia_kg_m2: Option<f64>,
    /// Whether the spin inertia is unknown. Default false.
    pub estimate: Option<bool>,
    /// Small tilt of the spin axis about the two directions across it: "none" (default), "estimate", or
    /// { sigma_rad = x }.
    pub misalignment: Option<NuisanceFile>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<SourceFile>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    pub uncertainty: Option<WheelUncertaintyFile>,
}
