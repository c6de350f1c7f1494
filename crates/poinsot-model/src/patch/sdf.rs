//! SDF, the robot description of Gazebo and Drake.

use super::xml::{Format, UPPER, Wanted, words};
use super::{Measured, Patched, Spring};
use crate::urdf::ELEMENTS;
use poinsot_spatial::MassProperties;
use roxmltree::Node;

/// Writes mass properties into the text of an SDF file, and the springs of joints. The axes of an `<inertial>` become those of its link.
///
/// # Errors
/// The text is not XML, or the result does not read back.
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
pub fn patch_sdf(text: &str, measured: &Measured) -> Result<Patched, String> {
    let format = Format {
        tag: "link",
        depth: usize::MAX,
        wanted,
        spring: Some(spring),
    };
    format.patched(text, measured)
}

fn wanted(_: Node<'_, '_>, new: &MassProperties) -> Option<Wanted> {
    let element = |(name, at)| Wanted::saying(name, words(&[new.I_BBcm_B[at]]));
    let elements = ELEMENTS.into_iter().zip(UPPER).map(element).collect();
    let pose = words(new.p_BoBcm_B.as_slice()) + " 0 0 0";
    let parts = vec![
        Wanted::saying("pose", pose).without(&["relative_to", "degrees", "rotation_format"]),
        Wanted::saying("mass", words(&[new.mass])),
        Wanted::holding("inertia", elements),
    ];
    // With `auto`, Gazebo computes other numbers from the shapes.
    Some(Wanted::holding("inertial", parts).without(&["auto"]))
}

fn spring(_: Node<'_, '_>, new: &Spring) -> Wanted {
    let all = [
        ("damping", new.damping),
        ("spring_reference", new.rest),
        ("spring_stiffness", new.stiffness),
    ];
    let given = all
        .into_iter()
        .filter_map(|(name, x)| Some(Wanted::saying(name, words(&[x?]))));
    let dynamics = Wanted::holding("dynamics", given.collect());
    Wanted::holding("joint", vec![Wanted::holding("axis", vec![dynamics])])
}
