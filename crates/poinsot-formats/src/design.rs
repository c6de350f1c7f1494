//! `DIR/design.json`: a designed manoeuvre and its predicted accuracy.

use crate::prediction::AgainstDurationFile;
use crate::read::ResultFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const DESIGN: &str = "poinsot.design/3";

/// A designed manoeuvre with its predicted accuracy.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignFile {
    /// "poinsot.design/3".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// The case.
    pub case: String,
    /// The answer that the design continues: its numbers are what is known so far.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<String>,
    /// Name of the vehicle.
    pub model: String,
    /// "reached", "not_reached", or "stopped": reached, but the search was stopped before any shorter manoeuvre was tried.
    pub verdict: String,
    /// The answer in one sentence.
    pub in_words: String,
    /// "worst_ratio", "log_det" or "shortest_time".
    pub objective: String,
    /// Duration of the manoeuvre, s.
    pub duration_s: f64,
    /// How far shorter manoeuvres were searched, where the objective is "shortest_time".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shorter: Option<ShorterFile>,
    /// Largest ratio of predicted to wanted sigma; null if a wanted number is not identifiable.
    pub worst_ratio: Option<f64>,
    /// Mean of the worst tenth of ln(largest ratio) over the vehicles of the prior that a robust design follows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robust_log_ratio: Option<f64>,
    /// The same over a thousand other vehicles, of the manoeuvre of the robust search. The better of the two is the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust_log_ratio_others: Option<f64>,
    /// The same of the best manoeuvre for the nominal vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nominal_log_ratio_others: Option<f64>,
    /// Wanted numbers, in the order of the case.
    pub wants: Vec<DesignedNumberFile>,
    /// Use of every limit.
    pub limits: Vec<LimitUseFile>,
    /// Share of the vehicles of the prior that exceed some limit, upper end of its estimate; at most 1e-4 is allowed. Absent without a
    /// prior or a limit that depends on the vehicle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_beyond_limits: Option<f64>,
    /// Effect of relaxed limits, if a wanted sigma is not reached.
    pub relaxed: Vec<RelaxedFile>,
    /// What one or two kinds of limits, tighter and looser, would give, where it was requested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub front: Vec<FrontPointFile>,
    /// Sigmas of what is wanted with the record ended earlier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub against_duration: Option<AgainstDurationFile>,
    /// The search.
    pub search: SearchFile,
    /// Trial flights, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verification: Option<DesignVerificationFile>,
    /// SHA-256 of the files that were written with this one, by their names in its folder; lower-case hexadecimal.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub files: IndexMap<String, String>,
}

/// The search for shorter manoeuvres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShorterFile {
    /// Longest duration, s, at which a search did not reach every wanted sigma; null if none was searched.
    pub missed_s: Option<f64>,
    /// Whether the search was stopped before its end.
    pub stopped: bool,
}

/// One wanted number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignedNumberFile {
    /// Address of the number, or the combination.
    pub name: String,
    /// Unit of the sigmas.
    pub unit: String,
    /// Wanted sigma.
    pub wanted_sigma: f64,
    /// Predicted sigma, of the manoeuvre with what is known so far; null if they do not determine the number.
    pub sigma: Option<f64>,
    /// Sigma in the answer that the design continues; absent where that does not determine the number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known_sigma: Option<f64>,
    /// Predicted sigma of the case's own manoeuvre, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_sigma: Option<f64>,
}

/// Use of one limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LimitUseFile {
    /// What is limited.
    pub what: String,
    /// Unit.
    pub unit: String,
    /// Value that comes closest to the limit.
    pub value: f64,
    /// The limit.
    pub limit: f64,
    /// Margin as a share of the limit (cones: rad, distances: m), the least of the nominal vehicle and those of the prior.
    pub margin: f64,
    /// Whether the limit is active.
    pub active: bool,
}

/// Margin below which a limit counts as active.
///
/// ```
/// let use_of = |margin| poinsot_formats::LimitUseFile::new("body rate".to_owned(), "rad/s", 0.1, 0.1, margin);
/// assert!(use_of(0.5 * poinsot_formats::ACTIVE).active && !use_of(2.0 * poinsot_formats::ACTIVE).active);
/// ```
pub const ACTIVE: f64 = 0.01;

impl LimitUseFile {
    /// The use of a limit; it is active below a margin of 1 %.
    pub fn new(what: String, unit: &str, value: f64, limit: f64, margin: f64) -> Self {
        Self {
            what,
            unit: unit.to_owned(),
            value,
            limit,
            margin,
            active: margin < ACTIVE,
        }
    }
}

/// Effect of relaxing one kind of limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RelaxedFile {
    /// Which limits.
    pub what: String,
    /// Factor on them.
    pub factor: f64,
    /// Largest ratio of predicted to wanted sigma with that limit.
    pub worst_ratio: f64,
}

/// One point of a front.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrontPointFile {
    /// Factor on each kind of limit, by its name.
    #[serde(default)]
    pub factors: IndexMap<String, f64>,
    /// Largest ratio of predicted to wanted sigma with these limits.
    pub worst_ratio: f64,
    /// Whether another point with limits that are as tight is as good.
    #[serde(default)]
    pub dominated: bool,
}

/// The search for the manoeuvre.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SearchFile {
    /// Evaluations of manoeuvres.
    pub evaluations: usize,
    /// Logarithm of the largest ratio of every start, after its first steps, and of every hop.
    pub starts: Vec<f64>,
    /// Whether the next step would gain less than 0.1 %.
    pub settled: bool,
}

/// Trial flights of the manoeuvre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DesignVerificationFile {
    /// Flights, each with another vehicle of the prior and other noise.
    pub flights: u64,
    /// Flights without an answer, and why.
    pub failed: Vec<String>,
    /// Result for every wanted number.
    pub numbers: Vec<VerifiedNumberFile>,
    /// Flights in which a limit was broken.
    pub limits_broken: u64,
    /// Whether every ratio is in its band, no flight failed, and so few broke a limit that one in 10,000 may be expected to.
    pub agrees: bool,
}

/// Errors of one wanted number over all flights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VerifiedNumberFile {
    /// Address of the number, or the combination.
    pub name: String,
    /// Root mean square of error over the predicted sigma of that flight.
    pub rms_ratio: f64,
    /// 99.9 % band if the prediction is correct.
    pub band: [f64; 2],
    /// Flights that determined it.
    pub flights: u64,
}

impl ResultFile for DesignFile {
    const SCHEMA: &'static str = DESIGN;
    const EARLIER: &'static [&'static str] = &["poinsot.design/1", "poinsot.design/2"];
}
