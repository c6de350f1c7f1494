//! The result of a campaign (`campaign.json`, `poinsot.campaign/2`).

use crate::check::Contradiction;
use crate::read::ResultFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const CAMPAIGN: &str = "poinsot.campaign/2";

/// Statistics of the trials of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CampaignFile {
    /// "poinsot.campaign/2".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// Name of the campaign.
    pub name: String,
    /// Description.
    pub about: String,
    /// SHA-256 of the plan and of all files that it names.
    pub digest: String,
    /// Trials of every cell that are counted here.
    pub trials: u64,
    /// Trials of every cell in the plan.
    pub planned: u64,
    /// Shards that are missing; empty where every trial counted here was run.
    pub missing: Vec<u64>,
    /// Probability outside every interval of this file.
    pub outside: f64,
    /// Every experiment at every point.
    pub cells: Vec<CellFile>,
}

/// One experiment at one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellFile {
    /// Name of the experiment.
    pub experiment: String,
    /// Varied numbers by address.
    pub at: IndexMap<String, f64>,
    /// What each method gave.
    pub methods: Vec<MethodResultFile>,
    /// Other methods beside the first, on the same trials.
    pub comparisons: Vec<PairFile>,
}

/// A statistic with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BandedFile {
    /// Value.
    pub value: Option<f64>,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

/// One method on the trials of one cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MethodResultFile {
    /// Method, with variant and settings.
    pub method: String,
    /// Trials.
    pub trials: u64,
    /// Share of trials without an answer, rejected, not converged or crashed.
    pub failed: BandedFile,
    /// Share of answers with evidence against them.
    pub doubted: BandedFile,
    /// Trials by status.
    pub statuses: IndexMap<String, u64>,
    /// The first failures: number of the trial and why.
    pub failures: Vec<(u64, String)>,
    /// Mean normalised squared error per degree of freedom; absent where no trial states a joint covariance.
    pub nees: Option<BandedFile>,
    /// Degrees of freedom behind it.
    pub nees_dof: u64,
    /// Mean of chi-square per degree of freedom.
    pub chi2_per_dof: Option<f64>,
    /// Mean and most iterations.
    pub iterations: (f64, u64),
    /// Processor time of one trial, s; the simulation is shared among the methods.
    pub seconds_per_trial: Option<f64>,
    /// Every number that some trial determined, by name; SI.
    pub numbers: IndexMap<String, NumberResultFile>,
    /// Statistics outside the limits of a calibrated estimator, in words.
    pub misses: Vec<String>,
}

/// One number over the trials that determined it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NumberResultFile {
    /// Trials that determined it.
    pub trials: u64,
    /// Root mean square of the Cramer-Rao bound; null where the bound says that the number is not identifiable.
    pub bound: Option<f64>,
    /// Root mean square of the stated sigmas; null where none is stated.
    pub stated: Option<f64>,
    /// Mean error.
    pub bias: BandedFile,
    /// Root mean square error.
    pub rmse: BandedFile,
    /// Root mean square error over the bound.
    pub rmse_over_bound: BandedFile,
    /// Share of 95 % intervals that contain the truth, of the trials that determined the number; null where none is
    /// stated.
    pub coverage_answered: BandedFile,
    /// The same of all trials: a trial without an answer counts as a miss.
    pub coverage_all: BandedFile,
}

/// Another method beside the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PairFile {
    /// The first method.
    pub first: String,
    /// The other.
    pub other: String,
    /// Every number, by name.
    pub numbers: IndexMap<String, PairNumberFile>,
}

/// One number by two methods on the same trials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PairNumberFile {
    /// Trials that both determined.
    pub trials: u64,
    /// Trials whose interval contains the truth by the first method alone.
    pub held_by_first_alone: u64,
    /// By the other alone.
    pub held_by_other_alone: u64,
    /// p-value of equal coverage (exact McNemar test); null where a method states no sigma.
    pub mcnemar_p: Option<f64>,
    /// RMSE of the other over that of the first, with the interval of a paired bootstrap.
    pub rmse_ratio: BandedFile,
}

/// Cost of the trials of a plan, measured with a few of them.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignCost {
    /// Name of the plan.
    pub name: String,
    /// CPU time of one trial by all methods, s, averaged over the measured cells.
    pub seconds: f64,
    /// Uncompressed bytes of the rows of one trial.
    pub bytes: f64,
    /// Peak memory of the process, bytes, if the system reports it.
    pub memory: Option<u64>,
    /// Trials of all cells.
    pub trials: u64,
    /// Trials per shard for 10 to 120 s.
    pub block: (u64, u64),
    /// Trials per shard in the plan.
    pub planned_block: u64,
}

impl ResultFile for CampaignFile {
    const SCHEMA: &'static str = CAMPAIGN;
    const EARLIER: &'static [&'static str] = &["poinsot.campaign/1"];

    fn contradictions(&self) -> Vec<Contradiction> {
        let methods = self.cells.iter().flat_map(|cell| &cell.methods);
        let wrong = methods.filter(|method| {
            let statuses = method.statuses.values();
            let answers = statuses.fold(0, |sum: u64, n| sum.saturating_add(*n));
            let numbers = method.numbers.values().map(|n| n.trials);
            let most = numbers.chain([answers]).max();
            method.trials > self.trials || most > Some(method.trials)
        });
        let contradiction = |method: &MethodResultFile| Contradiction {
            key: format!("cells.methods.{}.trials", method.method),
            value: method.trials.to_string(),
            problem: "the counts are not those of this number of trials".to_owned(),
        };
        wrong.map(contradiction).collect()
    }
}
