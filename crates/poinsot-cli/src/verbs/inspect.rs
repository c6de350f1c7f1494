//! `poinsot inspect`

use super::{Outcome, print, print_json, reading, shown};
use crate::arguments::Inspect;
use crate::terminal;
use poinsot::{inspect, inspection_file, segment_files};
use poinsot_telemetry::ReadOptions;

pub fn run(arguments: &Inspect) -> Outcome {
    let options = ReadOptions {
        recover: arguments.recover,
        ..reading(&arguments.rows)?
    };
    let files = segment_files(&arguments.telemetry);
    let (model, map) = (arguments.model.as_deref(), arguments.map.as_deref());
    let found = inspect(&files, &options, model, map)?;
    let text = found.text(terminal::style().width) + "\n";
    let json = || print_json(&inspection_file(found));
    shown(&arguments.print, json, || print(&text));
    Ok(0)
}
