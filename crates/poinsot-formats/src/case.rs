//! The case file (`poinsot.case/2`, TOML): structure only, values are not checked.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

/// Name and version of the format.
pub const CASE: &str = "poinsot.case/2";
/// The previous version, without wheel motions from files; it is read the same way.
pub const CASE_BEFORE: &str = "poinsot.case/1";

/// The motion of a vehicle, its duration, and the output. SI; every key that holds a quantity ends in its unit. Frames
/// are those of the model: N is inertial and in free fall with the vehicle, B is the frame of the base.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    /// "poinsot.case/2"; "poinsot.case/1" is read the same way.
    pub schema: String,
    /// Model file, relative to the case. Its nominal numbers are the truth.
    pub model: String,
    /// Duration, s. The case begins at time 0.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub duration_s: f64,
    /// Pose and velocity of the base, or momentum of the vehicle, at time 0. Default: at rest at the origin of N.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub initial: InitialFile,
    /// Prescribed motions of joints; those of one joint follow each other. A joint without motion, torque or spring stays
    /// locked.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub joint_motion: Vec<JointMotionFile>,
    /// Speeds or motor torques of wheels; at least one for each wheel unless `control` drives them. Speeds of one wheel
    /// follow each other.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub wheel_motion: Vec<WheelMotionFile>,
    /// Firings of thrusters.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub firing: Vec<FiringFile>,
    /// Torques of joint motors; such a joint is free.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub joint_torque: Vec<JointTorqueFile>,
    /// Attitude feedback by the wheels.
    pub control: Option<ControlFile>,
    /// Accuracy of the integration.
    pub integration: Option<IntegrationFile>,
    /// What is written.
    pub output: OutputFile,
    /// Required accuracies for `predict` and `design`.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub want: Vec<WantFile>,
    /// Limits that no manoeuvre of `design` exceeds.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub limits: LimitsFile,
    /// Free motions and objective of `design`.
    pub design: Option<DesignFile>,
}

impl CaseFile {
    /// Every file named in the case, except the model.
    pub fn files(&self) -> impl Iterator<Item = &String> {
        let torques = self.joint_torque.iter().map(|t| &t.file);
        let wheels = self.wheel_motion.iter().map(|w| &w.file);
        torques.chain(wheels).flatten()
    }

    /// The same files, mutable.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut String> {
        let torques = self.joint_torque.iter_mut().map(|t| &mut t.file);
        let wheels = self.wheel_motion.iter_mut().map(|w| &mut w.file);
        torques.chain(wheels).flatten()
    }
}

/// Whether a value equals its default.
fn is_usual<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Pose and velocity of the base, or momentum of the whole.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "CaseStartFile")]
pub struct InitialFile {
    /// Attitude R_NB: quaternion, Hamilton, scalar last. Default: aligned with N.
    pub q_xyzw: Option<[f64; 4]>,
    /// Angular velocity of B relative to N, axes of B, rad/s.
    pub omega_rad_s: Option<[f64; 3]>,
    /// Position of the origin of B in N, m.
    pub r_m: Option<[f64; 3]>,
    /// Velocity of the origin of B in N, m/s.
    pub v_m_s: Option<[f64; 3]>,
    /// true: the vehicle has no momentum. In place of velocities.
    pub momentum_zero: Option<bool>,
    /// Linear momentum of the vehicle in N, N s. In place of velocities.
    pub linear_N_s: Option<[f64; 3]>,
    /// Angular momentum about the mass centre of the vehicle in N, N m s. In place of velocities.
    pub angular_N_m_s: Option<[f64; 3]>,
    /// Start of joints that torques or springs move.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub joint: Vec<InitialJointFile>,
}

/// Start of a joint that torques move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InitialJointFile {
    /// Name of the joint.
    pub joint: String,
    /// Position of a revolute joint, rad. Default: the rest position of its spring, else the locked position of the
    /// model.
    pub position_rad: Option<f64>,
    /// Position of a prismatic joint, m.
    pub position_m: Option<f64>,
    /// Rate of a revolute joint, rad/s. Default 0.
    pub rate_rad_s: Option<f64>,
    /// Rate of a prismatic joint, m/s. Default 0.
    pub rate_m_s: Option<f64>,
}

