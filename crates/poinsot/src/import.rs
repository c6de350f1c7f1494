//! The command `import`: a URDF as a model file.

use crate::error::Error;
use poinsot_model::{Model, parse_model, read_urdf, write_model};
use std::path::Path;

/// The model of a URDF, and its model file.
///
/// # Errors
/// The URDF cannot be read, or its names or numbers violate the rules of a model file.
pub fn import(urdf: &Path) -> Result<(Model, String), Error> {
    let model = read_urdf(urdf).model?;
    let text = write_model(&model);
    parse_model(&text, &urdf.display().to_string())?;
    Ok((model, text))
}
