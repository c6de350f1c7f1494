//! `poinsot predict`

use super::{Failure, Outcome, exit_of, note, print_document, print_json};
use crate::arguments::Predict;
use poinsot::predict::{
    Prediction, predict_all, prediction_document, prediction_file, several_document,
};
use poinsot::{Error, check_outputs, write_file};
use poinsot_formats::PredictionFile;
use std::path::{Path, PathBuf};

const NAME: &str = "prediction.json";

pub fn run(arguments: &Predict) -> Outcome {
    poinsot::start_threads()?;
    let places = match &arguments.out {
        Some(folder) => places(folder, &arguments.cases)?,
        None => Vec::new(),
    };
    let inputs: Vec<&Path> = arguments.cases.iter().map(PathBuf::as_path).collect();
    check_outputs("--out", &places, &inputs)?;
    let accuracy = arguments.relative_accuracy;
    let all = predict_all(&arguments.cases, accuracy, arguments.durations)?;
    let files: Vec<PredictionFile> = all.iter().map(prediction_file).collect();
    for (place, file) in places.iter().zip(&files) {
        write_file(place, &pretty(file))?;
    }
    match (arguments.json, files.as_slice()) {
        (true, [one]) => print_json(one),
        (true, several) => print_json(&several),
        (false, _) if arguments.quiet => {}
        (false, [one]) => print_document(&prediction_document(one)),
        (false, several) => print_document(&several_document(several)),
    }
    for place in places.iter().filter(|_| !arguments.quiet) {
        note(&format!("written: {}", place.display()));
    }
    Ok(exit_of(all.iter().all(Prediction::passes)))
}

fn pretty(file: &PredictionFile) -> Vec<u8> {
    let mut text = serde_json::to_string_pretty(file).unwrap_or_default();
    text.push('\n');
    text.into_bytes()
}

/// Output folder of each case: the folder itself for one case, otherwise a subfolder named after the case.
fn places(folder: &Path, cases: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    if cases.len() == 1 {
        return Ok(vec![folder.join(NAME)]);
    }
    let mut all: Vec<PathBuf> = Vec::new();
    for case in cases {
        let place = folder.join(case.file_stem().unwrap_or_default()).join(NAME);
        if all.contains(&place) {
            return Err(Failure::from(Error::Usage {
                option: "CASE",
                value: case.display().to_string(),
                why: "another case has the same file name, and so the same folder below --out; predict them one by one".to_owned(),
            }));
        }
        all.push(place);
    }
    Ok(all)
}
