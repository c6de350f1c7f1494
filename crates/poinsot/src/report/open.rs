//! What the data cannot tell: what to do about it, which directions are open, and what is determined instead.

use super::Answer;
use super::numbers::{plus_minus, value};
use indexmap::IndexMap;
use minijinja::{Value, context};
use poinsot_report::{PageError, Part, render, significant};

/// Combinations listed; the result file has all.
const LISTED: usize = 80;
/// Remedies shown before the fold.
const SHOWN: usize = 6;
/// Terms of a combination that are typeset; the rest are counted.
const TERMS: usize = 8;
/// Coefficients nearer to one than this are not written; terms smaller than it, of the largest, neither.
const SMALL: f64 = 1.0e-3;

pub(super) fn part(answer: &Answer) -> Result<Option<Part>, PageError> {
    let e = &answer.estimate;
    let i = &e.identifiability;
    if i.not_identifiable.is_empty() || e.is_withheld() {
        return Ok(None);
    }
    let several = e.bodies.len() > 1;
    // One remedy often serves many directions: one row for them.
    let mut remedies: IndexMap<(&str, &str), Vec<Value>> = IndexMap::new();
    for open in &i.not_identifiable {
        let key = (without_detail(&open.remedy), without_detail(&open.reason));
        let row = remedies.entry(key).or_default();
        row.push(algebra(&open.coefficients, several));
    }
    let rows: Vec<Value> = remedies
        .into_iter()
        .map(|((remedy, reason), directions)| context! { remedy, reason, directions })
        .collect();
    let determined: Vec<Value> = i
        .identifiable
        .iter()
        .take(LISTED)
        .map(|c| {
            context! { terms => algebra(&c.coefficients, several), value => value(c.value, c.sigma), half => plus_minus(c.sigma), unit => c.unit.replace("m2", "m²") }
        })
        .collect();
    let body = render(
        "open.html",
        include_str!("templates/open.html"),
        context! {
            rows => rows.get(..SHOWN.min(rows.len())), rest => rows.get(SHOWN..), all => rows, determined,
            open => i.not_identifiable.len(),
            rank => i.rank,
            parameters => i.parameters,
            structural => (i.structural_rank != i.rank).then_some(i.structural_rank),
            more => i.identifiable.len().saturating_sub(LISTED),
        },
    )?;
    Ok(Some(Part {
        id: "open",
        title: "What the data cannot tell",
        body,
        figures: Vec::new(),
    }))
}

/// A sentence without the figures in brackets at its end.
fn without_detail(text: &str) -> &str {
    match text
        .trim_end()
        .strip_suffix(')')
        .and_then(|t| t.rsplit_once(" ("))
    {
        Some((head, _)) => head,
        None => text,
    }
}

/// A combination as terms to typeset, largest first.
fn algebra(coefficients: &IndexMap<String, f64>, several: bool) -> Value {
    let mut terms: Vec<(&String, f64)> = coefficients.iter().map(|(n, k)| (n, *k)).collect();
    terms.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let largest = terms.first().map_or(0.0, |t| t.1.abs());
    terms.retain(|t| t.1.abs() >= SMALL * largest);
    let shown: Vec<Value> = terms
        .iter()
        .take(TERMS)
        .enumerate()
        .map(|(at, (name, k))| {
            let (body, symbol) = name.rsplit_once('.').unwrap_or(("", name));
            let (letter, index) = symbol.split_once('_').unwrap_or((symbol, ""));
            // About the mass centre is the usual point; the frame origin is named.
            let index = index.replace("BBcm_", "").replace("BBo_", "Bo ");
            let factor = (k.abs() - 1.0).abs() >= SMALL;
            context! {
                sign => match (at, *k < 0.0) { (0, false) => "", (0, true) => "-", (_, false) => " + ", (_, true) => " - " },
                factor => factor.then(|| significant(k.abs(), 3)),
                letter, index,
                body => several.then_some(body),
            }
        })
        .collect();
    context! { shown, more => terms.len().saturating_sub(TERMS) }
}
