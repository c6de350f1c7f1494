//! The tests of an answer, one row each: priors, convergence, residuals, sensitivity, physical limits.
//!
//! Status, exit code, verdict and the factor on the sigmas follow from these rows (see
//! [`crate::solution::evidence`]).

use crate::answer::residual_tests::residual_tests;
use crate::answer::sensor_noise::{SensorNoise, sensor_noise};
use crate::diagnosis::Diagnostics;
use crate::problem::settings::{Coordinates, Settings};
use crate::solution::evidence::{Effect, Remark, RemarkKind};
use crate::solution::solved::{OfLikelihood, Solution};

/// Share of the misfit from which a suspect is reported with the sensors.
const MOST_OF_MISFIT: f64 = 0.5;
/// Chi-square per degree of freedom of a file without noise, round-off and rounded digits aside.
pub(crate) const NOISE_FREE: f64 = 1.0e-3;

/// Remark from residuals, priors and convergence.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reliability {
    /// One row per test, the most important first.
    pub rows: Vec<Remark>,
    /// Whether residuals are too large and correlated in time: then the model is wrong, not the noise.
    pub coloured: bool,
}

impl Reliability {
    pub fn of(solution: &Solution) -> Self {
        if let Some(lost) = solution.likelihood.as_ref().filter(|own| !own.found) {
            let mistake = suspect(&lost.diagnostics, false);
            let mistake = mistake.filter(|_| !lost.diagnostics.suspects.is_empty());
            return Self {
                coloured: mistake.is_some(),
                rows: [convergence(lost)].into_iter().chain(mistake).collect(),
            };
        }
        let sensors = sensor_noise(&solution.fit, &solution.settings);
        let excesses = || sensors.iter().filter_map(|s| s.excess.as_ref());
        let bad_sensor = excesses().any(|e| !e.is_made_up_for());
        let sensor_rows = sensors.iter().flat_map(SensorNoise::rows);
        let mut rows = Vec::new();
        match &solution.likelihood {
            None => {
                rows.extend(sensor_rows);
                rows.push(pooled(solution, bad_sensor));
                rows.push(accumulation(solution));
            }
            Some(own) => {
                rows.extend(priors(own));
                rows.push(convergence(own));
                rows.extend(suspect(&own.diagnostics, bad_sensor));
                rows.extend(sensor_rows);
                rows.push(pooled(solution, bad_sensor));
                let tests = solution.remarks.iter();
                rows.extend(tests.filter(|r| r.kind == RemarkKind::Test).cloned());
                rows.extend(rigidity(own));
                rows.extend(physical_limit(own, &solution.settings));
                rows.extend(residual_tests(&own.diagnostics));
            }
        }
        Self {
            rows,
            coloured: excesses().any(|e| e.coloured),
        }
    }
}

/// Declared numbers against the data. The first contradiction covers the shift of the answer by the priors.
fn priors(own: &OfLikelihood) -> Vec<Remark> {
    let mut ratio = own.conflict.as_ref().map(|conflict| conflict.ratio);
    let row = |test: &crate::problem::prior::PriorTest| {
        let words = match test.contradicted {
            true => "a prior is inconsistent with the data".to_owned(),
            false => format!("{} and data agree", test.of),
        };
        let effect = Effect::AgainstAnswer.if_failed(test.contradicted);
        let name = format!("{} against the data", test.of);
        let (statistic, value) = test.statistic;
        let factor = ratio.take_if(|_| test.contradicted).unwrap_or(1.0).sqrt();
        Remark {
            degrees_of_freedom: Some(test.count),
            p: Some(test.p),
            ..Remark::test(name, effect, words)
                .statistic(statistic, value)
                .widening(factor)
        }
    };
    own.prior_tests.iter().map(row).collect()
}

/// Convergence of the iteration.
fn convergence(own: &OfLikelihood) -> Remark {
    let failed = !own.converged;
    let words = match (failed, &own.followed) {
        (false, _) => "the iteration converged".to_owned(),
        (true, None) => "the iteration did not converge".to_owned(),
        (true, Some(part)) => format!("the search followed the record {part} and no further"),
    };
    let effect = Effect::WithholdsNumbers.if_failed(failed);
    Remark::test("convergence", effect, words).statistic("iterations", own.iterations as f64)
}

