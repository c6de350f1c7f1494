//! `poinsot compare`

use super::{Outcome, exit_of, print_document, print_result, shown};
use crate::arguments::Compare;
use poinsot::compare::compare;
use poinsot_report::comparison_document;

pub fn run(arguments: &Compare) -> Outcome {
    let comparison = compare(&arguments.answers)?;
    shown(
        &arguments.print,
        || print_result(&comparison),
        || print_document(&comparison_document(&comparison)),
    );
    Ok(exit_of(comparison.passes()))
}
