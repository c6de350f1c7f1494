//! The verb `design`: the manoeuvre that tells what you want to know, within limits.
//!
//! A case says what is wanted (`[[want]]`), what may move (`[design]`) and what no manoeuvre may exceed (`[limits]`). Each
//! candidate is flown by the nominal vehicle and asked for its Fisher information, as `predict` does; a search over the
//! free numbers of the manoeuvre (random starts, then sequential quadratic programming) makes the largest ratio of sigma
//! to wanted sigma as small as the limits allow.
//!
//! This crate stands on `poinsot`: a design simulates, predicts and identifies, and no verb needs a design.
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
pub use file::{design_document, design_file};
pub use result::{Designed, LimitUse, Reach, Relaxed, Verification, VerifiedNumber};
pub use vehicles::{drawn, has_prior};

pub use written::{manoeuvre_case, write_design};
