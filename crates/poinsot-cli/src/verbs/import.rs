//! `poinsot import`

use super::{Outcome, note, print_file, written};
use crate::arguments::Import;
use poinsot::check_outputs;
use poinsot_model::UrdfOptions;

pub fn run(arguments: &Import) -> Outcome {
    check_outputs("-o", arguments.out.as_slice(), &[&arguments.urdf])?;
    let options = UrdfOptions {
        allow_massless: arguments.allow_massless,
        base: arguments.base.clone(),
    };
    let (model, text) = poinsot::import(&arguments.urdf, &options)?;
    match &arguments.out {
        Some(path) => {
            poinsot::write_file(path, text.as_bytes())?;
            written(std::slice::from_ref(path), arguments.json, arguments.quiet);
        }
        None => print_file(&text),
    }
    if arguments.quiet {
        return Ok(0);
    }
    for found in &model.notes {
        note(&format!("note: {}:{found}", arguments.urdf.display()));
    }
    note(&format!(
        "{} bodies, {} joints; add sensors with their noise, and set estimate on the unknown bodies",
        model.bodies.len(),
        model.joints.len()
    ));
    Ok(0)
}
