//! The flagship: maximum likelihood in the momentum state.
//!
//! Unknown are the mass properties, the pose and momentum at the start of every segment, and biases.
//! Measured joint and wheel motion drives the pose-momentum equation; every reading is compared in its own
//! noise. Noise sits in the residual, not in the regressor, so nothing is attenuated. Levenberg-Marquardt
//! on the triangle of the shared unknowns; directions that the data leave open do not move.

use crate::answer;
use crate::estimate::{ChannelFit, Estimate, SegmentFit};
use crate::information::{Experiment, Point};
use crate::likelihood::{ChannelResidual, Evaluated, Sight};
use crate::linear::solve_linear;
use crate::parameters::{Equations, Parameters, ParametersError};
use crate::problem::{Problem, ProblemError};
use crate::solved::{Shared, Solved, StartOfSegment, VectorQuantity, head};
use crate::spectrum::Spectrum;
use nalgebra::UnitQuaternion;
use poinsot_model::{EstimateSet, MomentumKnowledge};
use poinsot_spatial::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Most iterations.
const ITERATIONS: usize = 60;
/// Settled when the next step would lower chi-square by less than this: steps of a ten-thousandth of a sigma.
const SETTLED: f64 = 1.0e-8;
/// Lags of the whiteness test.
const LAGS: usize = 10;

/// Identifies by maximum likelihood, started from the linear solution where there is one.
///
/// # Errors
/// The question cannot be asked. What the data leave open is an answer, not an error.
pub fn maximum_likelihood(problem: &Problem) -> Result<Estimate, ProblemError> {
    let solved = solve(problem)?;
    Ok(answer::write(problem, &solved))
}

fn solve(problem: &Problem) -> Result<Solved, ProblemError> {
    problem.check_samples()?;
    let (parameters, linear) = match solve_linear(problem) {
        Ok(solved) => (solved.parameters.clone(), Some(solved)),
        Err(ProblemError::Parameters(ParametersError::RotationOfTree { .. })) => {
            let fires = problem.segments.iter().any(|s| !s.firings.is_empty());
            let parameters =
                Parameters::new(problem.model, problem.tree, Equations::Momentum, fires)?;
            (parameters, None)
        }
        Err(other) => return Err(other),
    };
    let experiment = Experiment::new(problem, &parameters);
    let (at, evaluated) = starting_point(&experiment, linear.as_ref())?;
    let fitted = iterate(&experiment, at, evaluated)?;
    let explained = match &linear {
        Some(solved) => solved.explained,
        None => (!proportional(problem)).then_some(1.0),
    };
    Ok(conclude(&experiment, fitted, explained))
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
        .filter_map(|point| experiment.evaluate(&point, true).map(|e| (point, e)))
        .min_by(|a, b| chi2(&a.1).total_cmp(&chi2(&b.1)))
        .ok_or(ProblemError::NoMotion)
}

/// Where the iteration ended.
struct Fitted {
    at: Point,
    evaluated: Vec<Evaluated>,
    shared: Shared,
    spectrum: Spectrum,
    iterations: usize,
    settled: bool,
}

/// Levenberg-Marquardt (Levenberg 1944, Marquardt 1963). The damping is added to the squared singular
/// values in natural units: it holds back weak directions first.
fn iterate(
    experiment: &Experiment,
    mut at: Point,
    mut evaluated: Vec<Evaluated>,
) -> Result<Fitted, ProblemError> {
    let mut damping = 0.0;
    let mut iterations = 0;
    loop {
        let shared = Shared::new(experiment.parameters, &experiment.stack(&evaluated));
        let spectrum = experiment.spectrum(&shared)?;
        let now = chi2(&evaluated);
        let promised = promised_decrease(experiment, &evaluated, &shared, &spectrum);
        if promised < SETTLED || iterations == ITERATIONS {
            return Ok(Fitted {
                settled: promised < SETTLED,
                at,
                evaluated,
                shared,
                spectrum,
                iterations,
            });
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
                .is_some_and(|e| chi2(&e) <= now * (1.0 + 1.0e-12) + 1.0e-12);
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
                return Ok(Fitted {
                    settled: promised < 1.0e-4 * now.max(1.0),
                    at,
                    evaluated,
                    shared,
                    spectrum,
                    iterations,
                });
            }
        }
    }
}

