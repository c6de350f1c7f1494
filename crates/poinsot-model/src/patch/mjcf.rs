//! MJCF, the model file of MuJoCo.

use super::xml::{Element, Format, document, numbers, only, symmetric, words};
use super::{BodyProperties, Patched};
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
pub fn patch_mjcf(text: &str, bodies: &[BodyProperties]) -> Result<Patched, String> {
    refuse_overrides(&document(text)?)?;
    let format = Format {
        tag: "body",
        depth: usize::MAX,
        edit,
        read,
    };
    format.patched(text, bodies)
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

fn edit(mut body: Element<'_>, new: &MassProperties) {
    let i = &new.I_BBcm_B;
    let [xx, yy, zz] = [i[(0, 0)], i[(1, 1)], i[(2, 2)]];
    let tensor = [xx, yy, zz, i[(0, 1)], i[(0, 2)], i[(1, 2)]];
    let mut inertial = body.child("inertial");
    inertial.remove(&AXES);
    inertial.set("pos", words(new.p_BoBcm_B.as_slice()));
    inertial.set("mass", words(&[new.mass]));
    inertial.set("fullinertia", words(&tensor));
}

fn read(body: Node<'_, '_>) -> Option<MassProperties> {
    let inertial = only(body, "inertial")?;
    let [mass] = numbers(inertial.attribute("mass"))?;
    let [xx, yy, zz, xy, xz, yz] = numbers(inertial.attribute("fullinertia"))?;
    let turned = AXES.iter().any(|name| inertial.has_attribute(*name));
    (!turned).then_some(MassProperties {
        mass,
        p_BoBcm_B: numbers(inertial.attribute("pos"))?.into(),
        I_BBcm_B: symmetric([xx, xy, xz, yy, yz, zz]),
    })
}
