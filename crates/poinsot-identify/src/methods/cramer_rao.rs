//! The Cramer-Rao bound of an experiment: what its readings will tell, whatever estimator reads them.

use crate::answer;
use crate::diagnosis::Diagnostics;
use crate::fit::experiment::Experiment;
use crate::fit::fit;
use crate::methods::maximum_likelihood::{conclude, proportional};
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::Estimate;

/// Information of the experiment at the model's own numbers, which are taken as the truth; the segments
/// hold what perfect sensors read, the noise is the declared one.
///
/// Values of the answer are those of the model; its sigmas are the bound (Rao 1945, Cramer 1946), pose,
/// momentum and biases projected out.
///
/// # Errors
/// The question cannot be asked.
pub fn cramer_rao(problem: &Problem) -> Result<Estimate, ProblemError> {
    problem.check_samples()?;
    problem.check_observations()?;
    let parameters = problem.likelihood_parameters()?;
    let experiment = Experiment::new(problem, &parameters);
    let mut at_truth = fit(&experiment, None, 0)?;
    at_truth.converged = true;
    // A bound has no misfit: what the assumed motion of wheels between samples leaves of perfect readings is not noise.
    for segment in &mut at_truth.evaluated {
        segment.chi2 = 0.0;
        segment.cost = 0.0;
        segment.channels.clear();
    }
    let explained = (!proportional(problem)).then_some(1.0);
    let mut solution = conclude(&experiment, at_truth, explained, Diagnostics::default());
    solution.method = "cramer_rao";
    Ok(answer::write_with_remedies(problem, &solution))
}
