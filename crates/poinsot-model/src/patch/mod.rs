//! Mass properties put into files of other programs; every byte that states none stays as it is.

mod mjcf;
mod model_file;
mod sdf;
mod urdf;
mod xml;

pub use mjcf::patch_mjcf;
pub use model_file::patch_model;
pub use sdf::patch_sdf;
pub use urdf::patch_urdf;

use poinsot_spatial::MassProperties;

/// New mass properties of a body, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyProperties {
    /// Name of the body, or link.
    pub body: String,
    /// Mass, mass centre, central inertia.
    pub properties: MassProperties,
}

/// A file with new mass properties.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patched {
    /// The text.
    pub text: String,
    /// Bodies of which the file has none, or several, of this name.
    pub missing: Vec<String>,
}

/// A function that puts mass properties into a text. The error says in words why the text cannot be used.
pub type Patch = fn(&str, &[BodyProperties]) -> Result<Patched, String>;
