//! Hypotheses about what the fit took as exact: a known number, a firing, a joint without play. There are many, so that they
//! are tried only where the rows are held.

use super::candidate::{Candidate, Columns, Twin, unknown};
use super::types::FaultKind;
use crate::fit::experiment::{Experiment, Iterate, MovedVehicle, twin};
use crate::problem::parameters::{Unknown, UnknownKind};
use crate::problem::segment::InputErrors;
use poinsot_model::{JointKind, KnownNumber, Origin};

/// Step of the difference of what a number moves in the vehicle, in its usual uncertainty.
const CHANGE_STEP: f64 = 1.0e-3;
/// Largest number of firings tested one by one.
const FIRINGS: usize = 48;

/// Known numbers, firings and joints that the fit assumed exact, at its answer.
pub(super) fn changes(experiment: &Experiment, at: &Iterate) -> Vec<Candidate> {
    let mut list = of_known_numbers(experiment, at);
    list.extend(of_firings(experiment));
    list.extend(of_play(experiment));
    list
}

/// Numbers whose errors are no candidates otherwise.
fn of_known_numbers(experiment: &Experiment, at: &Iterate) -> Vec<Candidate> {
    let Some(moved) = MovedVehicle::new(experiment, at) else {
        return Vec::new();
    };
    let there = moved.problem(experiment.problem);
    let model = experiment.problem.model;
    let fitted = &experiment.parameters.unknowns;
    let is_unknown = |number: &KnownNumber| {
        let mut known = fitted.iter().filter_map(|u| u.kind.known());
        known.any(|k| k.number == *number)
    };
    let is_candidate = |number: &KnownNumber| {
        matches!(
            number,
            KnownNumber::SpinInertia(_)
                | KnownNumber::WheelAxis(_)
                | KnownNumber::Force(_)
                | KnownNumber::SpecificImpulse(_)
                | KnownNumber::PropellantPlace(_)
                | KnownNumber::Mounting(_)
        )
    };
    let numbers = model.known_numbers().into_iter();
    numbers
        .filter(|n| n.is_known(model) && !is_unknown(n) && !is_candidate(n))
        .map(|number| {
            let components = 0..number.components();
            let twin_of = |c: usize| {
                let usual = number.usual_sigma(Origin::Cad);
                let sigma = number.absolute(model, c, usual);
                let shift = (number, c, CHANGE_STEP * sigma);
                let own = (moved.parameters(), &moved.base.x);
                match twin((&there, model), own.0, own.1, shift) {
                    Some((unknown, _)) => Twin { unknown, sigma },
                    None => Twin {
                        unknown: unknown(
                            UnknownKind::Changed,
                            number.name(model, c),
                            number.unit(),
                        ),
                        sigma,
                    },
                }
            };
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
                columns: Columns::Twins(components.map(twin_of).collect()),
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
            let kind = UnknownKind::Firing {
                segment: s,
                firing: k,
                thruster: firing.thruster,
            };
            let mut own = unknown(kind, number, "1");
            own.nominal = 1.0;
            Some(Candidate {
                name: format!(
                    "another force of the firing of {name} at {:.1} s",
                    firing.start_s
                ),
                fault: FaultKind::Firing,
                columns: itself(&own),
                unknowns: vec![own],
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
            let number = unknown(
                UnknownKind::JointPlay(j),
                format!("{}.play", joint.name),
                unit,
            );
            Candidate {
                name: format!("backlash of {}", joint.name),
                fault: FaultKind::Backlash,
                columns: itself(&number),
                unknowns: vec![number],
            }
        })
        .collect()
}

/// The columns of a number that shows whatever its size.
fn itself(unknown: &Unknown) -> Columns {
    Columns::Twins(vec![Twin {
        unknown: unknown.clone(),
        sigma: f64::INFINITY,
    }])
}
