//! SDF, the robot description of Gazebo and Drake.

use super::xml::{Edits, child, document, named, patched};
use super::{BodyProperties, Patched};
use poinsot_spatial::MassProperties;
use roxmltree::Node;

/// Tensor elements with their indices.
const ELEMENTS: [(&str, (usize, usize)); 6] = [
    ("ixx", (0, 0)),
    ("ixy", (0, 1)),
    ("ixz", (0, 2)),
    ("iyy", (1, 1)),
    ("iyz", (1, 2)),
    ("izz", (2, 2)),
];

/// Writes mass properties into the text of an SDF file. The axes of an `<inertial>` become those of its link.
///
/// # Errors
/// The text is not XML.
///
/// ```
#[doc = include_str!("../../doc/measured.txt")]
/// let text = r#"<sdf version="1.9"><model name="m"><link name="bus">
///   <inertial><mass>9</mass></inertial>
/// </link></model></sdf>"#;
/// let patched = patch_sdf(text, &measured)?;
/// assert!(patched.text.contains("<mass>10.0</mass>") && patched.missing.is_empty());
/// # Ok::<(), String>(())
/// ```
pub fn patch_sdf(text: &str, bodies: &[BodyProperties]) -> Result<Patched, String> {
    let document = document(text)?;
    let find = |name: &str| named(&document, "link", name);
    Ok(patched(text, bodies, find, edit_link))
}

fn edit_link(link: Node<'_, '_>, new: &MassProperties, edits: &mut Edits) {
    let (pose, mass, inertia) = (pose(new), mass(new), inertia(new));
    let Some(inertial) = child(link, "inertial") else {
        edits.insert_inside(link, &format!("<inertial>{pose}{mass}{inertia}</inertial>"));
        return;
    };
    for (name, element) in [("pose", pose), ("mass", mass)] {
        match child(inertial, name) {
            Some(old) => edits.replace(old, element),
            None => edits.insert_inside(inertial, &element),
        }
    }
    let Some(old) = child(inertial, "inertia") else {
        edits.insert_inside(inertial, &inertia);
        return;
    };
    for (name, at) in ELEMENTS {
        let element = format!("<{name}>{:?}</{name}>", new.I_BBcm_B[at]);
        match child(old, name) {
            Some(node) => edits.replace(node, element),
            None => edits.insert_inside(old, &element),
        }
    }
}

fn pose(new: &MassProperties) -> String {
    let c = &new.p_BoBcm_B;
    format!("<pose>{:?} {:?} {:?} 0 0 0</pose>", c.x, c.y, c.z)
}

fn mass(new: &MassProperties) -> String {
    format!("<mass>{:?}</mass>", new.mass)
}

fn inertia(new: &MassProperties) -> String {
    let elements = ELEMENTS.map(|(name, at)| format!("<{name}>{:?}</{name}>", new.I_BBcm_B[at]));
    format!("<inertia>{}</inertia>", elements.concat())
}