/// The first suspect of the diagnosis; if a sensor fails too, only a suspect that explains most of the misfit is against
/// the answer.
fn suspect(found: &Diagnostics, bad_sensor: bool) -> Option<Remark> {
    if !found.is_made() {
        return None;
    }
    let test = "first suspect of the diagnosis";
    let Some(first) = found.suspects.first() else {
        let words = "no cause reduces chi-square significantly";
        return Some(Remark::test(test, Effect::None, words));
    };
    let of_noise = first.fault.is_noise_fault();
    let minor = bad_sensor && first.explains < MOST_OF_MISFIT;
    let name = &first.name;
    let words = match first.explains > 0.0 && !of_noise {
        true => format!(
            "{name} would explain {:.0} % of the misfit",
            100.0 * first.explains
        ),
        false => format!("{name} would reduce chi-square by {:.0}", first.decrease),
    };
    let effect = Effect::AgainstAnswer.if_failed(!of_noise && !minor);
    Some(Remark {
        degrees_of_freedom: Some(first.numbers),
        ..Remark::test(test, effect, words).statistic("decrease of chi-square", first.decrease)
    })
}

/// All residuals together.
fn pooled(solution: &Solution, bad_sensor: bool) -> Remark {
    let chi2 = solution.chi2_per_dof();
    let failed = !bad_sensor && chi2 > solution.settings.misfit;
    let effect = Effect::AgainstAnswer.if_failed(failed);
    let ratio = chi2.sqrt();
    let words = match failed {
        true => format!("residuals are {ratio:.1} times the declared noise"),
        false => format!("all residuals together are {ratio:.2} times the declared noise"),
    };
    let (square, dof) = solution.residual;
    Remark::test("all residuals", effect, words)
        .widening(chi2.sqrt())
        .chi_square(square, dof)
}

/// Spectral lines, which are searched where the misfit is significant.
fn rigidity(own: &OfLikelihood) -> Option<Remark> {
    let (found, not_rigid) = (&own.diagnostics, own.not_rigid());
    let lines = found.lines.iter();
    let share = lines.map(|line| line.share).reduce(f64::max);
    let words = match (not_rigid, share) {
        (true, _) => "a spectral line in the residual: the vehicle is not rigid",
        (false, Some(_)) => "a spectral line in the residual, but another cause of the misfit",
        (false, None) => "no spectral line in the residual",
    };
    let effect = Effect::AgainstAnswer.if_failed(not_rigid);
    let mut row = Remark::test("spectral line", effect, words);
    row.statistic = share.map(|share| ("share of the power", share));
    (found.is_misfit() || not_rigid).then_some(row)
}

/// Noise that the linear method assumes independent.
fn accumulation(solution: &Solution) -> Remark {
    let failed = solution.noise_accumulates && solution.chi2_per_dof() > NOISE_FREE;
    let words = match failed {
        true => "noise accumulates from sample to sample under thrust",
        false => "no noise accumulates from sample to sample",
    };
    let effect = Effect::AgainstAnswer.if_failed(failed);
    Remark::test("accumulation of noise", effect, words)
}

/// Bodies at the limit of physical mass properties; `None` if the fit has no such limit.
fn physical_limit(own: &OfLikelihood, settings: &Settings) -> Option<Remark> {
    let test = "limit of physical mass properties";
    let Some(held) = &own.held else {
        let words = "no body is at the limit of physical mass properties";
        let keeps_physical = settings.coordinates == Coordinates::Physical;
        return keeps_physical.then(|| Remark::test(test, Effect::None, words));
    };
    let bodies = held.bodies.join(", ");
    let words = format!("{bodies} is at the limit of physical mass properties");
    Some(Remark::test(test, Effect::AgainstAnswer, words).chi_square(held.cost, held.conditions))
}
