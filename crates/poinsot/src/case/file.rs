//! The case file as written: shape only, nothing checked.
#![allow(non_snake_case)]

use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// The whole file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CaseFile {
    pub schema: Spanned<String>,
    pub model: Spanned<String>,
    pub duration_s: Spanned<f64>,
    #[serde(default)]
    pub initial: InitialFile,
    #[serde(default)]
    pub joint_motion: Vec<JointMotionFile>,
    #[serde(default)]
    pub wheel_motion: Vec<WheelMotionFile>,
    #[serde(default)]
    pub firing: Vec<FiringFile>,
    #[serde(default)]
    pub joint_torque: Vec<JointTorqueFile>,
    pub control: Option<Spanned<ControlFile>>,
    pub integration: Option<IntegrationFile>,
    pub output: Spanned<OutputFile>,
    #[serde(default)]
    pub want: Vec<Spanned<WantFile>>,
    #[serde(default)]
    pub limits: LimitsFile,
    pub design: Option<Spanned<DesignFile>>,
}

/// Pose and velocity of the base, or momentum of the whole.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct InitialFile {
    pub q_xyzw: Option<Spanned<[f64; 4]>>,
    pub omega_rad_s: Option<Spanned<[f64; 3]>>,
    pub r_m: Option<Spanned<[f64; 3]>>,
    pub v_m_s: Option<Spanned<[f64; 3]>>,
    pub momentum_zero: Option<Spanned<bool>>,
    /// In N.
    pub linear_N_s: Option<Spanned<[f64; 3]>>,
    /// About the system's mass centre, in N.
    pub angular_N_m_s: Option<Spanned<[f64; 3]>>,
    #[serde(default)]
    pub joint: Vec<InitialJointFile>,
}

/// Start of a joint that torques move.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct InitialJointFile {
    pub joint: Spanned<String>,
    pub position_rad: Option<Spanned<f64>>,
    pub position_m: Option<Spanned<f64>>,
    pub rate_rad_s: Option<Spanned<f64>>,
    pub rate_m_s: Option<Spanned<f64>>,
}

/// Motion of one joint.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointMotionFile {
    pub joint: Spanned<String>,
    pub interpolation: Spanned<String>,
    pub time_s: Option<Spanned<Vec<f64>>>,
    pub position_rad: Option<Spanned<Vec<f64>>>,
    pub position_m: Option<Spanned<Vec<f64>>>,
    pub base_frequency_hz: Option<Spanned<f64>>,
    pub offset_rad: Option<Spanned<f64>>,
    pub offset_m: Option<Spanned<f64>>,
    pub sine_rad: Option<Spanned<Vec<f64>>>,
    pub sine_m: Option<Spanned<Vec<f64>>>,
    pub cosine_rad: Option<Spanned<Vec<f64>>>,
    pub cosine_m: Option<Spanned<Vec<f64>>>,
}

/// Torque of a joint's motor (prismatic: force): constant, sinusoid, table, or column of a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointTorqueFile {
    pub joint: Spanned<String>,
    pub constant_N_m: Option<Spanned<f64>>,
    pub constant_N: Option<Spanned<f64>>,
    pub amplitude_N_m: Option<Spanned<f64>>,
    pub amplitude_N: Option<Spanned<f64>>,
    pub frequency_rad_s: Option<Spanned<f64>>,
    pub phase_rad: Option<Spanned<f64>>,
    pub time_s: Option<Spanned<Vec<f64>>>,
    pub torque_N_m: Option<Spanned<Vec<f64>>>,
    pub force_N: Option<Spanned<Vec<f64>>>,
    pub file: Option<Spanned<String>>,
    /// Column of the file; `<joint>_Nm` (prismatic: `<joint>_N`) without it.
    pub column: Option<Spanned<String>>,
    pub interpolation: Option<Spanned<String>>,
}

