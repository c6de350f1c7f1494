//! `poinsot validate`

use super::{Outcome, ended};
use crate::arguments::Validate;
use poinsot::validate::{ValidateRequest, validate, write_validation};
use poinsot::{check_outputs, segment_files};
use poinsot_report::validation_document;
use std::path::Path;

pub fn run(arguments: &Validate) -> Outcome {
    poinsot::start_threads()?;
    if let Some(folder) = &arguments.out {
        let outputs = ["histories.csv", "validation.json"].map(|n| folder.join(n));
        let against = segment_files(&arguments.against);
        let estimate = arguments.estimate.as_deref();
        let of_folder = estimate.map(|e| e.join("estimate.json"));
        let inputs: Vec<&Path> = [&arguments.model, &arguments.case, &arguments.map]
            .into_iter()
            .flatten()
            .chain(&against)
            .chain(&of_folder)
            .map(|p| p.as_path())
            .chain(estimate)
            .collect();
        check_outputs("--out", &outputs, &inputs)?;
    }
    let mut validation = validate(&ValidateRequest {
        model: arguments.model.clone(),
        estimate: arguments.estimate.clone(),
        against: arguments.against.clone(),
        case: arguments.case.clone(),
        map: arguments.map.clone(),
        within_m: arguments.within_m,
        within_rad: arguments.within_rad,
        strict: arguments.strict,
        recover: arguments.recover,
    })?;
    let written = match &arguments.out {
        Some(folder) => write_validation(folder, &mut validation)?,
        None => Vec::new(),
    };
    let file = &validation.file;
    let end = (written.as_slice(), file.passes());
    ended(&arguments.print, file, validation_document, end)
}
