use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is known of the momentum at the first sample, in inertial axes.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(crate) struct MomentumFile {
    /// Linear momentum, N s: "estimate" (default), "zero", or [x, y, z].
    pub linear_N_s: Option<MomentumVectorFile>,
    /// Angular momentum about the mass centre of the system, N m s: "estimate" (default), "zero", or [x, y, z].
    pub angular_N_m_s: Option<MomentumVectorFile>,
}

/// What is known of one momentum vector.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum MomentumVectorFile {
    /// A word.
    Word(MomentumWord),
    /// Known.
    Known([f64; 3]),
}

/// Unknown or zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum MomentumWord {
    /// Unknown.
    Estimate,
    /// Known to be zero.
    Zero,
}
