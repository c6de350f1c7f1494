//! Undetermined numbers: remedies, unobservable directions, and determined combinations.

use super::Answer;
use crate::templates::TEMPLATES;
use indexmap::IndexMap;
use minijinja::{Value, context};
use poinsot_figures::{PageError, Part};
use poinsot_formats::{IdentifiabilityFile, UndeterminedFile, unknown_name};
use std::collections::BTreeSet;

/// Number of combinations listed; the result file has all.
const LISTED: usize = 80;
/// Number of remedies not folded.
const SHOWN: usize = 6;
/// Number of typeset terms of a combination; the rest is counted.
const TERMS: usize = 8;
/// Largest number of parameters as table columns.
const COLUMNS: usize = 12;
/// Number of cell shades above the lightest.
const SHADES: f64 = 4.0;
/// Smaller terms, relative to the largest, are dropped.
const SMALL: f64 = 1.0e-3;

pub(super) fn part(answer: &Answer) -> Result<Option<Part>, PageError> {
    let e = &answer.estimate;
    match e.is_withheld() {
        true => Ok(None),
        false => of(&e.identifiability, e.bodies.len() > 1),
    }
}

/// The section for any result; with `several` bodies, the body is named for each parameter.
pub(super) fn of(i: &IdentifiabilityFile, several: bool) -> Result<Option<Part>, PageError> {
    if i.not_identifiable.is_empty() {
        return Ok(None);
    }
    // One row per remedy, which often resolves several directions.
    let mut remedies: IndexMap<&str, (&str, Vec<&str>, Vec<Value>)> = IndexMap::new();
    for open in &i.not_identifiable {
        let (remedy, then) = without_detail(&open.remedy);
        let (reason, _) = without_detail(&open.reason);
        let row = remedies.entry(remedy).or_default();
        row.0 = then;
        if !row.1.contains(&reason) {
            row.1.push(reason);
        }
        row.2.push(algebra(&open.coefficients, several));
    }
    // The remedy that resolves most directions comes first.
    remedies.sort_by(|_, a, _, b| b.2.len().cmp(&a.2.len()));
    let rows: Vec<Value> = remedies
        .into_iter()
        .map(|(remedy, (then, reasons, directions))| {
            let reason = reasons.join("; ");
            context! { remedy, reason, then => then.strip_prefix("then ").unwrap_or(then), directions }
        })
        .collect();
    let determined = i.identifiable.iter().take(LISTED);
    let determined = determined.map(|c| {
        let terms = algebra(&c.coefficients, several);
        context! { terms, value => c.value, sigma => c.sigma, unit => c.unit }
    });
    let determined: Vec<Value> = determined.collect();
    let body = TEMPLATES.html(
        "open.html",
        context! {
            matrix => matrix(&i.not_identifiable, several),
            rows => rows.get(..SHOWN.min(rows.len())), rest => rows.get(SHOWN..), all => rows, determined,
            open => i.not_identifiable.len(),
            rank => i.rank,
            parameters => i.parameters,
            structural => (i.structural_rank != i.rank).then_some(i.structural_rank),
            more => i.identifiable.len().saturating_sub(LISTED),
        },
    )?;
    Ok(Some(Part::new(
        "open",
        "Not identifiable from the data",
        body,
    )))
}

/// Splits a sentence from the numbers in brackets at its end.
fn without_detail(text: &str) -> (&str, &str) {
    let open = text.trim_end().strip_suffix(')');
    open.and_then(|t| t.rsplit_once(" (")).unwrap_or((text, ""))
}

/// Typeset terms of a combination, largest first.
fn algebra(coefficients: &IndexMap<String, f64>, several: bool) -> Value {
    let mut terms: Vec<(&String, f64)> = coefficients.iter().map(|(n, k)| (n, *k)).collect();
    terms.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let largest = terms.first().map_or(0.0, |t| t.1.abs());
    terms.retain(|t| t.1.abs() >= SMALL * largest);
    let shown = terms.iter().take(TERMS);
    let shown: Vec<Value> = shown.map(|(name, k)| term(*k, name, several)).collect();
    context! { shown, more => terms.len().saturating_sub(TERMS) }
}

/// A typeset parameter with its coefficient.
fn term(coefficient: f64, address: &str, several: bool) -> Value {
    let name = unknown_name(address);
    let (body, symbol) = name.rsplit_once('.').unwrap_or(("", &name));
    let (letter, index) = symbol.split_once('_').unwrap_or((symbol, ""));
    // The mass centre is the default point; the frame origin is named.
    let index = index.replace("BBcm_", "").replace("BBo_", "Bo ");
    context! {
        coefficient, letter, index,
        body => several.then_some(body),
    }
}

/// Unobservable directions as rows over parameters: each coefficient relative to the largest of the row. `None` with
/// too many parameters for a page.
fn matrix(open: &[UndeterminedFile], several: bool) -> Option<Value> {
    let names = open.iter().flat_map(|o| o.coefficients.keys());
    let names: BTreeSet<&String> = names.collect();
    let row = |o: &UndeterminedFile| {
        let largest = o
            .coefficients
            .values()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        let cells = names.iter().map(|name| {
            let share = o.coefficients.get(*name).map_or(0.0, |k| k / largest);
            let shown = share.abs() >= SMALL;
            let class = format!("s{}", (share.abs() * SHADES).round());
            context! { class => shown.then_some(class), share => shown.then_some(share) }
        });
        let cells: Vec<Value> = cells.collect();
        context! { name => algebra(&o.coefficients, several), cells }
    };
    let head: Vec<Value> = names
        .iter()
        .map(|name| context! { shown => [term(1.0, name, several)] })
        .collect();
    let rows: Vec<Value> = open.iter().map(row).collect();
    (names.len() <= COLUMNS).then(|| context! { head, rows })
}
