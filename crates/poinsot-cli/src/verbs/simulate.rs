//! `poinsot simulate`

use super::{Outcome, written};
use crate::arguments::Simulate;
use poinsot::simulate::simulate;

pub fn run(arguments: &Simulate) -> Outcome {
    let made = simulate(&arguments.case, &arguments.out)?;
    written(
        &[made.telemetry, made.truth],
        arguments.print.json,
        arguments.print.quiet,
    );
    Ok(0)
}
