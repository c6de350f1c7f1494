//! Hypotheses about known numbers that the fit took as exact. There are many, so that they are tried only where the rows are held.

use super::candidate::{Candidate, Columns, Twin, changed};
use super::types::FaultKind;
use crate::fit::experiment::{Experiment, Iterate, MovedVehicle, twin};
use poinsot_model::{KnownNumber, Origin};

/// Step of the difference of what a number moves in the vehicle, in its usual uncertainty.
const CHANGE_STEP: f64 = 1.0e-3;

/// Numbers whose errors are no candidates otherwise.
pub(super) fn untested_numbers(experiment: &Experiment) -> Vec<KnownNumber> {
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
        .collect()
}

/// Hypotheses of other values of these numbers.
pub(super) fn of_known_numbers(
    experiment: &Experiment,
    at: &Iterate,
    numbers: Vec<KnownNumber>,
) -> Vec<Candidate> {
    let Some(moved) = MovedVehicle::new(experiment, at) else {
        return Vec::new();
    };
    let there = moved.problem(experiment.problem);
    let model = experiment.problem.model;
    numbers
        .into_iter()
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
                        unknown: changed(number.name(model, c), number.unit(), 0.0),
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
                        let value = number.value(model, c);
                        changed(number.name(model, c), number.unit(), value)
                    })
                    .collect(),
                columns: Columns::Twins(components.map(twin_of).collect()),
            }
        })
        .collect()
}
