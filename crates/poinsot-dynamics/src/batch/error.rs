//! What is wrong with a batch.

use crate::forward_dynamics::Singular;
use crate::motion::integrate::Halt;

/// Why a batch has no result.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// A vehicle has no unique acceleration.
    #[error("state {0}: {1}")]
    Singular(usize, Singular),
    /// The motion of this vehicle, or of one beside it, stopped.
    #[error("vehicle {0} or one of the next seven: {1}")]
    Halted(usize, Halt),
    /// An array has another length than the number of states asks for.
    #[error("{0}: {1} numbers, expected {2}; give one row per state")]
    Length(&'static str, usize, usize),
}

pub(super) fn expect(name: &'static str, found: usize, length: usize) -> Result<(), BatchError> {
    let fits = (found == length).then_some(());
    fits.ok_or(BatchError::Length(name, found, length))
}
