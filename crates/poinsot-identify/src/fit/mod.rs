//! The experiment at any value of its unknowns, and the fit of the momentum state.

pub(crate) mod alternatives;
pub(crate) mod coordinates;
pub(crate) mod degrees_of_freedom;
pub(crate) mod experiment;
pub(crate) mod known_numbers;
pub(crate) mod momentum_state;
pub(crate) mod part_of_record;
pub(crate) mod profile;
pub(crate) mod sampled_motion;
pub(crate) mod search;
pub(crate) mod smoothed_inputs;
pub(crate) mod step;
pub(crate) mod step_error;
pub(crate) mod triangle;
pub(crate) mod wheel_torque;

pub(crate) use momentum_state::{Fitted, Search, fit_from, fit_near, fit_on, fit_starts};
pub(crate) use search::{fit, fit_along};
pub(crate) use step::ITERATIONS;
