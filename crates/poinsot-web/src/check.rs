//! Errors of a model, each with its line.

use crate::Named;
use poinsot::Error;
use poinsot_model::{describe, parse_model};
use serde::Serialize;

/// One error.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LineError {
    /// Code, see `poinsot explain`.
    pub code: &'static str,
    /// Line of the model, from 1; 0 for an error of something else.
    pub line: u64,
    /// As the command prints it.
    pub text: String,
}

/// What is wrong with a model, or what it describes.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Checked {
    /// Errors, by line; empty for a model that can be used.
    pub errors: Vec<LineError>,
    /// The vehicle, as `poinsot check` prints it; empty with errors.
    pub vehicle: String,
}

/// Checks a model given as text, as `poinsot check` does.
pub fn check(model: &Named<String>) -> Checked {
    match parse_model(&model.content, &model.name) {
        Ok(vehicle) => Checked {
            vehicle: describe(&vehicle).to_string(),
            ..Checked::default()
        },
        Err(error) => Checked {
            errors: line_errors(&error, &model.name),
            ..Checked::default()
        },
    }
}

/// The errors, with lines where they are in the model of this name.
pub fn line_errors(error: &Error, model: &str) -> Vec<LineError> {
    let one = |fault: &poinsot::Fault| LineError {
        code: fault.code,
        line: if fault.place.file == model {
            fault.place.line
        } else {
            0
        },
        text: fault.to_string(),
    };
    error.list.iter().map(one).collect()
}
