//! Joints with unit axes and proper rotations.

use crate::check_rotation::{check_axis, check_rotation};
use crate::file::{JointFile, JointType};
use crate::finding::{Findings, Key};
use crate::vehicle::{Joint, JointKind};
use poinsot_spatial::Vector3;

pub(crate) fn check_joints(
    files: &[JointFile],
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Vec<Joint> {
    files
        .iter()
        .enumerate()
        .filter_map(|(k, file)| check_joint(k, file, resolve, findings))
        .collect()
}

fn check_joint(
    k: usize,
    file: &JointFile,
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Option<Joint> {
    let key = Key::entry("joint", k, file.name.as_deref());
    let rotation = check_rotation(
        file.rotation_xyzw.as_ref(),
        file.rotation_matrix.as_ref(),
        &key,
        findings,
    );
    let kind = match file.kind? {
        JointType::Revolute => JointKind::Revolute,
        JointType::Prismatic => JointKind::Prismatic,
        JointType::Fixed => JointKind::Fixed,
    };
    let axis = check_joint_axis(file, kind, &key, findings);
    let locked_at = check_locked_at(file, kind, &key, findings);
    Some(Joint {
        name: file.name.clone()?,
        kind,
        parent: resolve(file.parent.as_deref()?)?,
        child: resolve(file.child.as_deref()?)?,
        p_PoCo_P: Vector3::from(file.origin_m?),
        R_PC_zero: rotation?,
        axis_C: axis?,
        locked_at,
    })
}

fn check_joint_axis(
    file: &JointFile,
    kind: JointKind,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Vector3> {
    let here = key.at("axis");
    match (kind, &file.axis) {
        (JointKind::Fixed, None) => Some(Vector3::zeros()),
        (JointKind::Fixed, Some(_)) => {
            findings.note(&here, "the axis of a fixed joint has no effect".to_owned());
            Some(Vector3::zeros())
        }
        (_, Some(axis)) => check_axis(axis, &here, "axis", findings),
        (_, None) => {
            if !findings.has_near(&here) {
                findings.missing(
                    &here,
                    "the key is missing on a joint that moves",
                    "add axis = [x, y, z] in the child's frame",
                );
            }
            None
        }
    }
}

fn check_locked_at(
    file: &JointFile,
    kind: JointKind,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> f64 {
    let (wanted, other, other_name, remedy) = match kind {
        JointKind::Revolute => (
            file.locked_at_rad,
            file.locked_at_m,
            "locked_at_m",
            "write locked_at_rad for a revolute joint",
        ),
        JointKind::Prismatic => (
            file.locked_at_m,
            file.locked_at_rad,
            "locked_at_rad",
            "write locked_at_m for a prismatic joint",
        ),
        JointKind::Fixed => (
            None,
            file.locked_at_rad.or(file.locked_at_m),
            if file.locked_at_rad.is_some() {
                "locked_at_rad"
            } else {
                "locked_at_m"
            },
            "remove it: a fixed joint does not move",
        ),
    };
    if other.is_some() {
        findings.refuse(
            "E0105",
            &key.at(other_name),
            "the key does not fit the type of the joint".to_owned(),
            remedy,
        );
    }
    wanted.unwrap_or(0.0)
}
