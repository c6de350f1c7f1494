//! What the data determine, and what they leave open: combinations, walks of equal prediction, words.

pub(crate) mod barycentre;
pub(crate) mod combination;
pub(crate) mod continuation;
pub(crate) mod naming;
