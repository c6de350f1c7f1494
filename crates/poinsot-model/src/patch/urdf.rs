//! URDF, the robot description of ROS.

use super::xml::{Edits, child, document, patched};
use super::{BodyProperties, Patched};
use crate::urdf::{ELEMENTS, rotation};
use poinsot_spatial::MassProperties;
use roxmltree::Node;

/// Writes mass properties into the text of a valid URDF file.
///
/// The axes of an `<inertial>` (its `rpy`) are kept; the tensor is rotated to them. Missing elements (`<inertial>`,
/// `<origin>`) are added.
///
/// # Errors
/// The text is not XML.
///
/// ```
#[doc = include_str!("../../doc/measured.txt")]
/// let text = r#"<robot name="m"><link name="bus"><inertial><mass value="9"/>
/// <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;
/// let patched = patch_urdf(text, &measured)?;
/// assert!(patched.text.contains(r#"<mass value="10.0"/>"#) && patched.missing.is_empty());
/// # Ok::<(), String>(())
/// ```
pub fn patch_urdf(text: &str, bodies: &[BodyProperties]) -> Result<Patched, String> {
    let document = document(text)?;
    let find = |name: &str| {
        let mut links = document.root_element().children();
        links.find(|n| n.tag_name().name() == "link" && n.attribute("name") == Some(name))
    };
    Ok(patched(text, bodies, find, edit_link))
}

fn edit_link(link: Node<'_, '_>, new: &MassProperties, edits: &mut Edits) {
    let c = &new.p_BoBcm_B;
    let centre = format!("{:?} {:?} {:?}", c.x, c.y, c.z);
    let Some(inertial) = child(link, "inertial") else {
        let whole = format!(
            "<inertial><origin xyz=\"{centre}\"/><mass value=\"{:?}\"/>{}</inertial>",
            new.mass,
            tensor_element(new, [0.0; 3])
        );
        edits.insert_inside(link, &whole);
        return;
    };
    let origin = child(inertial, "origin");
    let rpy = origin
        .and_then(|o| o.attribute("rpy"))
        .map(|t| {
            t.split_whitespace()
                .filter_map(|w| w.parse().ok())
                .collect::<Vec<f64>>()
        })
        .and_then(|v| <[f64; 3]>::try_from(v).ok())
        .unwrap_or_default();
    match origin {
        Some(origin) => edits.set(origin, "xyz", &centre),
        None => edits.insert_inside(inertial, &format!("<origin xyz=\"{centre}\"/>")),
    }
    match child(inertial, "mass") {
        Some(mass) => edits.set(mass, "value", &format!("{:?}", new.mass)),
        None => edits.insert_inside(inertial, &format!("<mass value=\"{:?}\"/>", new.mass)),
    }
    match child(inertial, "inertia") {
        Some(inertia) => {
            for (name, value) in ELEMENTS.iter().zip(elements(new, rpy)) {
                edits.set(inertia, name, &format!("{value:?}"));
            }
        }
        None => edits.insert_inside(inertial, &tensor_element(new, rpy)),
    }
}

/// Tensor elements in the axes of the inertial frame.
fn elements(new: &MassProperties, rpy: [f64; 3]) -> [f64; 6] {
    let i = if rpy == [0.0; 3] {
        new.I_BBcm_B
    } else {
        let turn = rotation(rpy);
        turn.transpose() * new.I_BBcm_B * turn
    };
    [
        i[(0, 0)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 1)],
        i[(1, 2)],
        i[(2, 2)],
    ]
}

fn tensor_element(new: &MassProperties, rpy: [f64; 3]) -> String {
    let attributes: Vec<String> = ELEMENTS
        .iter()
        .zip(elements(new, rpy))
        .map(|(name, value)| format!("{name}=\"{value:?}\""))
        .collect();
    format!("<inertia {}/>", attributes.join(" "))
}
