//! Comparison of several cases.

use crate::prediction::{FIGURES, predicted_sigma};
use poinsot_figures::{Document, Section, Table, Tone};
use poinsot_files::significant;
use poinsot_formats::PredictionFile;
use std::path::Path;

/// Sigmas of several cases in one table: of their wanted numbers, or of every number that one of them determines. Also
/// the peaks of their motions.
///
/// ```
/// use poinsot_formats::PredictionFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/prediction.json"));
/// let short: PredictionFile = serde_json::from_str(text)?;
/// let long = PredictionFile { case: "long.toml".to_owned(), ..short.clone() };
/// let document = poinsot_report::several_document(&[short, long]);
/// assert!(!document.sections.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn several_document(predictions: &[PredictionFile]) -> Document {
    let name = |p: &PredictionFile| {
        let stem = Path::new(&p.case).file_stem();
        stem.map_or_else(|| p.case.clone(), |s| s.to_string_lossy().into_owned())
    };
    let names: Vec<String> = predictions.iter().map(name).collect();
    let all = predictions.iter().map(sigmas).collect();
    let worst = predictions.iter().map(worst_ratio);
    let best = worst
        .enumerate()
        .filter_map(|(k, ratio)| Some((k, ratio?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let verdict = match best {
        Some((k, ratio)) => format!(
            "{} is the most accurate of {} cases: its largest sigma is {} of the wanted one.",
            names[k],
            names.len(),
            significant(ratio, 3)
        ),
        None => format!("{} cases side by side.", names.len()),
    };
    let met = predictions.iter().all(|p| p.wants.iter().all(|w| w.met));
    let mut document = Document::new(verdict).toned(if met { Tone::Good } else { Tone::Fair });
    document.push(table("1 sigma", &names, all));
    let peaks = |p: &PredictionFile| {
        let peak = |x: &poinsot_formats::PeakFile| (x.what.clone(), x.unit.clone(), Some(x.value));
        p.peaks.iter().map(peak).collect()
    };
    let peaks = predictions.iter().map(peaks).collect();
    document.push(table("largest values", &names, peaks));
    document
}

type Row = (String, String, Option<f64>);

/// Rows by name, in order of first appearance.
fn table(title: &str, names: &[String], columns: Vec<Vec<Row>>) -> Section {
    let mut header: Vec<&str> = vec![""];
    header.extend(names.iter().map(String::as_str));
    header.push("unit");
    let mut rows: Vec<(&str, &str)> = Vec::new();
    for (name, unit, _) in columns.iter().flatten() {
        if !rows.iter().any(|r| r.0 == name) {
            rows.push((name, unit));
        }
    }
    let mut table = Table::new(&header);
    for (name, unit) in rows {
        let mut row = vec![name.to_owned()];
        for column in &columns {
            let value = column.iter().find(|r| r.0 == name);
            row.push(match value.map(|r| r.2) {
                None => String::new(),
                Some(None) => "not identifiable".to_owned(),
                Some(Some(x)) => significant(x, FIGURES),
            });
        }
        row.push(unit.to_owned());
        table.push(row);
    }
    Section::table(title, table)
}

fn sigmas(p: &PredictionFile) -> Vec<Row> {
    if !p.wants.is_empty() {
        let wants = p.wants.iter();
        return wants
            .map(|w| (w.name.clone(), w.unit.clone(), w.sigma))
            .collect();
    }
    let bodies = p.bodies.iter();
    bodies
        .flat_map(|(body, mass)| {
            let of = move |(name, unit, n): (String, &str, _)| {
                (
                    format!("{body} {name}"),
                    unit.to_owned(),
                    predicted_sigma(&n),
                )
            };
            mass.numbers().into_iter().map(of)
        })
        .collect()
}

/// Largest ratio of sigma to wanted sigma.
fn worst_ratio(p: &PredictionFile) -> Option<f64> {
    let ratios: Option<Vec<f64>> = p
        .wants
        .iter()
        .map(|w| w.sigma.map(|s| s / w.wanted_sigma))
        .collect();
    ratios?.into_iter().reduce(f64::max)
}
