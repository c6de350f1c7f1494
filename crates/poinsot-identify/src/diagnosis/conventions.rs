//! Conventions of channels: signs, units, ratios, zeros, exchanged columns, axes, dead thrusters, pulses of another length.
//!
//! Each is a change of the record that puts it right. First-order scores are meaningless so far from the answer, so each is tested
//! by a separate fit from the nominal numbers, on the shortest beginning of the record that contradicts the model, where the
//! predicted motion is still close. The whole record confirms it, as it would be read with the correction.

mod change;
mod table;

use super::channels::{QUIET, channels};
use super::types::{FaultKind, Suspect, SuspectValue};
use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::part_of_record::{FEW, beginning, thinned};
use crate::fit::sampled_motion::least;
use crate::fit::{Fitted, fit_from};
use crate::problem::Problem;
use crate::problem::segment::Segment;
use change::put_right;
use poinsot_solve::LeastSquares;
use poinsot_telemetry::Change;
use table::{Convention, Place};

pub(super) use table::{late, mistake};

/// Shares of the record that are tried as its beginning: each twice the one before, so that all fits together take no longer
/// than one of the whole record.
const BEGINNINGS: [f64; 4] = [0.0625, 0.125, 0.25, 0.5];
/// Iterations of such a fit: enough for a decision.
const MISTAKE_ITERATIONS: usize = 8;
/// Share of the misfit that a mistake must explain.
pub(super) const EXPLAINS: f64 = 0.99;
/// Largest excess of chi-square per number of a corrected fit.
const RIGHT: f64 = 10.0;
/// How many of a kind are fitted, those that lead nearest.
const FITTED: usize = 6;
/// Factor of the cost with the nominal numbers beyond which nothing is fitted, and of the misfit after a few iterations to which a
/// convention lowers it.
const WILD: f64 = 100.0;
const BETTER: f64 = 0.5;
/// Accuracy of a free value, as a share of the width of its search.
const ACCURACY: f64 = 0.01;

/// The convention that explains nearly all of a very bad fit.
pub(super) fn conventions(
    experiment: &Experiment,
    fitted: &Fitted,
    (excess, dof): (f64, f64),
) -> Option<Suspect> {
    // Other axes are no gross mistake where they turn slowly.
    let mut kinds = match excess < experiment.settings.diagnosis.gross_misfit * dof {
        true => table::frames(experiment.problem),
        false => table::all(experiment),
    };
    kinds.retain(|kind| !kind.is_empty());
    if kinds.is_empty() {
        return None;
    }
    let before = experiment.chi2(&fitted.at, &fitted.evaluated)?;
    let whole = experiment.problem;
    let (share, before_it) = contradicting(experiment);
    let record = begun(whole, share);
    let problem = whole.with_segments(&record);
    let short = Short {
        experiment: experiment.with_problem(&problem),
        share,
        before_it,
    };
    let mut best: Option<Suspect> = None;
    // Kinds outside, places inside: large factors cause fast motions, which are slow to compute.
    for kind in &kinds {
        for convention in short.promising(kind) {
            let least = best.as_ref().map_or(EXPLAINS * excess, |b| b.decrease);
            let convention = short.settled(convention);
            let Some((convention, after)) = of_record(experiment, &short, convention) else {
                continue;
            };
            let decrease = before - after - scaled(experiment, &convention);
            if decrease <= least {
                continue;
            }
            best = Some(named(whole, &convention, (decrease, excess)));
            // Correct, not only better: the others need no test.
            if excess - decrease < RIGHT * dof {
                return best;
            }
        }
    }
    best
}

/// The shortest beginning of the record that contradicts the model.
struct Short<'a> {
    experiment: Experiment<'a>,
    share: f64,
    /// Where the fit of the beginning before it ended, which does not contradict the model.
    before_it: Option<Iterate>,
}

/// Its share of the record, and where the fit of the one before it ended.
fn contradicting(experiment: &Experiment) -> (f64, Option<Iterate>) {
    let mut before_it = None;
    for share in BEGINNINGS {
        let segments = experiment.problem.segments.iter();
        let segments: Vec<Segment> = segments.map(|s| beginning(s, share)).collect();
        let problem = experiment.problem.with_segments(&segments);
        let short = experiment.with_problem(&problem);
        match fitting(&short, short.nominal_point(), MISTAKE_ITERATIONS) {
            None => return (share, before_it),
            found => before_it = found,
        }
    }
    (1.0, before_it)
}

