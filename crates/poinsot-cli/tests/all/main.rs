//! The integration tests of this crate, linked as one binary.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod bad_input;
mod bounds;
mod campaign;
mod cli;
mod environment;
mod export;
mod follow;
mod ground_export;
mod init;
mod mixtures;
mod noisy_gyro;
mod paper_tables;
mod pseudo_terminal;
mod report;
mod study;
mod terminal;
mod trust;
mod urdf;
mod validate;
