//! The numerical solution, its unobservable set, and the types of the answer.

pub(crate) mod estimate;
pub(crate) mod evidence;
pub(crate) mod solved;
pub(crate) mod unobservable_set;
