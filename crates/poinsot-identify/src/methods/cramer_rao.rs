//! The Cramer-Rao bound of an experiment: the information of its samples for any estimator.

use crate::answer;
use crate::diagnosis::Diagnostics;
use crate::fit::alternatives::{OtherWheelMotion, with_smooth_wheels};
use crate::fit::experiment::Experiment;
use crate::fit::fit_on;
use crate::fit::known_numbers::known_at;
use crate::fit::profile::profiled;
use crate::methods::maximum_likelihood::{conclude, proportional};
use crate::problem::refusal::no_motion;
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::Estimate;
use poinsot_solve::LeastSquares;

/// Information of the experiment at the model's own numbers, assumed true; the segments have ideal measurements, the
/// noise is the declared one.
///
/// Values of the answer are those of the model; its sigmas are the bound (Rao 1945, Cramer 1946), pose,
/// momentum and biases projected out. Known numbers are exact.
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
    bound(problem, false)
}

/// The sigmas that an identification of such measurements will state: the bound with the known numbers within their
/// uncertainty, and where the measurements can hardly tell what the wheels do between samples, the mean square of what the
/// choice adds.
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
    bound(problem, true)
}

/// What is not asked is known as the model declares and as an identification takes it, or else exactly: the known numbers, and the motion
/// of wheels between samples.
fn bound(problem: &Problem, declared: bool) -> Result<Estimate, ProblemError> {
    problem.check_observations()?;
    let parameters = problem.likelihood_parameters()?;
    let mut experiment = Experiment::new(problem, &parameters);
    let at = experiment.nominal_point();
    let mut here = experiment.linearise(&at).ok_or_else(no_motion)?;
    let smooth = declared.then(|| with_smooth_wheels(&experiment)).flatten();
    let mut other = None;
    if let Some(smooth) = smooth
        && let Some(there) = smooth.linearise(&at)
    {
        other = Some(OtherWheelMotion::expected(
            (&experiment, &at),
            &here,
            &there,
        ));
        if there.cost < here.cost {
            (experiment, here) = (smooth, there);
        }
    }
    let known = declared.then(|| known_at(&experiment, &at)).flatten();
    let at_truth = fit_on(&experiment, at, here, 0).ok_or_else(no_motion)?;
    let known = known.as_ref();
    let wide = known.map(|k| experiment.with_parameters(&k.parameters));
    let (experiment, at_truth) = match (&wide, known) {
        (Some(wide), Some(known)) => (wide, known.fitted.clone()),
        _ => (&experiment, at_truth),
    };
    let mut ideal = at_truth.clone();
    ideal.converged = true;
    // A bound has no misfit: interpolation errors of wheel motion are not noise.
    for segment in &mut ideal.evaluated {
        segment.chi2 = 0.0;
        segment.cost = 0.0;
        segment.channels.clear();
    }
    let explained = (!proportional(problem)).then_some(1.0);
    let mut solution = conclude(experiment, &ideal, explained, Diagnostics::default());
    if declared {
        solution.spectrum = profiled(experiment, &at_truth, solution.spectrum).0;
    }
    solution.method = "cramer_rao";
    if let Some(own) = &mut solution.likelihood {
        own.other_wheel_motion = other.map(|o| o.among(&parameters, &solution.parameters));
    }
    Ok(answer::write_with_remedies(problem, &solution))
}
