//! Maximum likelihood in the momentum state.
//!
//! Unknown are the mass properties, the pose and momentum at the start of every segment, and biases. Measured joint and
//! wheel motion drives the pose-momentum equation; every sample is compared in its own noise. Noise is in the residual,
//! not in the regressor, so there is no attenuation. Levenberg-Marquardt on the triangle of the shared unknowns;
//! unobservable directions do not move.

use crate::answer;
use crate::certify::continuation::unobservable_set;
use crate::diagnosis::conflict::{self, priors_against_data};
use crate::diagnosis::octaves::{consistent, octaves};
use crate::diagnosis::{Diagnostics, diagnose, whiteness};
use crate::fit::degrees_of_freedom::fitted_numbers;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::known_numbers::{Effects, fit_known};
use crate::fit::rest_motion::{refit_with_rest_motion, rest_assumed};
use crate::fit::step_error::{StepError, within_steps};
use crate::fit::triangle::conditional_estimate;
use crate::fit::wheel_motion::{
    BetweenSamples, MATTERS, OtherWheelMotion, choose_wheel_motion, fit_random_torque,
    random_torque,
};
use crate::fit::wheel_torque::RandomTorque;
use crate::fit::{Fitted, ITERATIONS, chi2, fit};
use crate::likelihood::{
    ChannelResidual, Evaluated, InitialState, InitialStateColumns, MeasuredMotion,
};
use crate::methods::linear::solve_linear;
use crate::motion::input_curves::extrapolated_inputs;
use crate::problem::loss::Loss;
use crate::problem::parameters::{Equations, Parameters, ParametersError, lifted_vector};
use crate::problem::prior::Conflict;
use crate::problem::segment::{InputErrors, Segment};
use crate::problem::settings::Settings;
use crate::problem::shifted_vehicle::ShiftedVehicle;
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::{ChannelFit, Estimate, SegmentFit};
use crate::solution::solved::{
    OfLikelihood, Sensitivity, Solution, StartOfSegment, VectorQuantity,
};
use crate::solution::unobservable_set::UnobservableSet;
use poinsot_model::{EstimateSet, MomentumKnowledge};
use poinsot_solve::Spectrum;
use poinsot_spatial::Vector3;

/// Share of the variance from which the choice between two wheel motions is said.
const NOTED_SHARE: f64 = 0.02;

/// Identifies by maximum likelihood, started from the linear solution where there is one.
///
/// # Errors
/// The model or the data are not valid for the method. Undetermined numbers are an answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let estimate = maximum_likelihood(&problem)?;
/// assert_eq!(estimate.status, Status::Partial);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn maximum_likelihood(problem: &Problem) -> Result<Estimate, ProblemError> {
    maximum_likelihood_with(problem, Loss::Gaussian)
}

/// The same with other settings; a [`Loss`] alone bounds what a few bad samples can do.
///
/// # Errors
/// As [`maximum_likelihood`], or a setting is out of its range.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// // A robust loss, with the default of every other setting.
/// let estimate = maximum_likelihood_with(&problem, Loss::from_name("huber").unwrap())?;
/// assert_eq!(estimate.status, Status::Partial);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn maximum_likelihood_with(
    problem: &Problem,
    settings: impl Into<Settings>,
) -> Result<Estimate, ProblemError> {
    let ended = solve(problem, settings.into())?;
    Ok(answer::write(problem, &ended.solution))
}

/// The solution of a problem.
pub(crate) struct FinishedFit {
    pub solution: Solution,
    /// Value of all unknowns where the fit ended.
    pub at: Iterate,
    /// The vehicle with the estimated values of its known numbers.
    pub shifted: Option<ShiftedVehicle>,
    /// The records as the fit took them, where the torque of wheels is a process.
    pub segments: Option<Vec<Segment>>,
}

