//! `poinsot inspect`

use super::{Outcome, print, print_json, step};
use crate::arguments::Inspect;
use poinsot::{inspect, inspection_file, segment_files};
use poinsot_telemetry::ReadOptions;

pub fn run(arguments: &Inspect) -> Outcome {
    let rows = &arguments.rows;
    let options = ReadOptions {
        encoding: rows.encoding.into(),
        recover: arguments.recover,
        time_s: rows.time_s,
        every: step(rows)?,
        memory_mib: rows.memory_mib.unwrap_or(poinsot_telemetry::MEMORY_MIB),
        ..ReadOptions::default()
    };
    let files = segment_files(&arguments.telemetry);
    let (model, map) = (arguments.model.as_deref(), arguments.map.as_deref());
    let found = inspect(&files, &options, model, map)?;
    if arguments.print.json {
        print_json(&inspection_file(found));
    } else if !arguments.print.quiet {
        print(&format!("{found}\n"));
    }
    Ok(0)
}
