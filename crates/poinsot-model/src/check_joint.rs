//! Checks joints: unit axes and proper rotations.

use crate::check_rotation::{check_axis, check_rotation};
use crate::file::{JointFile, JointType, SpringDamperFile};
use crate::finding::{Findings, Key};
use crate::vehicle::{Joint, JointKind, SpringDamper};
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
    let spring_damper = file
        .spring_damper
        .as_ref()
        .map(|spring| check_spring_damper(spring, kind, &key.at("spring_damper"), findings));
    Some(Joint {
        name: file.name.clone()?,
        kind,
        parent: resolve(file.parent.as_deref()?)?,
        child: resolve(file.child.as_deref()?)?,
        p_PoCo_P: Vector3::from(file.origin_m?),
        R_PC_zero: rotation?,
        axis_C: axis?,
        locked_at,
        spring_damper,
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

/// Spring and damper in the units of the joint type; zero if invalid.
fn check_spring_damper(
    file: &SpringDamperFile,
    kind: JointKind,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> SpringDamper {
    if kind == JointKind::Fixed {
        findings.refuse(
            "E0105",
            key,
            "the key does not fit the type of the joint".to_owned(),
            "remove it: a fixed joint does not move",
        );
        return SpringDamper::default();
    }
    let turning = [
        ("stiffness_N_m_per_rad", file.stiffness_N_m_per_rad),
        ("damping_N_m_s_per_rad", file.damping_N_m_s_per_rad),
        ("rest_rad", file.rest_rad),
    ];
    let sliding = [
        ("stiffness_N_per_m", file.stiffness_N_per_m),
        ("damping_N_s_per_m", file.damping_N_s_per_m),
        ("rest_m", file.rest_m),
    ];
    let (own, other, what) = match kind {
        JointKind::Prismatic => (sliding, turning, "prismatic"),
        _ => (turning, sliding, "revolute"),
    };
    for ((name, value), (wanted, _)) in other.iter().zip(&own) {
        if value.is_some() {
            findings.refuse(
                "E0105",
                &key.at(name),
                "the key does not fit the type of the joint".to_owned(),
                format!("write {wanted} for a {what} joint"),
            );
        }
    }
    let stiffness = key.at(own[0].0);
    if own[0].1.is_none() && other[0].1.is_none() && !findings.has_near(&stiffness) {
        findings.missing(
            &stiffness,
            "the key is missing",
            "add it; 0.0 for a hinge without a spring",
        );
    }
    for (name, value) in &own[..2] {
        if value.is_some_and(|x| x < 0.0) {
            findings.refuse(
                "E0108",
                &key.at(name),
                "stiffness and damping must not be negative: negative values add energy".to_owned(),
                "give zero or a positive number",
            );
        }
    }
    let [stiffness, damping, rest] = own.map(|(_, value)| value.unwrap_or(0.0));
    SpringDamper {
        stiffness,
        damping,
        rest,
    }
}
