//! A hypothesis: a possible fault with its unknown numbers.

use super::types::FaultKind;
use crate::problem::parameters::{Entry, Unknown, UnknownKind};

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
    /// The fault of a group of the registry.
    pub fn of(entries: Vec<Entry>) -> Option<Self> {
        let first = entries.first()?;
        let shows = matches!(
            first.unknown.kind,
            UnknownKind::Firing { .. } | UnknownKind::JointPlay(_)
        );
        let (name, fault) = (first.hypothesis.clone(), first.fault);
        let unknowns: Vec<Unknown> = entries.into_iter().map(|e| e.unknown).collect();
        Some(Self {
            name,
            fault,
            columns: match shows {
                true => Columns::Twins(unknowns.iter().map(Twin::itself).collect()),
                false => Columns::Slopes,
            },
            unknowns,
        })
    }

    /// Whether it is a lag of an input.
    pub fn delays_inputs(&self) -> bool {
        self.unknowns.iter().any(|u| u.kind.delays_drives())
    }
}

impl Twin {
    /// A number that shows whatever its size.
    fn itself(unknown: &Unknown) -> Self {
        Self {
            unknown: unknown.clone(),
            sigma: f64::INFINITY,
        }
    }
}

/// A number whose column is made of others.
pub(super) fn changed(name: String, unit: &'static str, nominal: f64) -> Unknown {
    Unknown {
        kind: UnknownKind::Changed,
        name,
        unit,
        nominal,
        natural: 1.0,
    }
}
