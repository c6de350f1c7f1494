//! Runs arbitrary bytes through every reader, small arbitrary problems through `identify`, and changed streams through the on-board filter.
//!
//! Each target takes bytes. It panics if the program panics or a result violates its invariants. libFuzzer calls them
//! from `fuzz/`; `tests/corpus.rs` replays the committed corpus.
#![allow(non_snake_case)]

mod identify;
mod model;
mod onboard;
mod results;
mod small_problem;
mod telemetry;
mod urdf;
mod xml;

pub use identify::identify;
pub use model::model;
pub use onboard::onboard;
pub use results::results;
pub use telemetry::{csv, parquet};
pub use urdf::urdf;
pub use xml::xml;

/// A target; it panics on a fault.
pub type Target = fn(&[u8]);
