//! Hypotheses whose columns are differences: a known number, a firing that did not happen, play in a joint. The problem
//! is changed and every prediction recomputed.

use super::candidate::{Candidate, Change, Columns, unknown};
use super::types::FaultKind;
use crate::fit::experiment::{
    Experiment, Iterate, PredictedExperiment, PredictionSlopes, Shift, slope,
};
use crate::fit::known_numbers::SILENT;
use crate::problem::Problem;
use crate::problem::parameters::UnknownKind;
use crate::problem::segment::{InputErrors, Segment};
use poinsot_model::{JointKind, KnownNumber, Origin};
use rayon::prelude::*;

/// Step of a difference, in the usual uncertainty of a number: the bend over it and its round-off stay far below the noise.
const CHANGE_STEP: f64 = 1.0e-3;
/// Step of the play of a joint, rad or m.
const PLAY: f64 = 1.0e-6;
/// Step of the share of a firing's force.
const SHARE: f64 = 1.0e-4;
/// Largest number of firings tested one by one.
const FIRINGS: usize = 48;

/// Known numbers, firings and joints that the fit assumed exact.
pub(super) fn changes(experiment: &Experiment) -> Vec<Candidate> {
    let mut list = of_known_numbers(experiment);
    list.extend(of_firings(experiment));
    list.extend(of_play(experiment));
    list
}

/// Numbers whose errors have no slopes of their own.
fn of_known_numbers(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let fitted = &experiment.parameters.unknowns;
    let is_unknown = |number: &KnownNumber| {
        let mut known = fitted.iter().filter_map(|u| u.kind.known());
        known.any(|k| k.number == *number)
    };
    let has_slopes = |number: &KnownNumber| {
        matches!(
            number,
            KnownNumber::SpinInertia(_)
                | KnownNumber::WheelAxis(_)
                | KnownNumber::Force(_)
                | KnownNumber::Mounting(_)
        )
    };
    let numbers = model.known_numbers().into_iter();
    numbers
        .filter(|n| n.is_known(model) && !is_unknown(n) && !has_slopes(n))
        .map(|number| {
            let components = 0..number.components();
            let name = number.name(model, 0);
            let what = match number {
                KnownNumber::Mass(_) => name.clone(),
                _ => name
                    .rsplit_once('_')
                    .map_or(name.clone(), |n| n.0.to_owned()),
            };
            Candidate {
                name: format!("another {what} than known"),
                fault: FaultKind::KnownNumber,
                unknowns: components
                    .clone()
                    .map(|c| {
                        let mut own =
                            unknown(UnknownKind::Changed, number.name(model, c), number.unit());
                        own.nominal = number.value(model, c);
                        own
                    })
                    .collect(),
                columns: Columns::Changes(components.map(|c| Change::Known(number, c)).collect()),
            }
        })
        .collect()
}

fn of_firings(experiment: &Experiment) -> Vec<Candidate> {
    let thrusters = &experiment.problem.model.thrusters;
    let segments = experiment.problem.segments.iter().enumerate();
    let all = segments.flat_map(|(s, segment)| {
        let firings = segment.firings.iter().enumerate();
        firings.map(move |(k, firing)| (s, k, firing))
    });
    all.take(FIRINGS)
        .filter_map(|(s, k, firing)| {
            let name = &thrusters.get(firing.thruster)?.name;
            let number = format!("{name}.firing_at_{:.1}_s", firing.start_s);
            let mut own = unknown(UnknownKind::Changed, number, "1");
            own.nominal = 1.0;
            Some(Candidate {
                name: format!(
                    "another force of the firing of {name} at {:.1} s",
                    firing.start_s
                ),
                fault: FaultKind::Firing,
                unknowns: vec![own],
                columns: Columns::Changes(vec![Change::Firing(s, k)]),
            })
        })
        .collect()
}

