//! Statistics of many trials, against the bands of a correct uncertainty.

use crate::band::Band;

/// Statistics of one number over all trials that determined it.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterStatistics {
    /// Name.
    pub name: String,
    /// Trials that determined it.
    pub trials: u64,
    /// Sigma of the Cramer-Rao bound at the true values; `None` if not identifiable.
    pub bound: Option<f64>,
    /// RMS of the stated sigmas; NaN if none is stated.
    pub stated: f64,
    /// Mean error.
    pub bias: f64,
    /// Root mean square error.
    pub rmse: f64,
    /// Standard deviation of the error.
    pub spread: f64,
    /// Fraction of stated 95 % intervals that hold the truth; NaN if none is stated.
    pub coverage: f64,
}

impl ParameterStatistics {
    /// The reference sigma: the bound, or the stated sigma without a bound.
    pub fn sigma(&self) -> f64 {
        self.bound.unwrap_or(self.stated)
    }
}

/// Statistics of many trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Trials run.
    pub trials: u64,
    /// The first failed or not converged trials: number and reason.
    pub failed: Vec<(u64, String)>,
    /// Number of failed trials.
    pub failures: u64,
    /// Trials by status.
    pub statuses: Vec<(String, u64)>,
    /// One entry per number.
    pub parameters: Vec<ParameterStatistics>,
    /// Mean normalised squared error per degree of freedom, and total degrees of freedom.
    pub nees: Option<(f64, u64)>,
    /// Mean of chi-square per degree of freedom.
    pub chi2_per_dof: f64,
    /// Mean chi-square per number of each kind of sensor.
    pub channels: Vec<(String, f64)>,
    /// Mean and largest number of iterations.
    pub iterations: (f64, usize),
}

impl Statistics {
    /// Statistics outside their 99.9 % bands. Empty if the stated uncertainty is correct.
    pub fn faults(&self) -> Vec<String> {
        let mut list = Vec::new();
        for (trial, why) in &self.failed {
            list.push(format!("trial {trial} failed: {why}"));
        }
        let mut judge = |name: &str, what: &str, x: f64, band: Band| {
            // A number that a method does not state is not a failure.
            if !x.is_nan() && !band.holds(x) {
                list.push(format!(
                    "{name}: {what} {x:.4} outside [{:.4}, {:.4}]",
                    band.low, band.high
                ));
            }
        };
        for p in &self.parameters {
            let n = p.trials;
            let sigma = p.sigma();
            judge(&p.name, "RMSE over bound", p.rmse / sigma, Band::of_rms(n));
            judge(
                &p.name,
                "|bias| over sigma",
                p.bias.abs() / sigma,
                Band::of_bias(n),
            );
            judge(&p.name, "coverage", p.coverage, Band::of_coverage(n));
        }
        if let Some((mean, dof)) = self.nees {
            judge("NEES", "mean per dof", mean, Band::of_mean_square(dof));
        }
        list
    }

    /// Violations of the requirements for 10^4 trials. RMSE is at most 1.05 times the bound, bias below 0.1 sigma,
    /// coverage of 95 % intervals 94 to 96 %. NEES is in its 99.9 % band, spread within 5 % of the prediction, and no
    /// trial failed. With fewer trials each limit is widened to its 99.9 % band.
    pub fn misses(&self) -> Vec<String> {
        let mut list: Vec<String> = Vec::new();
        if !self.failed.is_empty() {
            list.push(format!("{} failed trials", self.failures));
        }
        for p in &self.parameters {
            let (n, sigma) = (p.trials, p.sigma());
            let (rms, held) = (Band::of_rms(n), Band::of_coverage(n));
            let mut judge = |what: &str, x: f64, low: f64, high: f64| {
                if !x.is_nan() && !(low..=high).contains(&x) {
                    list.push(format!(
                        "{}: {what} {x:.4}, required {low:.4} to {high:.4}",
                        p.name
                    ));
                }
            };
            let bias = Band::of_bias(n).high.max(0.1);
            let spread = p.spread / sigma;
            judge("RMSE over bound", p.rmse / sigma, 0.0, rms.high.max(1.05));
            judge("|bias| over sigma", p.bias.abs() / sigma, 0.0, bias);
            judge(
                "coverage",
                p.coverage,
                held.low.min(0.94),
                held.high.max(0.96),
            );
            judge(
                "spread over prediction",
                spread,
                rms.low.min(0.95),
                rms.high.max(1.05),
            );
        }
        if let Some((mean, dof)) = self.nees {
            let band = Band::of_mean_square(dof);
            if !band.holds(mean) {
                list.push(format!(
                    "NEES {mean:.4}, required {:.4} to {:.4}",
                    band.low, band.high
                ));
            }
        }
        list
    }

    /// Largest relative difference between predicted sigma and observed spread.
    pub fn worst_prediction(&self) -> Option<(&str, f64)> {
        self.parameters
            .iter()
            .filter_map(|p| Some((p.name.as_str(), p.spread / p.bound? - 1.0)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}
