//! What a method has found: numbers with their spectrum, what stays open, the types of the answer.

pub(crate) mod estimate;
pub(crate) mod solved;
pub(crate) mod unobservable_set;
