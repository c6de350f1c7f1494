//! Sensitivity of the estimate to known numbers.

use super::Answer;
use minijinja::{Value, context};
use poinsot_figures::{PageError, Part, render};
use poinsot_files::significant;

/// Number of known numbers listed; the result file has all.
const LISTED: usize = 40;

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let known = &answer.estimate.known_numbers;
    let rows: Vec<Value> = known
        .sensitivities
        .iter()
        .take(LISTED)
        .filter_map(|s| {
            let (most, share) = s.most_sensitive()?;
            Some(context! {
                number => s.number, unit => s.unit,
                value => significant(s.value, 5),
                sigma => significant(s.sigma, 2),
                estimate => s.estimate.map(|x| significant(x, 5)),
                most,
                change => s.change.get(most).map(|c| significant(*c, 2)),
                step => s.step,
                share => format!("{:.0} %", 100.0 * share),
            })
        })
        .collect();
    let body = render(
        "known.html",
        include_str!("templates/known.html"),
        context! {
            rows, exact => known.exact, assumed => known.source_assumed,
            more => known.sensitivities.len().saturating_sub(LISTED),
        },
    )?;
    Ok(Part {
        id: "known",
        title: "Sensitivity to known numbers",
        body,
        figures: Vec::new(),
    })
}
