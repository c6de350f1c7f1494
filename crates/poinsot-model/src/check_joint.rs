//! Checks joints: unit axes and proper rotations.

use crate::check::Check;
use crate::file::{JointFile, SpringDamperFile, SpringParameter, Which};
use crate::finding::Key;
use crate::vehicle::{Joint, JointKind, SpringDamper, SpringNumber};
use poinsot_spatial::Vector3;

impl Check<'_, '_> {
    pub fn joint(&mut self, k: usize, file: &JointFile) -> Option<Joint> {
        let key = Key::entry("joint", k, file.name.as_deref());
        let rotation = self.rotation(file.rotation_xyzw, file.rotation_matrix, &key);
        let (kind, here) = (file.kind?, key.at("axis"));
        let axis = match (kind, file.axis) {
            (JointKind::Fixed, given) => {
                if given.is_some() {
                    self.note(&here, "the axis of a fixed joint has no effect");
                }
                Some(Vector3::zeros())
            }
            (_, axis) => axis.and_then(|axis| self.axis(&axis, &here, "axis")),
        };
        Some(Joint {
            name: file.name.clone()?,
            kind,
            parent: self.body_of(file.parent.as_deref())?,
            child: self.body_of(file.child.as_deref())?,
            p_PoCo_P: Vector3::from(file.origin_m?),
            R_PC_zero: rotation?,
            axis_C: axis?,
            locked_at: file.locked_at_rad.or(file.locked_at_m),
            spring_damper: file.spring_damper.as_ref().map(spring_damper),
            spring_unknown: file.spring_damper.as_ref().map_or_else(Vec::new, unknown),
        })
    }
}

fn unknown(file: &SpringDamperFile) -> Vec<SpringNumber> {
    let all = SpringParameter::ALL.into_iter();
    let asked = all.filter(|(key, _)| Which::asks(file.estimate.as_ref(), key));
    asked.map(|(_, number)| number).collect()
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
