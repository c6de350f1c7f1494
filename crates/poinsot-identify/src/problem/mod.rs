//! The problem: segments of telemetry, unknowns, priors, loss.

pub(crate) mod alternative;
pub(crate) mod error_process;
pub(crate) mod fault;
pub(crate) mod loss;
pub(crate) mod parameters;
pub(crate) mod prior;
pub(crate) mod quantity;
pub(crate) mod question;
pub mod refusal;
pub(crate) mod segment;
pub(crate) mod settings;
pub(crate) mod shifted_vehicle;

pub use question::{Problem, ProblemError};