/// The solved problem, and where the fit ended.
pub(crate) fn solve(problem: &Problem, settings: Settings) -> Result<FinishedFit, ProblemError> {
    settings.validate()?;
    problem.check_samples()?;
    problem.check_observations()?;
    let (parameters, linear) = match solve_linear(problem) {
        Ok(solution)
            if solution.parameters.equations == Equations::Rotation && problem.sees_points() =>
        {
            // The linear method sees rotation alone; an accelerometer sees the mass centre too.
            let parameters = problem.likelihood_parameters()?;
            let lifted = lifted(solution, &parameters);
            (parameters, Some(lifted))
        }
        Ok(solution) => (solution.parameters.clone(), Some(solution)),
        Err(ProblemError::Parameters(ParametersError::RotationOfTree { .. })) => {
            (problem.likelihood_parameters()?, None)
        }
        Err(other) => return Err(other),
    };
    problem.check_known_numbers()?;
    let linear = linear.map(|solution| padded(solution, &parameters));
    let mut experiment = Experiment::new(problem, &parameters);
    experiment.settings = settings;
    let start = linear.as_ref().map(|solution| solution.point(&experiment));
    let fitted = fit(&experiment, start.as_ref())?;
    let mut fitted = refit_with_rest_motion(&mut experiment, fitted, ITERATIONS);
    let mut assumptions: Vec<String> = rest_assumed(&experiment).into_iter().collect();
    let (mut shift, mut other) = (0.0, None);
    if problem.assumes_wheel_motion() {
        let between = choose_wheel_motion(&mut experiment, fitted);
        (fitted, shift, other) = (between.fitted, between.shift, between.other);
        let own = match experiment.wheels_smooth {
            true => BetweenSamples::Smooth,
            false => BetweenSamples::Held,
        };
        assumptions.push(assumed(own, other.as_ref()));
    }
    let torque = random_where_it_matters(&experiment, &fitted, shift);
    let driven = torque.as_ref().map(|torque| torque.problem(problem));
    let (mut problem, own) = (problem, problem.segments);
    let found = driven
        .as_ref()
        .and_then(|driven| fit_random_torque(&experiment, driven, &fitted))
        // A misfit that it does not explain has another cause, which the diagnosis names.
        .filter(|found| consistent(&found.fitted.evaluated, &settings));
    let at_random = found.is_some();
    if let Some(found) = found {
        (problem, experiment) = (found.experiment.problem, found.experiment);
        (fitted, shift, other) = (found.fitted, 0.0, found.other);
        assumptions.pop();
        assumptions.push(assumed(BetweenSamples::RandomTorque, other.as_ref()));
    }
    let (fitted, step_error) = within_steps(&mut experiment, fitted, ITERATIONS);
    let explained = match &linear {
        Some(solution) => solution.explained,
        None => (!proportional(problem)).then_some(1.0),
    };
    let (mut solution, at, shifted) = with_known_numbers(&experiment, fitted, explained);
    let counts = own.iter().map(|s| s.observations.time_s.len());
    let fits = solution.fit.iter_mut().zip(counts);
    fits.for_each(|(fit, samples)| fit.samples = samples);
    if let Some(own) = &mut solution.likelihood {
        own.assumptions = assumptions;
        own.other_wheel_motion = other.map(|o| o.among(&parameters, &solution.parameters));
    }
    note(problem, &mut solution, shift, step_error);
    Ok(FinishedFit {
        solution,
        at,
        shifted,
        segments: torque.filter(|_| at_random).map(|t| t.segments),
    })
}

