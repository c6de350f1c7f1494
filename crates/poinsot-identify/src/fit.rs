//! Levenberg-Marquardt on the triangle of the shared unknowns.
//!
//! Pose, momentum and biases are eliminated by the order of the columns, so each step is decided in the
//! mass properties alone; the rest follows by back-substitution. Directions that the data leave open do
//! not move.

use crate::information::{Experiment, Point};
use crate::likelihood::Evaluated;
use crate::problem::ProblemError;
use crate::solved::{Shared, Solved, head};
use crate::spectrum::Spectrum;
use nalgebra::UnitQuaternion;
use poinsot_spatial::Vector3;

/// Most iterations.
pub(crate) const ITERATIONS: usize = 60;
/// Settled when the next step would lower chi-square by less than this: steps of a ten-thousandth of a sigma.
const SETTLED: f64 = 1.0e-8;

/// Fits from the better of the linear solution and the nominal numbers, in at most `limit` iterations.
pub(crate) fn fit(
    experiment: &Experiment,
    linear: Option<&Solved>,
    limit: usize,
) -> Result<Fitted, ProblemError> {
    let (at, evaluated) = starting_point(experiment, linear)?;
    iterate(experiment, at, evaluated, limit)
}

/// The better of linear solution and nominal numbers.
fn starting_point(
    experiment: &Experiment,
    linear: Option<&Solved>,
) -> Result<(Point, Vec<Evaluated>), ProblemError> {
    let points = linear
        .map(|solved| experiment.point(solved))
        .into_iter()
        .chain([experiment.nominal_point()]);
    points
        .filter_map(|point| {
            let evaluated = experiment.evaluate(&point, true)?;
            let chi2 = experiment.chi2(&point, &evaluated)?;
            Some((chi2, point, evaluated))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, point, evaluated)| (point, evaluated))
        .ok_or(ProblemError::NoMotion)
}

/// Where the iteration ended.
pub(crate) struct Fitted {
    pub at: Point,
    pub evaluated: Vec<Evaluated>,
    pub shared: Shared,
    pub spectrum: Spectrum,
    /// Spectrum without the priors of mass properties, where any are declared.
    pub data_alone: Option<Spectrum>,
    pub iterations: usize,
    pub settled: bool,
}

/// Levenberg-Marquardt (Levenberg 1944, Marquardt 1963). The damping is added to the squared singular
/// values in natural units: it holds back weak directions first.
fn iterate(
    experiment: &Experiment,
    mut at: Point,
    mut evaluated: Vec<Evaluated>,
    limit: usize,
) -> Result<Fitted, ProblemError> {
    let mut damping = 0.0;
    let mut iterations = 0;
    loop {
        let stacked = experiment.stack(&at, &evaluated, true);
        let shared = Shared::new(experiment.parameters, &stacked);
        let spectrum = experiment.spectrum(&shared)?;
        let now = experiment.chi2(&at, &evaluated).unwrap_or(f64::INFINITY);
        let promised = promised_decrease(experiment, &evaluated, &shared, &spectrum);
        if promised < SETTLED || iterations == limit {
            return finish(
                experiment,
                promised < SETTLED,
                at,
                evaluated,
                shared,
                spectrum,
                iterations,
            );
        }
        iterations += 1;
        let weakest = spectrum.singular[..spectrum.rank]
            .iter()
            .fold(f64::INFINITY, |a, b| a.min(*b));
        let mut accepted = None;
        for _ in 0..30 {
            let step = spectrum.damped(&shared.rhs(), damping);
            let candidate = moved(experiment, &at, &evaluated, &shared, &spectrum, &step);
            let better = experiment
                .evaluate(&candidate, false)
                .and_then(|e| experiment.chi2(&candidate, &e))
                .is_some_and(|chi2| chi2 <= now * (1.0 + 1.0e-12) + 1.0e-12);
            if better {
                accepted = Some(candidate);
                break;
            }
            damping = f64::max(8.0 * damping, weakest * weakest);
        }
        damping /= 8.0;
        if damping < 1.0e-3 * weakest * weakest {
            damping = 0.0;
        }
        let next = accepted.and_then(|point| experiment.evaluate(&point, true).map(|e| (point, e)));
        match next {
            Some((point, e)) => (at, evaluated) = (point, e),
            // No step lowers chi-square: this is the minimum to round-off.
            None => {
                return finish(
                    experiment,
                    promised < 1.0e-4 * now.max(1.0),
                    at,
                    evaluated,
                    shared,
                    spectrum,
                    iterations,
                );
            }
        }
    }
}

fn finish(
    experiment: &Experiment,
    settled: bool,
    at: Point,
    evaluated: Vec<Evaluated>,
    shared: Shared,
    spectrum: Spectrum,
    iterations: usize,
) -> Result<Fitted, ProblemError> {
    let data_alone = if experiment.has_design_prior() {
        let stacked = experiment.stack(&at, &evaluated, false);
        let own = Shared::new(experiment.parameters, &stacked);
        Some(experiment.spectrum(&own)?)
    } else {
        None
    };
    Ok(Fitted {
        at,
        evaluated,
        shared,
        spectrum,
        data_alone,
        iterations,
        settled,
    })
}

/// Chi-square of the readings alone.
pub(crate) fn chi2(evaluated: &[Evaluated]) -> f64 {
    evaluated.iter().map(|e| e.chi2).sum()
}

/// How much the linear model says a full step lowers chi-square.
fn promised_decrease(
    experiment: &Experiment,
    evaluated: &[Evaluated],
    shared: &Shared,
    spectrum: &Spectrum,
) -> f64 {
    let heads: f64 = evaluated
        .iter()
        .zip(&experiment.unknown)
        .filter_map(|(e, unknown)| e.triangle.as_ref().map(|t| (t, unknown.count())))
        .map(|(t, h)| {
            let last = t.r.ncols() - 1;
            (0..h).map(|i| t.r[(i, last)].powi(2)).sum::<f64>()
        })
        .sum();
    let n = shared.nuisances + shared.mass;
    let biases: f64 = (0..shared.nuisances)
        .map(|i| shared.r[(i, n)].powi(2))
        .sum();
    heads + biases + spectrum.reach(&shared.rhs())
}

/// The point after a step of the mass properties: biases and heads follow.
fn moved(
    experiment: &Experiment,
    at: &Point,
    evaluated: &[Evaluated],
    shared: &Shared,
    spectrum: &Spectrum,
    step: &[f64],
) -> Point {
    let mut dx: Vec<f64> = step
        .iter()
        .zip(&spectrum.natural)
        .map(|(z, unit)| z * unit)
        .collect();
    dx.extend(shared.nuisances_for(&dx));
    let heads = at
        .heads
        .iter()
        .zip(evaluated)
        .zip(&experiment.unknown)
        .map(|((old, one), unknown)| {
            let Some(triangle) = &one.triangle else {
                return *old;
            };
            let d = head(&triangle.r, unknown.count(), &dx).mean;
            let mut parts = d.chunks_exact(3).map(Vector3::from_row_slice);
            let mut take =
                |present: bool| present.then(|| parts.next()).flatten().unwrap_or_default();
            let mut new = *old;
            new.R_NB = old.R_NB * UnitQuaternion::from_scaled_axis(take(unknown.attitude));
            new.p_NoBo_N += take(unknown.position);
            new.P += take(unknown.linear);
            new.h_SScm_N += take(unknown.angular);
            new
        })
        .collect();
    Point {
        x: at.x.iter().zip(&dx).map(|(a, b)| a + b).collect(),
        heads,
    }
}
