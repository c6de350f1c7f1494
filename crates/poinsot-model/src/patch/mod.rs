//! Writes mass properties and springs into files of other programs; all other bytes stay unchanged.

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
use std::collections::{BTreeMap, BTreeSet};

/// New mass properties of a body, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyProperties {
    /// Name of the body, or link.
    pub body: String,
    /// Mass, mass centre, central inertia.
    pub properties: MassProperties,
}

/// A number of a joint, a mode or another part of a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct PartNumber {
    /// Name of the part.
    pub part: String,
    /// Its key in the model file: `stiffness_N_m_per_rad`.
    pub key: String,
    /// The component, if there are several: `x`, or `xy` of a tensor.
    pub component: Option<String>,
    /// The value, in the unit of the key.
    pub value: f64,
}

/// What is written into a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// Bodies.
    pub bodies: Vec<BodyProperties>,
    /// Numbers of other parts.
    pub numbers: Vec<PartNumber>,
}

/// A file with new numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Patched {
    /// The text.
    pub text: String,
    /// Bodies that the file does not have, or has several times.
    pub missing: Vec<String>,
    /// The other parts whose numbers were written.
    pub parts: BTreeSet<String>,
}

/// A function that writes numbers into a text. The error is a message.
pub type Patch = fn(&str, &Measured) -> Result<Patched, String>;

/// The numbers of the spring and damper of one joint; those that are not known stay as they are.
#[derive(Debug, Clone, Copy, Default)]
struct Spring {
    /// N m/rad or N/m.
    stiffness: Option<f64>,
    /// N m s/rad or N s/m.
    damping: Option<f64>,
    /// rad or m.
    rest: Option<f64>,
}

impl Spring {
    /// Those of every joint.
    fn all(numbers: &[PartNumber]) -> BTreeMap<&str, Self> {
        let mut all = BTreeMap::<&str, Self>::new();
        for number in numbers {
            let [stiffness, damping, rest] = SPRING_KEYS.map(|keys| keys.contains(&&*number.key));
            let value = Some(number.value);
            match all.entry(&number.part) {
                own if stiffness => own.or_default().stiffness = value,
                own if damping => own.or_default().damping = value,
                own if rest => own.or_default().rest = value,
                _ => {}
            }
        }
        all
    }
}

/// Keys of stiffness, damping and rest position, of a revolute and a prismatic joint.
const SPRING_KEYS: [[&str; 2]; 3] = [
    ["stiffness_N_m_per_rad", "stiffness_N_per_m"],
    ["damping_N_m_s_per_rad", "damping_N_s_per_m"],
    ["rest_rad", "rest_m"],
];
