//! The plan of a campaign (`poinsot.plan/1`, TOML): experiments, methods, varied numbers, random numbers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name and version of the format.
pub const PLAN: &str = "poinsot.plan/1";

/// A campaign: every combination of experiments, varied numbers and methods, with trials of each.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    /// "poinsot.plan/1".
    pub schema: String,
    /// Name of the campaign. Default: the name of the file.
    #[serde(default)]
    pub name: String,
    /// What it is about, in one line.
    #[serde(default)]
    pub about: String,
    /// Trials of every experiment at every point.
    #[schemars(extend("minimum" = 1, "maximum" = 1_u64 << 48))]
    pub trials: Option<u64>,
    /// Trials of one shard. Default 100.
    #[schemars(extend("minimum" = 1, "maximum" = 1_u64 << 48))]
    pub trials_per_shard: Option<u64>,
    /// Seed of all random numbers. Default: the seed of the case; 1 for a record.
    pub seed: Option<u64>,
    /// What is repeated.
    pub experiment: Vec<ExperimentFile>,
    /// Methods, all on the same trials. Default: auto.
    #[serde(default)]
    pub method: Vec<MethodFile>,
    /// Numbers that vary.
    #[serde(default)]
    pub vary: Vec<VaryFile>,
    /// Numbers that differ from the files in every trial.
    #[serde(default)]
    pub change: Vec<ChangeFile>,
    /// Numbers that every trial draws.
    #[serde(default)]
    pub draw: Vec<DrawFile>,
}

/// A motion with its vehicle: a case that is simulated, or a recorded noise-free motion.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExperimentFile {
    /// Name. Default: that of the case or record.
    #[serde(default)]
    pub name: String,
    /// Case (poinsot.case/2), relative to the plan.
    #[serde(serialize_with = "readable")]
    pub case: Option<PathBuf>,
    /// Noise-free telemetry, relative to the plan, instead of a case; needs model and truth.
    #[serde(serialize_with = "readable")]
    pub record: Option<PathBuf>,
    /// Model with the true numbers. Default: that of the case.
    #[serde(serialize_with = "readable")]
    pub truth: Option<PathBuf>,
    /// Nominal model of the identification. Default: the true one.
    #[serde(serialize_with = "readable")]
    pub model: Option<PathBuf>,
    /// Every n-th sample is used. Default 1.
    pub every: Option<u64>,
    /// Whether every trial draws the phase of the quantisation steps. Default true.
    pub draw_phase: Option<bool>,
    /// Relative range in which every trial draws the true quantisation step. Default 0.
    pub step_spread: Option<f64>,
    /// True constant bias of a sensor in its own axes, SI, by the name of the sensor; only for a record.
    #[serde(default)]
    pub bias: BTreeMap<String, Vec<f64>>,
}

/// A path as text. That of a plan made by a program need not be UTF-8.
fn readable<S: Serializer>(path: &Option<PathBuf>, to: S) -> Result<S::Ok, S::Error> {
    path.as_deref().map(Path::to_string_lossy).serialize(to)
}

/// A method of `identify`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MethodFile {
    /// Name, see `poinsot methods`.
    pub name: String,
    /// Variant.
    pub variant: Option<String>,
    /// Settings of a published method, see `poinsot methods NAME`.
    #[serde(default)]
    pub set: BTreeMap<String, SettingFile>,
    /// Whether maximum likelihood searches the cause of a misfit. It changes no number. Default false.
    #[serde(default)]
    pub diagnose: bool,
}

/// Value of a setting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SettingFile {
    /// A number.
    Number(f64),
    /// Text, as after `--set`.
    Text(String),
}

/// In which files a number changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OfFile {
    /// Truth and nominal model: another vehicle, sensor or motion.
    Both,
    /// The truth alone.
    Truth,
    /// What the identification knows, alone.
    Nominal,
}

/// Steps of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScaleFile {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Log,
}

/// A number that varies.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VaryFile {
    /// Address, for example `noise`, `gyro.noise`, `body.arm.mass_kg`, `bus.inertia_kg_m2.xx`, `output.rate_hz`.
    pub number: String,
    /// Values.
    pub values: Option<Vec<f64>>,
    /// Lower end of a range.
    pub from: Option<f64>,
    /// Upper end of a range.
    pub to: Option<f64>,
    /// Values of the range, both ends among them.
    #[schemars(extend("minimum" = 2, "maximum" = 1_000_000, "x-advice" = "a range has two values or more"))]
    pub count: Option<u64>,
    /// Steps of the range.
    #[serde(default)]
    pub scale: ScaleFile,
    /// Where it changes. Default: both.
    pub of: Option<OfFile>,
}

/// One number for all, or one for each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum NumbersFile {
    /// One.
    One(f64),
    /// One for each element.
    Each(Vec<f64>),
}

/// A number, or a vector or tensor of numbers, that differs from the files. Exactly one of value, times, plus.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChangeFile {
    /// Address.
    pub number: String,
    /// New value.
    pub value: Option<NumbersFile>,
    /// Factor.
    pub times: Option<f64>,
    /// What is added.
    pub plus: Option<NumbersFile>,
    /// Where it changes. Default: both.
    pub of: Option<OfFile>,
}

/// A number that every trial draws. Exactly one of sigma, relative_sigma, or from with to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DrawFile {
    /// Address.
    pub number: String,
    /// Normal about the value of the file, one sigma in its unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sigma: Option<f64>,
    /// The same as a share of the value.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relative_sigma: Option<f64>,
    /// Uniform: lower end.
    pub from: Option<f64>,
    /// Uniform: upper end.
    pub to: Option<f64>,
    /// Where it changes. Default: the truth alone.
    pub of: Option<OfFile>,
}
