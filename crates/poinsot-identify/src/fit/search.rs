//! The search for the minimum: one procedure for every start.
//!
//! The nominal numbers and the linear solution both start, the better one by likelihood. Where a full step from it fails, the
//! start is too far: the prediction leaves the range in which it is linear in the unknowns, and chi-square has many minima (a
//! phase of nutation that is wrong by turns). The record is then followed: the longest beginning is fitted over which full steps
//! lead from a start to numbers that explain it, and extended by a factor as long as the prediction of each fit leads to the next one
//! (a homotopy in the length of the record; Voss, Timmer and Kurths 2004 extend by multiple shooting). Readings of a beginning
//! count as little at first as their misfit asks, and more from fit to fit, and what a beginning does not tell is held about the
//! nominal numbers: first steps from far away carry it off, as the scale of a tensor before the first pulse. Where this leads no
//! further, the next beginning is fitted without help and to its end: one that the model does not explain although no step
//! lowers its misfit much contradicts the model; one whose fit gets nowhere ends the search without an answer.
//!
//! Where the motion is unstable, the noise of measured inputs carries the prediction off with time, however good the numbers
//! are. A record along which no fit converges, with the torque of its wheels as a process neither, is followed once more about inputs that all sensors smooth, beginning by beginning.
//!
//! The first steps need not be exact: a few samples lead as close in a fraction of the time.

use crate::fit::coordinates::PhysicalBodies;
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::momentum_state::{Fitted, Search, fit_from, fit_on, is_settled};
use crate::fit::part_of_record::{FEW, beginning, thinned};
use crate::fit::smoothed_inputs::{SmoothedInputs, smoothed};
use crate::fit::step::{ITERATIONS, Linearisation, moved, physical_bodies};
use crate::problem::ProblemError;
use crate::problem::refusal::no_motion;
use crate::problem::segment::Segment;
use crate::problem::settings::Coordinates;
use poinsot_solve::{LeastSquares, Linearised, Minimum, levenberg_marquardt};

/// Smallest reduction of the grid for a coarse fit.
const WORTH: usize = 4;
/// Iterations for one beginning: a near start needs five.
const ARC_ITERATIONS: usize = 12;
/// Factor by which the readings of a beginning count more from fit to fit: the fits of a fast spin take two iterations each.
const HARDER: f64 = 100.0;
/// Share of the record by which the first beginning is shortened until a start explains it.
const SHORTER: f64 = 0.25;
/// Fewest grid times of a shorter beginning: what no motion over so few explains is no matter of the start.
const LEAST_TIMES: usize = 4;
/// Factor by which a beginning is extended, and the smallest one that is tried: its root is taken where a fit fails.
const LONGER: f64 = 2.0;
const LEAST_LONGER: f64 = 1.1;

/// Fits from the better of the linear solution and the nominal numbers.
///
/// The bodies are free at first: near the physical limit and far from the answer the equations are more nonlinear than
/// beyond it. An unphysical result is then moved back at the least cost and fitted within the limit.
pub(crate) fn fit(
    experiment: &Experiment,
    linear: Option<&Iterate>,
) -> Result<Fitted, ProblemError> {
    let starts = starts(experiment, linear);
    if let Some(bodies) = physical_bodies(experiment) {
        let mut free = experiment.with_parameters(experiment.parameters);
        free.settings.coordinates = Coordinates::Linear;
        let found = search(&free, &starts).ok_or_else(no_motion)?;
        if found.converged {
            let Some(bodies) = bodies.separable(&found.spectrum) else {
                return Ok(found);
            };
            if bodies.contain(&found.at.x) {
                return Ok(found);
            }
            let back = brought_back(experiment, &found, &bodies);
            if let Some(found) = back.filter(|f| f.converged) {
                return Ok(found);
            }
        } else if !found.explains {
            // The limit is not the reason for the missing convergence.
            return Ok(found);
        }
    }
    search(experiment, &starts).ok_or_else(no_motion)
}

/// The fit of the whole record, followed from its beginning; `None` where that does not lead to its end.
pub(crate) fn fit_along(experiment: &Experiment, linear: Option<&Iterate>) -> Option<Fitted> {
    let path = follow(experiment, &starts(experiment, linear), false);
    let at = path.at.filter(|_| path.end == Search::Whole)?;
    fit_from(experiment, at, ITERATIONS)
}

