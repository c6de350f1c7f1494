//! `truth.json`: the true values of simulated telemetry.

use crate::body::{BarycentricFile, MassFile, PrincipalFile};
use crate::estimate::{MomentumFile, ReferenceFile};
use crate::number::TrueNumberFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const TRUTH: &str = "poinsot.truth/3";

/// The truth of a simulation, with the names and places of `estimate.json`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TruthFile {
    /// "poinsot.truth/3".
    pub schema: String,
    /// Version of the program.
    #[serde(default)]
    pub poinsot: String,
    /// Name of the vehicle.
    #[serde(default)]
    pub model: String,
    /// Units, frames and points of all numbers.
    #[serde(default)]
    pub reference: ReferenceFile,
    /// What was simulated. Absent in a truth that no case of this program made.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub run: Option<TrueRunFile>,
    /// SHA-256 of the files that were written with this one, by their names in its folder; lower-case hexadecimal.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub files: IndexMap<String, String>,
    /// Pose and motion at time zero. Absent where there is no sample.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial: Option<InitialFile>,
    /// Bodies by name, in the order of the model.
    pub bodies: IndexMap<String, TrueBodyFile>,
    /// The whole vehicle at the first sample.
    #[serde(default)]
    pub system: Vec<TrueBodyFile>,
    /// Momentum at the first sample.
    #[serde(default)]
    pub momentum: Vec<MomentumFile<TrueNumberFile>>,
    /// Spin inertias, numbers of flexible modes and errors of sensors by address, for example "gyro.bias_rad_s.x". An error that is absent is zero.
    #[serde(default)]
    pub nuisance: IndexMap<String, TrueNumberFile>,
    /// Random stream and noise of every sensor, by name.
    #[serde(default)]
    pub sensors: IndexMap<String, TrueSensorFile>,
    /// Use of each wheel by the controller. Absent without a controller.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub wheel_use: IndexMap<String, WheelUseFile>,
}

/// What was simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrueRunFile {
    /// Duration, s.
    pub duration_s: f64,
    /// Rate of the rows, Hz.
    pub rate_hz: f64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of the trial.
    pub trial: u64,
}

/// True mass properties of a body, or of the whole vehicle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrueBodyFile {
    /// Mass, mass centre and inertia.
    #[serde(flatten)]
    pub mass: MassFile<TrueNumberFile>,
    /// Principal moments and axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub principal: Option<PrincipalFile>,
    /// The ten parameters about the origin of the body's frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub barycentric: Option<BarycentricFile<TrueNumberFile>>,
    /// Whether a distribution of positive mass has this tensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub physically_consistent: Option<bool>,
    /// Of the whole vehicle, the joint positions for which it holds: `<joint>_rad` or `<joint>_m`.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub joint_positions: IndexMap<String, f64>,
}

/// Pose and motion at time zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InitialFile {
    /// Attitude of the base: quaternion, Hamilton, scalar last, base to N.
    pub q_xyzw: [f64; 4],
    /// Angular velocity of the base relative to N, in base axes, rad/s.
    pub omega_rad_s: [f64; 3],
    /// Position of the base's origin in N, m.
    pub r_m: [f64; 3],
    /// Velocity of the base's origin in N, m/s.
    pub v_m_s: [f64; 3],
    /// Joints that move, by name.
    pub joints: IndexMap<String, JointStateFile>,
}

/// State of a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum JointStateFile {
    /// Of a prismatic joint.
    Prismatic {
        /// Position, m.
        position_m: f64,
        /// Rate, m/s.
        rate_m_s: f64,
    },
    /// Of a revolute joint.
    Revolute {
        /// Angle, rad.
        position_rad: f64,
        /// Rate, rad/s.
        rate_rad_s: f64,
    },
}

/// How one sensor was drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrueSensorFile {
    /// Kind, for example "gyro".
    #[serde(rename = "type")]
    pub kind: String,
    /// Unit of its samples as in keys, for example "rad_s".
    pub unit: String,
    /// Number of its stream of random numbers.
    pub stream: u64,
    /// Rate, Hz.
    pub rate_hz: f64,
    /// Covariance of a sample, `unit` squared: one row for each axis. Absent for a sensor without noise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance: Option<Vec<Vec<f64>>>,
    /// Least significant bit, in `unit`; zero where it is not rounded.
    pub quantisation: f64,
}

/// Use of a wheel by the controller.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WheelUseFile {
    /// Largest speed, rad/s.
    pub largest_speed_rad_s: f64,
    /// Largest torque, N m.
    pub largest_torque_N_m: f64,
    /// Whether a limit cut its commands.
    pub saturated: bool,
}

impl TrueBodyFile {
    /// Mass, mass centre and inertia alone.
    pub fn of(mass: MassFile<TrueNumberFile>) -> Self {
        Self {
            mass,
            principal: None,
            barycentric: None,
            physically_consistent: None,
            joint_positions: IndexMap::new(),
        }
    }
}
