//! MJCF, the model file of MuJoCo.

use super::xml::{Edits, document, named, patched};
use super::{BodyProperties, Patched};
use crate::patch::xml::child;
use poinsot_spatial::MassProperties;
use roxmltree::{Document, Node};

/// Attributes that rotate the axes of an `<inertial>` or give a diagonal tensor: excluded by a full tensor.
const AXES: [&str; 6] = [
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "diaginertia",
];
/// Settings of `<compiler>` by which MuJoCo changes given inertias, with the values that do not.
const OVERRIDES: [(&str, &[&str]); 3] = [
    ("inertiafromgeom", &["auto", "false"]),
    ("balanceinertia", &["false"]),
    ("settotalmass", &["-1"]),
];

/// Writes mass properties into the text of an MJCF file, in the axes of each body.
///
/// # Errors
/// The text is not XML, or its `<compiler>` changes inertias after reading.
///
/// ```
#[doc = include_str!("../../doc/measured.txt")]
/// let text = r#"<mujoco><worldbody><body name="bus">
///   <inertial mass="9" pos="0 0 0" diaginertia="1 1 1"/><geom type="box" size="1 1 1"/>
/// </body></worldbody></mujoco>"#;
/// let patched = patch_mjcf(text, &measured)?;
/// assert!(patched.text.contains(r#"mass="10.0""#) && patched.missing.is_empty());
/// # Ok::<(), String>(())
/// ```
pub fn patch_mjcf(text: &str, bodies: &[BodyProperties]) -> Result<Patched, String> {
    let document = document(text)?;
    refuse_overrides(&document)?;
    let find = |name: &str| named(&document, "body", name);
    Ok(patched(text, bodies, find, edit_body))
}

fn refuse_overrides(document: &Document<'_>) -> Result<(), String> {
    for compiler in document
        .descendants()
        .filter(|n| n.has_tag_name("compiler"))
    {
        for (name, harmless) in OVERRIDES {
            let value = compiler.attribute(name).map(str::trim);
            if let Some(value) = value.filter(|v| !harmless.contains(v)) {
                return Err(format!(
                    "with <compiler {name}=\"{value}\"> MuJoCo replaces the inertias that the file states; write \"{}\"",
                    harmless[0]
                ));
            }
        }
    }
    Ok(())
}

fn edit_body(body: Node<'_, '_>, new: &MassProperties, edits: &mut Edits) {
    let (c, i) = (&new.p_BoBcm_B, &new.I_BBcm_B);
    let attributes = [
        ("pos", format!("{:?} {:?} {:?}", c.x, c.y, c.z)),
        ("mass", format!("{:?}", new.mass)),
        (
            "fullinertia",
            format!(
                "{:?} {:?} {:?} {:?} {:?} {:?}",
                i[(0, 0)],
                i[(1, 1)],
                i[(2, 2)],
                i[(0, 1)],
                i[(0, 2)],
                i[(1, 2)]
            ),
        ),
    ];
    match child(body, "inertial") {
        Some(inertial) => {
            AXES.iter().for_each(|name| edits.remove(inertial, name));
            for (name, value) in &attributes {
                edits.set(inertial, name, value);
            }
        }
        None => {
            let all = attributes.map(|(name, value)| format!(" {name}=\"{value}\""));
            edits.insert_inside(body, &format!("<inertial{}/>", all.concat()));
        }
    }
}