fn chi2(evaluated: &[Evaluated]) -> f64 {
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
    let n = shared.biases + shared.mass;
    let biases: f64 = (0..shared.biases).map(|i| shared.r[(i, n)].powi(2)).sum();
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
    dx.extend(shared.biases_for(&dx));
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
            let mut take = |present: bool| {
                present
                    .then(|| parts.next())
                    .flatten()
                    .unwrap_or_default()
            };
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

/// Whether every momentum in the data is proportional to the unknowns: then their scale is open.
fn proportional(problem: &Problem) -> bool {
    let model = problem.model;
    let known_body = model
        .bodies
        .iter()
        .any(|b| b.estimate != EstimateSet::ALL && b.nominal.mass > 0.0);
    let known_wheel = model.wheels.iter().any(|w| !w.estimate);
    let fires = problem.segments.iter().any(|s| !s.firings.is_empty());
    !known_body && !known_wheel && !fires
}

fn conclude(experiment: &Experiment, fitted: Fitted, explained: Option<f64>) -> Solved {
    let given = &experiment.problem.model.momentum;
    let x = &fitted.at.x;
    let heads: usize = experiment.unknown.iter().map(|u| u.count()).sum();
    let rows: usize = fitted.evaluated.iter().map(|e| e.rows).sum();
    let starts = fitted
        .evaluated
        .iter()
        .zip(&fitted.at.heads)
        .zip(&experiment.unknown)
        .map(|((one, at), unknown)| {
            let solution = one
                .triangle
                .as_ref()
                .map(|t| head(&t.r, unknown.count(), x));
            let pick = |column: Option<usize>, value: Vector3| match (&solution, column) {
                (Some(solution), Some(from)) => VectorQuantity::of_head(solution, from, value),
                _ => VectorQuantity::known(value, x.len()),
            };
            let (linear, angular) = unknown.momentum_at();
            let translation = experiment.sight == Sight::Translation;
            StartOfSegment {
                linear: pick(linear, at.P),
                angular: pick(angular, at.h_SScm_N),
                linear_given: if translation {
                    given.linear
                } else {
                    MomentumKnowledge::Estimate
                },
                angular_given: given.angular,
                translation,
            }
        })
        .collect();
    let fit = experiment
        .problem
        .segments
        .iter()
        .zip(&fitted.evaluated)
        .map(|(segment, one)| SegmentFit {
            label: segment.label.clone(),
            samples: segment.observations.time_s.len(),
            chi2_per_dof: one.chi2 / one.rows.max(1) as f64,
            channels: one.channels.iter().map(channel_fit).collect(),
        })
        .collect();
    Solved {
        method: "maximum_likelihood",
        residual: (
            chi2(&fitted.evaluated),
            rows.saturating_sub(heads + fitted.spectrum.rank + fitted.shared.biases),
        ),
        parameters: experiment.parameters.clone(),
        x: fitted.at.x,
        shared: fitted.shared,
        spectrum: fitted.spectrum,
        explained,
        starts,
        fit,
        iterations: fitted.iterations,
        settled: fitted.settled,
        warnings: Vec::new(),
        regressor_noise: Vec::new(),
        reduced: Vec::new(),
        rows,
    }
}

fn channel_fit(channel: &ChannelResidual) -> ChannelFit {
    let count = 3.0 * channel.white.len().max(1) as f64;
    let chi2: f64 = channel.white.iter().map(|w| w.norm_squared()).sum();
    ChannelFit {
        name: channel.name,
        unit: channel.unit,
        rms: (channel.square / count).sqrt(),
        chi2_per_number: Some(chi2 / count),
        whiteness_p: whiteness(&channel.white),
    }
}

/// Ljung and Box 1978: `Q = n (n + 2) sum r_k^2 / (n - k)` over ten lags, summed over the axes, against
/// chi-square. `None` for records too short or without residual.
fn whiteness(white: &[Vector3]) -> Option<f64> {
    let n = white.len();
    if n < 4 * LAGS {
        return None;
    }
    let mut q = 0.0;
    for axis in 0..3 {
        let mean = white.iter().map(|w| w[axis]).sum::<f64>() / n as f64;
        let series: Vec<f64> = white.iter().map(|w| w[axis] - mean).collect();
        let variance: f64 = series.iter().map(|e| e * e).sum();
        if variance < 1.0e-12 * n as f64 {
            return None;
        }
        for lag in 1..=LAGS {
            let r = series
                .iter()
                .zip(&series[lag..])
                .map(|(a, b)| a * b)
                .sum::<f64>()
                / variance;
            q += n as f64 * (n as f64 + 2.0) * r * r / (n - lag) as f64;
        }
    }
    let chi2 = ChiSquared::new(3.0 * LAGS as f64).ok()?;
    Some(chi2.sf(q))
}
