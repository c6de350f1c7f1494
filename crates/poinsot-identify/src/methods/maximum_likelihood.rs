//! Maximum likelihood in the momentum state.
//!
//! Unknown are the mass properties, the pose and momentum at the start of every segment, and biases. Measured joint and
//! wheel motion drives the pose-momentum equation; every sample is compared in its own noise. Noise is in the residual,
//! not in the regressor, so there is no attenuation. Levenberg-Marquardt on the triangle of the shared unknowns;
//! unobservable directions do not move.

use crate::certify::continuation::unobservable_set;
use crate::diagnosis::conflict::priors_against_data;
use crate::diagnosis::octaves::{chance, consistent, octaves};
use crate::diagnosis::{Diagnostics, FaultKind, Finding, diagnose, power, whiteness};
use crate::fit::alternatives::AlternativeFit;
use crate::fit::degrees_of_freedom::fitted_numbers;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::known_numbers::{Effects, KnownFit, fit_known};
use crate::fit::part_of_record::beginning;
use crate::fit::profile::profiled;
use crate::fit::step_error::StepError;
use crate::fit::triangle::conditional_estimate;
use crate::fit::{Fitted, Search, fit};
use crate::likelihood::{ChannelResidual, Evaluated, InitialState, InitialStateColumns};
use crate::methods::linear::solve_linear;
use crate::methods::other_minima::least;
use crate::motion::input_curves::extrapolated_inputs;
use crate::motion::input_noise::approximate;
use crate::problem::alternative::BetweenSamples;
use crate::problem::loss::Loss;
use crate::problem::parameters::{Equations, Parameters, lifted_vector};
use crate::problem::prior::{Conflict, PriorTest};
use crate::problem::question::INTERVAL;
use crate::problem::refusal::NO_VELOCITY;
use crate::problem::segment::Segment;
use crate::problem::settings::Settings;
use crate::problem::shifted_vehicle::ShiftedVehicle;
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::{ChannelFit, SegmentFit};
use crate::solution::evidence::{Effect, Remark};
use crate::solution::solved::{OfLikelihood, Solution, StartOfSegment, VectorQuantity};
use crate::solution::unobservable_set::UnobservableSet;
use poinsot_model::EstimateSet;
use poinsot_solve::Spectrum;
use poinsot_spatial::Vector3;

/// The solution of a problem.
pub(crate) struct FinishedFit {
    pub solution: Solution,
    /// Value of all unknowns where the fit ended.
    pub at: Iterate,
    /// The vehicle with the estimated values of its known numbers.
    pub shifted: Option<ShiftedVehicle>,
    /// The records as the fit took them, where the torque of wheels is a process or the inputs are smoothed.
    pub segments: Option<Vec<Segment>>,
    /// -2 ln L, up to a constant of the records.
    pub cost: f64,
    /// The fit before the torque of wheels was taken as a process.
    pub plain: PlainFit,
}

/// What is left by a fit with the plain motion of the wheels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlainFit {
    /// What it assumes.
    pub wheels: BetweenSamples,
    /// Whether the answer is another one.
    pub replaced: bool,
    /// Chance of a residual like its own.
    pub chance: f64,
}

impl FinishedFit {
    /// A search that failed: nothing is said of the vehicle but a mistake that a fit of its own confirmed.
    fn lost(experiment: &Experiment, fitted: &Fitted) -> Self {
        let found = diagnosed(experiment, fitted);
        Self {
            solution: conclude(experiment, fitted, None, found),
            at: fitted.at.clone(),
            shifted: None,
            segments: None,
            cost: f64::INFINITY,
            plain: PlainFit {
                wheels: experiment.wheels,
                replaced: false,
                chance: 0.0,
            },
        }
    }
}

