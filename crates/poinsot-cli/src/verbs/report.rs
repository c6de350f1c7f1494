//! `poinsot report`

use super::{Outcome, formats, written};
use crate::arguments::Report;
use poinsot::write_report;

pub fn run(arguments: &Report) -> Outcome {
    let figures = formats(&arguments.figures)?;
    let paths = write_report(&arguments.result, &arguments.compare, &figures)?;
    written(&paths, arguments.print.json, arguments.print.quiet);
    Ok(0)
}
