//! `poinsot identify`

use super::{Outcome, formats, note, print_document, print_json, step};
use crate::arguments::Identify;
use poinsot::{
    Coordinates, IdentifyRequest, Question, Reading, estimate_document, estimate_json, identify,
    segment_files, write_figures, write_result,
};

/// Usual limit of the memory for the samples of one file, MiB.
const IDENTIFY_MIB: usize = 64;

pub fn run(arguments: &Identify) -> Outcome {
    let rows = &arguments.rows;
    let request = IdentifyRequest {
        model: arguments.model.clone(),
        segments: arguments
            .telemetry
            .iter()
            .map(|t| segment_files(t))
            .collect(),
        reading: Reading {
            map: arguments.map.clone(),
            recover: arguments.recover,
            encoding: rows.encoding.into(),
            time_s: rows.time_s,
            every: step(rows)?,
            memory_mib: rows.memory_mib.unwrap_or(IDENTIFY_MIB),
        },
        question: Question {
            method: arguments.method.clone(),
            variant: arguments.variant.clone(),
            relative_accuracy: arguments.relative_accuracy,
            coordinates: Coordinates::from_name(&arguments.coordinates).unwrap_or_default(),
            strict: arguments.strict,
            policies: arguments.policy.clone(),
        },
    };
    let identified = identify(&request)?;
    let written = match &arguments.out {
        Some(folder) => {
            let words = std::env::args_os().skip(1);
            let command: Vec<String> = std::iter::once("poinsot".to_owned())
                .chain(words.map(|a| a.to_string_lossy().into_owned()))
                .collect();
            let mut written = write_result(folder, &identified, &command, arguments.report)?;
            let wanted = formats(&arguments.figures);
            if !wanted.is_empty() {
                written.extend(write_figures(folder, &wanted)?);
            }
            written
        }
        None => Vec::new(),
    };
    if arguments.json {
        print_json(&estimate_json(&identified));
    } else if !arguments.quiet {
        print_document(&estimate_document(&identified));
    }
    for path in written.iter().filter(|_| !arguments.quiet) {
        note(&format!("written: {}", path.display()));
    }
    Ok(identified.exit_code())
}
