//! The verb `design`: designs a manoeuvre that reaches wanted sigmas within limits.
//!
//! A case holds the wanted sigmas (`[[want]]`), the free motion (`[design]`) and the limits (`[limits]`). Each
//! candidate is simulated with the nominal vehicle, and its Fisher information is computed as in `predict`. The search
//! minimises the largest ratio of sigma to wanted sigma over the free numbers, by random starts, hops from the best of
//! them, and sequential quadratic programming.
//!
//! This crate depends on `poinsot`, because a design simulates, predicts and identifies. No other command needs a
//! design.
#![allow(non_snake_case)]

mod design;
mod file;
pub mod interrupt;
mod margins;
mod mover;
mod relaxed;
mod result;
mod search;
mod shape;
mod text;
mod trial;
mod valves;
mod vehicles;
mod verify;
mod watch;
mod written;

pub use design::{DesignRequest, design, design_case};
pub use file::design_file;
pub use result::{Designed, LimitUse, Reach, Relaxed, Robust, Verification, VerifiedNumber};
pub use vehicles::{drawn, has_prior};

pub use written::{manoeuvre_case, write_design};
