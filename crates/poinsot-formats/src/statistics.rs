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
    /// Statistics outside their 99.9 % bands, and failed trials. Empty if the stated uncertainty is correct.
    pub fn faults(&self) -> Vec<String> {
        let failed = |(trial, why): &(u64, String)| format!("trial {trial} failed: {why}");
        let failed = self.failed.iter().map(failed);
        failed.chain(self.outside(false)).collect()
    }

    /// Violations of the requirements for 10^4 trials. RMSE is at most 1.05 times the bound, bias below 0.1 sigma,
    /// coverage of 95 % intervals 94 to 96 %. NEES is in its 99.9 % band, spread within 5 % of the prediction, and no
    /// trial failed. With fewer trials each limit is widened to its 99.9 % band.
    pub fn misses(&self) -> Vec<String> {
        let failed = (!self.failed.is_empty()).then(|| format!("{} failed trials", self.failures));
        failed.into_iter().chain(self.outside(true)).collect()
    }

    /// Statistics outside their 99.9 % bands, which `required` widens to the requirements.
    fn outside(&self, required: bool) -> Vec<String> {
        let mut list = Vec::new();
        let mut judge = |name: &str, x: f64, band: Band| {
            // A number that a method does not state is not a failure.
            if !x.is_nan() && !band.holds(x) {
                let (low, high) = (band.low, band.high);
                list.push(format!("{name} {x:.4}, required {low:.4} to {high:.4}"));
            }
        };
        let widened = |band: Band, low: f64, high: f64| match required {
            true => Band {
                low: band.low.min(low),
                high: band.high.max(high),
            },
            false => band,
        };
        for p in &self.parameters {
            let (n, sigma) = (p.trials, p.sigma());
            let mut judge = |what: &str, x, band| judge(&format!("{}: {what}", p.name), x, band);
            let (rms, held) = (Band::of_rms(n), Band::of_coverage(n));
            judge("RMSE over bound", p.rmse / sigma, widened(rms, 0.0, 1.05));
            let bias = widened(Band::of_bias(n), 0.0, 0.1);
            judge("|bias| over sigma", p.bias.abs() / sigma, bias);
            judge("coverage", p.coverage, widened(held, 0.94, 0.96));
            if required {
                let spread = widened(rms, 0.95, 1.05);
                judge("spread over prediction", p.spread / sigma, spread);
            }
        }
        if let Some((mean, dof)) = self.nees {
            judge("NEES", mean, Band::of_mean_square(dof));
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
