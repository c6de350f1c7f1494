//! What a method has found: numbers with their spectrum, what stays open, the types of the answer.

pub(crate) mod estimate;
pub(crate) mod open_set;
pub(crate) mod solved;
