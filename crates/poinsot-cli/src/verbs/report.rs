//! `poinsot report`

use super::{Outcome, formats, written};
use crate::arguments::Report;
use poinsot::{write_figures, write_report};

pub fn run(arguments: &Report) -> Outcome {
    let mut paths = vec![write_report(&arguments.folder)?];
    let wanted = formats(&arguments.figures);
    if !wanted.is_empty() {
        paths.extend(write_figures(&arguments.folder, &wanted)?);
    }
    written(&paths, arguments.json, arguments.quiet);
    Ok(0)
}