/// Play of the joints that are read.
fn of_play(experiment: &Experiment) -> Vec<Candidate> {
    let (model, tree) = (experiment.problem.model, experiment.problem.tree);
    let moves = |j: usize| {
        let mut segments = experiment.problem.segments.iter();
        segments.any(|s| {
            let o = &s.observations;
            let mut rates = o.joint_rate.iter().skip(j).step_by(tree.dof());
            o.joint_errors.get(j) != Some(&InputErrors::None) && rates.any(|r| *r != 0.0)
        })
    };
    (0..tree.dof())
        .filter(|j| moves(*j))
        .map(|j| {
            let joint = &model.joints[tree.coordinates[j]];
            let unit = match joint.kind {
                JointKind::Prismatic => "m",
                _ => "rad",
            };
            let number = unknown(UnknownKind::Changed, format!("{}.play", joint.name), unit);
            Candidate {
                name: format!("backlash of {}", joint.name),
                fault: FaultKind::Backlash,
                unknowns: vec![number],
                columns: Columns::Changes(vec![Change::Play(j)]),
            }
        })
        .collect()
}

/// Slopes over all changes at a point; empty for one that cannot be made.
pub(super) fn differences(
    experiment: &Experiment,
    at: &Iterate,
    changes: &[Change],
) -> Option<Vec<PredictionSlopes>> {
    if changes.is_empty() {
        return Some(Vec::new());
    }
    let predicted = PredictedExperiment::new(experiment, at)?;
    let numbers = changes.iter().filter_map(|c| shift(experiment, *c));
    let numbers: Vec<Shift> = numbers.collect();
    let mut of_numbers = predicted.slopes(experiment, &numbers)?.into_iter();
    let problem = predicted.problem(experiment.problem);
    let own = experiment.of_vehicle(&problem, predicted.parameters());
    let here = own.evaluate(&predicted.base, false)?;
    let others: Vec<Option<PredictionSlopes>> = changes
        .par_iter()
        .map(|change| {
            let (segments, step) = reread(&problem, *change)?;
            let other = Problem {
                segments: &segments,
                ..problem
            };
            let there = experiment.of_vehicle(&other, predicted.parameters());
            slope(&here, &there.evaluate(&predicted.base, false)?, step)
        })
        .collect();
    let pairs = changes.iter().zip(others);
    let own = pairs.map(|(change, other)| match shift(experiment, *change) {
        Some(number) => of_numbers
            .next()
            .filter(|s| shows(s, number.2 / CHANGE_STEP)),
        None => other,
    });
    Some(own.map(Option::unwrap_or_default).collect())
}

/// Whether one sigma of a number shows in the predictions: a column of round-off explains any residual with a huge number.
fn shows(slopes: &PredictionSlopes, sigma: f64) -> bool {
    let all = slopes.iter().flatten().flatten();
    let square: f64 = all.map(|v| v.norm_squared()).sum();
    square.sqrt() * sigma.abs() > SILENT
}

/// A known number with the step of its difference; `None` for other changes, and for a share of nothing.
fn shift(experiment: &Experiment, change: Change) -> Option<Shift> {
    let Change::Known(number, component) = change else {
        return None;
    };
    let usual = number.usual_sigma(Origin::Cad);
    let step = CHANGE_STEP * number.absolute(experiment.problem.model, component, usual);
    (step != 0.0).then_some((number, component, step))
}

/// The samples of all segments with what drove them changed, and by how much; `None` for a known number.
fn reread(problem: &Problem, change: Change) -> Option<(Vec<Segment>, f64)> {
    let copied = || problem.segments.to_vec();
    match change {
        Change::Known(..) => None,
        Change::Firing(segment, firing) => {
            let mut segments = copied();
            let own = segments.get_mut(segment)?.firings.get_mut(firing)?;
            own.force *= 1.0 + SHARE;
            Some((segments, SHARE))
        }
        Change::Play(joint) => {
            let mut segments = copied();
            let dof = problem.tree.dof();
            let all = segments.iter_mut();
            all.for_each(|s| take_play(s, joint, dof));
            Some((segments, PLAY))
        }
    }
}

/// The link behind its drive by half the play, on the side from which the joint moves.
fn take_play(segment: &mut Segment, joint: usize, dof: usize) {
    let o = &mut segment.observations;
    let mut side = 0.0;
    let rows = o.joint_rate.chunks_exact(dof);
    for (rates, positions) in rows.zip(o.joint_position.chunks_exact_mut(dof)) {
        // At rest the link stays on the side where it came to rest.
        if rates[joint] != 0.0 {
            side = rates[joint].signum();
        }
        positions[joint] -= 0.5 * PLAY * side;
    }
}