/// The fit about smoothed inputs, followed along the record; `None` where it does not converge either, or no input has noise.
pub(crate) fn fit_about_smoothed(
    experiment: &Experiment,
    linear: Option<&Iterate>,
) -> Option<SmoothedInputs> {
    if !experiment.has_noisy_inputs() {
        return None;
    }
    let path = follow(experiment, &starts(experiment, linear), true);
    let at = path.at.filter(|_| path.end == Search::Whole)?;
    let found = SmoothedInputs::about(experiment, at, path.segments)?;
    (found.fitted.converged && found.fitted.explains).then_some(found)
}

/// The linear solution and the nominal numbers, where the bodies are physical.
fn starts(experiment: &Experiment, linear: Option<&Iterate>) -> Vec<Iterate> {
    let mut starts: Vec<Iterate> = linear.cloned().into_iter().collect();
    if let Some(bodies) = physical_bodies(experiment) {
        starts.iter_mut().for_each(|at| bodies.start(&mut at.x));
    }
    starts.push(experiment.nominal_point());
    starts
}

/// Fits on from the step that leads back to physical bodies at the least cost.
fn brought_back(
    experiment: &Experiment,
    beyond: &Fitted,
    bodies: &PhysicalBodies,
) -> Option<Fitted> {
    let rhs = beyond.shared.rhs();
    let (step, _) = bodies.step(&beyond.spectrum, &rhs, 0.0, &beyond.at.x);
    let at = moved(experiment, &beyond.at, beyond.parts(), &step);
    fit_from(experiment, at, ITERATIONS)
}

/// Fits from the better of some starts; `None` where the vehicle moves from none of them.
///
/// Noise far beyond what is declared makes every start seem too far. Where the residual of a search that did not converge is of the
/// size of the noise that it shows, the search is made with that noise.
pub(super) fn search(experiment: &Experiment, starts: &[Iterate]) -> Option<Fitted> {
    let found = search_once(experiment, starts)?;
    let mut noisy = experiment.with_parameters(experiment.parameters);
    noisy.scatter = found.scatter();
    let failed = !(found.converged || found.explains);
    let is_noise = failed && noisy.expects(found.chi2(), &found.evaluated);
    let again = is_noise.then(|| search_once(&noisy, starts)).flatten();
    again.filter(|f| f.converged && f.explains).or(Some(found))
}

fn search_once(experiment: &Experiment, starts: &[Iterate]) -> Option<Fitted> {
    let direct = from_better(&experiment.within_linear_range(), starts);
    let direct = direct.filter(|d| d.converged || d.explains);
    if direct.as_ref().is_some_and(|d| d.converged && d.explains) {
        return direct;
    }
    let path = follow(experiment, starts, false);
    let is_lost = matches!(path.end, Search::Lost(_));
    let onward = match path.at {
        Some(at) if !is_lost => fit_from(experiment, at, ITERATIONS),
        _ => from_better(experiment, starts),
    };
    let found = best(experiment, direct.into_iter().chain(onward))?;
    if is_lost && found.explains {
        return Some(found);
    }
    // What no motion over a few samples explains is no matter of the start.
    let told = path.end == Search::Lost(0.0) && found.settled;
    Some(Fitted {
        search: if told { Search::Contradicted } else { path.end },
        converged: found.converged && (told || !is_lost),
        ..found
    })
}

