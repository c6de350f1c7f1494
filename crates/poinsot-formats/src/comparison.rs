//! `compare --json`: several results of one vehicle side by side.

use crate::read::ResultFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const COMPARISON: &str = "poinsot.comparison/2";
/// p-value below which answers differ.
pub const DIFFER_BELOW: f64 = 0.01;

/// Several answers of one vehicle side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonFile {
    /// "poinsot.comparison/2".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// Name of the vehicle.
    pub model: String,
    /// "agree", "differ" or "not_comparable".
    pub verdict: String,
    /// The answers, in the order given.
    pub answers: Vec<ComparedAnswerFile>,
    /// Every number that all answers determine, by name.
    pub numbers: IndexMap<String, ComparedNumberFile>,
    /// Joint tests: all numbers together, then mass, mass centre and inertia of each body.
    pub tests: Vec<JointTestFile>,
    /// Numbers that were not compared, with the reason.
    pub not_compared: Vec<String>,
    /// Why the p-values are not reliable; empty if they are.
    pub doubts: Vec<String>,
}

impl ComparisonFile {
    /// Whether all results agree, by p-values that are reliable.
    pub fn passes(&self) -> bool {
        self.verdict == "agree" && self.doubts.is_empty()
    }
}

/// One answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedAnswerFile {
    /// Path of estimate.json.
    pub path: String,
    /// Method.
    pub method: String,
    /// Status.
    pub status: String,
}

/// One number in every answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedNumberFile {
    /// Unit.
    pub unit: String,
    /// Value in each answer.
    pub values: Vec<f64>,
    /// One sigma in each answer.
    pub sigmas: Vec<f64>,
    /// Last value minus the first.
    pub difference: f64,
    /// One sigma of the difference, for independent answers.
    pub difference_sigma: f64,
    /// p-value of no change.
    pub p: f64,
    /// Weighted mean of all answers; absent where they differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pooled: Option<f64>,
    /// One sigma of the weighted mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pooled_sigma: Option<f64>,
}

/// Several numbers tested together, with their covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointTestFile {
    /// What is tested.
    pub what: String,
    /// Chi-square of the differences.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// p-value of the chi-square.
    pub p: f64,
}

impl ResultFile for ComparisonFile {
    const SCHEMA: &'static str = COMPARISON;
    const EARLIER: &'static [&'static str] = &["poinsot.comparison/1"];
}