/// Motion of one joint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointMotionFile {
    /// Name of the joint.
    pub joint: String,
    /// Through nodes "quintic_rest" (at rest at every node) or "cubic_clamped" (at rest at both ends); or "fourier".
    #[schemars(with = "JointInterpolation", extend("x-word-code" = "E0507"))]
    pub interpolation: String,
    /// Times of the nodes, ascending, s.
    #[schemars(extend("x-only" = {"interpolation": ["quintic_rest", "cubic_clamped"]}, "x-required" = {"interpolation": ["quintic_rest", "cubic_clamped"]}))]
    pub time_s: Option<Vec<f64>>,
    /// Positions of a revolute joint at the nodes, rad.
    #[schemars(extend("x-only" = {"interpolation": ["quintic_rest", "cubic_clamped"]}))]
    pub position_rad: Option<Vec<f64>>,
    /// Positions of a prismatic joint at the nodes, m.
    #[schemars(extend("x-only" = {"interpolation": ["quintic_rest", "cubic_clamped"]}))]
    pub position_m: Option<Vec<f64>>,
    /// Fourier: base frequency, Hz.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}, "x-required" = {"interpolation": ["fourier"]}, "exclusiveMinimum" = 0))]
    pub base_frequency_hz: Option<f64>,
    /// Fourier: constant part, rad.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}))]
    pub offset_rad: Option<f64>,
    /// Fourier: constant part, m.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}))]
    pub offset_m: Option<f64>,
    /// Fourier: sine amplitude of each harmonic, rad.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}))]
    pub sine_rad: Option<Vec<f64>>,
    /// Fourier: sine amplitude of each harmonic, m.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}))]
    pub sine_m: Option<Vec<f64>>,
    /// Fourier: cosine amplitude of each harmonic, rad.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}))]
    pub cosine_rad: Option<Vec<f64>>,
    /// Fourier: cosine amplitude of each harmonic, m.
    #[schemars(extend("x-only" = {"interpolation": ["fourier"]}))]
    pub cosine_m: Option<Vec<f64>>,
}

/// Motion of a joint between and beyond its nodes.
#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[allow(dead_code)]
enum JointInterpolation {
    QuinticRest,
    CubicClamped,
    Fourier,
}

/// Torque of a joint's motor (prismatic: force): constant, sinusoid, table, or column of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointTorqueFile {
    /// Name of the joint.
    pub joint: String,
    /// Constant torque of a revolute joint, N m.
    pub constant_N_m: Option<f64>,
    /// Constant force of a prismatic joint, N.
    pub constant_N: Option<f64>,
    /// Amplitude of a sinusoid, N m: amplitude sin(frequency t + phase).
    pub amplitude_N_m: Option<f64>,
    /// Amplitude of a sinusoid, N.
    pub amplitude_N: Option<f64>,
    /// Angular frequency of the sinusoid, rad/s.
    pub frequency_rad_s: Option<f64>,
    /// Phase of the sinusoid, rad. Default 0.
    pub phase_rad: Option<f64>,
    /// Times of the nodes of a table, ascending, s.
    pub time_s: Option<Vec<f64>>,
    /// Torques at the nodes, N m.
    pub torque_N_m: Option<Vec<f64>>,
    /// Forces at the nodes, N.
    pub force_N: Option<Vec<f64>>,
    /// Telemetry file with the torques, relative to the case.
    pub file: Option<String>,
    /// Column of the file. Default: `<joint>_Nm`, of a prismatic joint `<joint>_N`.
    pub column: Option<String>,
    /// "constant" (default: from a node to the next) or "linear".
    pub interpolation: Option<String>,
}

/// Speed of one wheel, or torque of its motor.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelMotionFile {
    /// Name of the wheel.
    pub wheel: String,
    /// Times of the nodes of a table, ascending, s.
    pub time_s: Option<Vec<f64>>,
    /// Speeds relative to the host at the nodes, rad/s.
    pub speed_rad_s: Option<Vec<f64>>,
    /// Motor torques at the nodes, N m.
    pub torque_N_m: Option<Vec<f64>>,
    /// Telemetry file with the speeds or torques, relative to the case. In place of a table.
    pub file: Option<String>,
    /// Column of the file: a speed where it ends in `_rad_s`, a torque where it ends in `_Nm`. Default: `<wheel>_rad_s`.
    pub column: Option<String>,
    /// Speed at time 0 of a wheel that a torque drives, rad/s. Default 0.
    pub initial_speed_rad_s: Option<f64>,
    /// Of speeds "linear" (default) or "cubic_clamped", of torques "constant" (default) or "linear".
    pub interpolation: Option<String>,
}

