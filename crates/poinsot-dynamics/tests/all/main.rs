//! The integration tests of this crate, linked as one binary.
#![allow(clippy::panic, clippy::unwrap_used, non_snake_case)]

#[cfg(feature = "batches")]
mod batch;
#[cfg(feature = "batches")]
mod exact_closed_forms;
mod exact_driven;
mod exact_gravity_gradient;
mod exact_joint_plans;
mod exact_measurements;
mod exact_modes;
mod exact_motions;
mod exact_passive_joints;
mod exact_propellant;
mod kernels;
mod prop_motion;
#[cfg(feature = "batches")]
mod propagation;
mod setup;
mod stat_sensors;
mod tree_dynamics;
#[path = "../../benches/xu_arm/mod.rs"]
mod xu_arm;
mod xval_accelerometer;
mod xval_attitude_control;
mod xval_dynamics;
mod xval_runs;
