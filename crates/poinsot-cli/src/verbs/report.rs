//! `poinsot report`

use super::Outcome;
use crate::arguments::Report;
use poinsot::write_report;

pub fn run(arguments: &Report) -> Outcome {
    let path = write_report(&arguments.folder)?;
    if !arguments.quiet {
        eprintln!("written: {}", path.display());
    }
    Ok(0)
}
