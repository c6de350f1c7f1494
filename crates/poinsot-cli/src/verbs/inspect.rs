//! `poinsot inspect`

use super::{Failure, Outcome, print, print_json, step};
use crate::arguments::Inspect;
use poinsot::{inspect, inspection_file, segment_files};
use poinsot_model::read_telemetry_map;
use poinsot_telemetry::ReadOptions;

pub fn run(arguments: &Inspect) -> Outcome {
    let rows = &arguments.rows;
    let mut options = ReadOptions {
        encoding: rows.encoding.into(),
        recover: arguments.recover,
        time_s: rows.time_s,
        every: step(rows)?,
        memory_mib: rows.memory_mib.unwrap_or(poinsot_telemetry::MEMORY_MIB),
        ..ReadOptions::default()
    };
    if let Some(path) = &arguments.map {
        options.map = read_telemetry_map(path).map_err(Failure::from)?;
    }
    let files = segment_files(&arguments.telemetry);
    let (inspection, proposal) = inspect(&files, &options, arguments.map.is_some())?;
    if arguments.json {
        print_json(&inspection_file(inspection, proposal));
    } else if !arguments.quiet {
        print(&format!("{inspection}\n"));
        if let Some(map) = proposal {
            print(&format!(
                "\nProposed map, to paste into the model file or into a file for --map; check what is unsure:\n\n{map}\n"
            ));
        }
    }
    Ok(0)
}
