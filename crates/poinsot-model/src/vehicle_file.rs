//! Reads a vehicle from a file of either kind.

use crate::model_text::read_model_text;
use crate::read::parse_model;
use crate::urdf::{UrdfOptions, read_urdf_with};
use crate::vehicle::Model;
use crate::write::write_model;
use poinsot_files::{Faults, Place};
use std::path::Path;

/// Reads and checks a vehicle (`poinsot.model/1`, TOML; or URDF, by file suffix).
///
/// # Errors
/// All faults of the file, each with line and column.
///
/// ```
/// use poinsot_model::read_model;
///
/// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/cases/cubesat_model.toml");
/// let model = read_model(path)?;
/// assert_eq!((model.bodies.len(), model.wheels.len()), (1, 3));
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn read_model(path: impl AsRef<Path>) -> Result<Model, Faults> {
    let path = path.as_ref();
    let ending = path.extension();
    if ending.is_some_and(|e| e.eq_ignore_ascii_case("urdf")) {
        return read_robot(path, &UrdfOptions::default());
    }
    let text = read_model_text(path)?;
    parse_model(&text, &path.display().to_string())
}

/// Reads a URDF file, and checks it by the rules of a model file.
///
/// # Errors
/// All faults of the file, each with its line.
///
/// ```
/// assert!(poinsot_model::read_robot("/nowhere/arm.urdf", &Default::default()).is_err());
/// ```
pub fn read_robot(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<Model, Faults> {
    let path = path.as_ref();
    let model = read_urdf_with(path, options).model?;
    let file = path.display().to_string();
    let Err(mut faults) = parse_model(&write_model(&model), &file) else {
        return Ok(model);
    };
    let text = read_model_text(path)?;
    for fault in &mut faults.list {
        // The line of the link or joint in the file itself.
        let name = fault.place.subject.split('"').nth(1).unwrap_or_default();
        let tag = format!("name=\"{name}\"");
        let line = text.lines().position(|line| line.contains(&tag));
        fault.place = Place {
            line: line.map_or(0, |line| line as u64 + 1),
            ..Place::label(&file).key(&fault.place.subject)
        };
    }
    Err(faults)
}
