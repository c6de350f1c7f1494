//! The Cramer-Rao bound of an experiment: the information of its samples for any estimator.

use crate::answer;
use crate::diagnosis::Diagnostics;
use crate::fit::experiment::Experiment;
use crate::fit::rest_motion::choose_rest_motion;
use crate::fit::wheel_motion::{self, BetweenSamples, OtherWheelMotion, expected_wheel_motion};
use crate::fit::wheel_torque::RandomTorque;
use crate::fit::{Fitted, fit_from};
use crate::methods::maximum_likelihood::{conclude, proportional, random_where_it_matters};
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::Estimate;

/// Information of the experiment at the model's own numbers, assumed true; the segments have ideal measurements, the
/// noise is the declared one.
///
/// Values of the answer are those of the model; its sigmas are the bound (Rao 1945, Cramer 1946), pose,
/// momentum and biases projected out.
///
/// # Errors
/// The model or the data are not valid for the method.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let bound = cramer_rao(&problem)?;
/// assert_eq!(bound.identifiability.rank, 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cramer_rao(problem: &Problem) -> Result<Estimate, ProblemError> {
    bound(problem, |_, _| None)
}

/// The sigmas that an identification of such measurements will state: the bound, and where they can hardly tell what the
/// wheels do between samples, the mean square of what the choice adds. Where an identification would fit the torque of the
/// wheels as a process, so does this.
///
/// # Errors
/// As [`cramer_rao`].
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let estimate = predicted_covariance(&problem)?;
/// assert!(estimate.states_covariance);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn predicted_covariance(problem: &Problem) -> Result<Estimate, ProblemError> {
    bound(problem, expected)
}

/// What an identification of such measurements assumes of the wheels.
pub(crate) struct Expected {
    /// The hypothesis that it does not assume.
    pub other: OtherWheelMotion,
    /// The torque as a process, if it assumes that.
    pub torque: Option<RandomTorque>,
}

/// The same from an evaluation at the true unknowns; `None` where nothing is assumed.
pub(crate) fn expected(experiment: &Experiment, at_truth: &Fitted) -> Option<Expected> {
    let plain = expected_wheel_motion(experiment, &at_truth.at)?;
    let torque = random_where_it_matters(experiment, at_truth, plain.other.shift);
    let found = torque.and_then(|torque| {
        let driven = plain.with_torque(experiment, (&torque, &at_truth.at))?;
        Some((driven.other, Some(torque)))
    });
    let (other, torque) = found.unwrap_or((plain.other, None));
    Some(Expected { other, torque })
}

fn bound(
    problem: &Problem,
    expected: impl Fn(&Experiment, &Fitted) -> Option<Expected>,
) -> Result<Estimate, ProblemError> {
    problem.check_samples()?;
    problem.check_observations()?;
    let parameters = problem.likelihood_parameters()?;
    let mut experiment = Experiment::new(problem, &parameters);
    let evaluated = |experiment: &Experiment| {
        let at_truth = fit_from(experiment, experiment.nominal_point(), 0);
        at_truth.ok_or(ProblemError::NoMotion)
    };
    let mut at_truth = evaluated(&experiment)?;
    if choose_rest_motion(&mut experiment, &at_truth) {
        at_truth = evaluated(&experiment)?;
    }
    let expected = expected(&experiment, &at_truth);
    let torque = expected.as_ref().and_then(|e| e.torque.as_ref());
    let driven = torque.map(|torque| torque.problem(problem));
    if let Some(driven) = &driven {
        experiment = wheel_motion::driven(&experiment, driven);
        at_truth = evaluated(&experiment)?;
    }
    at_truth.converged = true;
    // A bound has no misfit: interpolation errors of wheel motion are not noise.
    for segment in &mut at_truth.evaluated {
        segment.chi2 = 0.0;
        segment.cost = 0.0;
        segment.channels.clear();
    }
    let explained = (!proportional(problem)).then_some(1.0);
    let mut solution = conclude(&experiment, at_truth, explained, Diagnostics::default());
    let counts = problem.segments.iter().map(|s| s.observations.time_s.len());
    let fits = solution.fit.iter_mut().zip(counts);
    fits.for_each(|(fit, samples)| fit.samples = samples);
    solution.method = "cramer_rao";
    if let Some(own) = &mut solution.likelihood {
        if driven.is_some() {
            let motion = BetweenSamples::RandomTorque;
            own.assumptions.push(motion.words().to_owned());
        }
        own.other_wheel_motion = expected.map(|e| e.other);
    }
    Ok(answer::write_with_remedies(problem, &solution))
}
