//! A hypothesis: a possible fault with its unknown numbers.

use super::types::FaultKind;
use crate::problem::parameters::{Unknown, UnknownKind, axis_name};

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
    /// Those of an unknown that moves the predictions alike, one for each. Not tried where the record is too long to be held.
    Twins(Vec<Twin>),
    /// Those of the errors of a sensor, times the time since the start of the record.
    Ramp { sensor: usize },
}

/// An unknown that moves the predictions as a number of a candidate does.
#[derive(Debug, Clone)]
pub(super) struct Twin {
    pub unknown: Unknown,
    /// Size of the number whose effect has to show in the predictions.
    pub sigma: f64,
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