/// One firing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FiringFile {
    /// Name of the thruster.
    pub thruster: String,
    /// Begin, s.
    pub on_s: f64,
    /// End, s.
    pub off_s: f64,
    /// Force along the thruster's force direction, N.
    #[schemars(extend("minimum" = 0, "x-advice" = "give a force that is not negative: it acts along force_direction"))]
    pub force_N: f64,
}

/// Attitude feedback by wheels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlFile {
    /// On the vector part of the error quaternion.
    pub proportional_N_m: Option<[[f64; 3]; 3]>,
    /// On the angular velocity: 3 by 3, N m s.
    pub derivative_N_m_s: Option<[[f64; 3]; 3]>,
    /// With `damping_ratio` in place of the two gains: 2 w^2 I and 2 zeta w I, rad/s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub natural_frequency_rad_s: Option<f64>,
    /// Damping ratio.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub damping_ratio: Option<f64>,
    /// Time over which a command is held; continuous without it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period_s: Option<f64>,
    /// What is commanded of a wheel: "torque" of its motor (default) or "acceleration" relative to the body.
    #[schemars(with = "Option<WheelDriveWord>", extend("x-word-code" = "E0507"))]
    pub drive: Option<String>,
    /// Attitudes to reach. Default: aligned with N.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub target: Vec<ControlTargetFile>,
    /// Start, limits and friction of the wheels.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub wheel: Vec<ControlWheelFile>,
}

/// What is commanded of a wheel.
#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[allow(dead_code)]
enum WheelDriveWord {
    Torque,
    Acceleration,
}

/// Attitude to reach from a time on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlTargetFile {
    /// Time from which the target applies, s.
    pub time_s: f64,
    /// Attitude R_NB: quaternion, Hamilton, scalar last.
    pub q_xyzw: [f64; 4],
}

/// Start, limits and friction of one wheel under control.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlWheelFile {
    /// Name of the wheel.
    pub wheel: String,
    /// Speed at time 0, rad/s. Default 0.
    pub initial_speed_rad_s: Option<f64>,
    /// Largest motor torque, N m. Default: none.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub max_torque_N_m: Option<f64>,
    /// Largest speed, rad/s. Default: none.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub max_speed_rad_s: Option<f64>,
    /// Viscous friction, N m s. Default 0.
    #[schemars(extend("minimum" = 0))]
    pub viscous_N_m_s: Option<f64>,
    /// Coulomb friction, N m. Default 0.
    #[schemars(extend("minimum" = 0))]
    pub coulomb_N_m: Option<f64>,
}

/// Accuracy of the integration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IntegrationFile {
    /// Relative tolerance of a step, 1e-14 to 1e-3. Default 1e-12.
    #[schemars(extend("minimum" = 1e-14, "maximum" = 1e-3, "x-advice" = "leave it out for 1e-12"))]
    pub relative_tolerance: f64,
}

/// What is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputFile {
    /// Rows per second, Hz.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_hz: f64,
    /// "csv" (default) or "parquet".
    #[serde(default, skip_serializing_if = "is_usual")]
    pub format: Format,
    /// Seed of all noise. Default 0.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub seed: u64,
    /// true omits quantities that no sensor of the model measures. Commanded motions of joints and wheels and commanded
    /// thrust are always written. Default false.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub sensors_only: bool,
    /// Rates and errors of the sensors in this case.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub sensor: Vec<SensorOutputFile>,
}

/// Kind of telemetry file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// One header row, comma separated.
    #[default]
    Csv,
    /// Parquet.
    Parquet,
}

/// Rate and errors of a sensor in this case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorOutputFile {
    /// Name of the sensor in the model.
    pub name: String,
    /// Samples per second, Hz; the rate of the rows divided by a whole number. Default: every row.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_hz: Option<f64>,
    /// True bias in the axes of the sensor, rad.
    pub bias_rad: Option<Vec<f64>>,
    /// True bias, rad/s.
    pub bias_rad_s: Option<Vec<f64>>,
    /// True bias, m.
    pub bias_m: Option<Vec<f64>>,
    /// True bias, m/s.
    pub bias_m_s: Option<Vec<f64>>,
    /// True bias, m/s2.
    pub bias_m_s2: Option<Vec<f64>>,
    /// True bias, N.
    pub bias_N: Option<Vec<f64>>,
    /// Relative error of each axis; of a sensor of joints, wheels or thrusters one for each of them, or one for all.
    pub scale: Option<Vec<f64>>,
    /// Small rotation between true and assumed axes, rad.
    pub misalignment_rad: Option<[f64; 3]>,
    /// Turn of two axes towards each other, yz, xz, xy, rad.
    pub nonorthogonality_rad: Option<[f64; 3]>,
    /// Delay of the sensor, s.
    pub lag_s: Option<f64>,
}

