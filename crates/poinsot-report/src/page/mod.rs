//! The page of every result, from its files. One file and one template per section.

mod answer;
mod bodies;
mod curves;
mod envelope;
mod export;
mod flown;
mod known;
pub(crate) mod lights;
mod open;
mod picture;
mod poles;
mod provenance;
mod results;
mod tensor;
mod trust;
mod vehicle;

pub use results::{RESULTS, campaign_page, result_page};
pub use vehicle::{Flown, Motion};

use crate::comparison::comparison_document;
use poinsot_figures::{Page, PageError, Part};
use poinsot_formats::{
    BodyFile, ComparisonFile, EstimateFile, REPORT_DATA, ReportData, ResultFile, parse_result,
};
use std::path::Path;

/// Name of the whole vehicle.
const WHOLE: &str = "whole vehicle, joints as at the first sample";

/// Input of every section.
pub(crate) struct Answer {
    pub estimate: EstimateFile,
    pub data: ReportData,
}

impl Answer {
    /// The whole vehicle, if it has several bodies.
    fn whole(&self) -> Option<&BodyFile> {
        let system = self.estimate.system.first();
        let several = self.estimate.bodies.len() > 1;
        system.filter(|_| several).map(|s| &s.body)
    }
}

/// A page or figure that cannot be built from valid files.
///
/// ```
/// use poinsot_figures::Templates;
/// use poinsot_report::no_page;
///
/// let faulty = Templates::new(&[("title", "{{ unknown(1) }}")]);
/// let error = faulty.html("title", ()).unwrap_err();
/// assert!(no_page(&error).contains("report this bug"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn no_page(error: &PageError) -> String {
    format!("{error}; report this bug in poinsot, if possible with the folder")
}

fn parse<T: ResultFile>(bytes: &[u8]) -> Result<T, String> {
    parse_result(Path::new(""), bytes).map_err(|e| e.to_string())
}

/// `report_data.json` as bytes.
///
/// # Errors
/// It has another format.
///
/// ```
/// let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/report_data.json"));
/// assert_eq!(poinsot_report::parse_report_data(bytes)?.vehicle.bodies.len(), 1);
/// assert!(poinsot_report::parse_report_data(b"{}").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn parse_report_data(bytes: &[u8]) -> Result<ReportData, String> {
    parse(bytes)
}

/// The page as HTML text.
///
/// # Errors
/// The documents have another format or do not match.
///
/// ```
#[doc = include_str!("../../doc/estimate.txt")]
/// let data = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/report_data.json"));
/// let html = poinsot_report::report_html(estimate, poinsot_report::parse_report_data(data)?)?;
/// assert!(html.contains("Mass properties of box"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn report_html(estimate: EstimateFile, data: ReportData) -> Result<String, String> {
    report_page(estimate, data)?
        .html()
        .map_err(|e| e.to_string())
}

/// The page of an estimate with its figures.
///
/// # Errors
/// As [`report_html`].
///
/// ```
#[doc = include_str!("../../doc/estimate.txt")]
/// let data = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/report_data.json"));
/// let page = poinsot_report::report_page(estimate, poinsot_report::parse_report_data(data)?)?;
/// assert_eq!(page.title, "Mass properties of box");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn report_page(estimate: EstimateFile, data: ReportData) -> Result<Page, String> {
    if data.schema != REPORT_DATA {
        return Err(format!(
            "schema '{}' is not {REPORT_DATA}; write it again with `poinsot identify`",
            data.schema
        ));
    }
    if !estimate.inputs.iter().map(|i| &i.sha256).eq(&data.inputs) {
        let why = "estimate.json and report_data.json come from different runs; run identify again";
        return Err(why.to_owned());
    }
    page(&Answer { estimate, data }).map_err(|e| no_page(&e))
}

/// A section that compares the answer of a page with others.
///
/// # Errors
/// The section cannot be built.
///
/// ```
/// use poinsot_formats::ComparisonFile;
///
/// let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/comparison.json"));
/// let comparison: ComparisonFile = serde_json::from_str(text)?;
/// assert_eq!(poinsot_report::comparison_part(&comparison)?.title, "Comparison");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn comparison_part(found: &ComparisonFile) -> Result<Part, String> {
    let document = comparison_document(found);
    let about = document.verdict.as_str();
    let part = Part::of_sections("comparison", "Comparison", about, &document.sections);
    part.map_err(|e| no_page(&e))
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