/// The answer with all known numbers as unknowns, where any is uncertain.
fn with_known_numbers(
    experiment: &Experiment,
    fitted: Fitted,
    explained: Option<f64>,
) -> (Solution, Iterate, Option<ShiftedVehicle>) {
    let problem = experiment.problem;
    let known = fit_known(experiment, &fitted);
    let (mut solution, at) = match &known {
        None => {
            let end = (fitted, None, None);
            judged(experiment, end, explained)
        }
        Some(known) => {
            let wide = known.experiment(experiment);
            let looked_at = known.left.then_some((experiment, &fitted));
            let end = known.fitted.clone();
            let contradiction = known.contradiction.clone();
            let end = (end, looked_at, contradiction);
            judged(&wide, end, explained)
        }
    };
    let of_known = known.as_ref().and_then(|known| known.test.clone());
    if let Some(own) = &mut solution.likelihood {
        own.prior_tests.extend(of_known);
    }
    let shifted = match &known {
        Some(_) => ShiftedVehicle::at(problem, &solution.parameters, &at.x),
        None => None,
    };
    solution.unobservable_set = match &known {
        None => unobservable_set(experiment, &at, &solution),
        Some(known) => unobservable_set(&known.experiment(experiment), &at, &solution),
    };
    (solution, at, shifted)
}

/// The wheel motion that is assumed between samples, and what the choice adds to the sigmas.
fn assumed(motion: BetweenSamples, other: Option<&OtherWheelMotion>) -> String {
    let own = motion.words();
    match other.filter(|o| o.added > NOTED_SHARE) {
        None => own.to_owned(),
        Some(o) => format!(
            "{own}, {:.0} % probable; the other way would move the answer by {:.1} sigma, which the sigmas include",
            100.0 * (1.0 - o.probability),
            o.shift
        ),
    }
}

/// Sensitivities and approximations of the answer; `shift` is that of another wheel motion between samples.
fn note(problem: &Problem, solution: &mut Solution, shift: f64, step_error: Option<StepError>) {
    if let Some(warning) = crate::motion::input_noise::approximate(problem) {
        solution.warnings.push(warning);
    }
    let sensitive = shift > solution.settings.sensitivity_sigmas;
    let mut sensitivities = Vec::new();
    if problem.assumes_wheel_motion() {
        // Torques usually change at the samples; here they are known not to.
        let mut segments = problem.segments.iter();
        let seldom = segments.any(|s| s.observations.between_readings);
        sensitivities.push(Sensitivity {
            to: "the wheel motion between samples",
            statistic: ("change of the estimate, sigma", shift),
            too_large: sensitive && seldom,
        });
        if sensitive {
            let own = solution.likelihood.as_ref();
            let smooth = own.is_some_and(|own| own.wheels_smooth);
            let warning = wheel_warning(shift, smooth, seldom);
            solution.warnings.extend(warning);
        }
    }
    let beyond = extrapolated_inputs(problem.segments, &solution.parameters, &solution.x);
    if let Some(beyond) = beyond {
        sensitivities.push(Sensitivity {
            to: "inputs beyond the first and last sample",
            statistic: ("share of the shortest record", beyond.share),
            too_large: beyond.is_large(),
        });
        if beyond.is_large() {
            solution.warnings.push(beyond.message());
        }
    }
    if let Some(error) = step_error {
        let small = error.is_small(&solution.settings.integration);
        sensitivities.push(Sensitivity {
            to: "the integration steps",
            statistic: ("change of the estimate, sigma", error.answer),
            too_large: !small,
        });
        if !small {
            solution.warnings.push(error.message());
        }
    }
    if let Some(own) = &mut solution.likelihood {
        own.sensitivities = sensitivities;
        own.diagnostics.shift_between_readings = shift;
    }
}

/// The torque of the wheels as a process, where it may change an answer that another wheel motion changes by `shift` sigmas.
fn random_where_it_matters(
    experiment: &Experiment,
    fitted: &Fitted,
    shift: f64,
) -> Option<RandomTorque> {
    let (problem, settings) = (experiment.problem, &experiment.settings);
    let rounded = rounding_lasts(problem);
    if shift <= MATTERS && !rounded {
        return None;
    }
    let explains = consistent(&fitted.evaluated, settings);
    let trusted = explains && !sensitive(problem, settings, shift) && !rounded;
    random_torque(experiment, (fitted, trusted))
}

