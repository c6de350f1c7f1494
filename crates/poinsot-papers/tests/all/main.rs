//! The integration tests of this crate, linked as one binary.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod any_vehicle;
mod kim2010;
mod ma2008;
mod outside;
mod xu2017;
