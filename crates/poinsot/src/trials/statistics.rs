//! Error, bias, coverage and consistency of many trials against what was stated.

use super::band::{Band, sigmas_of_interval};
use super::{Answer, Trial};
use poinsot_identify::{Estimate, Status};

/// How one number came out over all trials that determined it.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterStatistics {
    /// Name.
    pub name: String,
    /// Trials that determined it.
    pub trials: u64,
    /// Sigma of the Cramer-Rao bound at the truth; `None` where the bound says it is open.
    pub bound: Option<f64>,
    /// Root mean square of the stated sigmas.
    pub stated: f64,
    /// Mean error.
    pub bias: f64,
    /// Root mean square error.
    pub rmse: f64,
    /// Standard deviation of the error.
    pub spread: f64,
    /// Share of stated 95 % intervals that hold the truth.
    pub coverage: f64,
}

impl ParameterStatistics {
    /// The yardstick: the bound, or what was stated where there is none.
    pub fn sigma(&self) -> f64 {
        self.bound.unwrap_or(self.stated)
    }
}

/// What many trials show.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Trials run.
    pub trials: u64,
    /// Trials without an answer or whose iteration did not settle: number and why.
    pub failed: Vec<(u64, String)>,
    /// Trials by status.
    pub statuses: Vec<(Status, u64)>,
    /// One entry per number.
    pub parameters: Vec<ParameterStatistics>,
    /// Mean normalised squared error per degree of freedom, and the degrees of freedom in all.
    pub nees: Option<(f64, u64)>,
    /// Mean of chi-square per degree of freedom.
    pub chi2_per_dof: f64,
    /// Mean chi-square per number of each kind of sensor.
    pub channels: Vec<(&'static str, f64)>,
    /// Mean and most iterations.
    pub iterations: (f64, usize),
}

/// Reduces trials in their order. A failed trial counts as failed; its numbers, if it gave any, count too.
pub fn statistics(trials: &[Trial], bound: Option<&Estimate>) -> Statistics {
    let bounds = bound.map(super::estimated_numbers).unwrap_or_default();
    let answers: Vec<&Answer> = trials
        .iter()
        .filter_map(|t| t.outcome.as_ref().ok())
        .collect();
    let mut failed = Vec::new();
    for trial in trials {
        match &trial.outcome {
            Err(why) => failed.push((trial.number, why.clone())),
            Ok(a) if matches!(a.status, Status::IterationLimit | Status::Rejected) => {
                failed.push((trial.number, a.status.name().to_owned()));
            }
            Ok(_) => {}
        }
    }
    let mut names: Vec<&str> = Vec::new();
    let mut statuses: Vec<(Status, u64)> = Vec::new();
    for answer in &answers {
        match statuses.iter_mut().find(|(s, _)| *s == answer.status) {
            Some((_, count)) => *count += 1,
            None => statuses.push((answer.status, 1)),
        }
        for number in &answer.numbers {
            if !names.contains(&number.name.as_str()) {
                names.push(&number.name);
            }
        }
    }
    let parameters = names
        .iter()
        .map(|name| {
            let bound = bounds.iter().find(|(n, _, _)| n == name).map(|b| b.2);
            of_parameter(name, &answers, bound)
        })
        .collect();
    let (sum, dof) = answers
        .iter()
        .filter_map(|a| a.nees)
        .fold((0.0, 0), |(s, d), (x, n)| (s + x, d + n as u64));
    let count = answers.len().max(1) as f64;
    let mut channels: Vec<(&'static str, f64)> = Vec::new();
    for (name, chi2) in answers.iter().flat_map(|a| &a.channels) {
        match channels.iter_mut().find(|(n, _)| n == name) {
            Some((_, total)) => *total += chi2 / count,
            None => channels.push((name, chi2 / count)),
        }
    }
    Statistics {
        trials: trials.len() as u64,
        failed,
        statuses,
        parameters,
        nees: (dof > 0).then(|| (sum / dof as f64, dof)),
        chi2_per_dof: answers.iter().map(|a| a.chi2_per_dof).sum::<f64>() / count,
        channels,
        iterations: (
            answers.iter().map(|a| a.iterations as f64).sum::<f64>() / count,
            answers.iter().map(|a| a.iterations).max().unwrap_or(0),
        ),
    }
}

fn of_parameter(name: &str, answers: &[&Answer], bound: Option<f64>) -> ParameterStatistics {
    let numbers: Vec<(f64, f64)> = answers
        .iter()
        .flat_map(|a| &a.numbers)
        .filter(|n| n.name == name)
        .map(|n| (n.error, n.sigma))
        .collect();
    let n = numbers.len().max(1) as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| numbers.iter().map(f).sum::<f64>() / n;
    let bias = mean(&|x| x.0);
    let square = mean(&|x| x.0 * x.0);
    let reach = sigmas_of_interval();
    ParameterStatistics {
        name: name.to_owned(),
        trials: numbers.len() as u64,
        bound,
        stated: mean(&|x| x.1 * x.1).sqrt(),
        bias,
        rmse: square.sqrt(),
        spread: ((square - bias * bias).max(0.0) * n / (n - 1.0).max(1.0)).sqrt(),
        coverage: mean(&|x| f64::from(u8::from(x.0.abs() <= reach * x.1))),
    }
}

impl Statistics {
    /// Everything that lies outside its 99.9 % band, in words. Empty where the stated uncertainty is right.
    pub fn faults(&self) -> Vec<String> {
        let mut list = Vec::new();
        for (trial, why) in &self.failed {
            list.push(format!("trial {trial} failed: {why}"));
        }
        let mut judge = |name: &str, what: &str, x: f64, band: Band| {
            if !band.holds(x) {
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

    /// Largest relative gap between the predicted sigma and the spread that was reached.
    pub fn worst_prediction(&self) -> Option<(&str, f64)> {
        self.parameters
            .iter()
            .filter_map(|p| Some((p.name.as_str(), p.spread / p.bound? - 1.0)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }
}