/// A number, or a combination of numbers, with its wanted sigma.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WantFile {
    /// Address of a number, for example "bus.com_m.x".
    pub number: Option<String>,
    /// Combination instead of one number: factor by address.
    pub combination: Option<BTreeMap<String, f64>>,
    /// Wanted one sigma, in the unit of the number.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sigma: Option<f64>,
    /// The same as a share of the nominal mass, or of the mean principal moment of the body.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relative: Option<f64>,
}

/// Limits of a designed manoeuvre.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LimitsFile {
    /// Largest angular rate of the base, rad/s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub body_rate_rad_s: Option<f64>,
    /// Smallest distance between capsules of bodies that no joint connects, m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub clearance_m: Option<f64>,
    /// Limits of joints.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub joint: Vec<JointLimitFile>,
    /// Limits of wheels.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub wheel: Vec<WheelLimitFile>,
    /// Limits of thrusters.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub thruster: Vec<ThrusterLimitFile>,
    /// Cones of directions.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub cone: Vec<ConeFile>,
    /// Shapes of the bodies for the clearance.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub capsule: Vec<CapsuleFile>,
}

/// Limits of some joints; of all without `joints`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointLimitFile {
    /// Names. Default: all.
    pub joints: Option<Vec<String>>,
    /// Smallest and largest position, rad.
    pub position_rad: Option<[f64; 2]>,
    /// Smallest and largest position, m.
    pub position_m: Option<[f64; 2]>,
    /// Largest rate, rad/s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_rad_s: Option<f64>,
    /// Largest rate, m/s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate_m_s: Option<f64>,
    /// Largest acceleration, rad/s2.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub acceleration_rad_s2: Option<f64>,
    /// Largest acceleration, m/s2.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub acceleration_m_s2: Option<f64>,
    /// Largest motor torque, N m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub torque_N_m: Option<f64>,
    /// Largest motor force, N.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub force_N: Option<f64>,
}

/// Limits of some wheels; of all without `wheels`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelLimitFile {
    /// Names. Default: all.
    pub wheels: Option<Vec<String>>,
    /// Largest speed, rad/s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub speed_rad_s: Option<f64>,
    /// Largest motor torque, N m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub torque_N_m: Option<f64>,
    /// Largest momentum of each, N m s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub momentum_N_m_s: Option<f64>,
}

/// Limits of some thrusters; of all without `thrusters`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThrusterLimitFile {
    /// Names. Default: all.
    pub thrusters: Option<Vec<String>>,
    /// Shortest firing, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub minimum_on_s: Option<f64>,
    /// Shortest pause between two firings of one thruster, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub minimum_off_s: Option<f64>,
    /// Largest impulse of these thrusters together, N s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub impulse_N_s: Option<f64>,
    /// The same as propellant, kg; needs `specific_impulse_s`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub propellant_kg: Option<f64>,
    /// Specific impulse, s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub specific_impulse_s: Option<f64>,
    /// Half angle of the plume, rad: no capsule of another body lies in it while the thruster fires.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = FRAC_PI_2, "x-advice" = "give it in rad, below pi/2"))]
    pub plume_rad: Option<f64>,
}

/// A cone about a direction in N that an axis of the base must avoid or stay in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConeFile {
    /// Name for messages.
    pub name: String,
    /// Axis of the base, axes of B.
    pub axis_B: [f64; 3],
    /// Direction in N.
    pub direction_N: [f64; 3],
    /// Smallest angle between the two, rad.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = PI, "x-advice" = "give it in rad, below pi"))]
    pub keep_out_rad: Option<f64>,
    /// Largest angle between the two, rad.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = PI, "x-advice" = "give it in rad, below pi"))]
    pub keep_in_rad: Option<f64>,
}

