//! The searches: `design`, and the studies of the papers.

use crate::printed::{Printed, json, printed};
use crate::run::run;
use poinsot::case::read_case;
use poinsot::study::{find, findings_file, printed_findings, run as run_study};
use poinsot_design::{DesignRequest, write_design};
use poinsot_formats::{FINDINGS, FindingsFile};
use poinsot_report::{design_document, study_document};
use pyo3::prelude::*;
use std::path::PathBuf;

/// `poinsot design`.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
#[pyo3(signature = (case, out=None, after=None, accept_unreliable=false, minutes=None, verify=0, front=Vec::new(), progress=None))]
pub fn design(
    py: Python<'_>,
    case: PathBuf,
    out: Option<PathBuf>,
    after: Option<PathBuf>,
    accept_unreliable: bool,
    minutes: Option<f64>,
    verify: u64,
    front: Vec<String>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    run(py, progress.as_ref(), move || {
        let mut designed = poinsot_design::design(&DesignRequest {
            case: case.clone(),
            after,
            accept_unreliable,
            minutes,
            verify,
            front,
            told: None,
        })?;
        if let Some(folder) = &out {
            let model = read_case(&case)?.model;
            write_design(folder, &mut designed, &model)?;
        }
        let file = &designed.file;
        printed(file, &design_document(file), designed.passes())
    })
}

/// `poinsot study` of one study of a paper, or of all.
#[pyfunction]
#[pyo3(signature = (paper, name, data, progress=None))]
pub fn study(
    py: Python<'_>,
    paper: String,
    name: String,
    data: PathBuf,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    run(py, progress.as_ref(), move || {
        let (mut findings, mut words) = (Vec::new(), Vec::new());
        for (paper, study) in find(Some(&paper), Some(&name))? {
            let found = run_study(study, &data)?;
            let printed = printed_findings(paper, study, &found);
            words.push(study_document(&printed).to_string());
            findings.push(findings_file(paper, study, &found));
        }
        let file = FindingsFile {
            schema: FINDINGS.to_owned(),
            findings,
        };
        let values = json(&file)?;
        Ok((values, words.join("\n"), 0))
    })
}