/// Speed of one wheel, or torque of its motor.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelMotionFile {
    pub wheel: Spanned<String>,
    pub time_s: Spanned<Vec<f64>>,
    pub speed_rad_s: Option<Spanned<Vec<f64>>>,
    pub torque_N_m: Option<Spanned<Vec<f64>>>,
    /// Only with a torque.
    pub initial_speed_rad_s: Option<Spanned<f64>>,
    pub interpolation: Option<Spanned<String>>,
}

/// One firing.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FiringFile {
    pub thruster: Spanned<String>,
    pub on_s: Spanned<f64>,
    pub off_s: Spanned<f64>,
    pub force_N: Spanned<f64>,
}

/// Attitude feedback by wheels.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControlFile {
    /// On the vector part of the error quaternion.
    pub proportional_N_m: Option<Spanned<[[f64; 3]; 3]>>,
    pub derivative_N_m_s: Option<Spanned<[[f64; 3]; 3]>>,
    pub natural_frequency_rad_s: Option<Spanned<f64>>,
    pub damping_ratio: Option<Spanned<f64>>,
    /// Time over which a command is held; continuous without it.
    pub period_s: Option<Spanned<f64>>,
    pub drive: Option<Spanned<String>>,
    #[serde(default)]
    pub target: Vec<ControlTargetFile>,
    #[serde(default)]
    pub wheel: Vec<ControlWheelFile>,
}

/// Attitude to reach from a time on.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControlTargetFile {
    pub time_s: Spanned<f64>,
    pub q_xyzw: Spanned<[f64; 4]>,
}

/// Start, limits and friction of one wheel under control.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControlWheelFile {
    pub wheel: Spanned<String>,
    pub initial_speed_rad_s: Option<f64>,
    pub max_torque_N_m: Option<f64>,
    pub max_speed_rad_s: Option<f64>,
    pub viscous_N_m_s: Option<f64>,
    pub coulomb_N_m: Option<f64>,
}

/// How hard the integrator works.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct IntegrationFile {
    pub relative_tolerance: Spanned<f64>,
}

/// What is written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OutputFile {
    pub rate_hz: Spanned<f64>,
    #[serde(default)]
    pub format: Format,
    #[serde(default)]
    pub seed: u64,
    /// Leave out the channels that no sensor of the model reads (they are exact).
    #[serde(default)]
    pub sensors_only: bool,
    #[serde(default)]
    pub sensor: Vec<SensorOutputFile>,
}

/// Kind of telemetry file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// One header row, comma separated.
    #[default]
    Csv,
    /// Parquet.
    Parquet,
}

/// What a sensor of the model does in this case.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SensorOutputFile {
    pub name: Spanned<String>,
    pub rate_hz: Option<Spanned<f64>>,
    pub bias_rad: Option<Spanned<Vec<f64>>>,
    pub bias_rad_s: Option<Spanned<Vec<f64>>>,
    pub bias_m: Option<Spanned<Vec<f64>>>,
    pub bias_m_s: Option<Spanned<Vec<f64>>>,
    pub bias_m_s2: Option<Spanned<Vec<f64>>>,
    pub bias_N: Option<Spanned<Vec<f64>>>,
    /// Relative error of each axis.
    pub scale: Option<Spanned<[f64; 3]>>,
    /// Small rotation between true and assumed axes, rad.
    pub misalignment_rad: Option<Spanned<[f64; 3]>>,
    /// Turn of two axes towards each other, yz, xz, xy, rad.
    pub nonorthogonality_rad: Option<Spanned<[f64; 3]>>,
    /// How late the sensor reads, s.
    pub lag_s: Option<Spanned<f64>>,
}

/// A number, or a combination of numbers, and the sigma that is wanted of it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WantFile {
    pub number: Option<Spanned<String>>,
    pub combination: Option<Spanned<BTreeMap<String, f64>>>,
    pub sigma: Option<Spanned<f64>>,
    pub relative: Option<Spanned<f64>>,
}