/// Whether an answer depends on how wheels run between samples that are rarer than those of other sensors.
fn sensitive(problem: &Problem, settings: &Settings, shift: f64) -> bool {
    let mut segments = problem.segments.iter();
    shift > settings.sensitivity_sigmas && segments.any(|s| s.observations.between_readings)
}

/// Whether rounding errors of wheels last over several samples: then their correlation is known roughly alone.
fn rounding_lasts(problem: &Problem) -> bool {
    let wheels = problem
        .segments
        .iter()
        .map(|s| &s.observations.wheel_errors);
    wheels.flatten().any(InputErrors::lasts)
}

/// Diagnoses a fit and concludes. `looked_at` is diagnosed instead, where known numbers do not explain a misfit.
fn judged(
    experiment: &Experiment,
    (fitted, looked_at, contradiction): (Fitted, Option<(&Experiment, &Fitted)>, Option<Conflict>),
    explained: Option<f64>,
) -> (Solution, Iterate) {
    let undiagnosed = experiment.settings.undiagnosed;
    let (of, end) = looked_at.unwrap_or((experiment, &fitted));
    let mut found = match undiagnosed {
        true => Diagnostics::default(),
        false => diagnose(of, end, fitted_numbers(of, end)),
    };
    let priors = priors_against_data(of, end, !undiagnosed);
    let conflict = priors.conflict.or(contradiction);
    if let Some(conflict) = &conflict {
        if let Some(freed) = priors.freed {
            (found.suspects, found.findings) = (freed.suspects, freed.findings);
            (found.lags, found.drift, found.lines) = (freed.lags, freed.drift, freed.lines);
        }
        found.findings.insert(0, conflict::finding(conflict));
    }
    let at = fitted.at.clone();
    let mut solution = conclude(experiment, fitted, explained, found);
    if let Some(own) = &mut solution.likelihood {
        (own.prior_tests, own.conflict) = (priors.tests, conflict);
    }
    (solution, at)
}

/// The warning where the answer is sensitive to the wheel motion between samples. Smooth speeds that fit better are far
/// more accurate than the difference of the two, if the wheels are sampled as often as other sensors.
fn wheel_warning(shift: f64, smooth: bool, seldom: bool) -> Option<String> {
    let (assumed, other) = match smooth {
        true => ("wheel speed smooth between samples", "constant torque"),
        false => ("wheel torque constant between samples", "smooth speed"),
    };
    let consequence = match (seldom, smooth) {
        (true, _) => {
            ", and the wheels are sampled less often than other sensors: the covariance is not trustworthy"
        }
        (false, false) => "",
        (false, true) => return None,
    };
    Some(format!(
        "assumed: {assumed}; with {other} the estimate would change by {shift:.1} sigma{consequence}; sample the wheels more often"
    ))
}

/// Whether every momentum in the data is proportional to the unknowns: then their scale is undetermined.
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
fn padded(mut solution: Solution, parameters: &Parameters) -> Solution {
    let known = solution.x.len();
    let further = parameters.unknowns[known..].iter().map(|u| u.nominal);
    solution.x.extend(further);
    solution.parameters = parameters.clone();
    solution
}

/// A linear solution of the rotation of one body in barycentric unknowns, mass and other missing unknowns at their
/// nominal values.
fn lifted(mut solution: Solution, parameters: &Parameters) -> Solution {
    solution.x = lifted_vector(&solution.parameters, &solution.x, parameters);
    solution.parameters = parameters.clone();
    solution
}

