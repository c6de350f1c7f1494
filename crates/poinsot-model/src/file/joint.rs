use super::{JointUncertaintyFile, SourceFile};
use schemars::JsonSchema;
use serde::Deserialize;

/// A joint between a parent and a child body. The origin of the child's frame lies in the joint.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointFile {
    /// Name, unique among joints.
    #[schemars(required)]
    pub name: Option<String>,
    /// How the child moves.
    #[serde(rename = "type")]
    #[schemars(required)]
    pub kind: Option<JointType>,
    /// Name of the body that carries the joint.
    #[schemars(required)]
    pub parent: Option<String>,
    /// Name of the body that the joint carries.
    #[schemars(required)]
    pub child: Option<String>,
    /// Origin of the child's frame at joint position zero, in the parent's frame, m.
    #[schemars(required)]
    pub origin_m: Option<[f64; 3]>,
    /// Parent from child at joint position zero: quaternion, Hamilton, scalar last. Default identity.
    pub rotation_xyzw: Option<[f64; 4]>,
    /// The same as a matrix of rows: takes components in the child to components in the parent.
    pub rotation_matrix: Option<[[f64; 3]; 3]>,
    /// Axis in the child's frame; right-hand rule. Required unless the joint is fixed.
    pub axis: Option<[f64; 3]>,
    /// Position of a revolute joint where telemetry has no column for it, rad. Default 0.
    pub locked_at_rad: Option<f64>,
    /// Position of a prismatic joint where telemetry has no column for it, m. Default 0.
    pub locked_at_m: Option<f64>,
    /// Spring and damper in the joint. Where a simulated case does not prescribe the joint's motion, it is then free:
    /// slosh as a pendulum, a hinged panel.
    pub spring_damper: Option<SpringDamperFile>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<SourceFile>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    pub uncertainty: Option<JointUncertaintyFile>,
}

/// Torque `-stiffness (q - rest) - damping q'` on the child about the joint axis (prismatic: force along it).
#[allow(non_snake_case)]
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpringDamperFile {
    /// Stiffness of a revolute joint, N m/rad; not negative. Required there.
    pub stiffness_N_m_per_rad: Option<f64>,
    /// Stiffness of a prismatic joint, N/m; not negative. Required there.
    pub stiffness_N_per_m: Option<f64>,
    /// Damping of a revolute joint, N m s/rad; not negative. Default 0.
    pub damping_N_m_s_per_rad: Option<f64>,
    /// Damping of a prismatic joint, N s/m; not negative. Default 0.
    pub damping_N_s_per_m: Option<f64>,
    /// Rest position of the spring of a revolute joint, rad. Default 0.
    pub rest_rad: Option<f64>,
    /// The same of a prismatic joint, m. Default 0.
    pub rest_m: Option<f64>,
}

/// Kind of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum JointType {
    /// Turns about its axis, rad.
    Revolute,
    /// Slides along its axis, m.
    Prismatic,
    /// Rigid.
    Fixed,
}
