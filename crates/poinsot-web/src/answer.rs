//! `poinsot identify` of inputs in memory.

use crate::Named;
use poinsot::{
    Error, IDENTIFY_MIB, Question, Reading, estimate_file, identify_records, result_files,
};
use poinsot_figures::Tone;
use poinsot_formats::{ModelInputFile, sha256};
use poinsot_model::parse_model;
use poinsot_report::{Detail, estimate_document};
use poinsot_telemetry::Part;
use serde::Serialize;
use std::path::Path;

/// A file of the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct OutputText {
    /// Name.
    pub name: String,
    /// Content.
    pub text: String,
}

/// What the command prints and writes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Exit code of the command: 0 where everything asked for is determined and nothing speaks against it, else 1.
    pub exit_code: u8,
    /// The verdict in one sentence.
    pub verdict: String,
    /// Its colour.
    pub tone: Tone,
    /// Everything that the command prints.
    pub text: String,
    /// `report_data.json`, `report.html` and `estimate.json`.
    pub files: Vec<OutputText>,
}

/// Identifies as the command with `--report` does. `together`: the files are one segment, else one each.
///
/// # Errors
/// Those of the command.
pub fn identify(
    model: &Named<String>,
    telemetry: Vec<Named<Vec<u8>>>,
    together: bool,
) -> Result<Answer, Error> {
    let vehicle = parse_model(&model.content, &model.name)?;
    if telemetry.is_empty() {
        let problem = "there is no telemetry";
        let advice = "give at least one file";
        return Err(Error::usage("--telemetry", "", problem, advice));
    }
    let names: Vec<String> = telemetry.iter().map(|file| file.name.clone()).collect();
    let command = command(&model.name, &names, together);
    let parts = telemetry
        .into_iter()
        .map(|file| Part::bytes(&file.name, file.content));
    let records: Vec<Vec<Part>> = match together {
        true => vec![parts.collect()],
        false => parts.map(|part| vec![part]).collect(),
    };
    let reading = Reading {
        memory_mib: IDENTIFY_MIB,
        ..Reading::default()
    };
    let mut identified = identify_records(vehicle, &records, &reading, &Question::default())?;
    identified.model_file = Some(ModelInputFile {
        path: model.name.clone(),
        sha256: sha256(model.content.as_bytes()),
    });
    let files = result_files(Path::new("."), &identified, &command, true, &[])?;
    let file = |(path, bytes): poinsot::OutputFile| OutputText {
        name: path.display().to_string(),
        text: String::from_utf8_lossy(&bytes).into_owned(),
    };
    let document = estimate_document(&estimate_file(&identified), Detail::Answer);
    Ok(Answer {
        exit_code: u8::from(!identified.passes()),
        text: document.to_string(),
        verdict: document.verdict,
        tone: document.tone,
        files: files.into_iter().map(file).collect(),
    })
}

/// The command that gives the same answer.
fn command(model: &str, telemetry: &[String], together: bool) -> Vec<String> {
    let segments = match together {
        true => vec![telemetry.join(",")],
        false => telemetry.to_vec(),
    };
    let segments = segments
        .into_iter()
        .flat_map(|s| ["--telemetry".to_owned(), s]);
    let words = ["poinsot", "identify", "--model", model].map(str::to_owned);
    words.into_iter().chain(segments).collect()
}
