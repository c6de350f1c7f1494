//! The integration tests of this crate, linked as one binary.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod accelerometer_noise;
mod answers;
mod at_rest;
mod bad_questions;
mod book;
mod campaign;
mod campaign_page;
mod coasting;
mod common_thrust;
mod compare;
mod conventions;
mod counts;
mod evaluation;
mod evidence;
mod far_starts;
mod faults;
mod formats;
mod gaps;
mod gate;
mod gravity_gradient;
mod held_out;
mod hidden_modes;
mod hidden_oscillator;
mod identify_examples;
mod input_faults;
mod integrity;
mod known_numbers;
mod known_start;
mod late_inputs;
mod low_orbit;
mod many_nuisances;
mod many_sensors;
mod map_keys;
mod methods;
mod mixed_up;
mod mode_table;
mod motor_torque;
mod mutations;
mod noisy_files;
mod noisy_inputs;
mod nutation;
mod open_set;
mod passive_joints;
mod physical;
mod point_sensors;
mod points;
mod promises;
mod propellant;
mod pyramid;
mod random_torque;
mod real_data;
mod remedies;
mod report;
mod reported;
mod reported_fits;
mod reported_inputs;
mod scalar_errors;
mod settings;
mod setups;
mod shared;
mod simulate;
mod statistics;
mod stored_momentum;
mod tables;
mod throws;
mod torque;
mod trust;
mod uncertainty;
mod validate;
mod vehicle;
mod weak_numbers;
mod wheel_motion;
