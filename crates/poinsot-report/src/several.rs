//! Comparison of several cases.

use crate::prediction::predicted_sigma;
use crate::templates::TEMPLATES;
use indexmap::IndexMap;
use minijinja::{Value, context};
use poinsot_figures::{Document, Tone};
use poinsot_formats::{PredictionFile, ValueFile};
use serde::Serialize;
use std::path::Path;

/// A number of every case; a case that does not have it has an empty cell.
#[derive(Serialize)]
struct Row {
    unit: String,
    values: Vec<Value>,
}

/// Sigmas of several cases in one table: of their wanted numbers, or of every number that one of them determines. Also
/// the peaks of their motions.
///
/// ```
/// use poinsot_formats::{PredictionFile, ValueFile};
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
    let ratios = predictions.iter().map(worst_ratio).enumerate();
    let best = ratios
        .filter_map(|(case, ratio)| Some((case, ratio?)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(case, ratio)| context! { case, ratio });
    let table = |title: &str, cells: fn(&PredictionFile) -> Vec<ValueFile>| {
        let columns: Vec<Vec<ValueFile>> = predictions.iter().map(cells).collect();
        context! { title, rows => rows(&columns) }
    };
    let tables = [table("1 sigma", sigmas), table("largest values", peaks)];
    let met = predictions.iter().all(|p| p.wants.iter().all(|w| w.met));
    let document = TEMPLATES.document("several.txt", context! { names, best, tables });
    document.toned(if met { Tone::Good } else { Tone::Fair })
}

/// Rows by name, in order of first appearance.
fn rows(columns: &[Vec<ValueFile>]) -> IndexMap<&str, Row> {
    let mut rows: IndexMap<&str, Row> = IndexMap::new();
    for (k, cell) in columns
        .iter()
        .enumerate()
        .flat_map(|(k, c)| c.iter().map(move |c| (k, c)))
    {
        let row = rows.entry(&cell.name).or_insert_with(|| Row {
            unit: cell.unit.clone(),
            values: vec![Value::UNDEFINED; columns.len()],
        });
        row.values[k] = Value::from(cell.value);
    }
    rows
}

fn peaks(p: &PredictionFile) -> Vec<ValueFile> {
    let peaks = p.peaks.iter();
    peaks
        .map(|x| ValueFile {
            name: x.what.clone(),
            unit: x.unit.clone(),
            value: Some(x.value),
        })
        .collect()
}

fn sigmas(p: &PredictionFile) -> Vec<ValueFile> {
    let wants = p.wants.iter().map(|w| ValueFile {
        name: w.name.clone(),
        unit: w.unit.clone(),
        value: w.sigma,
    });
    let numbers = p.bodies.iter().flat_map(|(body, mass)| {
        let cell = move |(name, unit, n): (String, &str, _)| ValueFile {
            name: format!("{body} {name}"),
            unit: unit.to_owned(),
            value: predicted_sigma(&n),
        };
        mass.numbers().into_iter().map(cell)
    });
    match p.wants.is_empty() {
        true => numbers.collect(),
        false => wants.collect(),
    }
}

/// Largest ratio of sigma to wanted sigma.
fn worst_ratio(p: &PredictionFile) -> Option<f64> {
    let ratios = p.wants.iter().map(|w| w.sigma.map(|s| s / w.wanted_sigma));
    let ratios: Option<Vec<f64>> = ratios.collect();
    ratios?.into_iter().reduce(f64::max)
}
