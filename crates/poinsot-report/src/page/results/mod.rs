//! Pages for the results of `validate`, `predict`, `compare`, `design` and `campaign`: the layout of `identify` with
//! their own sections.

mod campaign;
mod comparison;
mod curves;
mod design;
mod prediction;
mod validation;

pub use campaign::campaign_page;

use super::lights::light;
use super::vehicle::Flown;
use super::{no_page, open, parse};
use indexmap::IndexMap;
use poinsot_figures::{
    Axis, Document, Figure, Light, Mark, Opening, Page, PageError, Part, Plot, Section, Series,
    Tone,
};
use poinsot_formats::{IdentifiabilityFile, check_files, checksum};
use serde::Deserialize;
use std::path::Path;

/// File names of results in a folder, in order of search.
pub const RESULTS: [&str; 5] = [
    "validation.json",
    "prediction.json",
    "comparison.json",
    "design.json",
    "campaign.json",
];

/// Largest number of rows of the figure on the first screen.
const ROWS: usize = 24;
/// Ratio of largest to smallest value above which the axis is logarithmic.
const DECADE: f64 = 10.0;

/// Content of a result page.
#[derive(Default)]
struct Shown {
    title: String,
    /// Version of the program that wrote it.
    poinsot: String,
    opening: Opening,
    /// Figure next to the verdict.
    beside: Option<Figure>,
    document: Document,
    /// Section of curves, with its title.
    curves: (&'static str, Vec<Figure>),
    /// Undetermined combinations.
    open: Option<IdentifiabilityFile>,
    /// Whether the vehicle has several bodies.
    several: bool,
    /// Inputs: kind and path.
    inputs: Vec<(&'static str, String)>,
}

/// Fields common to all result files.
#[derive(Deserialize)]
struct Named {
    schema: String,
    #[serde(default)]
    files: IndexMap<String, String>,
}

/// The page of a result file.
///
/// `flown` gives the vehicle as it flies the case of a design next to the result.
///
/// # Errors
/// The format has no page, or the file is damaged.
///
/// ```
/// use poinsot_report::result_page;
///
/// let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/prediction.json"));
/// let page = result_page("prediction.json".as_ref(), bytes, |_| None)?;
/// assert!(page.html()?.contains("box"));
/// // A file without a page.
/// assert!(result_page("other.json".as_ref(), br#"{"schema": "other"}"#, |_| None).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn result_page(
    path: &Path,
    bytes: &[u8],
    flown: impl FnOnce(&Path) -> Option<Flown>,
) -> Result<Page, String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let named: Named = serde_json::from_slice(bytes).map_err(|e| e.to_string())?;
    check_files(folder, &named.files)?;
    let kind = named.schema.split('/').next().unwrap_or_default();
    let page = match kind {
        "poinsot.validation" => page(validation::result(&parse(bytes)?, folder)?),
        "poinsot.prediction" => page(prediction::result(&parse(bytes)?)),
        "poinsot.comparison" => page(comparison::result(&parse(bytes)?)),
        "poinsot.design" => page(design::result(&parse(bytes)?, folder, flown(folder))?),
        "poinsot.campaign" => campaign_page(&parse(bytes)?),
        _ => {
            return Err(format!(
                "a file of schema '{}' has no page; give the folder of identify --out, or one of {}",
                named.schema,
                RESULTS.join(", ")
            ));
        }
    };
    let mut page = page.map_err(|e| no_page(&e))?;
    let text = std::str::from_utf8(bytes).unwrap_or_default();
    if checksum(text).is_none() {
        let warning = format!("Unchecked: {} has no checksum. ", named.schema);
        page.subtitle.insert_str(0, &warning);
    }
    Ok(page)
}

fn page(shown: Shown) -> Result<Page, PageError> {
    let mut opening = shown.opening;
    if let Some(figure) = &shown.beside {
        opening.beside = figure.html()?;
    }
    let mut parts = vec![opening.part()?];
    parts[0].figures.extend(shown.beside);
    let (title, figures) = shown.curves;
    if !figures.is_empty() {
        let body = Figure::page(&figures)?;
        parts.push(Part::new("curves", title, body).with_figures(figures));
    }
    if let Some(found) = shown.open {
        parts.extend(open::of(&found, shown.several)?);
    }
    let sections = shown.document.sections.into_iter();
    let (tables, notes): (Vec<Section>, Vec<Section>) = sections.partition(|s| !s.rows.is_empty());
    for (id, title, sections) in [("numbers", "Numbers", tables), ("notes", "Notes", notes)] {
        if !sections.is_empty() {
            parts.push(Part::of_sections(id, title, "", &sections)?);
        }
    }
    let input = |(kind, path): (&str, String)| vec![kind.to_owned(), path];
    let from = Section {
        title: "made from".to_owned(),
        head: ["input", "file"].map(str::to_owned).to_vec(),
        rows: shown.inputs.into_iter().map(input).collect(),
        ..Section::default()
    };
    parts.push(Part::of_sections("provenance", "Provenance", "", &[from])?);
    Ok(Page {
        title: shown.title,
        subtitle: format!("Computed by poinsot {}.", shown.poinsot),
        footer: "This file needs no network.".to_owned(),
        parts,
    })
}

/// Values at 1, 2, 3 ...; `None` without a finite one.
fn points(name: &str, colour: usize, values: impl Iterator<Item = f64>) -> Option<Series> {
    let at = (1..).map(f64::from).zip(values).filter(|p| p.1.is_finite());
    let (x, y): (Vec<f64>, Vec<f64>) = at.unzip();
    (!x.is_empty()).then(|| Series::new(name, Mark::Points, colour, &x, &y))
}

/// Ratios relative to one: marks of each kind, one position per row. `None` without a finite ratio.
fn ratio_figure<'a>(
    kinds: &[&str],
    rows: impl Iterator<Item = (&'a str, Vec<f64>)>,
) -> Option<Figure> {
    let rows: Vec<_> = rows.take(ROWS).collect();
    let kind = |(k, kind): (usize, &&str)| {
        let ratio = |row: &(&str, Vec<f64>)| row.1.get(k).copied().unwrap_or(f64::NAN);
        points(kind, k, rows.iter().map(ratio))
    };
    let series: Vec<Series> = kinds.iter().enumerate().filter_map(kind).collect();
    let all = series.iter().flat_map(|s| &s.points).map(|p| p.1);
    let ends = all.fold([1.0, 1.0], |e: [f64; 2], y| [e[0].min(y), e[1].max(y)]);
    let plot = Plot {
        title: "predicted sigma over wanted sigma".to_owned(),
        x: Axis::new("number", ""),
        y: Axis::new("ratio", ""),
        names: rows.iter().map(|row| row.0.to_owned()).collect(),
        log: ends[1] > DECADE * ends[0],
        levels: vec![(1.0, "wanted".to_owned())],
        half: true,
        ..Plot::default()
    };
    (!series.is_empty()).then(|| Figure::plot("wanted", Plot { series, ..plot }))
}

/// A question with yes or no.
fn asked(question: &'static str, holds: bool, found: String) -> Light {
    let (tone, word) = match holds {
        true => (Tone::Good, "yes"),
        false => (Tone::Bad, "no"),
    };
    light(question, "numbers", tone, word, found)
}
