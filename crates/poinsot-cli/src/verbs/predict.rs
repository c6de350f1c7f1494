//! `poinsot predict`

use super::{Outcome, print, print_json};
use crate::arguments::Predict;
use poinsot::predict::{predict, prediction_document, prediction_json};

pub fn run(arguments: &Predict) -> Outcome {
    let prediction = predict(&arguments.case, arguments.relative_accuracy)?;
    if arguments.json {
        print_json(&prediction_json(&prediction));
    } else {
        print(&prediction_document(&prediction).to_string());
    }
    Ok(prediction.exit_code())
}
