//! `poinsot simulate`

use super::{Outcome, written};
use crate::arguments::Simulate;
use poinsot::simulate::simulate;

pub fn run(arguments: &Simulate) -> Outcome {
    let made = simulate(&arguments.case, &arguments.out)?;
    let (print, paths) = (&arguments.print, [made.telemetry, made.truth]);
    written(&paths, print.json, print.quiet);
    Ok(0)
}
