//! The integration tests of this crate, linked as one binary.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod corpora;
mod telemetry;
