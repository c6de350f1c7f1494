//! The result in one sentence of at most twenty words, and the next action, for terminal and page.

use crate::templates::TEMPLATES;
use minijinja::{Value, context};
use poinsot_figures::half_width;
use poinsot_formats::{BodyFile, EstimateFile, NumberFile, UndeterminedFile};
use std::ops::Range;

/// The result with its numbers.
pub(crate) fn sentence(e: &EstimateFile) -> String {
    let asked: Vec<&BodyFile> = e.bodies.values().filter(|b| b.is_asked()).collect();
    let kinds = [
        ("mass", "kg", 0..1),
        ("mass centre", "m", 1..4),
        ("inertia", "kg m2", 4..10),
    ];
    let kind = |(name, unit, places): (&str, &str, Range<usize>)| {
        let all = asked
            .iter()
            .flat_map(|b| b.numbers().drain(places.clone()).collect::<Vec<_>>());
        let asked: Vec<NumberFile> = all.map(|n| n.2).filter(|n| !n.is_known()).collect();
        let half: Option<Vec<f64>> = asked.iter().map(|n| half_width(n.sigma)).collect();
        let widest = half.and_then(|all| all.into_iter().reduce(f64::max));
        let found = asked.iter().filter(|n| n.value.is_some()).count();
        context! { name, unit, widest, found, count => asked.len() }
    };
    let context = context! {
        kinds => kinds.map(kind),
        asked => asked.len(),
        chi2 => largest_chi2(e),
        doubted => !e.evidence_against().is_empty(),
        ..Value::from_serialize(e)
    };
    TEMPLATES.lines("sentence.txt", context).concat()
}

/// The next action; `None` if none is needed.
pub(crate) fn action(e: &EstimateFile) -> Option<String> {
    let first = |all: &[String]| all.first().cloned();
    let against = e.evidence_against();
    let found = match e.status.as_str() {
        "partial" | "not_identifiable" if against.is_empty() => {
            let open = &e.identifiability.not_identifiable;
            serves_most(open).map(|o| o.remedy.clone())
        }
        "rejected" => {
            let findings = e.diagnostics.iter().flat_map(|d| &d.findings);
            findings
                .map(|f| f.text.clone())
                .next()
                .or_else(|| first(&e.warnings))
                .map(|why| format!("correct the model or the telemetry: {why}"))
        }
        _ => (against.first()).map(|why| format!("explain the failed test first: {why}")),
    }?;
    let mut letters = found.trim().trim_end_matches('.').chars();
    let head = letters.next()?.to_uppercase();
    Some(format!("{head}{}.", letters.as_str()))
}

/// The direction whose remedy resolves most directions, the first if equal; numbers in brackets are ignored in the
/// comparison.
fn serves_most(open: &[UndeterminedFile]) -> Option<&UndeterminedFile> {
    let head = |o: &UndeterminedFile| o.remedy.split(" (").next().map(str::to_owned);
    let count = |o: &&UndeterminedFile| open.iter().filter(|p| head(p) == head(o)).count();
    open.iter().rev().max_by_key(count)
}

/// Largest chi-square per degree of freedom of a segment.
pub(crate) fn largest_chi2(e: &EstimateFile) -> f64 {
    let all = e.fit.iter().filter_map(|f| f.chi2_per_dof);
    all.fold(0.0, f64::max)
}
