//! What is wrong with a batch.

use crate::forward_dynamics::Singular;
use crate::motion::integrate::Halt;
use crate::propagation::StepError;
use crate::sensor::SensorKind;

/// Why a batch has no result.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// A vehicle has no unique acceleration.
    #[error("state {0}: {1}")]
    Singular(usize, Singular),
    /// The motion of this vehicle, or of one beside it, stopped.
    #[error("vehicle {0} or one of the next seven: {1}")]
    Halted(usize, Halt),
    /// The step of this vehicle, or of one beside it, has no result.
    #[error("vehicle {0} or one of the next seven: {1}")]
    Step(usize, StepError),
    /// The kind has no axes, or what it measures is missing: the reference of a direction, the accelerations of an
    /// accelerometer.
    #[error("{}: give a kind with axes, its reference_N for a direction, accelerations for an accelerometer", .0.word())]
    Unmeasured(SensorKind),
    /// The tree does not have this body.
    #[error("body {0}: the tree has {1} bodies, counted from 0")]
    Body(usize, usize),
    /// An array has another length than the number of states asks for.
    #[error("{0}: {1} numbers, expected {2}; give one row per state")]
    Length(&'static str, usize, usize),
}

pub(super) fn expect(name: &'static str, found: usize, length: usize) -> Result<(), BatchError> {
    match found == length {
        true => Ok(()),
        false => Err(BatchError::Length(name, found, length)),
    }
}
