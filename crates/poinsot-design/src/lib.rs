//! The verb `design`: designs a manoeuvre that reaches wanted sigmas within limits.
//!
//! A case holds the wanted sigmas (`[[want]]`), the free motion (`[design]`) and the limits (`[limits]`). Each
//! candidate is simulated with the nominal vehicle, and its Fisher information is computed as in `predict`. The search
//! minimises the largest ratio of sigma to wanted sigma over the free numbers, by random starts, hops from the best of
//! them, and sequential quadratic programming.
//!
//! This crate depends on `poinsot`, because a design simulates, predicts and identifies. No other command needs a
//! design.
//!
//! [`DesignRequest`] -> [`design()`] or [`design_case`] -> [`Designed`] -> [`write_design`]. [`manoeuvre_case`] gives the
//! manoeuvre as a case, for `simulate` and `predict`.
//!
//! # Example
//! A box with one wheel: its moment about the axis of the wheel is wanted to 0.1 %, with at most 200 rad/s.
//!
//! ```
//! use poinsot_design::{DesignRequest, design};
//!
//! let case = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/case.toml");
//! let designed = design(&DesignRequest { case, ..DesignRequest::default() })?;
//! assert!(designed.passes());
//! let speed = designed.file.limits.iter().find(|limit| limit.what == "speed of wheel").unwrap();
//! assert!(speed.value.abs() <= 200.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Files
//! - `design.rs`: from case to manoeuvre. `search.rs`: multistart search. `trial.rs`: one candidate: flight,
//!   information, limits.
//! - `shape.rs`: all free numbers and their linear limits. `mover.rs`: motion of one joint or wheel. `valves.rs`:
//!   firings with free times.
//! - `margins.rs`: use of limits, also by vehicles of the prior. `reliability.rs`: the share of a prior that exceeds limits.
//!   `relaxed.rs`: other limits. `watch.rs`: limits that need a simulation.
//! - `vehicles.rs`: vehicles of the prior. `verify.rs`: trial flights.
//! - `result.rs`, `written.rs`: the result and its files. `interrupt.rs`: a stopped search keeps its best result.
//!   `progress.rs`: the best manoeuvre so far.
#![allow(non_snake_case)]

mod design;
pub mod interrupt;
mod margins;
mod mover;
mod progress;
mod relaxed;
mod reliability;
mod result;
mod search;
mod shape;
mod trial;
mod valves;
mod vehicles;
mod verify;
mod watch;
mod written;

pub use design::{DesignRequest, design, design_case};
pub use progress::{BestSoFar, Told};
pub use result::Designed;
pub use vehicles::{drawn, has_prior};

pub use written::{manoeuvre_case, write_design};
