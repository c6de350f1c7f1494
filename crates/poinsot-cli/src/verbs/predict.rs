//! `poinsot predict`

use super::{Outcome, exit_of, print_document, print_json};
use crate::arguments::Predict;
use poinsot::predict::{predict, prediction_document, prediction_file};

pub fn run(arguments: &Predict) -> Outcome {
    poinsot::start_threads()?;
    let prediction = predict(&arguments.case, arguments.relative_accuracy)?;
    if arguments.json {
        print_json(&prediction_file(&prediction));
    } else if !arguments.quiet {
        print_document(&prediction_document(&prediction));
    }
    Ok(exit_of(prediction.passes()))
}
