//! Runs arbitrary bytes through every reader, and small arbitrary problems through `identify`.
//!
//! Each target takes bytes. It panics if the program panics or a result violates its invariants. libFuzzer calls them
//! from `fuzz/`; `tests/corpus.rs` replays the committed corpus.
#![allow(non_snake_case)]

mod identify;
mod model;
mod results;
mod small_problem;
mod telemetry;
mod urdf;
mod xml;

pub use identify::identify;
pub use model::model;
pub use results::results;
pub use telemetry::{csv, parquet};
pub use urdf::urdf;
pub use xml::xml;

/// A target; it panics on a fault.
pub type Target = fn(&[u8]);
