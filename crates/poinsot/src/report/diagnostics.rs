//! The evidence for and against the fit, as a table under the fit.

use super::Answer;
use crate::diagnostics_file::rows;
use minijinja::{Value, context};
use poinsot_report::{PageError, render};

/// Nothing for a method that does not test its residuals.
pub(super) fn table(answer: &Answer) -> Result<poinsot_report::Html, PageError> {
    let rows: Vec<Value> = answer
        .estimate
        .diagnostics
        .iter()
        .flat_map(rows)
        .map(|[test, found, verdict]| {
            let tone = match verdict.as_str() {
                "as declared" | "white" | "none seen" => "good",
                "smaller than declared" | "" => "",
                _ => "fair",
            };
            context! { test, found, verdict, tone }
        })
        .collect();
    render(
        "diagnostics.html",
        include_str!("templates/diagnostics.html"),
        context! { rows },
    )
}
