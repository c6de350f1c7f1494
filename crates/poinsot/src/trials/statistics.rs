//! Error, bias, coverage and consistency of many trials.

use super::Trial;
use super::sums::{NumberSums, Sums};
use poinsot_formats::{ParameterStatistics, Statistics};
use poinsot_identify::Estimate;

/// Reduces trials in order. A failed trial is counted; its numbers, if any, are included.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// let study = trials::Study::of_case(&case, &model.clone(), model)?;
/// let trials: Vec<_> = (0..4).map(|number| study.trial(number)).collect();
/// let found = trials::statistics(&trials, None);
/// assert_eq!((found.trials, found.failures, found.parameters.len()), (4, 0, 6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn statistics(trials: &[Trial], bound: Option<&Estimate>) -> Statistics {
    let mut sums = Sums::new("", bound);
    trials.iter().for_each(|trial| sums.add(trial));
    statistics_of(&sums)
}

/// Statistics of summed trials.
///
/// ```
/// use poinsot::trials::{Sums, statistics_of};
///
/// // No trial yet.
/// assert_eq!(statistics_of(&Sums::new("", None)).trials, 0);
/// ```
pub fn statistics_of(sums: &Sums) -> Statistics {
    let count = sums.answers.max(1) as f64;
    let (square, dof) = sums.nees;
    let seen = sums.numbers.iter().filter(|n| n.trials > 0);
    Statistics {
        trials: sums.trials,
        failed: sums.failed.clone(),
        // Files of earlier versions have only the list.
        failures: sums.failures.max(sums.failed.len() as u64),
        statuses: sums.statuses.clone(),
        parameters: seen.map(of_parameter).collect(),
        nees: (dof > 0).then(|| (square / dof as f64, dof)),
        chi2_per_dof: sums.chi2_per_dof / count,
        channels: sums
            .channels
            .iter()
            .map(|(name, sum)| (name.clone(), sum / count))
            .collect(),
        iterations: (sums.iterations.0 as f64 / count, sums.iterations.1 as usize),
    }
}

fn of_parameter(sums: &NumberSums) -> ParameterStatistics {
    let n = sums.trials as f64;
    let stated = (sums.trials - sums.unstated) as f64;
    let bias = sums.error / n;
    let square = sums.square / n;
    ParameterStatistics {
        name: sums.name.clone(),
        trials: sums.trials,
        bound: match sums.bounds {
            (0, _) => sums.bound,
            (trials, squares) => Some((squares / trials as f64).sqrt()),
        },
        stated: (sums.variance / stated).sqrt(),
        bias,
        rmse: square.sqrt(),
        spread: ((square - bias * bias).max(0.0) * n / (n - 1.0).max(1.0)).sqrt(),
        coverage: sums.held as f64 / stated,
    }
}
