//! `poinsot design`

use super::{Outcome, ended, print_styled};
use crate::arguments::Design;
use poinsot::case::read_case;
use poinsot::check_outputs;
use poinsot_design::{BestSoFar, DesignRequest, design, write_design};
use poinsot_files::json_escaped;
use poinsot_report::design_document;
use std::path::Path;

const FILES: [&str; 5] = [
    "case.toml",
    "model.toml",
    "commands.csv",
    "firings.csv",
    "design.json",
];

pub fn run(arguments: &Design) -> Outcome {
    poinsot::start_threads()?;
    let case = read_case(&arguments.case)?;
    if let Some(folder) = &arguments.out {
        let outputs = FILES.map(|name| folder.join(name));
        let inputs: [&Path; 2] = [&arguments.case, &case.model];
        check_outputs("--out", &outputs, &inputs)?;
    }
    let mut designed = design(&DesignRequest {
        case: arguments.case.clone(),
        after: arguments.after.clone(),
        accept_unreliable: arguments.accept_unreliable,
        minutes: arguments.minutes,
        verify: arguments.verify,
        front: arguments.front.clone(),
        told: arguments.follow.then_some(told),
    })?;
    let written = match &arguments.out {
        Some(folder) => write_design(folder, &mut designed, &case.model)?,
        None => Vec::new(),
    };
    let end = (written.as_slice(), designed.passes());
    ended(&arguments.print, &designed.file, design_document, end)
}

/// A better manoeuvre as a line of JSON.
fn told(best: &BestSoFar) {
    let text = serde_json::to_string(best).unwrap_or_default();
    print_styled(&format!("{}\n", json_escaped(&text)));
}
