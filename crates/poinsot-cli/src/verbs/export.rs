//! `poinsot export`

use super::{Outcome, exit_of, note, print_file, written};
use crate::arguments::Export;
use poinsot::check_outputs;
use poinsot::export::export;

pub fn run(arguments: &Export) -> Outcome {
    let estimate = arguments.folder.join("estimate.json");
    let onto = arguments.onto.as_deref();
    let inputs: Vec<&std::path::Path> = std::iter::once(estimate.as_path()).chain(onto).collect();
    check_outputs("-o", arguments.out.as_slice(), &inputs)?;
    let (folder, to) = (&arguments.folder, arguments.to.parse()?);
    let exported = export(folder, to, onto, arguments.accept_unreliable)?;
    if !arguments.quiet {
        let lines = exported.left_out.iter().chain(&exported.no_field);
        lines.for_each(|line| note(line));
    }
    match &arguments.out {
        Some(path) => {
            poinsot::write_file(path, exported.text.as_bytes())?;
            written(std::slice::from_ref(path), arguments.json, arguments.quiet);
        }
        None => print_file(&exported.text),
    }
    Ok(exit_of(exported.left_out.is_empty()))
}
