//! `poinsot report`

use super::{Outcome, formats, written};
use crate::arguments::Report;
use poinsot::write_report;

pub fn run(arguments: &Report) -> Outcome {
    let paths = write_report(
        &arguments.result,
        &arguments.compare,
        &formats(&arguments.figures)?,
    )?;
    written(&paths, arguments.print.json, arguments.print.quiet);
    Ok(0)
}