pub(crate) fn conclude(
    experiment: &Experiment,
    fitted: Fitted,
    explained: Option<f64>,
    found: Diagnostics,
) -> Solution {
    let numbers = fitted_numbers(experiment, &fitted);
    let rows: usize = fitted.evaluated.iter().map(|e| e.rows).sum();
    let starts = starts(experiment, &fitted);
    let fit = segment_fits(experiment, &fitted);
    // The fit uses all information; identifiability is evaluated afterwards with exact known numbers.
    let judged = |spectrum: Spectrum| spectrum.judged(experiment.problem.relative_accuracy);
    let known = Effects::new(experiment, &fitted).ok().flatten();
    let within = |k: &Effects| Spectrum::within(&fitted.shared.block(), None, &k.exact).ok();
    let spectrum = known.as_ref().and_then(within);
    let spectrum = spectrum.unwrap_or_else(|| judged(fitted.spectrum.clone()));
    Solution {
        method: "maximum_likelihood",
        residual: (chi2(&fitted.evaluated), rows.saturating_sub(numbers)),
        parameters: experiment.parameters.clone(),
        x: fitted.at.x,
        shared: fitted.shared,
        spectrum,
        explained,
        starts,
        fit,
        warnings: found.findings.iter().map(|f| f.text.clone()).collect(),
        noise_accumulates: false,
        settings: experiment.settings,
        unobservable_set: UnobservableSet::default(),
        likelihood: Some(OfLikelihood {
            known,
            data_alone: fitted.data_alone.map(judged),
            prior_tests: Vec::new(),
            conflict: None,
            iterations: fitted.iterations,
            converged: fitted.converged,
            held: fitted.held,
            diagnostics: found,
            assumptions: Vec::new(),
            wheels_smooth: experiment.wheels_smooth,
            rest_motion: experiment.rest_motion,
            other_wheel_motion: None,
            sensitivities: Vec::new(),
        }),
    }
}

/// Momentum at the start of every segment.
fn starts(experiment: &Experiment, fitted: &Fitted) -> Vec<StartOfSegment> {
    let given = &experiment.problem.model.momentum;
    let x = &fitted.at.x;
    let translation = experiment.measured_motion == MeasuredMotion::Translation;
    let segments = fitted.evaluated.iter().zip(&fitted.at.initial_states);
    let start = |((one, at), unknown): ((&Evaluated, &InitialState), &InitialStateColumns)| {
        let triangle = one.triangle.as_ref();
        let conditional = triangle.map(|t| conditional_estimate(&t.r, unknown.count(), x));
        let pick = |column: Option<usize>, value: Vector3| match (&conditional, column) {
            (Some(conditional), Some(from)) => {
                VectorQuantity::of_initial_state(conditional, from, value)
            }
            _ => VectorQuantity::known(value, x.len()),
        };
        let (linear, angular) = unknown.momentum_at();
        StartOfSegment {
            linear: pick(linear, at.P),
            angular: pick(angular, at.h_SScm_N),
            linear_given: match translation {
                true => given.linear,
                false => MomentumKnowledge::Estimate,
            },
            angular_given: given.angular,
            translation,
        }
    };
    segments.zip(&experiment.unknown).map(start).collect()
}

/// Fit of every segment.
pub(crate) fn segment_fits(experiment: &Experiment, fitted: &Fitted) -> Vec<SegmentFit> {
    let segments = experiment.problem.segments.iter().zip(&fitted.evaluated);
    let fit = |(segment, one): (&Segment, &Evaluated)| SegmentFit {
        label: segment.label.clone(),
        samples: segment.observations.time_s.len(),
        chi2_per_dof: one.chi2 / one.rows.max(1) as f64,
        channels: (one.channels.iter())
            .map(|c| channel_fit(c, experiment.settings.loss))
            .collect(),
    };
    segments.map(fit).collect()
}

fn channel_fit(channel: &ChannelResidual, loss: Loss) -> ChannelFit {
    let numbers = channel.numbers;
    let count = (numbers * channel.white.len().max(1)) as f64;
    let chi2: f64 = channel.white.iter().map(|w| w.norm_squared()).sum();
    ChannelFit {
        name: channel.name.clone(),
        unit: channel.unit,
        rms: (channel.square / count).sqrt(),
        chi2_per_number: Some(chi2 / count),
        whiteness_p: whiteness(&channel.white, numbers),
        octaves: octaves(&channel.white, numbers, loss),
    }
}
