//! The raw model file: one type per table, checked for structure only.
//!
//! Every field is optional here, even if the schema requires it. The structure is checked first, and invalid parts are
//! dropped, so that the rest can still be checked.

mod body;
mod environment;
mod joint;
mod known;
mod momentum;
mod nuisance;
mod sensor;
mod telemetry;
mod thruster;
mod wheel;

pub(crate) use body::{BodyFile, EstimateFile, InertiaFile, Parameter};
pub(crate) use environment::{EnvironmentFile, Gravity, OrbitFile, RandomTorqueFile};
pub(crate) use joint::{JointFile, JointType, SpringDamperFile};
pub(crate) use known::{
    BodyUncertaintyFile, JointUncertaintyFile, SensorUncertaintyFile, SourceFile,
    ThrusterUncertaintyFile, WheelUncertaintyFile,
};
pub(crate) use momentum::{MomentumFile, MomentumVectorFile, MomentumWord};
pub(crate) use nuisance::{NuisanceFile, NuisanceWord};
pub(crate) use sensor::{NamesFile, NoiseFile, SensorFile, SensorType};
pub(crate) use telemetry::{
    AttitudeFile, ColumnFile, FrameFile, OrbitColumnsFile, OrderFile, ScaleFile, SenseFile,
    TelemetryFile, TelemetryMapFile, TimeFile, TimeFormatFile,
};
pub(crate) use thruster::ThrusterFile;
pub(crate) use wheel::WheelFile;

use schemars::JsonSchema;
use serde::Deserialize;

/// A vehicle: a tree of rigid bodies with joints, wheels, thrusters and sensors. SI; every key that
/// holds a quantity ends in its unit. Products of inertia are tensor elements (I_xy = -integral x y dm).
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "poinsot.model/1")]
pub(crate) struct ModelFile {
    /// Version of this format: "poinsot.model/1". Read before the rest of the file is.
    #[allow(dead_code)]
    #[schemars(required)]
    pub schema: Option<String>,
    /// Name of the vehicle. Default "vehicle".
    pub name: Option<String>,
    /// Source of the known numbers, for every table that does not declare it: "measured" or "cad", the default. It sets
    /// their uncertainty.
    pub source: Option<SourceFile>,
    /// true: all known numbers are exact, except in tables that declare otherwise.
    pub exact: Option<bool>,
    /// Largest plausible distance from nominal: a factor above 1 for masses and principal moments, and that many radii
    /// of gyration for a mass centre. Default 3.
    pub nominal_within: Option<f64>,
    /// Bodies; the first is the base.
    #[schemars(required)]
    pub body: Option<Vec<BodyFile>>,
    /// Joints; one for every body but the base.
    pub joint: Option<Vec<JointFile>>,
    /// Momentum wheels and geared rotors.
    pub wheel: Option<Vec<WheelFile>>,
    /// Thrusters.
    pub thruster: Option<Vec<ThrusterFile>>,
    /// Sensors with their declared noise.
    pub sensor: Option<Vec<SensorFile>>,
    /// Momentum at the first sample of each segment, as far as known.
    pub momentum: Option<MomentumFile>,
    /// External forces and torques.
    pub environment: Option<EnvironmentFile>,
    /// How columns of a telemetry file become channels.
    pub telemetry: Option<TelemetryFile>,
}
