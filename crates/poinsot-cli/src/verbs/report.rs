//! `poinsot report`

use super::{Outcome, formats, written};
use crate::arguments::Report;
use poinsot::write_report;

pub fn run(arguments: &Report) -> Outcome {
    let paths = write_report(
        &arguments.result,
        &arguments.compare,
        &formats(&arguments.figures),
    )?;
    written(&paths, arguments.json, arguments.quiet);
    Ok(0)
}
