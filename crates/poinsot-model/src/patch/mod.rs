//! Writes mass properties into files of other programs; all other bytes stay unchanged.

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
    /// Bodies that the file does not have, or has several times.
    pub missing: Vec<String>,
}

/// A function that writes mass properties into a text. The error is a message.
pub type Patch = fn(&str, &[BodyProperties]) -> Result<Patched, String>;
