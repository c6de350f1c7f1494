//! Checks joints: unit axes and proper rotations.

use crate::check_rotation::{check_axis, check_rotation};
use crate::file::{JointFile, SpringDamperFile};
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
    let kind = file.kind?;
    let here = key.at("axis");
    let axis = match (kind, &file.axis) {
        (JointKind::Fixed, given) => {
            if given.is_some() {
                findings.note(&here, "the axis of a fixed joint has no effect");
            }
            Some(Vector3::zeros())
        }
        (_, axis) => axis
            .as_ref()
            .and_then(|axis| check_axis(axis, &here, "axis", findings)),
    };
    Some(Joint {
        name: file.name.clone()?,
        kind,
        parent: resolve(file.parent.as_deref()?)?,
        child: resolve(file.child.as_deref()?)?,
        p_PoCo_P: Vector3::from(file.origin_m?),
        R_PC_zero: rotation?,
        axis_C: axis?,
        locked_at: file.locked_at_rad.or(file.locked_at_m),
        spring_damper: file.spring_damper.as_ref().map(spring_damper),
    })
}

/// The numbers in the unit of the joint: keys of the other unit have been refused.
fn spring_damper(file: &SpringDamperFile) -> SpringDamper {
    let stiffness = file.stiffness_N_m_per_rad.or(file.stiffness_N_per_m);
    let damping = file.damping_N_m_s_per_rad.or(file.damping_N_s_per_m);
    let rest = file.rest_rad.or(file.rest_m);
    let [stiffness, damping, rest] = [stiffness, damping, rest].map(|x| x.unwrap_or(0.0));
    SpringDamper {
        stiffness,
        damping,
        rest,
    }
}
