//! URDF, the robot description of ROS.

use super::xml::{Format, UPPER, Wanted, words};
use super::{Measured, Patched};
use crate::urdf::{ELEMENTS, rotation};
use poinsot_spatial::MassProperties;
use roxmltree::Node;

/// Writes mass properties into the text of a valid URDF file.
///
/// The axes of an `<inertial>` (its `rpy`) are kept; the tensor is rotated to them. Missing elements (`<inertial>`,
/// `<origin>`) are added.
///
/// # Errors
/// The text is not XML, or the result does not read back.
///
/// ```
#[doc = include_str!("../../doc/measured.txt")]
/// let text = r#"<robot name="m"><link name="bus"><inertial><mass value="9"/>
/// <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>"#;
/// let patched = patch_urdf(text, &measured)?;
/// assert!(patched.text.contains(r#"<mass value="10.0"/>"#) && patched.missing.is_empty());
/// # Ok::<(), String>(())
/// ```
pub fn patch_urdf(text: &str, measured: &Measured) -> Result<Patched, String> {
    let format = Format {
        tag: "link",
        depth: 2,
        wanted,
        spring: None,
    };
    format.patched(text, measured)
}

fn wanted(link: Node<'_, '_>, new: &MassProperties) -> Option<Wanted> {
    let mut inertial = link.children().filter(|n| n.has_tag_name("inertial"));
    let origin = inertial.next().and_then(|own| {
        let mut origins = own.children().filter(|n| n.has_tag_name("origin"));
        origins.next()
    });
    let rpy = origin.and_then(|origin| origin.attribute("rpy"));
    let turn = rpy.map_or(Some([0.0; 3]), numbers).map(rotation)?;
    let i = turn.transpose() * new.I_BBcm_B * turn;
    let element = |(name, at)| (name, words(&[i[at]]));
    let elements = ELEMENTS.into_iter().zip(UPPER).map(element);
    let parts = vec![
        Wanted::new("origin", vec![("xyz", words(new.p_BoBcm_B.as_slice()))]),
        Wanted::new("mass", vec![("value", words(&[new.mass]))]),
        Wanted::new("inertia", elements.collect()),
    ];
    Some(Wanted::holding("inertial", parts))
}

/// The three finite numbers of an attribute.
fn numbers(text: &str) -> Option<[f64; 3]> {
    let words = text.split_whitespace().map(str::parse);
    let all: Vec<f64> = words.collect::<Result<_, _>>().ok()?;
    let finite = all.iter().all(|x| x.is_finite());
    all.try_into().ok().filter(|_| finite)
}
