//! How far a quantity moves while its rounded reading stays: decided by the data.
//!
//! A joint on its brake does not move at all, one that is held by its motor by a small share of a step, a drifting one by a
//! whole step. All three read alike. The whole step is assumed first, since nothing moves further unseen; the likelihood may prefer less.

use crate::fit::experiment::Experiment;
use crate::fit::momentum_state::{Fitted, fit_from};
use crate::problem::segment::InputErrors;

/// Shares of a step that are compared.
const MOTIONS: [f64; 3] = [1.0, 0.1, 0.0];

/// Takes the share with the largest likelihood where a fit ended; whether it is another one than the fit had.
pub(crate) fn choose_rest_motion(experiment: &mut Experiment, fitted: &Fitted) -> bool {
    if !may_rest(experiment) {
        return false;
    }
    let before = experiment.rest_motion;
    let mut best = (experiment.cost_of(fitted), before);
    for share in MOTIONS.into_iter().filter(|share| *share != before) {
        experiment.rest_motion = share;
        let evaluated = experiment.evaluate(&fitted.at, false);
        let cost = evaluated.and_then(|e| experiment.chi2(&fitted.at, &e));
        if let Some(cost) = cost.filter(|cost| *cost < best.0) {
            best = (cost, share);
        }
    }
    experiment.rest_motion = best.1;
    best.1 != before
}

/// The fit with the share that the data prefer, from the end of another.
pub(crate) fn refit_with_rest_motion(
    experiment: &mut Experiment,
    fitted: Fitted,
    limit: usize,
) -> Fitted {
    if !choose_rest_motion(experiment, &fitted) {
        return fitted;
    }
    let found = fit_from(experiment, fitted.at.clone(), limit);
    found.unwrap_or_else(|| {
        experiment.rest_motion = 1.0;
        fitted
    })
}

/// Whether a joint may be at rest in some run of equal readings.
fn may_rest(experiment: &Experiment) -> bool {
    let segments = experiment.problem.segments.iter();
    let mut errors = segments.flat_map(|s| &s.observations.joint_errors);
    errors.any(InputErrors::may_rest)
}

/// What is assumed of joints whose rounded readings stay.
pub(crate) fn rest_assumed(experiment: &Experiment) -> Option<String> {
    let share = experiment.rest_motion;
    let how = match share {
        0.0 => "not at all".to_owned(),
        1.0 => "by up to a step".to_owned(),
        _ => format!("by {share} of a step"),
    };
    may_rest(experiment)
        .then(|| format!("joints whose rounded samples stay equal move {how} meanwhile"))
}
