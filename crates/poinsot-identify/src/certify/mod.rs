//! Identifiability: combinations, paths of equal prediction, and their names.

pub(crate) mod barycentre;
pub(crate) mod combination;
pub(crate) mod continuation;
pub(crate) mod naming;
