//! `poinsot export`

use super::{Outcome, note, print_file, written};
use crate::arguments::{Export, Format};
use poinsot::check_outputs;
use poinsot::export::export_into_urdf;

pub fn run(arguments: &Export) -> Outcome {
    let Format::Urdf = arguments.to;
    let estimate = arguments.folder.join("estimate.json");
    check_outputs(
        "-o",
        arguments.out.as_slice(),
        &[&estimate, &arguments.onto],
    )?;
    let exported = export_into_urdf(&arguments.folder, &arguments.onto)?;
    for line in exported.left_out.iter().filter(|_| !arguments.quiet) {
        note(line);
    }
    match &arguments.out {
        Some(path) => {
            poinsot::write_file(path, exported.text.as_bytes())?;
            written(std::slice::from_ref(path), arguments.json, arguments.quiet);
        }
        None => print_file(&exported.text),
    }
    Ok(u8::from(!exported.left_out.is_empty()))
}
