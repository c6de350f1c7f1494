//! Sensitivities of the predictions to known numbers.

use super::as_predicted::take_predictions;
use super::{Experiment, Iterate};
use crate::likelihood::KnownColumns;
use crate::problem::Problem;
use crate::problem::parameters::KnownUnknown;
use crate::problem::shifted_vehicle::ShiftedVehicle;
use poinsot_spatial::Vector3;
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// Step of a difference, sigmas of the number. One sigma may be 10^5 times the noise of all readings together; the bend over
/// a step and its round-off must both stay far below the noise.
pub(crate) const DIFFERENCE: f64 = 1.0e-5;
/// Sigmas by which a known number may have moved since its columns were made. One sigma changes a column by a tenth at most
/// (inertia from a drawing), so columns this old move no answer by more than a hundredth of its sigma.
const FRESH: f64 = 0.1;

/// Columns with the values of the known numbers where they were made, sigmas.
pub(crate) type KeptColumns = Arc<Mutex<Option<(Vec<f64>, Arc<KnownColumns>)>>>;

/// Columns of the known numbers at a value of all unknowns: those kept, where the numbers have hardly moved.
pub(crate) fn columns_at(experiment: &Experiment, at: &Iterate) -> Option<Arc<KnownColumns>> {
    let unknowns = &experiment.parameters.unknowns;
    let places = experiment.parameters.known_places();
    let value = |p: &usize| at.x[*p] / unknowns[*p].natural;
    let here: Vec<f64> = places.iter().map(value).collect();
    let close = |old: &[f64]| {
        let mut pairs = old.iter().zip(&here);
        old.len() == here.len() && pairs.all(|(a, b)| (a - b).abs() < FRESH)
    };
    let mut kept = experiment.kept.lock().ok()?;
    if let Some((_, columns)) = kept.as_ref().filter(|(old, _)| close(old)) {
        return Some(Arc::clone(columns));
    }
    let columns = Arc::new(slopes(experiment, at)?);
    *kept = Some((here, Arc::clone(&columns)));
    Some(columns)
}

/// Slopes of all whitened predictions over each known number, by differences, at a value of all unknowns. Predictions are
/// compared with each other: whitening depends on the vehicle where inputs err, and its change times the residual is no
/// slope.
pub(crate) fn slopes(experiment: &Experiment, at: &Iterate) -> Option<KnownColumns> {
    let (own, kept) = experiment.parameters.without_known();
    let base = Iterate {
        x: kept.iter().map(|k| at.x[*k]).collect(),
        initial_states: at.initial_states.clone(),
    };
    let numbers: Vec<(&KnownUnknown, f64)> = experiment
        .parameters
        .known_places()
        .iter()
        .map(|p| (&experiment.parameters.unknowns[*p], at.x[*p]))
        .filter_map(|(u, x)| Some((u.kind.known()?, x - u.nominal)))
        .collect();
    let moved = numbers
        .iter()
        .map(|(n, change)| (n.number, n.component, *change));
    let shifted = ShiftedVehicle::new(experiment.problem, &own, &moved.collect::<Vec<_>>())?;
    let there = shifted.problem(experiment.problem);
    let mut perfect = there.segments.to_vec();
    take_predictions(
        &experiment.of_vehicle(&there, &shifted.parameters),
        &base,
        &mut perfect,
    )?;
    let there = Problem {
        segments: &perfect,
        ..there
    };
    let here = experiment
        .of_vehicle(&there, &shifted.parameters)
        .evaluate(&base, false)?;
    let differences = |k: usize| -> Option<Vec<Vec<Vec<Vector3>>>> {
        let number = numbers[k].0;
        let step = DIFFERENCE * number.sigma;
        let change = (number.number, number.component, step);
        let nominal = experiment.problem.model;
        let shifted = ShiftedVehicle::from(&there, nominal, &shifted.parameters, &[change])?;
        let beside = shifted.problem(&there);
        let evaluated = experiment
            .of_vehicle(&beside, &shifted.parameters)
            .evaluate(&base, false)?;
        let segments = here.iter().zip(&evaluated);
        let slope = |(a, b): (&Vector3, &Vector3)| (a - b) / step;
        segments
            .map(|(a, b)| {
                let sensors = a.channels.iter().zip(&b.channels);
                sensors
                    .map(|(a, b)| {
                        let same = a.white.len() == b.white.len();
                        same.then(|| a.white.iter().zip(&b.white).map(slope).collect())
                    })
                    .collect()
            })
            .collect()
    };
    let by_number: Vec<Option<_>> = (0..numbers.len())
        .into_par_iter()
        .map(differences)
        .collect();
    let mut out = KnownColumns::default();
    for (s, one) in here.iter().enumerate() {
        let names = one.channels.iter().map(|c| c.name.clone());
        out.sensors.push(names.collect());
        let sensors = 0..one.channels.len();
        out.slopes.push(
            sensors
                .map(|i| {
                    let of = |all: &Option<Vec<Vec<Vec<Vector3>>>>| {
                        // A number without a valid step gives no column.
                        let all = all.as_ref().and_then(|all| all.get(s)?.get(i).cloned());
                        all.unwrap_or_default()
                    };
                    by_number.iter().map(of).collect()
                })
                .collect(),
        );
    }
    Some(out)
}
