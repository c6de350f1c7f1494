//! The integration tests of this crate, linked as one binary.
#![allow(clippy::unwrap_used, non_snake_case)]

mod coarse_fit;
mod threads;
mod two_bodies;
