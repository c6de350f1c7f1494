//! Test of the integration error of an answer.
//!
//! With e the change of all whitened predictions when every step is halved, and Q an orthonormal basis of the whitened
//! sensitivities, the answer moves by `|Q^T e|` sigma; the rest of e stays in the residual. With nutation about stored
//! momentum, nearly all of e is in the span of Q, where chi-square is blind to it. The right-hand sides of the
//! triangles with whole and with halved steps differ by `Q^T e`.
//!
//! The same two triangles show how the sensitivities S change: `|S v|` of every direction v, in the norm of the
//! information. A change that turns `S v` and keeps its length is not seen.

use crate::fit::experiment::Experiment;
use crate::fit::step::Linearisation;
use crate::fit::{Fitted, fit_on};
use crate::likelihood::Evaluated;
use crate::problem::settings::IntegrationSettings;
use faer::Mat;
use poinsot_solve::{LeastSquares, Linearised, Spectrum};
use std::ops::Range;

/// Most fits with finer steps.
const REFINEMENTS: usize = 4;
/// Most steps for each one of the grid.
const MOST: u32 = 64;
/// Order of the integrator.
const ORDER: f64 = 4.0;
/// Largest factor at once: the order holds for small errors alone.
const AT_ONCE: u32 = 8;
/// Change of the sensitivities per natural unit of an unknown, in units of the change of the predictions: both errors come
/// from the same steps. Seven of nine recorded motions show at most 100. The two others show more with a change of the
/// predictions below 1e-5: 2e-6 and 8e-4 of the sensitivities, within the limit.
const PER_UNIT: f64 = 300.0;

/// Change by halved steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepError {
    /// Of the answer, sigmas.
    pub answer: f64,
    /// Of all predictions together, in their noise.
    pub predictions: f64,
    /// Of the lengths `|S v|` of the whitened sensitivities of the mass properties, v in natural units: of identified
    /// directions, the largest relative one.
    identified: f64,
    /// Of the others, the largest one in units of the smallest singular value of an identified direction.
    unidentified: f64,
}

impl StepError {
    /// Whether the error is negligible.
    pub fn is_small(&self, limits: &IntegrationSettings) -> bool {
        self.excess(limits) <= 1.0
    }

    /// The largest part of the error in units of its limit.
    fn excess(&self, limits: &IntegrationSettings) -> f64 {
        let parts = [
            (self.answer, limits.answer_sigmas),
            (self.predictions, limits.predictions_sigmas),
            (self.identified, limits.sensitivities),
            (self.unidentified, limits.unidentified),
        ];
        parts
            .iter()
            .fold(0.0, |worst, (x, most)| worst.max(x / most))
    }

    /// Refinement factor that would make it small.
    fn factor(&self, limits: &IntegrationSettings) -> u32 {
        let factor = self.excess(limits).powf(1.0 / ORDER).ceil();
        factor.clamp(2.0, f64::from(AT_ONCE)) as u32
    }

    pub fn message(&self) -> String {
        format!(
            "halving the integration step changes the estimate by {:.2} sigma and its sensitivities by {:.1e}, which the covariance does not include; sample faster, or check the wheel momentum",
            self.answer, self.identified
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
    let limits = &experiment.settings.integration;
    let bound = PER_UNIT * predictions / fitted.spectrum.smallest_singular_value();
    if predictions <= limits.answer_sigmas && bound <= limits.sensitivities.min(limits.unidentified)
    {
        // The answer cannot move by more. Sensitivities are not evaluated again: that would take a fifth of a fit.
        return Some(StepError {
            answer: predictions,
            predictions,
            identified: bound,
            unidentified: bound,
        });
    }
    let here = finer.linearise(&fitted.at)?;
    Some(StepError {
        answer: shift(experiment, fitted, &here),
        predictions,
        ..StepError::of_sensitivities(&fitted.spectrum, &here.rows.shared.block())
    })
}

impl StepError {
    /// From a spectrum to another triangle of the same unknowns.
    fn of_sensitivities(spectrum: &Spectrum, triangle: &Mat<f64>) -> Self {
        let (n, rank) = (spectrum.natural.len(), spectrum.rank);
        let scaled = Mat::from_fn(n, n, |i, j| triangle[(i, j)] * spectrum.natural[j]);
        let lengths = |columns: Range<usize>, unit: &dyn Fn(usize) -> f64| -> Vec<f64> {
            if columns.is_empty() {
                return Vec::new();
            }
            let v = Mat::from_fn(n, columns.len(), |i, k| {
                let k = columns.start + k;
                spectrum.directions[(i, k)] / unit(k)
            });
            let svd = (&scaled * &v).thin_svd();
            svd.map_or_else(
                |_| vec![f64::INFINITY],
                |svd| svd.S().column_vector().iter().copied().collect(),
            )
        };
        let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        // The singular values of `S' V / s` are the ratios of the lengths.
        let ratios = lengths(0..rank, &|k| spectrum.singular[k]);
        let ratios: Vec<f64> = ratios.iter().map(|ratio| ratio - 1.0).collect();
        let outside = largest(&lengths(rank..n, &|_| 1.0)) - largest(&spectrum.singular[rank..]);
        Self {
            answer: 0.0,
            predictions: 0.0,
            identified: largest(&ratios),
            unidentified: outside.abs() / spectrum.smallest_singular_value(),
        }
    }
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
    let [a, b] = [&coarse.evaluated, &fine.evaluated].map(|all| experiment.triangles(all));
    let initial_states: f64 = a
        .zip(b)
        .map(|((a, h), (b, _))| {
            let rows = rhs_change(&a.r, &b.r, 0..h);
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
fn rhs_change(a: &Mat<f64>, b: &Mat<f64>, rows: Range<usize>) -> Vec<f64> {
    let last = a.ncols() - 1;
    rows.map(|i| {
        let own = a[(i, last)] * a[(i, i)].signum() * b[(i, i)].signum();
        b[(i, last)] - own
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::mat;

    /// Two identified directions of lengths 100 and 10 and one of 0.1 that is not, in natural units of 2.
    fn spectrum() -> Spectrum {
        let r = mat![[50.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 0.05]];
        Spectrum::new(&r, &[2.0; 3], None, 100.0, 1.0).unwrap()
    }

    #[test]
    fn exact_change_of_sensitivities_is_relative_where_identified() {
        let same = mat![[50.0, 0.0, 0.0], [0.0, -5.0, 0.0], [0.0, 0.0, 0.05]];
        let found = StepError::of_sensitivities(&spectrum(), &same);
        assert!(
            found.identified < 1e-14 && found.unidentified < 1e-14,
            "{found:?}"
        );
        let other = mat![[50.0, 0.0, 0.0], [0.0, 5.02, 0.0], [0.0, 0.0, 1.05]];
        let found = StepError::of_sensitivities(&spectrum(), &other);
        // 0.02 of 5, and 2 of 10 by halves of the natural unit.
        assert!((found.identified - 0.004).abs() < 1e-12, "{found:?}");
        assert!((found.unidentified - 0.2).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn unit_wrong_sensitivities_refine_where_the_answer_does_not_move() {
        let limits = IntegrationSettings::default();
        let error = |identified, unidentified| StepError {
            answer: 0.01,
            predictions: 0.02,
            identified,
            unidentified,
        };
        assert!(error(9e-4, 0.09).is_small(&limits));
        assert!(!error(2e-3, 0.0).is_small(&limits));
        assert!(!error(0.0, 0.2).is_small(&limits));
        // 81 times the limit of an error of fourth order.
        assert_eq!(error(0.0809, 0.0).factor(&limits), 3);
    }
}
