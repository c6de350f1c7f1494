//! The search for the minimum: one procedure for every start.
//!
//! The nominal numbers and the linear solution both start, the better one by likelihood. Where a fit from it does not
//! explain the record, the start is too far: the prediction leaves the range in which it is linear in the unknowns, and
//! chi-square has many minima (a phase of nutation that is wrong by turns). The record is then followed: its longest beginning
//! that a start explains is fitted, and extended by a factor as long as the prediction of each fit leads to the next one
//! (a homotopy in the length of the record; Voss, Timmer and Kurths 2004 extend by multiple shooting). A beginning that the
//! model cannot explain although the fit converged contradicts the model; one at which the fit does not converge ends the
//! search without an answer.
//!
//! The first steps need not be exact: a few samples lead as close in a fraction of the time.

use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::momentum_state::{Fitted, fit_from, fit_on};
use crate::fit::part_of_record::{beginning, thinned};
use crate::fit::step::{ITERATIONS, Linearisation, is_close};
use crate::problem::segment::Segment;
use poinsot_solve::{LeastSquares, Minimum, levenberg_marquardt};

/// Samples per sensor in a segment up to which none is omitted.
const START_SAMPLES: usize = 128;
/// Smallest reduction of the grid for a coarse fit.
const WORTH: usize = 4;
/// Iterations for one beginning: a near start needs five.
const ARC_ITERATIONS: usize = 12;
/// Share of the record by which the first beginning is shortened until a start explains it.
const SHORTER: f64 = 0.25;
/// Fewest grid times of a beginning: what no motion over so few explains is no matter of the start.
const LEAST_TIMES: usize = 4;
/// Factor by which a beginning is extended, and the smallest one that is tried: its root is taken where a fit fails.
const LONGER: f64 = 2.0;
const LEAST_LONGER: f64 = 1.1;
/// Share of the cost that a full step may still promise where the cost is known well enough to contradict a model.
const SETTLED: f64 = 1.0e-2;

/// Where a search ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Search {
    /// At a minimum of the whole record.
    Whole,
    /// At a minimum of a beginning of the record that the model does not explain.
    Contradicted,
    /// Nowhere: beyond this share of the record no fit converges.
    Lost(f64),
}

/// Fits from the better of some starts; `None` where the vehicle moves from none of them.
pub(crate) fn search(experiment: &Experiment, starts: &[Iterate]) -> Option<Fitted> {
    let direct = from_better(experiment, starts);
    if direct.as_ref().is_some_and(|d| d.converged && d.explains()) {
        return direct;
    }
    let path = follow(experiment, starts);
    let onward = match (path.end, path.at) {
        (Search::Lost(share), at) => {
            let found = direct.or_else(|| fit_from(experiment, at?, 0))?;
            if found.explains() {
                return Some(found);
            }
            // What no motion over a few samples explains is no matter of the start.
            if share == 0.0 && found.settled {
                return Some(Fitted {
                    search: Search::Contradicted,
                    ..found
                });
            }
            return Some(Fitted {
                search: path.end,
                converged: false,
                ..found
            });
        }
        (_, Some(at)) => fit_from(experiment, at, ITERATIONS),
        (_, None) => direct
            .as_ref()
            .and_then(|d| fit_from(experiment, d.at.clone(), ITERATIONS)),
    };
    let cost = |found: &Fitted| (!found.settled, experiment.cost_of(found));
    let both = direct.into_iter().chain(onward);
    let best = both.min_by(|a, b| {
        let (a, b) = (cost(a), cost(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })?;
    Some(Fitted {
        search: path.end,
        ..best
    })
}

/// The fit of the whole record from the better start: over a few samples where there are many and these lead close.
fn from_better(experiment: &Experiment, starts: &[Iterate]) -> Option<Fitted> {
    let close = few_samples(experiment.problem.segments)
        .and_then(|few| coarse_fit(experiment, starts, &few))
        .and_then(|at| Some((experiment.linearise(&at).filter(is_close)?, at)));
    if let Some((here, at)) = close {
        return fit_on(experiment, at, here, ITERATIONS);
    }
    let start = better(experiment, starts)?.clone();
    let found = fit_from(experiment, start, ARC_ITERATIONS)?;
    match found.converged || !found.explains() {
        true => Some(found),
        false => fit_from(experiment, found.at, ITERATIONS),
    }
}

/// End of a fit to a few samples from the better of some starts; `None` where it is not close.
fn coarse_fit(experiment: &Experiment, starts: &[Iterate], few: &[Segment]) -> Option<Iterate> {
    let problem = experiment.problem.with_segments(few);
    let few = experiment.with_problem(&problem).near();
    let start = better(&few, starts)?;
    let here = few.linearise(start)?;
    let end = levenberg_marquardt(&few, start.clone(), here, ITERATIONS);
    // Few samples also tell less of what drives the vehicle: all of them decide where these are not met.
    let close = is_close(&end.here) || experiment.is_close(&end.at);
    close.then_some(end.at)
}

/// The start of the smallest cost; one without a motion comes last.
fn better<'s>(experiment: &Experiment, starts: &'s [Iterate]) -> Option<&'s Iterate> {
    if let [only] = starts {
        return Some(only);
    }
    let cost = |at: &Iterate| experiment.cost(at).filter(|c| !c.is_nan());
    let costs = starts
        .iter()
        .map(|at| (at, cost(at).unwrap_or(f64::INFINITY)));
    Some(costs.min_by(|a, b| a.1.total_cmp(&b.1))?.0)
}