/// A capsule about a part of a body; a sphere where both ends are equal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleFile {
    /// Name of the body.
    pub body: String,
    /// One end in the body's frame, m.
    pub from_m: [f64; 3],
    /// The other end. Default: the same, a sphere.
    pub to_m: Option<[f64; 3]>,
    /// Radius, m.
    #[schemars(extend("minimum" = 0))]
    pub radius_m: f64,
}

/// Free motions and objective of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "CaseDesignFile")]
pub struct DesignFile {
    /// What is minimised. Default "worst_ratio".
    #[serde(default, skip_serializing_if = "is_usual")]
    pub objective: Objective,
    /// Whether vehicles drawn from the prior count, not only the nominal one.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub robust: bool,
    /// Whether declared priors of mass properties count in the sigmas.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub priors: bool,
    /// Largest number of manoeuvre evaluations. Default 12000.
    #[schemars(extend("minimum" = 1))]
    pub evaluations: Option<usize>,
    /// Starts of the search.
    #[schemars(extend("minimum" = 1))]
    pub starts: Option<usize>,
    /// Seed of the search. Default 0.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub seed: u64,
    /// Begin of the designed manoeuvre, s. Motions and firings of the case that end before it are flown first, and a
    /// joint or wheel starts where they leave it. Default 0.
    pub from_s: Option<f64>,
    /// End of the designed manoeuvre, s. Motions and firings of the case that begin after it are flown next, and a joint
    /// or wheel ends where they take it up. Default: the duration.
    pub until_s: Option<f64>,
    /// Joints that may move.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub joint: Vec<DesignJointFile>,
    /// Wheels that may turn.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub wheel: Vec<DesignWheelFile>,
    /// Thrusters that may fire.
    #[serde(default, skip_serializing_if = "is_usual")]
    pub thruster: Vec<DesignThrusterFile>,
}

/// What a design minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignJointFile {
    /// Names. Default: all.
    pub joints: Option<Vec<String>>,
    /// "fourier", "spline" or "slews".
    #[schemars(with = "DesignForm", extend("x-word-code" = "E0507"))]
    pub form: String,
    /// Fourier: harmonics.
    #[schemars(extend("x-only" = {"form": ["fourier"]}, "x-required" = {"form": ["fourier"]}, "minimum" = 1, "maximum" = 64))]
    pub harmonics: Option<usize>,
    /// Fourier: base frequency, Hz. Default: one period in the duration.
    #[schemars(extend("x-only" = {"form": ["fourier"]}, "exclusiveMinimum" = 0))]
    pub base_frequency_hz: Option<f64>,
    /// Fourier: whether the joint starts without rate and acceleration. Default false.
    #[schemars(extend("x-only" = {"form": ["fourier"]}))]
    pub at_rest: Option<bool>,
    /// Spline: nodes.
    #[schemars(extend("x-only" = {"form": ["spline"]}, "x-required" = {"form": ["spline"]}, "minimum" = 3, "maximum" = 64))]
    pub nodes: Option<usize>,
    /// Slews: how many.
    #[schemars(extend("x-only" = {"form": ["slews"]}, "x-required" = {"form": ["slews"]}, "minimum" = 1, "maximum" = 64))]
    pub slews: Option<usize>,
    /// Whether the final position equals the initial one. Default true. A motion flown next sets the final one.
    #[schemars(extend("x-only" = {"form": ["spline", "slews"]}))]
    pub returns: Option<bool>,
}

/// Forms of a designed motion.
#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[allow(dead_code)]
enum DesignForm {
    Fourier,
    Spline,
    Slews,
}

/// How some wheels may turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignWheelFile {
    /// Names. Default: all.
    pub wheels: Option<Vec<String>>,
    /// Nodes of the speed.
    #[schemars(extend("minimum" = 3, "maximum" = 64))]
    pub nodes: usize,
    /// Speed at the start, rad/s. Default: that of the motion flown first, else 0.
    pub start_speed_rad_s: Option<f64>,
    /// Whether the final speed equals the initial one. Default true. A motion flown next sets the final one.
    pub returns: Option<bool>,
}

/// How some thrusters may fire; the times are free.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignThrusterFile {
    /// Names. Default: all.
    pub thrusters: Option<Vec<String>>,
    /// Firings of each.
    #[schemars(extend("minimum" = 1, "maximum" = 64))]
    pub firings: usize,
    /// Force of each while it fires, N.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub force_N: f64,
}
