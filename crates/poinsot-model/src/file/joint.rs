use super::rows::JointUncertaintyFile;
use super::{Sigmas, Which};
use crate::knowledge::Origin;
use crate::vehicle::{JointKind, SpringNumber};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A joint between a parent and a child body. The origin of the child's frame lies in the joint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointFile {
    /// Name, unique among joints.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// How the child moves.
    #[serde(rename = "type")]
    #[schemars(required)]
    pub kind: Option<JointKind>,
    /// Name of the body that carries the joint.
    #[schemars(required, extend("x-names" = "body"))]
    pub parent: Option<String>,
    /// Name of the body that the joint carries.
    #[schemars(required, extend("x-names" = "body"))]
    pub child: Option<String>,
    /// Origin of the child's frame at joint position zero, in the parent's frame, m.
    #[schemars(required)]
    pub origin_m: Option<[f64; 3]>,
    /// Parent from child at joint position zero: quaternion, Hamilton, scalar last. Default identity.
    pub rotation_xyzw: Option<[f64; 4]>,
    /// The same as a matrix of rows: takes components in the child to components in the parent.
    pub rotation_matrix: Option<[[f64; 3]; 3]>,
    /// Axis in the child's frame; right-hand rule. Required unless the joint is fixed.
    #[schemars(extend("x-required" = {"type": ["revolute", "prismatic"]}))]
    pub axis: Option<[f64; 3]>,
    /// The joint is locked at this position, rad, where telemetry has no column for it. Without a column and without
    /// this key the telemetry is refused.
    #[schemars(extend("x-only" = {"type": ["revolute"]}))]
    pub locked_at_rad: Option<f64>,
    /// The same of a prismatic joint, m.
    #[schemars(extend("x-only" = {"type": ["prismatic"]}))]
    pub locked_at_m: Option<f64>,
    /// Spring and damper in the joint. Where neither a column nor `locked_at_rad` says otherwise they move it, at any angle: slosh as
    /// a pendulum, a hinged panel, a flexible joint.
    #[schemars(extend("x-only" = {"type": ["revolute", "prismatic"]}))]
    pub spring_damper: Option<SpringDamperFile>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<Origin>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    #[schemars(with = "Option<JointUncertaintyFile>")]
    pub uncertainty: Option<Sigmas>,
}

/// Torque `-stiffness (q - rest) - damping q'` on the child about the joint axis (prismatic: force along it).
#[allow(non_snake_case)]
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringDamperFile {
    /// Stiffness of a revolute joint, N m/rad; not negative. Required there.
    #[schemars(extend("x-only" = {"type": ["revolute"]}, "x-required" = {"type": ["revolute"]}, "minimum" = 0))]
    pub stiffness_N_m_per_rad: Option<f64>,
    /// Stiffness of a prismatic joint, N/m; not negative. Required there.
    #[schemars(extend("x-only" = {"type": ["prismatic"]}, "x-required" = {"type": ["prismatic"]}, "minimum" = 0))]
    pub stiffness_N_per_m: Option<f64>,
    /// Damping of a revolute joint, N m s/rad; not negative. Default 0.
    #[schemars(extend("x-only" = {"type": ["revolute"]}, "minimum" = 0))]
    pub damping_N_m_s_per_rad: Option<f64>,
    /// Damping of a prismatic joint, N s/m; not negative. Default 0.
    #[schemars(extend("x-only" = {"type": ["prismatic"]}, "minimum" = 0))]
    pub damping_N_s_per_m: Option<f64>,
    /// Rest position of the spring of a revolute joint, rad. Default 0.
    #[schemars(extend("x-only" = {"type": ["revolute"]}))]
    pub rest_rad: Option<f64>,
    /// The same of a prismatic joint, m. Default 0.
    #[schemars(extend("x-only" = {"type": ["prismatic"]}))]
    pub rest_m: Option<f64>,
    /// false (default): the numbers are known. true: all are unknown and the numbers nominal. Or a list of what is unknown.
    pub estimate: Option<Which<SpringParameter>>,
}

/// A number of a spring and damper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SpringParameter {
    /// The stiffness.
    Stiffness,
    /// The damping.
    Damping,
    /// The position without force.
    Rest,
}

impl SpringParameter {
    /// All of them, with what they are.
    pub(crate) const ALL: [(Self, SpringNumber); 3] = [
        (Self::Stiffness, SpringNumber::Stiffness),
        (Self::Damping, SpringNumber::Damping),
        (Self::Rest, SpringNumber::Rest),
    ];
}