/// The fit of the smallest cost, one that can contradict the model first.
fn best(experiment: &Experiment, fits: impl Iterator<Item = Fitted>) -> Option<Fitted> {
    let cost = |found: &Fitted| (!found.settled, experiment.cost_of(found));
    fits.min_by(|a, b| {
        let (a, b) = (cost(a), cost(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}

/// The fit of the whole record from the better start: over a few samples where there are many and these lead close. A
/// start can change the directions that are identified as the fit goes on; where it does not converge, the other is tried.
fn from_better(experiment: &Experiment, starts: &[Iterate]) -> Option<Fitted> {
    let is_close = |here: &Linearised<_>| experiment.is_close(here);
    let close = few_samples(experiment.problem.segments)
        .and_then(|few| coarse_fit(experiment, starts, &few))
        .and_then(|at| Some((experiment.linearise(&at).filter(is_close)?, at)));
    let mut best = close.and_then(|(here, at)| fit_on(experiment, at, here, ITERATIONS));
    if best.as_ref().is_some_and(|b| b.converged) {
        return best;
    }
    let mut own = experiment.clone();
    for at in by_cost(experiment, starts) {
        // If one start explains the record, the others are not far from it either.
        own.full_steps &= !best.as_ref().is_some_and(|b| b.explains);
        let Some(found) = fit_whole(&own, at) else {
            continue;
        };
        if found.converged {
            return Some(found);
        }
        let stays = |b: &Fitted| b.explains || !found.explains;
        best = best.filter(stays).or(Some(found));
    }
    best
}

/// The fit of the whole record from a start; in few iterations where they do not come to explain it.
fn fit_whole(experiment: &Experiment, at: &Iterate) -> Option<Fitted> {
    let found = fit_from(experiment, at.clone(), ARC_ITERATIONS)?;
    match found.converged || !found.explains {
        true => Some(found),
        false => fit_from(experiment, found.at, ITERATIONS),
    }
}

/// End of a fit to a few samples from the better of some starts; `None` where it is not close.
fn coarse_fit(experiment: &Experiment, starts: &[Iterate], few: &[Segment]) -> Option<Iterate> {
    let problem = experiment.problem.with_segments(few);
    let mut few = experiment.with_problem(&problem);
    few.only_near = true;
    let start = *by_cost(&few, starts).first()?;
    let here = few.linearise(start)?;
    let end = levenberg_marquardt(&few, start.clone(), here, ITERATIONS);
    // Few samples also tell less of what drives the vehicle: all of them decide where these are not met.
    let close = few.is_close(&end.here) || experiment.meets(&end.at);
    close.then_some(end.at)
}

/// The start of the smallest cost first; one without a motion comes last.
fn by_cost<'s>(experiment: &Experiment, starts: &'s [Iterate]) -> Vec<&'s Iterate> {
    if let [only] = starts {
        return vec![only];
    }
    let cost = |at| experiment.cost(at).filter(|c| !c.is_nan());
    let costs = starts
        .iter()
        .map(|at| (cost(at).unwrap_or(f64::INFINITY), at));
    let mut costs: Vec<(f64, &Iterate)> = costs.collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    costs.into_iter().map(|(_, at)| at).collect()
}

/// How far along a record the fits of its beginnings led.
struct Followed {
    /// Where the last one that explains its beginning ended.
    at: Option<Iterate>,
    end: Search,
    /// The records, about smoothed inputs where the experiment smooths them.
    segments: Vec<Segment>,
}

/// Follows the record from its longest beginning that a start explains; about inputs that each beginning smooths, if so.
fn follow(experiment: &Experiment, starts: &[Iterate], smooths: bool) -> Followed {
    let mut share = SHORTER;
    let mut ends = starts.to_vec();
    let near = experiment.within_linear_range();
    loop {
        for at in starts {
            match fit_beginning(&near, at, share) {
                Some(found) if found.explains => {
                    return extend(experiment, (found.at, share), smooths);
                }
                found => ends.extend(found.map(|f| f.at)),
            }
        }
        if !is_long_enough(experiment, share * SHORTER) {
            break;
        }
        share *= SHORTER;
    }
    let end = match fit_to_end(experiment, &ends, share) {
        Some(found) if found.explains => {
            return extend(experiment, (found.at, share), smooths);
        }
        Some(found) if found.settled => Search::Contradicted,
        _ => Search::Lost(0.0),
    };
    let (at, segments) = (None, Vec::new());
    Followed { at, end, segments }
}

/// Extends the beginning whose fit ended at a point to the whole record.
fn extend(experiment: &Experiment, (mut at, mut share): (Iterate, f64), smooths: bool) -> Followed {
    let mut factor = LONGER;
    let mut ends = vec![at.clone()];
    let mut segments = experiment.problem.segments.to_vec();
    let end = loop {
        if smooths {
            let Some(about) = smoothed(experiment, &segments, &at, share) else {
                break Search::Lost(share);
            };
            segments = about;
        }
        if share >= 1.0 {
            break Search::Whole;
        }
        let problem = experiment.problem.with_segments(&segments);
        let own = experiment.with_problem(&problem);
        let longer = (share * factor).min(1.0);
        let mut found = fit_beginning(&own, &at, longer);
        if let Some(beyond) = found.as_ref().filter(|f| !f.explains) {
            ends.push(beyond.at.clone());
        }
        let is_last = factor <= LEAST_LONGER;
        if is_last && !found.as_ref().is_some_and(|f| f.explains) {
            found = fit_to_end(&own, &ends, longer);
        }
        match found {
            Some(found) if found.explains => {
                (at, share) = (found.at, longer);
                ends.push(at.clone());
                factor = LONGER.min(factor * factor);
            }
            _ if !is_last => factor = factor.sqrt(),
            Some(found) if found.settled => break Search::Contradicted,
            _ => break Search::Lost(share),
        }
    };
    let at = Some(at);
    Followed { at, end, segments }
}

fn is_long_enough(experiment: &Experiment, share: f64) -> bool {
    let mut segments = experiment.problem.segments.iter();
    segments.any(|s| s.observations.time_s.len() as f64 * share >= LEAST_TIMES as f64)
}

/// Where the fit of a beginning of the record ended.
struct Beginning {
    at: Iterate,
    /// Whether its chi-square is of the size of its expectation, and its numbers are as declared.
    explains: bool,
    /// Whether no step lowers it much.
    settled: bool,
}

/// Fits a share of the record with help: what it does not tell is held, and its readings count more and more.
fn fit_beginning(experiment: &Experiment, start: &Iterate, share: f64) -> Option<Beginning> {
    fit_share(experiment, share, |part| tempered(part, start, share))
}

/// Fits a share of the record without help, from the best of the starts and of the points at which fits of beginnings ended.
fn fit_to_end(experiment: &Experiment, ends: &[Iterate], share: f64) -> Option<Beginning> {
    fit_share(experiment, share, |part| {
        let start = *by_cost(part, ends).first()?;
        let here = part.linearise(start)?;
        let end = levenberg_marquardt(part, start.clone(), here, ITERATIONS);
        Some(end)
    })
}

/// Fits a few samples of a share of the record, or all of them where the few do not tell enough of what drives the vehicle.
fn fit_share(
    experiment: &Experiment,
    share: f64,
    fitted: impl Fn(&mut Experiment) -> Option<Minimum<Iterate, Linearisation>>,
) -> Option<Beginning> {
    let segments = experiment.problem.segments.iter();
    let whole: Vec<Segment> = segments.map(|s| beginning(s, share)).collect();
    let is_smoothed = whole.iter().any(|s| s.observations.is_smoothed());
    let fit = |segments: &[Segment]| {
        let problem = experiment.problem.with_segments(segments);
        let mut part = experiment.with_problem(&problem);
        part.only_near = true;
        let end = fitted(&mut part)?;
        let as_declared = part.declared_chance(&end.at) > part.settings.false_alarm;
        Some(Beginning {
            explains: part.is_close(&end.here) && as_declared,
            settled: is_settled(&end),
            at: end.at,
        })
    };
    let few = few_samples(&whole).filter(|_| !is_smoothed);
    let few = few.and_then(|few| fit(&few));
    few.filter(|f| f.explains).or_else(|| fit(&whole))
}

/// The end of a row of fits in which readings count as little at first as their misfit asks. Readings far more exact than the
/// first prediction make a curved valley, along which no step leads far.
fn tempered(
    part: &mut Experiment,
    start: &Iterate,
    share: f64,
) -> Option<Minimum<Iterate, Linearisation>> {
    part.tempers = true;
    let here = part.linearise(start)?;
    let rows: usize = here.rows.evaluated.iter().map(|e| e.rows).sum();
    part.weight = (rows as f64 / here.cost).min(1.0);
    // Those of a short beginning cost less.
    let more = ARC_ITERATIONS as f64 * SHORTER / share;
    let limit = (more as usize).clamp(ARC_ITERATIONS, ITERATIONS);
    let mut at = start.clone();
    loop {
        let here = part.linearise(&at)?;
        let end = levenberg_marquardt(part, at, here, limit);
        if part.weight >= 1.0 {
            return Some(end);
        }
        part.weight = (part.weight * HARDER).min(1.0);
        at = end.at;
    }
}

/// A few samples of a record; `None` where that saves little.
fn few_samples(whole: &[Segment]) -> Option<Vec<Segment>> {
    let few = whole.iter().map(|s| thinned(s, FEW));
    let few: Vec<Segment> = few.collect::<Option<_>>()?;
    let times =
        |all: &[Segment]| -> usize { all.iter().map(|s| s.observations.time_s.len()).sum() };
    (WORTH * times(&few) <= times(whole)).then_some(few)
}
