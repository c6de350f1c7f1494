//! Trials of the filter against motions computed by code that shares nothing with it.
#![allow(
    clippy::expect_used,
    clippy::needless_range_loop,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod arm;
mod dense;
mod prop_table;
mod setups;
mod sprung;
mod stat_faults;
mod stat_long;
mod stat_trials;
mod truth;
mod unit_stream;
