//! Everything at any value of the unknowns, for other methods and for searches.

pub(crate) mod evaluator;
pub(crate) mod wanted;

pub use evaluator::{EvaluatedUnknown, Evaluation, Evaluator, SensorResiduals};
