//! `poinsot identify`

use super::{Outcome, command_line, ended, formats};
use crate::arguments::Identify;
use poinsot::{
    Coordinates, Error, IDENTIFY_MIB, IdentifyRequest, Modes, Question, Reading, check_outputs,
    estimate_file, identify, row_step, segment_files, write_result,
};
use poinsot_files::{Fault, Place, open};
use poinsot_report::{Detail, estimate_document};
use poinsot_telemetry::Encoding;
use std::ffi::OsString;
use std::path::Path;

pub fn run(arguments: &Identify) -> Outcome {
    poinsot::start_threads()?;
    let rows = &arguments.rows;
    let mut files: Vec<&OsString> = arguments.files.iter().collect();
    // A file of TOML is no telemetry.
    let is_toml = |file: &&OsString| file.to_string_lossy().ends_with(".toml");
    let named = || Some(files.remove(files.iter().position(is_toml)?).into());
    let model = arguments.model.clone().or_else(named);
    files.splice(0..0, &arguments.telemetry);
    let model = model.ok_or_else(|| no_model(&files))?;
    if files.is_empty() {
        let advice = "name its files after the model";
        return Err(Fault::new("E0001", Place::option("FILE"), "no telemetry", advice).into());
    }
    let request = IdentifyRequest {
        model,
        segments: files.into_iter().map(segment_files).collect(),
        reading: Reading {
            model: None,
            map: arguments.map.clone(),
            recover: arguments.recover,
            encoding: Encoding::from_name(&rows.encoding).unwrap_or_default(),
            time_s: rows.time_s,
            every: row_step(rows.every)?,
            memory_mib: rows.memory_mib.unwrap_or(IDENTIFY_MIB),
        },
        question: Question {
            method: arguments.method.clone(),
            variant: arguments.variant.clone(),
            settings: arguments.set.clone(),
            relative_accuracy: arguments.relative_accuracy,
            coordinates: Coordinates::from_name(&arguments.coordinates).unwrap_or_default(),
            modes: Modes::from_name(&arguments.modes).unwrap_or_default(),
            strict: arguments.strict,
            repair: arguments.repair,
            policies: arguments.policy.clone(),
        },
    };
    let figures = formats(&arguments.figures)?;
    if let Some(folder) = &arguments.out {
        check_places(arguments, folder, &request)?;
    }
    let identified = identify(&request)?;
    let written = match &arguments.out {
        Some(folder) => {
            let words = command_line();
            write_result(folder, &identified, words, arguments.report, &figures)?
        }
        None => Vec::new(),
    };
    let detail = match arguments.verbose {
        true => Detail::Everything,
        false => Detail::Answer,
    };
    let (file, passes) = (estimate_file(&identified), identified.passes());
    let document = |file: &_| estimate_document(file, detail);
    ended(&arguments.print, &file, document, (&written, passes))
}

/// Without a model: a file that does not exist, or the command that drafts one.
fn no_model(files: &[&OsString]) -> Error {
    let paths = files.iter().flat_map(segment_files);
    let mut named = paths.filter(|path| path != Path::new("-"));
    if let Some(error) = named.find_map(|path| Some(open(&path).err()?.fault("E0201", &path))) {
        return error;
    }
    let files: Vec<_> = files.iter().map(|file| file.to_string_lossy()).collect();
    let files = files.join(" ");
    let problem = "no model says what the vehicle consists of";
    let advice = format!(
        "draft one: poinsot init {files} -o model.toml, then poinsot identify -m model.toml {files}"
    );
    Fault::new("E0001", Place::option("--model"), problem, advice).into()
}

/// Checks the output paths before the computation starts.
fn check_places(
    arguments: &Identify,
    folder: &Path,
    request: &IdentifyRequest,
) -> Result<(), Error> {
    let mut names = vec!["estimate.json", "report_data.json"];
    names.extend(arguments.report.then_some("report.html"));
    let mut outputs: Vec<_> = names.into_iter().map(|n| folder.join(n)).collect();
    let figures = arguments.figures.first();
    outputs.extend(figures.map(|_| folder.join("figures").join("...")));
    let mut inputs: Vec<&Path> = vec![&request.model];
    inputs.extend(request.reading.map.as_deref());
    inputs.extend(request.segments.iter().flatten().map(|p| p.as_path()));
    check_outputs("--out", &outputs, &inputs)
}
