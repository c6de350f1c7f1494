//! The methods, each from top to bottom.

pub(crate) mod cramer_rao;
pub(crate) mod flexible;
pub(crate) mod linear;
pub(crate) mod maximum_likelihood;
mod other_minima;
pub(crate) mod twist_residual;
