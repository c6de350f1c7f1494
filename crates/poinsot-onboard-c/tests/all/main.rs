//! The C interface against the Rust one and against its header.
#![allow(
    clippy::expect_used,
    clippy::needless_range_loop,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod header;
mod interface;
mod record;
// Truth and set-ups of the filter's own tests.
#[path = "../../../poinsot-onboard/tests/all/arm.rs"]
#[allow(dead_code)]
mod arm;
#[path = "../../../poinsot-onboard/tests/all/setups.rs"]
#[allow(dead_code)]
mod setups;
#[path = "../../../poinsot-onboard/tests/all/sprung.rs"]
#[allow(dead_code)]
mod sprung;
#[path = "../../../poinsot-onboard/tests/all/truth.rs"]
mod truth;
