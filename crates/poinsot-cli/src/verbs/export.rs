//! `poinsot export`

use super::{Outcome, delivered, exit_of, note, written};
use crate::arguments::Export;
use poinsot::export::{Target, export, export_table};
use poinsot::{Error, check_outputs};

pub fn run(arguments: &Export) -> Outcome {
    if arguments.to == Target::Onboard.name()
        && (arguments.folder.is_file() || arguments.onto.is_some())
    {
        return table(arguments);
    }
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
    let out = arguments.out.as_ref();
    delivered(&exported.text, out, arguments.json, arguments.quiet)?;
    Ok(exit_of(exported.left_out.is_empty()))
}

/// The table of the on-board filter, from a model, or from an answer and its model.
fn table(arguments: &Export) -> Outcome {
    let (model, answer) = match &arguments.onto {
        Some(model) => (model, Some(arguments.folder.as_path())),
        None => (&arguments.folder, None),
    };
    let Some(out) = &arguments.out else {
        let problem = "the table of the on-board filter is binary";
        let advice = "name its file by -o";
        return Err(Error::usage("--to", &arguments.to, problem, advice));
    };
    check_outputs("-o", std::slice::from_ref(out), &[model])?;
    let (bytes, assumed) = export_table(model, answer, arguments.accept_unreliable)?;
    if !arguments.quiet {
        assumed.iter().for_each(|line| note(line));
    }
    poinsot::write_file(out, &bytes)?;
    written(std::slice::from_ref(out), arguments.json, arguments.quiet);
    Ok(exit_of(true))
}
