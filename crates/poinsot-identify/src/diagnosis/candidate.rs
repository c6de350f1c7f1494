//! A hypothesis: a possible fault with its unknown numbers.

use super::types::FaultKind;
use crate::problem::parameters::{Unknown, UnknownKind, axis_name};
use poinsot_model::KnownNumber;

/// Candidate faults of one kind.
pub(super) struct Candidate {
    /// Its name.
    pub name: String,
    pub fault: FaultKind,
    pub unknowns: Vec<Unknown>,
    pub columns: Columns,
}

/// Source of a candidate's columns.
#[derive(Debug, Clone)]
pub(super) enum Columns {
    /// The unknowns have slopes of their own.
    Slopes,
    /// Differences of whole evaluations, one for each unknown.
    Changes(Vec<Change>),
    /// Those of the errors of a sensor, times the time since the start of the record.
    Ramp { sensor: usize },
}

impl Candidate {
    /// Whether it is a lag of an input.
    pub fn delays_inputs(&self) -> bool {
        let late = |kind: &UnknownKind| {
            kind.delays_inputs() || matches!(kind, UnknownKind::ThrusterLag(_))
        };
        self.unknowns.iter().any(|u| late(&u.kind))
    }
}

pub(super) fn unknown(kind: UnknownKind, name: String, unit: &'static str) -> Unknown {
    Unknown {
        kind,
        name,
        unit,
        nominal: 0.0,
        natural: 1.0,
    }
}

pub(super) fn triple(
    kind: fn(usize) -> UnknownKind,
    prefix: &str,
    unit: &'static str,
) -> Vec<Unknown> {
    (0..3)
        .map(|k| unknown(kind(k), format!("{prefix}_{}", axis_name(k)), unit))
        .collect()
}

/// One change of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    /// A component of a known number.
    Known(KnownNumber, usize),
    /// The force of one firing in a segment, as a share of it.
    Firing(usize, usize),
    /// Play of a joint coordinate: its link is half of it behind its drive.
    Play(usize),
}
