//! The book in `docs/`: pages generated from the program, formulas as MathML, one folder of HTML that loads
//! nothing from a network.
//!
//! mdBook is used as a library: its version is fixed in `Cargo.lock`, and no second program has to be installed.
//!
//! # Files
//! - `commands.rs`, `formats.rs`, `validation.rs`: generated pages.
//! - `math.rs`: LaTeX to MathML. `rewrite.rs`, `links.rs`: links and their check.
//! - `summary.rs`, `site.rs`: mdBook as a library.

#![allow(non_snake_case)]

pub mod bad_input;
pub mod commands;
mod drawn;
pub mod error;
pub mod formats;
mod library;
pub mod links;
pub mod math;
pub mod pages;
pub mod repository;
pub mod results;
pub mod rewrite;
pub mod site;
pub mod summary;
pub mod trees;
pub mod validation;
mod verdicts;

pub use error::BookError;
