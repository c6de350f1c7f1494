//! The flagship: maximum likelihood in the momentum state.
//!
//! Unknown are the mass properties, the pose and momentum at the start of every segment, and biases.
//! Measured joint and wheel motion drives the pose-momentum equation; every reading is compared in its own
//! noise. Noise sits in the residual, not in the regressor, so nothing is attenuated. Levenberg-Marquardt
//! on the triangle of the shared unknowns; directions that the data leave open do not move.

use crate::answer;
use crate::coordinates::FitOptions;
use crate::diagnosis::{Diagnosis, diagnose};
use crate::estimate::{ChannelFit, Estimate, SegmentFit};
use crate::fit::{Fitted, ITERATIONS, chi2, fit};
use crate::information::{Experiment, Point};
use crate::likelihood::{ChannelResidual, Sight};
use crate::linear::solve_linear;
use crate::loss::Loss;
use crate::parameters::{
    Equations, Parameters, ParametersError, TENSOR, UnknownKind, rotation_properties,
};
use crate::problem::{Problem, ProblemError};
use crate::solved::{Solved, StartOfSegment, VectorQuantity, head};
use poinsot_model::{EstimateSet, MomentumKnowledge};
use poinsot_spatial::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Lags of the whiteness test.
const LAGS: usize = 10;

/// Identifies by maximum likelihood, started from the linear solution where there is one.
///
/// # Errors
/// The question cannot be asked. What the data leave open is an answer, not an error.
pub fn maximum_likelihood(problem: &Problem) -> Result<Estimate, ProblemError> {
    maximum_likelihood_with(problem, Loss::Gaussian)
}

/// The same with a loss that bounds what a few bad readings can do, or other coordinates of the steps.
///
/// # Errors
/// As [`maximum_likelihood`].
pub fn maximum_likelihood_with(
    problem: &Problem,
    options: impl Into<FitOptions>,
) -> Result<Estimate, ProblemError> {
    let (solved, _) = solve(problem, options.into())?;
    Ok(answer::write(problem, &solved))
}

/// The solved problem, and the value of all unknowns where the fit ended.
pub(crate) fn solve(
    problem: &Problem,
    options: FitOptions,
) -> Result<(Solved, Point), ProblemError> {
    problem.check_samples()?;
    let (parameters, linear) = match solve_linear(problem) {
        Ok(solved)
            if solved.parameters.equations == Equations::Rotation && problem.sees_points() =>
        {
            // The linear method sees rotation alone; an accelerometer sees the mass centre too.
            let parameters = problem.likelihood_parameters()?;
            let lifted = lifted(solved, &parameters);
            (parameters, Some(lifted))
        }
        Ok(solved) => (solved.parameters.clone(), Some(solved)),
        Err(ProblemError::Parameters(ParametersError::RotationOfTree { .. })) => {
            (problem.likelihood_parameters()?, None)
        }
        Err(other) => return Err(other),
    };
    let mut parameters = parameters;
    parameters.add_resting_joints(problem.segments, problem.noise);
    let linear = linear.map(|solved| padded(solved, &parameters));
    let mut experiment = Experiment::new(problem, &parameters);
    experiment.loss = options.loss;
    experiment.coordinates = options.coordinates;
    let mut fitted = fit(&experiment, linear.as_ref(), ITERATIONS)?;
    let mut assumptions = Vec::new();
    if !problem.model.wheels.is_empty() {
        // Between readings a wheel may run straight (torque held) or smoothly: the data decide.
        experiment.wheels_smooth = true;
        let smooth = fit(&experiment, linear.as_ref(), ITERATIONS)?;
        let cost = |experiment: &Experiment, f: &Fitted| {
            experiment
                .chi2(&f.at, &f.evaluated)
                .unwrap_or(f64::INFINITY)
        };
        if cost(&experiment, &smooth) < cost(&experiment, &fitted) {
            fitted = smooth;
            assumptions.push("wheel speeds taken as smooth between readings".to_owned());
        } else {
            experiment.wheels_smooth = false;
            assumptions.push("wheel torques taken as held between readings".to_owned());
        }
    }
    let explained = match &linear {
        Some(solved) => solved.explained,
        None => (!proportional(problem)).then_some(1.0),
    };
    let found = diagnose(&experiment, &fitted);
    let at = fitted.at.clone();
    let mut solved = conclude(&experiment, fitted, explained, found);
    solved.assumptions = assumptions;
    solved.wheels_smooth = experiment.wheels_smooth;
    Ok((solved, at))
}

/// Whether every momentum in the data is proportional to the unknowns: then their scale is open.
pub(crate) fn proportional(problem: &Problem) -> bool {
    let model = problem.model;
    let known_body = model
        .bodies
        .iter()
        .any(|b| b.estimate != EstimateSet::ALL && b.nominal.mass > 0.0);
    let known_wheel = model.wheels.iter().any(|w| !w.estimate);
    let fires = problem.segments.iter().any(|s| !s.firings.is_empty());
    !known_body && !known_wheel && !fires
}

/// A linear solution with the unknowns that only the fit has, at their nominal values.
fn padded(mut solved: Solved, parameters: &Parameters) -> Solved {
    let known = solved.x.len();
    let further = parameters.unknowns[known..].iter().map(|u| u.nominal);
    solved.x.extend(further);
    solved.parameters = parameters.clone();
    solved
}

/// A linear solution of the rotation of one body in barycentric unknowns, mass and whatever else it does not
/// know at their nominal values.
fn lifted(mut solved: Solved, parameters: &Parameters) -> Solved {
    solved.x = lifted_vector(&solved.parameters, &solved.x, parameters);
    solved.parameters = parameters.clone();
    solved
}

/// The same for the values of the unknowns alone.
pub(crate) fn lifted_vector(from: &Parameters, x: &[f64], parameters: &Parameters) -> Vec<f64> {
    let body = rotation_properties(from, x);
    let pi = body.parameters().to_array();
    let with_centre = parameters.estimate[0].com;
    let known: Vec<(&str, f64)> = from
        .unknowns
        .iter()
        .zip(x)
        .map(|(u, x)| (u.name.as_str(), *x))
        .collect();
    parameters
        .unknowns
        .iter()
        .map(|unknown| match &unknown.kind {
            UnknownKind::Barycentric(parts) => {
                let k = parts.first().map_or(0, |(at, _)| at % 10);
                match k.checked_sub(4) {
                    Some(e) if !with_centre => body.I_BBcm_B[TENSOR[e]],
                    _ => pi[k],
                }
            }
            _ => {
                let found = known.iter().find(|(name, _)| *name == unknown.name);
                found.map_or(unknown.nominal, |(_, x)| *x)
            }
        })
        .collect()
}

pub(crate) fn conclude(
    experiment: &Experiment,
    fitted: Fitted,
    explained: Option<f64>,
    found: Diagnosis,
) -> Solved {
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
            rows.saturating_sub(heads + fitted.spectrum.rank + fitted.shared.nuisances),
        ),
        parameters: experiment.parameters.clone(),
        x: fitted.at.x,
        shared: fitted.shared,
        spectrum: fitted.spectrum,
        data_alone: fitted.data_alone,
        explained,
        starts,
        fit,
        iterations: fitted.iterations,
        settled: fitted.settled,
        warnings: found.findings,
        not_rigid: found.not_rigid,
        held: fitted.held,
        assumptions: Vec::new(),
        wheels_smooth: false,
        regressor_noise: Vec::new(),
        reduced: Vec::new(),
        rows,
    }
}

pub(crate) fn channel_fit(channel: &ChannelResidual) -> ChannelFit {
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
