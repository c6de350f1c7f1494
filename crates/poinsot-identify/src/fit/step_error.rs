//! Test of the integration error of an answer.
//!
//! With e the change of all whitened predictions when every step is halved, and Q an orthonormal basis of the whitened
//! sensitivities, the answer moves by `|Q^T e|` sigma; the rest of e stays in the residual. With nutation about stored
//! momentum, nearly all of e is in the span of Q, where chi-square is blind to it. The right-hand sides of the
//! triangles with whole and with halved steps differ by `Q^T e`.

use crate::fit::experiment::Experiment;
use crate::fit::step::Linearisation;
use crate::fit::{Fitted, fit_on};
use crate::likelihood::Evaluated;
use crate::problem::settings::IntegrationSettings;
use faer::Mat;
use poinsot_solve::{LeastSquares, Linearised};

/// Most fits with finer steps.
const REFINEMENTS: usize = 4;
/// Most steps for each one of the grid.
const MOST: u32 = 64;
/// Order of the integrator.
const ORDER: f64 = 4.0;
/// Largest factor at once: the order holds for small errors alone.
const AT_ONCE: u32 = 8;

/// Change by halved steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepError {
    /// Of the answer, sigmas.
    pub answer: f64,
    /// Of all predictions together, in their noise.
    pub predictions: f64,
}

impl StepError {
    /// Whether the error is negligible.
    pub fn is_small(&self, limits: &IntegrationSettings) -> bool {
        self.answer <= limits.answer_sigmas && self.predictions <= limits.predictions_sigmas
    }

    /// Refinement factor that would make it small.
    fn factor(&self, limits: &IntegrationSettings) -> u32 {
        let excess = f64::max(
            self.answer / limits.answer_sigmas,
            self.predictions / limits.predictions_sigmas,
        );
        let factor = excess.powf(1.0 / ORDER).ceil();
        factor.clamp(2.0, f64::from(AT_ONCE)) as u32
    }

    pub fn message(&self) -> String {
        format!(
            "halving the integration step changes the estimate by {:.2} sigma, which the covariance does not include; sample faster, or check the wheel momentum",
            self.answer
        )
    }
}

/// Refines the steps and fits again from the answer until halving them no longer matters. Gives the error that is left;
/// `None` if it was not tested.
pub(crate) fn within_steps(
    experiment: &mut Experiment,
    mut fitted: Fitted,
    limit: usize,
) -> (Fitted, Option<StepError>) {
    if !fitted.converged {
        return (fitted, None);
    }
    let limits = experiment.settings.integration;
    for round in 0..=REFINEMENTS {
        let Some(error) = step_error(experiment, &fitted) else {
            return (fitted, None);
        };
        let finest = round == REFINEMENTS || experiment.fineness.factor >= MOST;
        if finest || error.is_small(&limits) {
            return (fitted, Some(error));
        }
        // Linear interpolation of the speeds may be the only cause.
        match experiment.may_bend() && !experiment.bends() {
            true => experiment.fineness.bends = true,
            false => experiment.fineness.factor *= error.factor(&limits),
        }
        let here = experiment.linearise(&fitted.at);
        let finer = here.and_then(|h| fit_on(experiment, fitted.at.clone(), h, limit));
        match finer {
            Some(finer) => fitted = finer,
            None => return (fitted, Some(error)),
        }
    }
    (fitted, None)
}

/// Change by halved steps at the end of a fit; `None` without a motion.
fn step_error(experiment: &Experiment, fitted: &Fitted) -> Option<StepError> {
    let mut finer = experiment.with_parameters(experiment.parameters);
    finer.fineness.factor *= 2;
    finer.fineness.bends = true;
    let evaluated = finer.evaluate(&fitted.at, false)?;
    let predictions = difference(&fitted.evaluated, &evaluated);
    if predictions <= experiment.settings.integration.answer_sigmas {
        // The answer cannot move by more.
        return Some(StepError {
            answer: predictions,
            predictions,
        });
    }
    let here = finer.linearise(&fitted.at)?;
    Some(StepError {
        answer: shift(experiment, fitted, &here),
        predictions,
    })
}

/// `|e|`.
fn difference(coarse: &[Evaluated], fine: &[Evaluated]) -> f64 {
    let count = |all: &[Evaluated]| -> usize {
        let channels = all.iter().flat_map(|e| &e.channels);
        channels.map(|c| c.white.len()).sum()
    };
    if count(coarse) != count(fine) {
        return f64::INFINITY;
    }
    let [coarse, fine] = [coarse, fine].map(|all| {
        let channels = all.iter().flat_map(|e| &e.channels);
        channels.flat_map(|c| &c.white)
    });
    let pairs = coarse.zip(fine);
    pairs
        .map(|(a, b)| (a - b).norm_squared())
        .sum::<f64>()
        .sqrt()
}

/// `|Q^T e|`: pose, momentum and nuisances, then the mass properties that the data determine.
fn shift(experiment: &Experiment, coarse: &Fitted, fine: &Linearised<Linearisation>) -> f64 {
    let fine = &fine.rows;
    let pairs = coarse.evaluated.iter().zip(&fine.evaluated);
    let initial_states: f64 = pairs
        .zip(&experiment.unknown)
        .filter_map(|((a, b), unknown)| Some((a.triangle.as_ref()?, b.triangle.as_ref()?, unknown)))
        .map(|(a, b, unknown)| {
            let rows = rhs_change(&a.r, &b.r, 0..unknown.count());
            rows.iter().map(|d| d * d).sum::<f64>()
        })
        .sum();
    let (a, b) = (&coarse.shared, &fine.shared);
    let all = rhs_change(&a.r, &b.r, 0..a.nuisances + a.mass);
    let (nuisances, mass) = all.split_at(a.nuisances);
    let nuisances: f64 = nuisances.iter().map(|d| d * d).sum();
    (initial_states + nuisances + fine.spectrum.decrease(mass, 0.0)).sqrt()
}

/// Change of the right-hand side of some rows between two triangles of one problem, whose rows may differ in sign.
fn rhs_change(a: &Mat<f64>, b: &Mat<f64>, rows: std::ops::Range<usize>) -> Vec<f64> {
    let last = a.ncols() - 1;
    rows.map(|i| {
        let own = a[(i, last)] * a[(i, i)].signum() * b[(i, i)].signum();
        b[(i, last)] - own
    })
    .collect()
}
