//! `poinsot predict`

use super::{Outcome, exit_of, noted, print_document, print_json, print_result};
use crate::arguments::Predict;
use poinsot::predict::{
    Prediction, predict_all, prediction_file, prediction_paths, write_predictions,
};
use poinsot_formats::PredictionFile;
use poinsot_report::{prediction_document, several_document};

pub fn run(arguments: &Predict) -> Outcome {
    poinsot::start_threads()?;
    let paths = match &arguments.out {
        Some(folder) => prediction_paths(folder, &arguments.cases)?,
        None => Vec::new(),
    };
    let accuracy = arguments.relative_accuracy;
    let all = predict_all(&arguments.cases, accuracy, arguments.durations)?;
    write_predictions(&paths, &all)?;
    let files: Vec<PredictionFile> = all.iter().map(prediction_file).collect();
    match (arguments.print.json, files.as_slice()) {
        (true, [one]) => print_result(one),
        (true, several) => print_json(&several),
        (false, _) if arguments.print.quiet => {}
        (false, [one]) => print_document(&prediction_document(one)),
        (false, several) => print_document(&several_document(several)),
    }
    noted(&paths, arguments.print.quiet);
    Ok(exit_of(all.iter().all(Prediction::passes)))
}
