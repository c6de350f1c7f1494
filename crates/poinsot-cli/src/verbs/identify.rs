//! `poinsot identify`

use super::{Outcome, print, print_json};
use crate::arguments::Identify;
use poinsot::{
    Coordinates, IdentifyRequest, estimate_document, estimate_json, identify, segment_files,
    write_estimate, write_report, write_report_data,
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
        coordinates: Coordinates::from_name(&arguments.coordinates).unwrap_or_default(),
        strict: arguments.strict,
        recover: arguments.recover,
    })?;
    let written = match &arguments.out {
        Some(folder) => {
            let words = std::env::args_os().skip(1);
            let command: Vec<String> = std::iter::once("poinsot".to_owned())
                .chain(words.map(|a| a.to_string_lossy().into_owned()))
                .collect();
            let mut written = vec![write_estimate(folder, &identified)?];
            write_report_data(folder, &identified, &command)?;
            if arguments.report {
                written.push(write_report(folder)?);
            }
            written
        }
        None => Vec::new(),
    };
    if arguments.json {
        print_json(&estimate_json(&identified));
    } else if !arguments.quiet {
        print(&estimate_document(&identified).to_string());
    }
    for path in written.iter().filter(|_| !arguments.quiet) {
        eprintln!("written: {}", path.display());
    }
    Ok(identified.exit_code())
}
