//! Arbitrary bytes into every reader, and small arbitrary problems into `identify`.
//!
//! Each target takes bytes and panics when something is wrong: a panic on the way, or an answer that breaks its
//! promises. libFuzzer calls them from `fuzz/`; `tests/corpus.rs` replays the committed corpus and its mutations.
#![allow(non_snake_case)]

mod identify;
mod model;
mod mutate;
mod small_problem;
mod telemetry;
mod urdf;

pub use identify::identify;
pub use model::model;
pub use mutate::Mutator;
pub use telemetry::{csv, parquet};
pub use urdf::urdf;

/// A target: it panics when something is wrong.
pub type Target = fn(&[u8]);

/// All targets by the names of their corpora.
pub const TARGETS: [(&str, Target); 5] = [
    ("csv", csv),
    ("parquet", parquet),
    ("model", model),
    ("urdf", urdf),
    ("identify", identify),
];
