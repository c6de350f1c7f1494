//! Reads the text of a model file.

use poinsot_files::Faults;
use std::path::Path;

/// The text of a model file, TOML or URDF.
///
/// # Errors
/// The file cannot be read, is too large, or is not UTF-8.
///
/// ```
/// use poinsot_model::read_model_text;
///
/// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/cases/cubesat_model.toml");
/// assert!(read_model_text(path)?.contains("[[body]]"));
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn read_model_text(path: impl AsRef<Path>) -> Result<String, Faults> {
    let path = path.as_ref();
    poinsot_files::read_tree(path).map_err(|e| e.fault("E0101", path))
}
