//! Test whether the prediction depends on undetermined numbers.
//!
//! The data determine combinations, and the motion should depend on these only. The completed numbers are varied along
//! every unobservable direction, and the change of the prediction is measured.

use super::Mover;
use super::motion::{compare_paths, path};
use super::telemetry::HeldBackFindings;
use crate::case::Case;
use crate::error::Error;
use poinsot_formats::{CompletedFile, PredictionChangeFile};
use poinsot_identify::Completion;
use poinsot_model::Model;
use poinsot_telemetry::{Channel, Table};

/// Variation of each unobservable direction, in natural units of its unique parameter.
const MOVED: f64 = 0.1;
/// Relative change of the motion that exceeds round-off by cancellation.
const MATTERS: f64 = 1.0e-6;
/// Significant change of chi-square per degree of freedom.
const MATTERS_CHI2: f64 = 1.0e-3;

/// Varies the vehicle along every unobservable direction of its completion; `own` is the motion without variation.
///
/// # Errors
/// A motion cannot be computed.
pub(super) fn motion_effect(
    case: &Case,
    model: &Model,
    completion: &Completion,
    own: &Table,
) -> Result<CompletedFile, Error> {
    let travel = travel(model, own);
    effect(model, completion, MATTERS, Vec::new(), |moved, changes| {
        // A vehicle that cannot be simulated counts as changed.
        let Ok(other) = path(case, moved) else {
            return Ok(f64::INFINITY);
        };
        let mut strongest = 0.0_f64;
        for (one, travel) in compare_paths(model, own, &other).iter().zip(&travel) {
            let one = &one.file;
            match changes.iter_mut().find(|c| c.quantity == one.quantity) {
                Some(known) => known.largest = known.largest.max(one.largest),
                None => changes.push(change(&one.quantity, &one.unit, one.largest)),
            }
            let share = one.largest / travel;
            if share > strongest || share.is_nan() {
                strongest = share;
            }
        }
        Ok(strongest)
    })
}

fn change(quantity: &str, unit: &str, largest: f64) -> PredictionChangeFile {
    PredictionChangeFile {
        quantity: quantity.to_owned(),
        unit: unit.to_owned(),
        largest,
    }
}

/// Moves the vehicle along every unobservable direction; the prediction depends on those whose `strength` is above the
/// limit.
fn effect(
    model: &Model,
    completion: &Completion,
    limit: f64,
    mut changes: Vec<PredictionChangeFile>,
    strength: impl Fn(&Mover, &mut Vec<PredictionChangeFile>) -> Result<f64, Error>,
) -> Result<CompletedFile, Error> {
    let mut dependent: Vec<(f64, String)> = Vec::new();
    for direction in &completion.open {
        let moved = Mover::of_estimate(model, &completion.moved(direction, MOVED));
        let strength = strength(&moved, &mut changes)?;
        if strength > limit || strength.is_nan() {
            dependent.push((strength, completion.name(direction).to_owned()));
        }
    }
    dependent.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(CompletedFile {
        determined: completion.x.len().saturating_sub(completion.open.len()),
        open: completion.open.len(),
        distance_natural: completion.distance,
        open_moved_by_natural: MOVED,
        prediction_changes: changes,
        depends_on: dependent.into_iter().map(|d| d.1).collect(),
    })
}

/// Largest displacement of each quantity of a path from its start, at least 1e-3 m or rad.
fn travel(model: &Model, path: &Table) -> Vec<f64> {
    let still = |c: &Channel| Channel {
        values: vec![c.values.first().copied().unwrap_or(0.0); c.values.len()],
        ..c.clone()
    };
    let still = Table {
        channels: path.channels.iter().map(still).collect(),
        ..Table::default()
    };
    let moved = compare_paths(model, path, &still);
    moved.iter().map(|c| c.file.largest.max(1.0e-3)).collect()
}

/// Change of chi-square per degree of freedom of held-back telemetry along every unobservable direction.
///
/// # Errors
/// Model and telemetry do not match.
pub(super) fn held_back_effect(
    model: &Model,
    completion: &Completion,
    tables: &[Table],
    own: f64,
) -> Result<CompletedFile, Error> {
    let none = vec![change("chi-square per degree of freedom", "", 0.0)];
    effect(model, completion, MATTERS_CHI2, none, |moved, changes| {
        let change = match HeldBackFindings::of(moved, tables, None) {
            Ok(found) => (found.chi2_per_dof() - own).abs(),
            Err(faults) if faults.code().starts_with("E04") => f64::INFINITY,
            Err(other) => return Err(other),
        };
        changes[0].largest = changes[0].largest.max(change);
        Ok(change)
    })
}
