//! `poinsot inspect`

use super::{Failure, Outcome, print, print_json, step};
use crate::arguments::Inspect;
use poinsot::{proposed_map, segment_files};
use poinsot_model::{parse_telemetry_map, read_telemetry_map};
use poinsot_telemetry::{ReadOptions, inspect_files};

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
    let described = arguments.map.is_some();
    let proposal = (!described).then(|| proposed_map(&files)).flatten();
    let inspection = match (inspect_files(&files, &options), &proposal) {
        (Ok(inspection), _) => inspection,
        // What cannot be read as it is may be readable as proposed.
        (Err(error), Some(map)) => {
            let Ok(map) = parse_telemetry_map(map, "the proposed map") else {
                return Err(error.into());
            };
            let proposed = ReadOptions { map, ..options };
            inspect_files(&files, &proposed).map_err(|_| error)?
        }
        (Err(error), None) => return Err(error.into()),
    };
    if arguments.json {
        let mut value = serde_json::to_value(&inspection).unwrap_or_default();
        if let (Some(map), Some(object)) = (proposal, value.as_object_mut()) {
            object.insert("proposed_map".to_owned(), map.into());
        }
        print_json(&value);
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
