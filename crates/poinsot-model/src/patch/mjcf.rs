//! MJCF, the model file of MuJoCo.

use super::xml::{Format, Wanted, document, words};
use super::{Measured, Patched, Spring};
use poinsot_spatial::{MassProperties, elements};
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

/// Writes mass properties into the text of an MJCF file, in the axes of each body, and the springs of joints.
///
/// # Errors
/// The text is not XML, the result does not read back, or its `<compiler>` changes inertias after reading.
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
pub fn patch_mjcf(text: &str, measured: &Measured) -> Result<Patched, String> {
    refuse_overrides(&document(text)?)?;
    let format = Format {
        tag: "body",
        depth: usize::MAX,
        wanted,
        spring: Some(spring),
    };
    format.patched(text, measured)
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

fn wanted(_: Node<'_, '_>, new: &MassProperties) -> Option<Wanted> {
    let [xx, xy, yy, xz, yz, zz] = elements(&new.I_BBcm_B);
    let attributes = vec![
        ("pos", words(new.p_BoBcm_B.as_slice())),
        ("mass", words(&[new.mass])),
        ("fullinertia", words(&[xx, yy, zz, xy, xz, yz])),
    ];
    Some(Wanted::new("inertial", attributes).without(&AXES))
}

fn spring(joint: Node<'_, '_>, new: &Spring) -> Wanted {
    let compilers = joint.document().descendants();
    let mut compilers = compilers.filter(|n| n.has_tag_name("compiler"));
    let compilers = compilers.find_map(|n| n.attribute("angle"));
    let turns = joint.attribute("type") != Some("slide");
    let in_degrees = turns && compilers.is_none_or(|angle| angle.trim() != "radian");
    let written = |x: f64| if in_degrees { x.to_degrees() } else { x };
    let rest = new.rest.map(written);
    let all = [
        ("stiffness", new.stiffness),
        ("damping", new.damping),
        ("springref", rest),
    ];
    let given = all
        .into_iter()
        .filter_map(|(name, x)| Some((name, words(&[x?]))));
    Wanted::new("joint", given.collect())
}