/// A beginning of the record with samples enough for a decision.
fn begun(whole: &Problem, share: f64) -> Vec<Segment> {
    let of = |segment: &Segment| {
        let begun = beginning(segment, share);
        match thinned(&begun, FEW) {
            Some(few) => Segment {
                // Start of a fit.
                samples: begun.samples,
                ..few
            },
            None => begun,
        }
    };
    whole.segments.iter().map(of).collect()
}

impl Short<'_> {
    /// Where fits start: the nominal numbers, and what the beginning before tells.
    fn starts(&self, experiment: &Experiment) -> impl Iterator<Item = Iterate> {
        let nominal = experiment.nominal_point();
        std::iter::once(nominal).chain(self.before_it.clone())
    }

    /// The cost at the nearer start.
    fn cost(&self, experiment: &Experiment) -> Option<f64> {
        let costs = self.starts(experiment).map(|at| experiment.cost(&at));
        costs.flatten().min_by(f64::total_cmp)
    }

    /// The better end of a few iterations from either start: a beginning that a mistake fits tells of another vehicle.
    fn fitted(&self, experiment: &Experiment) -> Option<Fitted> {
        let fits = self.starts(experiment);
        let fits = fits.filter_map(|at| fit_from(experiment, at, MISTAKE_ITERATIONS / 2));
        fits.min_by(|a, b| experiment.cost_of(a).total_cmp(&experiment.cost_of(b)))
    }

    /// Those with which a few iterations lead nearer than without, the best first.
    fn promising(&self, kind: &[Convention]) -> Vec<Convention> {
        let own = &self.experiment;
        let cost = self.cost(own).unwrap_or(f64::INFINITY);
        let found = self.fitted(own);
        let (fitted, rows) =
            found.map_or((f64::INFINITY, 0.0), |f| (own.cost_of(&f), f.rows() as f64));
        let leads = |c: &Convention| {
            let there = put_right(own, c, |other| self.cost(other))?;
            // What changes nothing here explains nothing; what is far worse moves too fast to be fitted.
            let tame = there != cost && there < WILD * cost;
            let cost = tame.then(|| self.fitted_cost(c)).flatten();
            let cost = cost.filter(|cost| *cost - rows < BETTER * (fitted - rows))?;
            Some((cost + scaled(own, c), c.clone()))
        };
        let mut list: Vec<(f64, Convention)> = kind.iter().filter_map(leads).collect();
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Of one place with a free value the best is enough: the others lead to it.
        let mut kept: Vec<Convention> = Vec::new();
        for (_, convention) in list {
            let known = |k: &Convention| convention.free.is_some() && k.place == convention.place;
            if kept.len() < FITTED && !kept.iter().any(known) {
                kept.push(convention);
            }
        }
        kept
    }

    /// What the fit of a record with the correction leaves after a few iterations.
    fn fitted_cost(&self, convention: &Convention) -> Option<f64> {
        put_right(&self.experiment, convention, |other| {
            Some(other.cost_of(&self.fitted(other)?))
        })
    }

    /// A convention with its value where it has a free one.
    fn settled(&self, convention: Convention) -> Convention {
        let Some(width) = convention.free else {
            return convention;
        };
        let ends = [convention.value() - width, convention.value() + width];
        let at = |value: f64| convention.clone().with_value(value);
        let cost = |c: &Convention| self.fitted_cost(c).unwrap_or(f64::INFINITY);
        let own = at(least(|value| cost(&at(value)), ends, ACCURACY * width));
        // The number that an engineer would write, where it fits about as well.
        match own.rounded() {
            Some(known) if cost(&known) < RIGHT * cost(&own) => known,
            _ => own,
        }
    }
}

