//! `poinsot compare`

use super::{Outcome, ended};
use crate::arguments::Compare;
use poinsot::compare::compare;
use poinsot_report::comparison_document;

pub fn run(arguments: &Compare) -> Outcome {
    let comparison = compare(&arguments.answers)?;
    let end = (&[][..], comparison.passes());
    ended(&arguments.print, &comparison, comparison_document, end)
}
