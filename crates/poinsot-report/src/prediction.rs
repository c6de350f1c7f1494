//! A prediction as text: one sentence, then the numbers.

use crate::estimate::open_sentences;
use poinsot_figures::{Document, Section, Table, Tone};
use poinsot_files::significant;
use poinsot_formats::{
    AgainstDurationFile, HALF_WIDTH_95, IdentifiabilityFile, MassFile, PredictedNumberFile,
    PredictionFile, WantedFile,
};

/// Number of combinations listed in the terminal; the file has all.
const LISTED: usize = 12;
/// Significant figures of a predicted sigma.
pub(crate) const FIGURES: i32 = 2;

/// The prediction as a document.
///
/// ```
/// use poinsot_formats::PredictionFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/prediction.json"));
/// let prediction: PredictionFile = serde_json::from_str(text)?;
/// let document = poinsot_report::prediction_document(&prediction);
/// assert!(document.verdict.contains("box"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prediction_document(prediction: &PredictionFile) -> Document {
    let mut document = accuracy(prediction);
    let found = &prediction.identifiability;
    if !found.not_identifiable.is_empty() {
        document.push(Section::list(
            "not identifiable from this manoeuvre",
            open_sentences(&found.not_identifiable),
        ));
        document.push(instead(found));
    }
    document
}

/// The document without undetermined numbers.
pub(crate) fn accuracy(prediction: &PredictionFile) -> Document {
    let enough = match prediction.wants.is_empty() {
        true => prediction.status == "converged",
        false => prediction.wants.iter().all(|w| w.met),
    };
    let tone = if enough { Tone::Good } else { Tone::Fair };
    let mut document = Document::new(prediction.in_words.clone()).toned(tone);
    if !prediction.wants.is_empty() {
        document.push(wanted(&prediction.wants));
    }
    for (name, body) in prediction.bodies.iter().filter(|b| is_shown(b.1)) {
        document.push(body_section(name, body));
    }
    if let Some(whole) = prediction.system.as_ref().filter(|b| is_shown(b)) {
        let mut section = body_section("", whole);
        section.title =
            "whole vehicle at the first sample (base axes, from the base origin)".to_owned();
        document.push(section);
    }
    if !prediction.nuisance.is_empty() {
        let mut table = Table::new(&["", "1 sigma"]);
        for (address, number) in &prediction.nuisance {
            table.push(vec![address.clone(), sigma_text(number)]);
        }
        document.push(Section::table("also found", table));
    }
    if let Some(found) = &prediction.against_duration {
        document.push(durations(found));
    }
    if !prediction.assumptions.is_empty() {
        document.push(Section::list("assumed", prediction.assumptions.clone()));
    }
    document
}

/// Table of the peaks of the motion.
pub(crate) fn peaks(prediction: &PredictionFile) -> Section {
    let mut table = Table::new(&["", "largest", "unit"]);
    for p in &prediction.peaks {
        table.push(vec![
            p.what.clone(),
            significant(p.value, 3),
            p.unit.clone(),
        ]);
    }
    Section::table("largest values at the samples", table)
}

/// Number of record ends shown in a table; the page has all.
const QUARTERS: usize = 4;

/// Sigmas for shorter records, one row per number.
pub(crate) fn durations(found: &AgainstDurationFile) -> Section {
    let ends = found.end_s.len();
    let shown: Vec<usize> = (1..=QUARTERS)
        .filter_map(|q| (q * ends / QUARTERS).checked_sub(1))
        .collect();
    let names: Vec<String> = shown
        .iter()
        .map(|k| format!("{} s", significant(found.end_s[*k], 4)))
        .collect();
    let mut header = vec![""];
    header.extend(names.iter().map(String::as_str));
    header.push("unit");
    let mut table = Table::new(&header);
    for n in &found.numbers {
        let sigma =
            |k: &usize| n.sigma[*k].map_or_else(|| "-".to_owned(), |s| significant(s, FIGURES));
        let mut row = vec![n.name.clone()];
        row.extend(shown.iter().map(sigma));
        row.push(n.unit.clone());
        table.push(row);
    }
    Section::table("1 sigma with the record ended earlier", table)
}

fn wanted(wants: &[WantedFile]) -> Section {
    let mut table = Table::new(&["", "1 sigma", "wanted", "verdict", "unit"]);
    for w in wants {
        let sigma = w.sigma.map(|s| significant(s, FIGURES));
        table.push(vec![
            w.name.clone(),
            sigma.unwrap_or_else(|| "not identifiable".to_owned()),
            significant(w.wanted_sigma, FIGURES),
            if w.met { "met" } else { "missed" }.to_owned(),
            w.unit.clone(),
        ]);
    }
    Section::table("wanted", table)
}

/// Determined combinations, if single numbers are not determined.
fn instead(found: &IdentifiabilityFile) -> Section {
    let mut table = Table::new(&["combination", "1 sigma", "unit"]);
    for c in found.identifiable.iter().take(LISTED) {
        let sigma = c.sigma.map(|s| significant(s, FIGURES));
        table.push(vec![
            c.combination.clone(),
            sigma.unwrap_or_default(),
            c.unit.clone(),
        ]);
    }
    let mut section = Section::table("identifiable combinations", table);
    if found.identifiable.len() > LISTED {
        section.note = Some(format!(
            "and {} more combinations with --json",
            found.identifiable.len() - LISTED
        ));
    }
    section
}

/// Whether any single number of a body will be determined.
pub(crate) fn is_shown(body: &MassFile<PredictedNumberFile>) -> bool {
    body.numbers()
        .iter()
        .any(|n| predicted_sigma(&n.2).is_some())
}

pub(crate) fn predicted_sigma(n: &PredictedNumberFile) -> Option<f64> {
    n.sigma.filter(|_| n.source.is_some() && !n.is_known())
}

fn sigma_text(n: &PredictedNumberFile) -> String {
    match (n.source.as_deref(), n.sigma) {
        (Some("known"), _) => "known".to_owned(),
        (None, _) => "not identifiable".to_owned(),
        (_, sigma) => sigma.map_or_else(String::new, |s| significant(s, FIGURES)),
    }
}

fn body_section(name: &str, body: &MassFile<PredictedNumberFile>) -> Section {
    let mut table = Table::new(&["", "truth", "1 sigma", "95 %", "relative", "unit"]);
    for (number, unit, n) in body.numbers() {
        let s = predicted_sigma(&n);
        let of_all = |s: f64| format!("{} %", significant(100.0 * s / n.nominal.abs(), FIGURES));
        table.push(vec![
            number.replace(' ', "_"),
            significant(n.nominal, 6),
            sigma_text(&n),
            s.map_or_else(String::new, |s| {
                format!("+- {}", significant(HALF_WIDTH_95 * s, FIGURES))
            }),
            s.filter(|_| n.nominal != 0.0)
                .map_or_else(String::new, of_all),
            unit.replace('²', "2"),
        ]);
    }
    Section::table(
        &format!("{name} (inertia about its mass centre, tensor elements)"),
        table,
    )
}