/// What a factor of measurements adds to `-2 ln L` of those that were read.
fn scaled(experiment: &Experiment, convention: &Convention) -> f64 {
    let (Place::Sensor(k), Change::Factor(x)) = (&convention.place, convention.change) else {
        return 0.0;
    };
    let segments = experiment.problem.segments.iter();
    let sensors = segments.filter_map(|s| s.observations.sensors.get(*k));
    let numbers: usize = sensors.map(|s| s.kind.numbers() * s.samples.len()).sum();
    -2.0 * numbers as f64 * x.abs().ln()
}

/// Whether the sensor of a convention is far less noisy than declared: smaller measurements fit anything within their noise.
fn silences(experiment: &Experiment, fitted: &Fitted, convention: &Convention) -> bool {
    let (Place::Sensor(k), Change::Factor(_)) = (&convention.place, convention.change) else {
        return false;
    };
    let first = experiment.problem.segments.first();
    let sensor = first.and_then(|s| s.observations.sensors.get(*k));
    let channels = channels(fitted);
    let mut own = channels
        .iter()
        .filter(|c| sensor.is_some_and(|s| s.name == c.name));
    own.any(|c| c.chi2_per_number < QUIET)
}

/// A convention with its value by the whole record, and the chi-square that it leaves: fitted by longer and longer beginnings, as what
/// one of them tells of the vehicle may be far off later. `None` where a beginning does not fit.
fn of_record(
    experiment: &Experiment,
    short: &Short,
    convention: Convention,
) -> Option<(Convention, f64)> {
    let mut at = put_right(&short.experiment, &convention, |other| {
        explaining(other, short.fitted(other)?)
    })?;
    for longer in BEGINNINGS
        .into_iter()
        .filter(|longer| *longer > short.share)
    {
        let segments = begun(experiment.problem, longer);
        let problem = experiment.problem.with_segments(&segments);
        let other = experiment.with_problem(&problem);
        at = put_right(&other, &convention, |other| {
            fitting(other, at, MISTAKE_ITERATIONS)
        })?;
    }
    let left = |convention: &Convention| {
        put_right(experiment, convention, |other| {
            let found = fit_from(other, at.clone(), MISTAKE_ITERATIONS)?;
            let chi2 = other.chi2(&found.at, &found.evaluated);
            chi2.filter(|_| !silences(other, &found, convention))
        })
    };
    let own = left(&convention)?;
    Some(refined(convention, own, left))
}

/// The convention with the lowest chi-square of a parabola over its value, where it has a free one that is no round number.
fn refined(
    convention: Convention,
    own: f64,
    left: impl Fn(&Convention) -> Option<f64>,
) -> (Convention, f64) {
    let step = convention.free.map_or(0.0, |width| ACCURACY * width);
    let at = |value: f64| convention.clone().with_value(value);
    let value = convention.value();
    if step > 0.0
        && convention
            .rounded()
            .is_none_or(|known| known.value() != value)
        && let (Some(before), Some(after)) = (left(&at(value - step)), left(&at(value + step)))
    {
        let bend = before - 2.0 * own + after;
        let better = at(value + 0.5 * step * (before - after) / bend);
        if let Some(least) = left(&better).filter(|least| bend > 0.0 && *least < own) {
            return (better, least);
        }
    }
    (convention, own)
}

/// Where a fit ends that explains the record roughly.
fn fitting(experiment: &Experiment, from: Iterate, iterations: usize) -> Option<Iterate> {
    explaining(experiment, fit_from(experiment, from, iterations)?)
}

/// Where it ended, if it explains the record roughly.
fn explaining(experiment: &Experiment, found: Fitted) -> Option<Iterate> {
    let gross = experiment.settings.diagnosis.gross_misfit;
    let fits = experiment.cost_of(&found) < gross * found.rows() as f64;
    fits.then_some(found.at)
}

fn named(problem: &Problem, convention: &Convention, (decrease, excess): (f64, f64)) -> Suspect {
    let values = convention.values();
    let values = values.map(|(name, value, unit)| SuspectValue::other(name, value, unit));
    let (fault, words) = convention.named(problem);
    Suspect {
        explains: (decrease / excess).clamp(0.0, 1.0),
        repair: convention.repair(problem),
        ..Suspect::new(words, fault, decrease, values.into_iter().collect())
    }
}