/// What no designed manoeuvre may exceed.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LimitsFile {
    pub body_rate_rad_s: Option<Spanned<f64>>,
    pub clearance_m: Option<Spanned<f64>>,
    #[serde(default)]
    pub joint: Vec<Spanned<JointLimitFile>>,
    #[serde(default)]
    pub wheel: Vec<Spanned<WheelLimitFile>>,
    #[serde(default)]
    pub cone: Vec<Spanned<ConeFile>>,
    #[serde(default)]
    pub capsule: Vec<Spanned<CapsuleFile>>,
}

/// Limits of some joints; of all without `joints`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointLimitFile {
    pub joints: Option<Vec<Spanned<String>>>,
    pub position_rad: Option<Spanned<[f64; 2]>>,
    pub position_m: Option<Spanned<[f64; 2]>>,
    pub rate_rad_s: Option<Spanned<f64>>,
    pub rate_m_s: Option<Spanned<f64>>,
    pub acceleration_rad_s2: Option<Spanned<f64>>,
    pub acceleration_m_s2: Option<Spanned<f64>>,
    pub torque_N_m: Option<Spanned<f64>>,
    pub force_N: Option<Spanned<f64>>,
}

/// Limits of some wheels; of all without `wheels`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WheelLimitFile {
    pub wheels: Option<Vec<Spanned<String>>>,
    pub speed_rad_s: Option<Spanned<f64>>,
    pub torque_N_m: Option<Spanned<f64>>,
    pub momentum_N_m_s: Option<Spanned<f64>>,
}

/// An axis of the base that must stay out of, or in, a cone about a direction in N.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ConeFile {
    pub name: Spanned<String>,
    pub axis_B: Spanned<[f64; 3]>,
    pub direction_N: Spanned<[f64; 3]>,
    pub keep_out_rad: Option<Spanned<f64>>,
    pub keep_in_rad: Option<Spanned<f64>>,
}

/// A capsule about a part of a body; a sphere where both ends are equal.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CapsuleFile {
    pub body: Spanned<String>,
    pub from_m: Spanned<[f64; 3]>,
    pub to_m: Option<Spanned<[f64; 3]>>,
    pub radius_m: Spanned<f64>,
}

/// What a design may move, and what it is after.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DesignFile {
    #[serde(default)]
    pub objective: Objective,
    /// Whether the vehicles of the prior count and not the nominal one alone.
    #[serde(default)]
    pub robust: bool,
    /// Whether declared priors of mass properties count in the sigmas.
    #[serde(default)]
    pub priors: bool,
    pub evaluations: Option<Spanned<usize>>,
    pub starts: Option<Spanned<usize>>,
    #[serde(default)]
    pub seed: u64,
    #[serde(default)]
    pub joint: Vec<Spanned<DesignJointFile>>,
    #[serde(default)]
    pub wheel: Vec<Spanned<DesignWheelFile>>,
}

/// What a design minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objective {
    /// The largest ratio of sigma to wanted sigma.
    #[default]
    WorstRatio,
    /// The logarithm of the determinant of the covariance of what is wanted, in wanted sigmas.
    LogDet,
    /// The time in which every wanted sigma is reached.
    ShortestTime,
}

/// How some joints may move.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DesignJointFile {
    pub joints: Option<Vec<Spanned<String>>>,
    pub form: Spanned<String>,
    pub harmonics: Option<Spanned<usize>>,
    pub base_frequency_hz: Option<Spanned<f64>>,
    pub at_rest: Option<Spanned<bool>>,
    pub nodes: Option<Spanned<usize>>,
    pub slews: Option<Spanned<usize>>,
    pub returns: Option<Spanned<bool>>,
}

/// How some wheels may turn.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DesignWheelFile {
    pub wheels: Option<Vec<Spanned<String>>>,
    pub nodes: Spanned<usize>,
    pub start_speed_rad_s: Option<Spanned<f64>>,
    pub returns: Option<Spanned<bool>>,
}
