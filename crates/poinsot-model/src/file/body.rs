use super::rows::BodyUncertaintyFile;
use super::{Sigmas, Which};
use crate::knowledge::Origin;
use crate::vehicle::Prior;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One rigid body. The origin of its frame is its joint (base: any fixed point of the base).
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyFile {
    /// Name, unique among bodies.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// Mass, kg. Zero is allowed where the body carries mass or moves with a body that has mass.
    #[schemars(required, extend("minimum" = 0, "x-code" = "E0115", "x-advice" = "give a positive mass"))]
    pub mass_kg: Option<f64>,
    /// Mass centre from the origin of the body's frame, in its axes, m. Required where the mass is not zero.
    pub com_m: Option<[f64; 3]>,
    /// Inertia tensor about the mass centre, in the body's axes, kg m2. Required where the mass is not zero.
    pub inertia_kg_m2: Option<InertiaFile>,
    /// false (default): the numbers are known. true: they are unknown and the numbers nominal.
    /// Or a list of what is unknown.
    pub estimate: Option<Which<Parameter>>,
    /// One sigma of the nominal values. No prior unless given.
    pub prior: Option<Prior>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<Origin>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    #[schemars(with = "Option<BodyUncertaintyFile>")]
    pub uncertainty: Option<Sigmas>,
}

/// Inertia tensor about the mass centre, kg m2. Off-diagonal entries are tensor elements
/// (xy = -integral x y dm).
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct InertiaFile {
    /// Moment about x, kg m2.
    #[schemars(required)]
    pub xx: Option<f64>,
    /// Moment about y, kg m2.
    #[schemars(required)]
    pub yy: Option<f64>,
    /// Moment about z, kg m2.
    #[schemars(required)]
    pub zz: Option<f64>,
    /// Tensor element I_xy, kg m2. Default 0.
    pub xy: Option<f64>,
    /// Tensor element I_xz, kg m2. Default 0.
    pub xz: Option<f64>,
    /// Tensor element I_yz, kg m2. Default 0.
    pub yz: Option<f64>,
}

/// A group of mass properties.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Parameter {
    /// The mass.
    Mass,
    /// The mass centre.
    Com,
    /// The inertia tensor.
    Inertia,
}