/// The solved problem, and where the fit ended; from a point near the solution, where one is known.
pub(super) fn solve(
    problem: &Problem,
    settings: Settings,
    near: Option<Iterate>,
) -> Result<FinishedFit, ProblemError> {
    settings.validate()?;
    problem.check_observations()?;
    let LinearStart { parameters, linear } = LinearStart::new(problem)?;
    problem.check_known_numbers()?;
    problem.check_modes()?;
    let mut experiment = Experiment::new(problem, &parameters);
    experiment.settings = settings;
    let start = near.or_else(|| linear.as_ref().map(|solution| solution.point(&experiment)));

    // The alternatives of what inputs do between their samples, each fitted from the end of the best one before it.
    let explains = |fitted: &Fitted| consistent(&fitted.evaluated, &settings);
    let first = fit(&experiment, start.as_ref())?;
    let first = least(&experiment, first, start.as_ref());
    let best = AlternativeFit::new(experiment, first).or_smooth_wheels();
    let mut plain = PlainFit {
        wheels: best.experiment.wheels,
        replaced: false,
        chance: chance(&best.fitted.evaluated, &settings),
    };
    let process = best.wheel_process(explains);
    let driven = process.as_ref().map(|p| problem.with_segments(&p.segments));
    let best = best.or_random_torque(driven.as_ref(), explains);
    let (smooth, fitted) = (best.smoothed(explains, start.as_ref()))
        .map(|s| (s.segments, s.fitted))
        .unzip();
    let about = smooth.as_ref().map(|s| problem.with_segments(s));
    let best = best.about(about.as_ref().zip(fitted));
    let (tried, end) = (&best.experiment, &best.fitted);
    let known = || fit_known(tried, end).filter(|known| known.fitted.converged);
    if !end.is_found() && known().is_none() {
        return Ok(FinishedFit::lost(tried, end));
    }
    let (best, step_error) = best.within_steps();

    // The known numbers within their uncertainty, what explains a misfit, and the certificate.
    let known = fit_known(&best.experiment, &best.fitted);
    let wide = known
        .as_ref()
        .map(|known| best.experiment.with_parameters(&known.parameters));
    let (experiment, fitted) = match (&wide, &known) {
        (Some(wide), Some(known)) => (wide, &known.fitted),
        _ => (&best.experiment, &best.fitted),
    };
    let causes = match &known {
        Some(known) if known.left => Causes::of(&best.experiment, &best.fitted),
        _ => Causes::of(experiment, fitted),
    };
    let causes = causes.and_of_known_numbers(known.as_ref());
    let explained = match &linear {
        Some(solution) => solution.explained,
        None => (!proportional(problem)).then_some(1.0),
    };
    let mut solution = certified(experiment, fitted, explained, causes.diagnostics);

    // The answer, with what it owes to its assumptions.
    let records = solution.fit.iter_mut().zip(problem.segments);
    records.for_each(|(fit, own)| fit.samples = own.observations.time_s.len());
    let owed = owed(&best, problem, &solution, step_error);
    solution.remarks.extend(owed);
    if let Some(own) = &mut solution.likelihood {
        (own.prior_tests, own.conflict) = (causes.prior_tests, causes.conflict);
        own.diagnostics.shift_between_readings = best.shift;
        let other = best.other.clone();
        own.other_wheel_motion = other.map(|o| o.among(&parameters, &solution.parameters));
    }
    let (taken, x) = (best.experiment.problem, &fitted.at.x);
    let of_known = |_| ShiftedVehicle::at(taken, &solution.parameters, x);
    let shifted = known.as_ref().and_then(of_known);
    plain.replaced = best.experiment.wheels == BetweenSamples::RandomTorque;
    Ok(FinishedFit {
        solution,
        at: fitted.at.clone(),
        shifted,
        cost: best.experiment.cost_of(&best.fitted),
        plain,
        segments: smooth.or(process.filter(|_| plain.replaced).map(|p| p.segments)),
    })
}

/// The solution with its certificate: what the data determine, and along which paths all predictions are equal.
fn certified(
    experiment: &Experiment,
    fitted: &Fitted,
    explained: Option<f64>,
    found: Diagnostics,
) -> Solution {
    tracing::info!(target: "poinsot::progress", stage = "finding what the data determine");
    let mut solution = conclude(experiment, fitted, explained, found);
    let (spectrum, curved) = profiled(experiment, fitted, solution.spectrum);
    solution.spectrum = spectrum;
    if curved > 0 {
        solution.remarks.push(by_profile(curved));
    }
    solution.unobservable_set = unobservable_set(experiment, &fitted.at, &solution);
    solution
}

/// What an answer owes to its assumptions.
fn owed(
    best: &AlternativeFit,
    problem: &Problem,
    solution: &Solution,
    step_error: Option<StepError>,
) -> Vec<Remark> {
    let approximate = approximate(best.experiment.problem).map(Remark::warning);
    let sensitivities = sensitivities(best, solution, step_error);
    let assumption = best.assumption(problem).map(Remark::assumption);
    let all = approximate.into_iter().chain(sensitivities);
    all.chain(assumption).collect()
}

