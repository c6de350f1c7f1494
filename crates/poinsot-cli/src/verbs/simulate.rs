//! `poinsot simulate`

use super::{Failure, Outcome};
use crate::arguments::Simulate;
use poinsot::simulate::simulate;

pub fn run(arguments: &Simulate) -> Outcome {
    let written = simulate(&arguments.case, &arguments.out).map_err(Failure::from)?;
    if !arguments.quiet {
        eprintln!("written: {}", written.telemetry.display());
        eprintln!("written: {}", written.truth.display());
    }
    Ok(0)
}