/// How far along a record the fits of its beginnings led.
struct Followed {
    /// Where the last one that explains its beginning ended.
    at: Option<Iterate>,
    end: Search,
}

/// Follows the record from its longest beginning that a start explains.
fn follow(experiment: &Experiment, starts: &[Iterate]) -> Followed {
    let mut share = SHORTER;
    let mut settled = false;
    let first = loop {
        if !is_long_enough(experiment, share) {
            let end = if settled {
                Search::Contradicted
            } else {
                Search::Lost(0.0)
            };
            return Followed { at: None, end };
        }
        let mut found = starts
            .iter()
            .filter_map(|at| fit_beginning(experiment, at, share));
        settled = false;
        let explains = found.find(|f| {
            settled |= f.settled;
            f.explains
        });
        match explains {
            Some(first) => break first.at,
            None => share *= SHORTER,
        }
    };
    extend(experiment, first, share)
}

/// Extends the beginning whose fit ended at a point to the whole record.
fn extend(experiment: &Experiment, mut at: Iterate, mut share: f64) -> Followed {
    let mut factor = LONGER;
    let end = loop {
        if share >= 1.0 {
            break Search::Whole;
        }
        let longer = (share * factor).min(1.0);
        match fit_beginning(experiment, &at, longer) {
            Some(found) if found.explains => {
                (at, share) = (found.at, longer);
                factor = LONGER.min(factor * factor);
            }
            _ if factor > LEAST_LONGER => factor = factor.sqrt(),
            Some(found) if found.settled => break Search::Contradicted,
            _ => break Search::Lost(share),
        }
    };
    Followed { at: Some(at), end }
}

fn is_long_enough(experiment: &Experiment, share: f64) -> bool {
    let mut segments = experiment.problem.segments.iter();
    segments.any(|s| s.observations.time_s.len() as f64 * share >= LEAST_TIMES as f64)
}

/// Where the fit of a beginning of the record ended.
struct Beginning {
    at: Iterate,
    /// Whether its chi-square is of the size of its expectation.
    explains: bool,
    /// Whether no step lowers it much.
    settled: bool,
}

/// Fits a share of the record: a few of its samples, or all of them where the few do not tell enough of what drives the
/// vehicle.
fn fit_beginning(experiment: &Experiment, start: &Iterate, share: f64) -> Option<Beginning> {
    let segments = experiment.problem.segments.iter();
    let whole: Vec<Segment> = segments.map(|s| beginning(s, share)).collect();
    let fit = |segments: &[Segment]| {
        let problem = experiment.problem.with_segments(segments);
        let part = experiment.with_problem(&problem).near();
        let here = part.linearise(start)?;
        let end = levenberg_marquardt(&part, start.clone(), here, ARC_ITERATIONS);
        Some(Beginning {
            explains: is_close(&end.here),
            settled: is_settled(&end),
            at: end.at,
        })
    };
    let few = few_samples(&whole).and_then(|few| fit(&few));
    few.filter(|f| f.explains).or_else(|| fit(&whole))
}

/// Whether no step lowers the cost by more than a negligible share.
pub(crate) fn is_settled(end: &Minimum<Iterate, Linearisation>) -> bool {
    end.here.predicted_reduction < SETTLED * end.here.cost.max(1.0)
}

/// A few samples of a record; `None` where that saves little.
fn few_samples(whole: &[Segment]) -> Option<Vec<Segment>> {
    let few = whole.iter().map(|s| thinned(s, START_SAMPLES));
    let few: Vec<Segment> = few.collect::<Option<_>>()?;
    let times =
        |all: &[Segment]| -> usize { all.iter().map(|s| s.observations.time_s.len()).sum() };
    (WORTH * times(&few) <= times(whole)).then_some(few)
}
