//! The tests of this crate, linked as one binary: references against each other, and rules on all sources.
#![allow(clippy::unwrap_used, non_snake_case)]

mod examples;
mod floors;
mod imports;
mod momentum_of_trees;
mod pages;
mod supply_chain;
