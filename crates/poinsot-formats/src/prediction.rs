//! `predict --json`: the predicted accuracy of a case.

use crate::body::MassFile;
use crate::estimate::{CovarianceFile, IdentifiabilityFile, KnownNumbersFile, ReferenceFile};
use crate::number::PredictedNumberFile;
use crate::read::ResultFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const PREDICTION: &str = "poinsot.prediction/3";

/// The accuracy that a case allows (Cramer-Rao). Names and places of the numbers are those of `estimate.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictionFile {
    /// "poinsot.prediction/3".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// Path of the case.
    pub case: String,
    /// Name of the vehicle.
    pub model: String,
    /// Units, frames and points of all numbers.
    pub reference: ReferenceFile,
    /// Duration, s.
    pub duration_s: f64,
    /// "converged", "partial" or "not_identifiable".
    pub status: String,
    /// The answer in one sentence.
    pub in_words: String,
    /// Wanted numbers of the case; empty without any.
    pub wants: Vec<WantedFile>,
    /// Bodies with unknown numbers, by name.
    pub bodies: IndexMap<String, MassFile<PredictedNumberFile>>,
    /// The whole vehicle at the first sample, base axes, from the base origin. Absent of a single body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub system: Option<MassFile<PredictedNumberFile>>,
    /// Everything else that is estimated, by address.
    pub nuisance: IndexMap<String, PredictedNumberFile>,
    /// Addresses, units and matrix of all determined numbers.
    pub covariance: CovarianceFile,
    /// Identifiable and unidentifiable combinations.
    pub identifiability: IdentifiabilityFile,
    /// What the known numbers add: sigmas without them, and the share of each. Absent in files of earlier versions, whose
    /// sigmas take them as exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known_numbers: Option<KnownNumbersFile>,
    /// What was assumed.
    pub assumptions: Vec<String>,
    /// Largest values of the motion.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peaks: Vec<PeakFile>,
    /// Sigmas with the record ended earlier, where they were requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against_duration: Option<AgainstDurationFile>,
}

/// The largest value of something over the motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PeakFile {
    /// For example "rate of joint1".
    pub what: String,
    /// Unit.
    pub unit: String,
    /// Largest magnitude.
    pub value: f64,
}

/// Sigmas of some numbers with the record ended at some times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AgainstDurationFile {
    /// Ends of the record, s.
    pub end_s: Vec<f64>,
    /// One per number.
    pub numbers: Vec<SigmasFile>,
}

/// Sigmas of one number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SigmasFile {
    /// Address of the number, or the combination.
    pub name: String,
    /// Unit of the sigmas.
    pub unit: String,
    /// Wanted sigma; null of a number that is not wanted.
    pub wanted_sigma: Option<f64>,
    /// One per end; null where the number is not identifiable.
    pub sigma: Vec<Option<f64>>,
}

/// One wanted number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WantedFile {
    /// Address of the number, or the combination.
    pub name: String,
    /// Unit of the sigmas.
    pub unit: String,
    /// Wanted sigma.
    pub wanted_sigma: f64,
    /// Predicted sigma; null where the number is not identifiable.
    pub sigma: Option<f64>,
    /// Whether the predicted sigma is at most the wanted one.
    pub met: bool,
}

impl ResultFile for PredictionFile {
    const SCHEMA: &'static str = PREDICTION;
    const EARLIER: &'static [&'static str] = &["poinsot.prediction/2"];
}
