//! The integration tests of this crate, linked as one binary.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod corpora;
mod patch;
mod reading;
mod refusals;
mod urdf;