/// The unknowns, and the linear solution in them where there is one.
pub(super) struct LinearStart {
    pub parameters: Parameters,
    linear: Option<Solution>,
}

impl LinearStart {
    pub fn new(problem: &Problem) -> Result<Self, ProblemError> {
        let mut linear = match solve_linear(problem) {
            Ok(linear) => linear,
            Err(fault) if fault.code() == NO_VELOCITY => {
                return Ok(Self {
                    parameters: problem.likelihood_parameters()?,
                    linear: None,
                });
            }
            Err(other) => return Err(other),
        };
        if linear.parameters.equations == Equations::Rotation && problem.sees_points() {
            // The linear method sees rotation alone; an accelerometer sees the mass centre too. What is missing is nominal.
            let parameters = problem.likelihood_parameters()?;
            linear.x = lifted_vector(&linear.parameters, &linear.x, &parameters);
            linear.parameters = parameters;
        }
        let further = &linear.parameters.unknowns[linear.x.len()..];
        linear.x.extend(further.iter().map(|u| u.nominal));
        Ok(Self {
            parameters: linear.parameters.clone(),
            linear: Some(linear),
        })
    }
}

/// The diagnosis of a fit, empty where none is wanted.
fn diagnosed(experiment: &Experiment, fitted: &Fitted) -> Diagnostics {
    match experiment.settings.undiagnosed {
        true => Diagnostics::default(),
        false => diagnose(experiment, fitted),
    }
}

/// What explains the misfit of a fit, and whether the declared numbers agree with the data.
struct Causes {
    diagnostics: Diagnostics,
    prior_tests: Vec<PriorTest>,
    conflict: Option<Conflict>,
}

impl Causes {
    fn of(experiment: &Experiment, fitted: &Fitted) -> Self {
        let mut diagnostics = diagnosed(experiment, fitted);
        let wanted = !experiment.settings.undiagnosed;
        let priors = priors_against_data(experiment, fitted, wanted);
        // What a convention explains no prior has to.
        let freed = priors.freed.filter(|_| !diagnostics.is_mistaken());
        if let Some(freed) = freed {
            let found = &mut diagnostics;
            (found.suspects, found.findings) = (freed.suspects, freed.findings);
            (found.lags, found.drift, found.lines) = (freed.lags, freed.drift, freed.lines);
        }
        Self {
            diagnostics,
            prior_tests: priors.tests,
            conflict: priors.conflict,
        }
    }

    /// With the test of the known numbers, and the one that the data contradict.
    fn and_of_known_numbers(mut self, known: Option<&KnownFit>) -> Self {
        self.prior_tests.extend(known.and_then(|k| k.test.clone()));
        self.conflict = (self.conflict).or_else(|| known.and_then(|k| k.contradiction.clone()));
        let conflict = self.conflict.as_ref();
        let finding = conflict.map(|c| Finding::new(FaultKind::Prior, c.text.clone()));
        let at = usize::from(self.diagnostics.is_mistaken());
        self.diagnostics.findings.splice(at..at, finding);
        self
    }
}

/// Directions whose interval is that of the profile.
fn by_profile(curved: usize) -> Remark {
    let words = format!("directions with the interval of the profile likelihood: {curved}");
    Remark::test("shape of the likelihood", Effect::None, words)
        .statistic("directions", curved as f64)
}

/// How much the answer depends on each assumption: tests, and what the user has to know.
fn sensitivities(
    best: &AlternativeFit,
    solution: &Solution,
    step_error: Option<StepError>,
) -> Vec<Remark> {
    let problem = best.experiment.problem;
    let mut list = Vec::new();
    let mut add = |to: &str, statistic, value: f64, too_large: bool, warning: Option<String>| {
        let not = if too_large { "" } else { "not " };
        let words = format!("the estimate is {not}sensitive to {to}");
        let effect = Effect::AgainstAnswer.if_failed(too_large);
        let test = Remark::test(format!("sensitivity to {to}"), effect, words);
        list.push(test.statistic(statistic, value));
        list.extend(warning.map(Remark::warning));
    };
    let change = "change of the estimate, sigma";
    if problem.assumes_wheel_motion() {
        let to = "the wheel motion between samples";
        let warning = wheel_warning(best);
        add(to, change, best.shift, best.is_sensitive(), warning);
    }
    let beyond = extrapolated_inputs(problem.segments, &solution.parameters, &solution.x);
    if let Some(beyond) = beyond {
        let to = "inputs beyond the first and last sample";
        let share = "share of the shortest record";
        let large = beyond.is_large();
        let warning = large.then(|| beyond.message());
        add(to, share, beyond.share, large, warning);
    }
    if let Some(error) = step_error {
        let large = !error.is_small(&solution.settings.integration);
        let warning = large.then(|| error.message());
        let to = "the integration steps";
        add(to, change, error.answer, large, warning);
    }
    list
}

