//! The integration tests of this crate, linked as one binary.
#![allow(clippy::unwrap_used, non_snake_case)]

mod far_start;
mod threads;
mod two_bodies;
