//! `poinsot import`

use super::{Outcome, delivered, note};
use crate::arguments::Import;
use poinsot::{Error, check_outputs};
use poinsot_files::counted;
use poinsot_model::UrdfOptions;

pub fn run(arguments: &Import) -> Outcome {
    let file = &arguments.file;
    check_outputs("-o", arguments.out.as_slice(), &[file])?;
    let (text, notes) = match &arguments.body {
        Some(body) => modes(arguments, body)?,
        None => robot(arguments)?,
    };
    let out = arguments.out.as_ref();
    delivered(&text, out, arguments.json, arguments.quiet)?;
    if !arguments.quiet {
        notes.iter().for_each(|line| note(line));
    }
    Ok(0)
}

/// A text to write, and what to say of it.
type Imported = (String, Vec<String>);

fn robot(arguments: &Import) -> Result<Imported, Error> {
    let file = &arguments.file;
    let options = UrdfOptions {
        allow_massless: arguments.allow_massless,
        base: arguments.base.clone(),
    };
    if file
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("csv"))
    {
        let problem = "a table of modes does not say which body carries them";
        let advice = "name the body by --body";
        return Err(Error::usage("import", file.display(), problem, advice));
    }
    let (model, text) = poinsot::import(file, &options)?;
    let said = model
        .notes
        .iter()
        .map(|found| format!("note: {}:{found}", file.display()));
    let mut notes: Vec<String> = said.collect();
    notes.push(format!(
        "{}, {}; add sensors with their noise, and set estimate on the unknown bodies",
        counted(model.bodies.len(), "body"),
        counted(model.joints.len(), "joint")
    ));
    Ok((text, notes))
}

fn modes(arguments: &Import, body: &str) -> Result<Imported, Error> {
    let modes = poinsot::import_modes(&arguments.file, body)?;
    let left = modes.notes.iter().map(|line| format!("left out: {line}"));
    let mut notes: Vec<String> = left.collect();
    notes.push(format!(
        "append these tables to the model of {body}, whose mass properties contain what moves; `estimate` asks for their numbers"
    ));
    Ok((modes.text, notes))
}
