//! The verbs beside `identify`: documents as JSON and as the text of the command.

use crate::answer::{CoreAnswer, chosen};
use crate::fault::Fault;
use crate::printed::{Printed, json, printed};
use crate::record::{CoreRecord, record_of};
use crate::run::run;
use poinsot::bind::mountings;
use poinsot::case::read_case;
use poinsot::compare::compare_estimates;
use poinsot::predict::{
    Prediction, predict_all, prediction_file, prediction_paths, write_predictions,
};
use poinsot::simulate::simulate_case;
use poinsot::validate::{ValidateRequest, write_validation};
use poinsot::{estimate_file, inspection_file};
use poinsot_formats::{EstimateFile, PredictionFile, read_estimate};
use poinsot_model::read_model;
use poinsot_report::{
    comparison_document, prediction_document, several_document, validation_document,
};
use poinsot_telemetry::{Encoding, MEMORY_MIB, Mounting, ReadOptions, mount};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Version of the program.
#[pyfunction]
pub fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// `poinsot inspect`: JSON and text.
#[pyfunction]
#[pyo3(signature = (paths, model=None, map=None, recover=false, time_s=None, every=1, memory_mib=None, encoded="utf8"))]
#[allow(clippy::too_many_arguments)]
pub fn inspect(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    model: Option<PathBuf>,
    map: Option<PathBuf>,
    recover: bool,
    time_s: Option<[f64; 2]>,
    every: usize,
    memory_mib: Option<usize>,
    encoded: &str,
) -> PyResult<(String, String)> {
    let options = ReadOptions {
        encoding: chosen(
            "--encoding",
            Some(encoded.to_owned()),
            &Encoding::NAMES,
            Encoding::from_name,
        )?,
        recover,
        time_s,
        every,
        memory_mib: memory_mib.unwrap_or(MEMORY_MIB),
        ..ReadOptions::default()
    };
    run(py, None, move || {
        let found = poinsot::inspect(&paths, &options, model.as_deref(), map.as_deref())?;
        let printed = found.text(None);
        Ok((json(&inspection_file(found))?, printed))
    })
}

/// `poinsot simulate` in memory, and into a folder where one is given: record, truth as JSON.
#[pyfunction]
#[pyo3(signature = (case, out=None, progress=None))]
pub fn simulate(
    py: Python<'_>,
    case: PathBuf,
    out: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(CoreRecord, String)> {
    run(py, progress.as_ref(), move || {
        if let Some(folder) = &out {
            let written = poinsot::simulate::simulate(&case, folder)?;
            let truth = poinsot_model::read_model_text(&written.truth)?;
            let parts = vec![poinsot_telemetry::Part::File(written.telemetry)];
            return Ok((CoreRecord { parts }, truth));
        }
        let read = read_case(&case)?;
        let model = read_model(&read.model)?;
        let mut simulation = simulate_case(&read, &model)?;
        // Files are in the axes of the sensors, tables in those of the bodies.
        let back: Vec<Mounting> = mountings(&model).iter().map(Mounting::inverse).collect();
        mount(&mut simulation.table, &back);
        let name = format!("<simulation of {}>", case.display());
        Ok((
            record_of(&name, &simulation.table),
            json(&simulation.truth)?,
        ))
    })
}

/// `poinsot predict`.
#[pyfunction]
#[pyo3(signature = (cases, relative_accuracy=1.0, durations=false, out=None, progress=None))]
pub fn predict(
    py: Python<'_>,
    cases: Vec<PathBuf>,
    relative_accuracy: f64,
    durations: bool,
    out: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Printed> {
    run(py, progress.as_ref(), move || {
        let paths = out.map(|folder| prediction_paths(&folder, &cases));
        let paths = paths.transpose()?.unwrap_or_default();
        let all = predict_all(&cases, relative_accuracy, durations)?;
        write_predictions(&paths, &all)?;
        let files: Vec<PredictionFile> = all.iter().map(prediction_file).collect();
        let document = match files.as_slice() {
            [one] => prediction_document(one),
            several => several_document(several),
        };
        let passes = all.iter().all(Prediction::passes);
        printed(&files, &document, passes)
    })
}

/// `poinsot validate`.
#[pyfunction]
#[pyo3(signature = (against, case=None, model=None, estimate=None, map=None, within_m=None, within_rad=None, strict=false, recover=false, out=None))]
#[allow(clippy::too_many_arguments)]
pub fn validate(
    py: Python<'_>,
    against: String,
    case: Option<PathBuf>,
    model: Option<PathBuf>,
    estimate: Option<PathBuf>,
    map: Option<PathBuf>,
    within_m: Option<f64>,
    within_rad: Option<f64>,
    strict: bool,
    recover: bool,
    out: Option<PathBuf>,
) -> PyResult<Printed> {
    let request = ValidateRequest {
        model,
        estimate,
        against: against.into(),
        case,
        map,
        within_m,
        within_rad,
        strict,
        recover,
    };
    run(py, None, move || {
        let mut found = poinsot::validate::validate(&request)?;
        if let Some(folder) = &out {
            write_validation(folder, &mut found)?;
        }
        let file = &found.file;
        printed(file, &validation_document(file), file.passes())
    })
}

/// An answer in memory, or the folder of one.
#[derive(FromPyObject)]
pub enum AnswerOrPath<'py> {
    /// In memory.
    Answer(Bound<'py, CoreAnswer>),
    /// In a folder.
    Path(PathBuf),
}

/// `poinsot compare`.
#[pyfunction]
pub fn compare(py: Python<'_>, answers: Vec<AnswerOrPath<'_>>) -> PyResult<Printed> {
    let mut files: Vec<(PathBuf, EstimateFile)> = Vec::new();
    for (k, answer) in answers.into_iter().enumerate() {
        files.push(match answer {
            AnswerOrPath::Answer(answer) => {
                let name = format!("<answer {}>", k + 1);
                (name.into(), estimate_file(&answer.get().identified))
            }
            AnswerOrPath::Path(path) => read_estimate(&path).map_err(Fault::from)?,
        });
    }
    run(py, None, move || {
        let found = compare_estimates(&files)?;
        printed(&found, &comparison_document(&found), found.passes())
    })
}

/// `poinsot methods` as JSON.
#[pyfunction]
pub fn methods() -> PyResult<String> {
    Ok(json(&poinsot::methods::methods())?)
}

/// `poinsot units` as JSON.
#[pyfunction]
pub fn units() -> PyResult<String> {
    Ok(json(&poinsot::units_file().units)?)
}

/// Meaning, usual cause and remedy of a code; `None` for an unknown one.
#[pyfunction]
pub fn explain(code: &str) -> Option<(&'static str, &'static str, &'static str, &'static str)> {
    let found = poinsot::explain::explain(code)?;
    Some((found.code, found.meaning, found.cause, found.remedy))
}

/// All codes.
#[pyfunction]
pub fn error_codes() -> Vec<&'static str> {
    poinsot::explain::error_codes()
        .iter()
        .map(|c| c.code)
        .collect()
}
