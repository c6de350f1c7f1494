//! `poinsot simulate`

use super::Outcome;
use crate::arguments::Simulate;

pub fn run(arguments: &Simulate) -> Outcome {
    let _ = arguments;
    Ok(0)
}
