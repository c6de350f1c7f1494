//! `poinsot identify`

use super::{Outcome, print, print_json};
use crate::arguments::Identify;
use poinsot::{
    IdentifyRequest, estimate_document, estimate_json, identify, segment_files, write_estimate,
};

pub fn run(arguments: &Identify) -> Outcome {
    let identified = identify(&IdentifyRequest {
        model: arguments.model.clone(),
        segments: arguments
            .telemetry
            .iter()
            .map(|t| segment_files(t))
            .collect(),
        map: arguments.map.clone(),
        method: arguments.method.clone(),
        variant: arguments.variant.clone(),
        relative_accuracy: arguments.relative_accuracy,
        strict: arguments.strict,
        recover: arguments.recover,
    })?;
    let written = match &arguments.out {
        Some(folder) => Some(write_estimate(folder, &identified)?),
        None => None,
    };
    if arguments.json {
        print_json(&estimate_json(&identified));
    } else if !arguments.quiet {
        print(&estimate_document(&identified).to_string());
    }
    if let Some(path) = written.filter(|_| !arguments.quiet) {
        eprintln!("written: {}", path.display());
    }
    Ok(identified.exit_code())
}
