//! The HTML report, from `estimate.json` and `report_data.json`. One file and one template per section.

mod answer;
mod bodies;
mod data;
mod envelope;
mod export;
mod flown;
mod known;
mod lights;
mod morph;
mod numbers;
mod open;
mod picture;
mod placed;
mod poles;
mod provenance;
mod repairs;
mod results;
mod tensor;
mod trust;
mod truth;
mod vehicle;

pub use data::{REPORT_SCHEMA, ReportData, TrueNumbers, report_data};
pub use results::design_document;

use crate::compare::{CompareRequest, compare, comparison_document, format_error};
use crate::error::{Error, no_page, unreadable};
use crate::written::{OutputFile, write_files};
use poinsot_files::read;
use poinsot_formats::{EstimateFile, LARGEST_RESULT, parse_estimate};
use poinsot_report::{FigureFormat, Page, PageError, Part};
use results::{NAMES, result_page};
use std::path::{Path, PathBuf};
use truth::Truth;

/// Input of every section.
pub(crate) struct Answer {
    pub estimate: EstimateFile,
    pub data: ReportData,
    pub truth: Truth,
}

/// Writes `report.html` next to a result: a folder of `identify`, compared with `earlier` results, or a file or folder
/// of another command. Also writes every figure into the folder `figures` in each given format. Writes all files or
/// none. Returns their paths.
///
/// # Errors
/// A file is missing, has another format, or belongs to another run.
pub fn write_report(
    result: &Path,
    earlier: &[PathBuf],
    figures: &[FigureFormat],
) -> Result<Vec<PathBuf>, Error> {
    let bytes = |path: &Path| read(path, LARGEST_RESULT).map_err(|e| unreadable(path, e));
    let inside = |name: &str| result.join(name);
    let of_other = || NAMES.into_iter().map(inside).find(|path| path.is_file());
    let file = match (result.is_dir(), inside("estimate.json").is_file()) {
        (true, true) => None,
        (true, false) => of_other(),
        (false, _) if result.file_name().is_some_and(|n| n == "estimate.json") => None,
        (false, _) => result.is_file().then(|| result.to_owned()),
    };
    let folder = match result.is_dir() || !result.is_file() {
        true => result,
        false => result.parent().unwrap_or(Path::new("")),
    };
    let mut page = match &file {
        Some(path) => result_page(path, &bytes(path)?)?,
        None => page_of(
            folder,
            &bytes(&folder.join("estimate.json"))?,
            &bytes(&folder.join("report_data.json"))?,
        )?,
    };
    let fault = |e: PageError| Error::Report {
        path: folder.to_owned(),
        why: no_page(&e),
    };
    if !earlier.is_empty() {
        let this = std::iter::once(folder.to_owned());
        let answers = earlier.iter().cloned().chain(this).collect();
        let found = compare(&CompareRequest { answers })?;
        let document = comparison_document(&found);
        let about = document.verdict.as_str();
        page.parts
            .push(Part::of_document("comparison", "Comparison", about, &document).map_err(fault)?);
    }
    let html = page.html().map_err(fault)?;
    let mut files = vec![("report.html".into(), html.into_bytes())];
    files.extend(figure_files(folder, &page, figures)?);
    write_files(folder, &files)
}

/// The page for the two files of `identify`, as bytes.
pub(crate) fn page_of(folder: &Path, estimate: &[u8], data: &[u8]) -> Result<Page, Error> {
    let estimate = parse_estimate(&folder.join("estimate.json"), estimate).map_err(format_error)?;
    let data: ReportData = parse(&folder.join("report_data.json"), data)?;
    report_page(estimate, data).map_err(|why| Error::Report {
        path: folder.to_owned(),
        why,
    })
}

fn parse<T: serde::de::DeserializeOwned>(path: &Path, bytes: &[u8]) -> Result<T, Error> {
    serde_json::from_slice(bytes).map_err(|e| Error::Report {
        path: path.to_owned(),
        why: format!("{e}; write it again with `poinsot identify`"),
    })
}

/// Every figure of the page as separate files: SVG, PNG or both.
pub(crate) fn figure_files(
    folder: &Path,
    page: &Page,
    formats: &[FigureFormat],
) -> Result<Vec<OutputFile>, Error> {
    let fault = |e: &PageError| Error::Report {
        path: folder.to_owned(),
        why: no_page(e),
    };
    let mut files = Vec::new();
    for figure in page.parts.iter().flat_map(|p| &p.figures) {
        for format in formats {
            let bytes = figure.file(*format).map_err(|e| fault(&e))?;
            let name = format!("{}.{}", figure.name, format.extension());
            files.extend(bytes.map(|b| (Path::new("figures").join(name), b)));
        }
    }
    Ok(files)
}

/// The page as HTML text.
///
/// # Errors
/// The documents have another format or do not match.
pub fn report_html(estimate: EstimateFile, data: ReportData) -> Result<String, String> {
    report_page(estimate, data)?
        .html()
        .map_err(|e| e.to_string())
}

/// The page with its figures.
///
/// # Errors
/// As [`report_html`].
pub fn report_page(estimate: EstimateFile, data: ReportData) -> Result<Page, String> {
    if data.schema != REPORT_SCHEMA {
        return Err(format!(
            "schema '{}' is not {REPORT_SCHEMA}; write it again with `poinsot identify`",
            data.schema
        ));
    }
    if !estimate.inputs.iter().map(|i| &i.sha256).eq(&data.inputs) {
        let why = "estimate.json and report_data.json come from different runs; run identify again";
        return Err(why.to_owned());
    }
    let truth = Truth::new(data.truth.clone());
    let answer = Answer {
        estimate,
        data,
        truth,
    };
    page(&answer).map_err(|e| no_page(&e))
}

fn page(answer: &Answer) -> Result<Page, PageError> {
    let e = &answer.estimate;
    let mut parts = vec![answer::part(answer)?, picture::part(answer)?];
    parts.extend(open::part(answer)?);
    parts.extend([
        bodies::part(answer)?,
        trust::part(answer)?,
        flown::part(answer)?,
        known::part(answer)?,
        provenance::part(answer)?,
    ]);
    Ok(Page {
        title: format!("Mass properties of {}", e.model),
        subtitle: format!("Identified from telemetry by poinsot {}.", e.poinsot),
        footer: "Inertia: tensor elements (I xy = -∫ x y dm) about the body's mass centre, in body axes. A 95 % interval contains the true value with 95 % probability if the declared noise and the rigid model are correct. This file needs no network."
            .to_owned(),
        parts,
    })
}
