//! The table of keys: one type per table of the file, one field per key, with its unit, its words and its range.
//!
//! JSON Schema, the reference page, and the checks of `shape.rs` come from these rows; the writer fills them. Beside the
//! words of JSON Schema, a row may have:
//! - `x-only`, `x-required`: the values of another key with which this key is allowed, or needed;
//! - `x-needs`: a key that must be beside it;
//! - `x-names`: the text is the name of an entry of this list of tables; `x-name`: it is a name itself;
//! - `x-unique`: no two entries of the list agree in all these keys;
//! - `x-code`, `x-only-code`: the code of a value out of range, or of a key that is not allowed; `x-advice`: what to do.
//!
//! Every field is optional, even if the schema requires it: invalid parts are dropped, so that the rest can still be
//! checked.

mod body;
mod environment;
mod joint;
mod mode;
mod momentum;
mod rows;
mod sensor;
mod thruster;
mod wheel;
mod which;

pub(crate) use body::{BodyFile, InertiaFile, Parameter};
pub(crate) use environment::{EnvironmentFile, Gravity, OrbitFile};
pub use joint::{JointFile, SpringDamperFile, SpringParameter};
pub(crate) use mode::PanelFile;
pub use mode::{ModeFile, ModeParameter, SlopeFile, TankFile};
pub(crate) use momentum::{MomentumFile, MomentumVectorFile, MomentumWord};
pub(crate) use sensor::{NamesFile, NoiseFile, SensorFile, SensorType};
pub use thruster::ThrusterFile;
pub use wheel::WheelFile;
pub use which::Which;

use crate::knowledge::Origin;
use poinsot_telemetry::TelemetryMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One sigma by key.
pub(crate) type Sigmas = BTreeMap<String, f64>;

/// Knowledge of a nuisance parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum NuisanceFile {
    /// A word.
    Word(NuisanceWord),
    /// One sigma about the nominal value.
    Sigma(#[schemars(with = "rows::SigmaFile")] Sigmas),
}

/// Known or unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum NuisanceWord {
    /// Taken as exact.
    None,
    /// Unknown.
    Estimate,
}

/// A vehicle: a tree of rigid bodies with joints, wheels, thrusters and sensors. SI; every key that
/// holds a quantity ends in its unit. Products of inertia are tensor elements (I_xy = -integral x y dm).
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "poinsot.model/1")]
pub(crate) struct ModelFile {
    /// Version of this format: "poinsot.model/1". Read before the rest of the file is.
    #[schemars(required)]
    pub schema: Option<String>,
    /// Name of the vehicle. Default "vehicle".
    #[schemars(extend("x-name" = true))]
    pub name: Option<String>,
    /// Source of the known numbers, for every table that does not declare it: "measured" or "cad", the default. It sets
    /// their uncertainty.
    pub source: Option<Origin>,
    /// true: all known numbers are exact, except in tables that declare otherwise.
    pub exact: Option<bool>,
    /// Largest plausible distance from nominal: a factor above 1 for masses and principal moments, and that many radii
    /// of gyration for a mass centre. Default 3.
    #[schemars(extend("exclusiveMinimum" = 1, "x-advice" = "give 3 for a third to three times the nominal numbers"))]
    pub nominal_within: Option<f64>,
    /// Correlation of the errors of the thrusters' known forces: 0 where each has its own, the default, up to 0.99 for one
    /// common factor, as of a tank pressure or a test stand.
    #[schemars(extend("minimum" = 0, "maximum" = 0.99))]
    pub thrust_correlation: Option<f64>,
    /// Bodies; the first is the base.
    #[schemars(required, extend("x-unique" = ["name"]))]
    pub body: Option<Vec<BodyFile>>,
    /// Joints; one for every body but the base.
    #[schemars(extend("x-unique" = ["name"]))]
    pub joint: Option<Vec<JointFile>>,
    /// Momentum wheels and geared rotors.
    #[schemars(extend("x-unique" = ["name"]))]
    pub wheel: Option<Vec<WheelFile>>,
    /// Thrusters.
    #[schemars(extend("x-unique" = ["name"]))]
    pub thruster: Option<Vec<ThrusterFile>>,
    /// Flexible modes of bodies: panels, booms, propellant that moves. At most 6.
    #[schemars(extend("x-unique" = ["name"]))]
    pub mode: Option<Vec<ModeFile>>,
    /// Panels on hinges with springs, each a mode.
    #[schemars(extend("x-unique" = ["name"]))]
    pub panel: Option<Vec<PanelFile>>,
    /// Propellant that moves against springs, each a mode for every direction.
    #[schemars(extend("x-unique" = ["name"]))]
    pub tank: Option<Vec<TankFile>>,
    /// Sensors with their declared noise.
    #[schemars(extend("x-unique" = ["type", "name"]))]
    pub sensor: Option<Vec<SensorFile>>,
    /// Momentum at the first sample of each segment, as far as known.
    pub momentum: Option<MomentumFile>,
    /// External forces and torques.
    pub environment: Option<EnvironmentFile>,
    /// How columns of a telemetry file become channels.
    pub telemetry: Option<TelemetryMap>,
}

/// A file with the [telemetry] table alone.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TelemetryMapFile {
    /// How columns of telemetry files become channels.
    #[schemars(required)]
    pub telemetry: Option<TelemetryMap>,
}
