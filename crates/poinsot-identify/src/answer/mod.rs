//! From a solved problem to the estimate that is written.

pub(crate) mod body;
pub(crate) mod covariance;
pub(crate) mod determined;
pub(crate) mod known_numbers;
pub(crate) mod momentum;
mod nominal;
mod rejection;
pub(crate) mod reliability;
mod residual_tests;
mod sensor_noise;
mod signatures;
pub(crate) mod write;

pub(crate) use write::{write, write_with_remedies};
