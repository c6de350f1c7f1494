//! Test whether the prediction depends on undetermined numbers.
//!
//! The data determine combinations, and the motion should depend on these only. The completed numbers are varied along
//! every unobservable direction, and the change of the prediction is measured.

use super::Mover;
use super::motion::{Path, compare_paths, path};
use super::telemetry::held_back_chi2;
use crate::case::Case;
use crate::error::Error;
use poinsot_identify::Completion;
use poinsot_model::Model;
use poinsot_telemetry::Table;

/// Variation of each unobservable direction, in natural units of its unique parameter.
const MOVED: f64 = 0.1;
/// Relative change of the motion that exceeds round-off by cancellation.
const MATTERS: f64 = 1.0e-6;
/// Significant change of chi-square per degree of freedom.
const MATTERS_CHI2: f64 = 1.0e-3;

/// Sensitivity of the prediction to the unobservable directions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OpenEffect {
    /// Variation of each direction, in natural units of its own parameter.
    pub moved: f64,
    /// Largest change of each quantity: name, unit, change.
    pub changes: Vec<(String, &'static str, f64)>,
    /// Parameters whose direction changes the prediction, strongest first.
    pub dependent: Vec<String>,
}

impl OpenEffect {
    /// Whether the prediction depends on undetermined numbers.
    pub fn matters(&self) -> bool {
        !self.dependent.is_empty()
    }
}

/// Varies the vehicle along every unobservable direction of its completion; `own` is the motion without variation.
///
/// # Errors
/// A motion cannot be computed.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// use poinsot::validate::{Mover, motion_effect, of_estimate, path};
///
/// let vehicle = of_estimate(&identified.estimate, &model)?;
/// let own = path(&case, &vehicle.mover)?;
/// // No direction is open, so none matters.
/// assert!(!motion_effect(&case, &model, &vehicle.completion.unwrap(), &own)?.matters());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn motion_effect(
    case: &Case,
    model: &Model,
    completion: &Completion,
    own: &Path,
) -> Result<OpenEffect, Error> {
    let travel = travel(own);
    let mut effect = OpenEffect {
        moved: MOVED,
        ..OpenEffect::default()
    };
    let mut dependent: Vec<(f64, String)> = Vec::new();
    for direction in &completion.open {
        let moved = Mover::of_estimate(model, &completion.moved(direction, MOVED));
        // A vehicle that cannot be simulated counts as changed.
        let Ok(other) = path(case, &moved) else {
            dependent.push((f64::INFINITY, completion.name(direction).to_owned()));
            continue;
        };
        let mut strongest = 0.0_f64;
        for (one, travel) in compare_paths(own, &other).iter().zip(&travel) {
            match effect.changes.iter_mut().find(|c| c.0 == one.name) {
                Some(known) => known.2 = known.2.max(one.largest),
                None => effect
                    .changes
                    .push((one.name.clone(), one.unit, one.largest)),
            }
            let share = one.largest / travel;
            if share > strongest || share.is_nan() {
                strongest = share;
            }
        }
        if strongest > MATTERS || strongest.is_nan() {
            dependent.push((strongest, completion.name(direction).to_owned()));
        }
    }
    dependent.sort_by(|a, b| b.0.total_cmp(&a.0));
    effect.dependent = dependent.into_iter().map(|d| d.1).collect();
    Ok(effect)
}

/// Largest displacement of each quantity of a path from its start, at least 1e-3 m or rad.
fn travel(path: &Path) -> Vec<f64> {
    let still = Path {
        p_NoBo_N: path.p_NoBo_N.iter().map(|_| path.p_NoBo_N[0]).collect(),
        R_NB: path.R_NB.iter().map(|_| path.R_NB[0]).collect(),
        joints: path
            .joints
            .iter()
            .map(|joint| super::JointPath {
                position: joint.position.iter().map(|_| joint.position[0]).collect(),
                ..joint.clone()
            })
            .collect(),
        time_s: path.time_s.clone(),
    };
    let moved = compare_paths(path, &still);
    moved.iter().map(|c| c.largest.max(1.0e-3)).collect()
}

/// Change of chi-square per degree of freedom of held-back telemetry along every unobservable direction.
///
/// # Errors
/// Model and telemetry do not match.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// use poinsot::validate::{held_back_effect, of_estimate};
///
/// let completion = of_estimate(&identified.estimate, &model)?.completion.unwrap();
/// // No direction is open, so none matters.
/// assert!(!held_back_effect(&model, &completion, &[table], 1.0)?.matters());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn held_back_effect(
    model: &Model,
    completion: &Completion,
    tables: &[Table],
    own: f64,
) -> Result<OpenEffect, Error> {
    let mut effect = OpenEffect {
        moved: MOVED,
        ..OpenEffect::default()
    };
    let mut largest = 0.0_f64;
    let mut dependent: Vec<(f64, String)> = Vec::new();
    for direction in &completion.open {
        let moved = Mover::of_estimate(model, &completion.moved(direction, MOVED));
        let change = match held_back_chi2(&moved, tables) {
            Ok(found) => (found - own).abs(),
            Err(Error::Problem(_)) => f64::INFINITY,
            Err(other) => return Err(other),
        };
        largest = largest.max(change);
        if change > MATTERS_CHI2 || change.is_nan() {
            dependent.push((change, completion.name(direction).to_owned()));
        }
    }
    effect
        .changes
        .push(("chi-square per degree of freedom".to_owned(), "", largest));
    dependent.sort_by(|a, b| b.0.total_cmp(&a.0));
    effect.dependent = dependent.into_iter().map(|d| d.1).collect();
    Ok(effect)
}
