//! The result of a campaign (`campaign.json`, `poinsot.campaign/2`).

use crate::band::{Band, BandedFile};
use crate::check::contradiction;
use crate::read::ResultFile;
use indexmap::IndexMap;
use poinsot_files::{Fault, significant};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Name and version of the format.
pub const CAMPAIGN: &str = "poinsot.campaign/2";
/// Half-width of a 95 % interval, sigmas.
const INTERVAL: f64 = 1.96;

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
    /// Mean chi-square per number of each kind of sensor; empty in files of earlier versions.
    #[serde(default)]
    pub channels: IndexMap<String, f64>,
    /// Mean and most iterations.
    pub iterations: (f64, u64),
    /// Processor time of one trial, s; the simulation is shared among the methods.
    pub seconds_per_trial: Option<f64>,
    /// Every number that some trial determined, by name; SI.
    pub numbers: IndexMap<String, NumberResultFile>,
    /// Statistics outside the limits of a calibrated estimator, in words.
    pub misses: Vec<String>,
}

impl MethodResultFile {
    /// Number of failed trials.
    pub fn failure_count(&self) -> u64 {
        (self.failed.value.unwrap_or(0.0) * self.trials as f64).round() as u64
    }

    /// Number of failed trials, and of statistics outside their bands.
    pub fn fault_count(&self) -> u64 {
        self.failure_count() + self.outside(false).len() as u64
    }

    /// Violations of the requirements for 10^4 trials. RMSE is at most 1.05 times the bound, bias below 0.1 sigma,
    /// coverage of 95 % intervals 94 to 96 %. NEES is in its 99.9 % band, spread within 5 % of the prediction, and no
    /// trial failed. With fewer trials each limit is widened to its 99.9 % band.
    pub fn find_misses(&self) -> Vec<String> {
        let failed = self.failure_count();
        let failed = (failed > 0).then(|| format!("{failed} failed trials"));
        failed.into_iter().chain(self.outside(true)).collect()
    }

    /// Statistics outside their 99.9 % bands, which `required` widens to the requirements.
    pub fn outside(&self, required: bool) -> Vec<String> {
        let mut list = Vec::new();
        let mut judge = |name: &str, x: Option<f64>, band: Band| {
            // A number that a method does not state is not a failure.
            if let Some(x) = x.filter(|x| !x.is_nan() && !band.holds(*x)) {
                let (low, high) = (band.low, band.high);
                list.push(format!("{name} {x:.4}, required {low:.4} to {high:.4}"));
            }
        };
        let widened = |band: Band, low, high| if required { band.and(low, high) } else { band };
        for (name, n) in &self.numbers {
            let mut judge = |what: &str, x, band| judge(&format!("{name}: {what}"), x, band);
            let (rms, held) = (Band::of_rms(n.trials), Band::of_coverage(n.trials));
            judge(
                "RMSE over bound",
                n.in_sigmas(n.rmse.value),
                widened(rms, 0.0, 1.05),
            );
            let bias = n.bias.value.map(f64::abs);
            let of_bias = widened(Band::of_bias(n.trials), 0.0, 0.1);
            judge("|bias| over sigma", n.in_sigmas(bias), of_bias);
            judge(
                "coverage",
                n.coverage_answered.value,
                widened(held, 0.94, 0.96),
            );
            if required {
                let spread = n.in_sigmas(n.spread());
                judge("spread over prediction", spread, rms.and(0.95, 1.05));
            }
        }
        if let Some(nees) = self.nees {
            judge("NEES", nees.value, Band::of_mean_square(self.nees_dof));
        }
        list
    }

    /// What the trials say of the stated uncertainty.
    pub fn calibration(&self) -> Calibration {
        let trials = self.numbers.values().map(|n| n.trials).min();
        Calibration {
            missed: self.misses.len(),
            trials: trials.unwrap_or(self.trials),
        }
    }

    /// Largest relative difference between predicted sigma and observed spread, with its number.
    pub fn worst_prediction(&self) -> Option<(&str, f64)> {
        let ratio = |(name, n): (_, &NumberResultFile)| Some((name, n.spread()? / n.bound? - 1.0));
        let all = self.numbers.iter().map(|(name, n)| (name.as_str(), n));
        all.filter_map(ratio)
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}

/// What trials say of the stated uncertainty, and how well they could tell.
///
/// ```
/// use poinsot_formats::Calibration;
///
/// let few = Calibration { missed: 0, trials: 30 };
/// assert!(!few.is_resolved());
/// let words = "30 trials: coverage is consistent with 95 % within +-7.8 %, errors with their bound within +-25 %";
/// assert_eq!(few.to_string(), words);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// Statistics that miss a limit.
    pub missed: usize,
    /// Trials of the number that fewest determined.
    pub trials: u64,
}

impl Calibration {
    /// Half-width of a 95 % interval of a coverage of 95 %, and of an error over its bound.
    fn resolved(self) -> [f64; 2] {
        let n = self.trials.max(1) as f64;
        [(0.95_f64 * 0.05 / n).sqrt(), (0.5 / n).sqrt()].map(|sigma| INTERVAL * sigma)
    }

    /// Whether so many trials tell apart what is calibrated and what is not: coverage to 1 %, errors to 5 %.
    pub fn is_resolved(self) -> bool {
        let [coverage, error] = self.resolved();
        coverage <= 0.01 && error <= 0.05
    }
}

impl fmt::Display for Calibration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [coverage, error] = self.resolved().map(|half| significant(100.0 * half, 2));
        write!(f, "{} trials: ", self.trials)?;
        match self.missed {
            0 => write!(
                f,
                "coverage is consistent with 95 % within +-{coverage} %, errors with their bound within +-{error} %"
            ),
            1 => write!(f, "1 statistic misses its limit"),
            n => write!(f, "{n} statistics miss their limits"),
        }
    }
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

impl NumberResultFile {
    /// A statistic over the reference sigma: the bound, or the stated sigma without a bound.
    pub fn in_sigmas(&self, x: Option<f64>) -> Option<f64> {
        Some(x? / self.bound.or(self.stated)?)
    }

    /// Standard deviation of the error.
    pub fn spread(&self) -> Option<f64> {
        let (n, bias, rmse) = (self.trials as f64, self.bias.value?, self.rmse.value?);
        let variance = (rmse * rmse - bias * bias).max(0.0);
        Some((variance * n / (n - 1.0).max(1.0)).sqrt())
    }
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

    fn contradictions(&self) -> Vec<Fault> {
        let methods = self.cells.iter().flat_map(|cell| &cell.methods);
        let wrong = methods.filter(|method| {
            let statuses = method.statuses.values();
            let answers = statuses.fold(0, |sum: u64, n| sum.saturating_add(*n));
            let numbers = method.numbers.values().map(|n| n.trials);
            let most = numbers.chain([answers]).max();
            method.trials > self.trials || most > Some(method.trials)
        });
        let fault = |method: &MethodResultFile| {
            let key = format!("cells.methods.{}.trials", method.method);
            let problem = "the counts are not those of this number of trials";
            contradiction(&key, method.trials.to_string(), problem)
        };
        wrong.map(fault).collect()
    }
}
