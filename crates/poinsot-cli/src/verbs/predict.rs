//! `poinsot predict`

use super::{Outcome, exit_of, print_document, print_json};
use crate::arguments::Predict;
use poinsot::predict::{predict, prediction_document, prediction_file};

pub fn run(arguments: &Predict) -> Outcome {
    poinsot::start_threads()?;
    let prediction = predict(&arguments.case, arguments.relative_accuracy)?;
    let file = prediction_file(&prediction);
    if arguments.json {
        print_json(&file);
    } else if !arguments.quiet {
        print_document(&prediction_document(&file));
    }
    Ok(exit_of(prediction.passes()))
}