/// The warning where the answer is sensitive to the wheel motion between samples. Smooth speeds that fit better are far
/// more accurate than the difference of the two, if the wheels are sampled as often as other sensors; torques usually change
/// at the samples.
fn wheel_warning(best: &AlternativeFit) -> Option<String> {
    let shift = best.shift;
    if shift <= best.experiment.settings.sensitivity_sigmas {
        return None;
    }
    let smooth = best.experiment.wheels == BetweenSamples::Smooth;
    let (assumed, other) = match smooth {
        true => ("wheel speed smooth between samples", "constant torque"),
        false => ("wheel torque constant between samples", "smooth speed"),
    };
    let consequence = match (best.is_sensitive(), smooth) {
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
    !known_body && !known_wheel && !problem.fires()
}

pub(crate) fn conclude(
    experiment: &Experiment,
    fitted: &Fitted,
    explained: Option<f64>,
    found: Diagnostics,
) -> Solution {
    let numbers = fitted_numbers(experiment, fitted);
    // The fit uses all information; identifiability is evaluated afterwards with exact known numbers.
    let judged = |spectrum: Spectrum| spectrum.judged(experiment.problem.largest_sigma());
    let known = Effects::new(experiment, fitted);
    let within = |k: &Effects| Spectrum::within(&fitted.shared.block(), None, &k.exact).ok();
    let spectrum = known.as_ref().and_then(within);
    let spectrum = spectrum.unwrap_or_else(|| judged(fitted.spectrum.clone()));
    let (R, rhs) = (fitted.shared.block(), fitted.shared.rhs());
    let spectrum = spectrum.reaching(&R, &rhs, INTERVAL);
    Solution {
        method: "maximum_likelihood",
        residual: (fitted.chi2(), fitted.rows().saturating_sub(numbers)),
        parameters: experiment.parameters.clone(),
        x: fitted.at.x.clone(),
        shared: fitted.shared.clone(),
        spectrum,
        explained,
        starts: starts(experiment, fitted),
        fit: segment_fits(experiment, fitted),
        remarks: (found.findings.iter())
            .map(|f| Remark::warning(f.text.clone()))
            .collect(),
        noise_accumulates: false,
        settings: experiment.settings,
        unobservable_set: UnobservableSet::default(),
        likelihood: Some(OfLikelihood {
            known,
            data_alone: fitted.data_alone.clone().map(judged),
            prior_tests: Vec::new(),
            conflict: None,
            iterations: fitted.iterations,
            costs: fitted.costs.clone(),
            converged: fitted.converged,
            found: fitted.is_found(),
            contradicted: fitted.search == Search::Contradicted,
            followed: followed(experiment, fitted),
            held: fitted.held.clone(),
            diagnostics: found,
            wheels: experiment.wheels,
            other_wheel_motion: None,
        }),
    }
}

/// The part of the record that a failed search explains, in words; `None` of every other one.
fn followed(experiment: &Experiment, fitted: &Fitted) -> Option<String> {
    let (Search::Lost(share), segments) = (fitted.search, experiment.problem.segments) else {
        return None;
    };
    let times = |only: &Segment| beginning(only, share).observations.time_s;
    let words = match segments {
        [only] => match times(only)[..] {
            [from, .., to] => {
                let [from, to] = [from, to].map(|t| (t * 1.0e3).round() / 1.0e3);
                format!("from {from} to {to} s (--time-s {from},{to})")
            }
            _ => return None,
        },
        _ => format!("over the first {:.0} % of each record", 100.0 * share),
    };
    (share > 0.0).then_some(words)
}

/// Momentum at the start of every segment.
fn starts(experiment: &Experiment, fitted: &Fitted) -> Vec<StartOfSegment> {
    let x = &fitted.at.x;
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
            given: experiment.problem.model.momentum,
            translation: experiment.sees_translation,
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
        power_p: power(&channel.white, numbers),
        octaves: octaves(&channel.white, numbers, loss),
    }
}
