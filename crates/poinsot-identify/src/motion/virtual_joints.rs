//! Joints that do not move: an error of a joint's origin or axis displaces all bodies that the joint carries, as another joint
//! in its place would.

use super::Motion;
use crate::problem::parameters::{Parameters, UnknownKind};
use poinsot_dynamics::{Link, Motion as Joint, SubtreeMotion, Tree};
use poinsot_spatial::Vector3;

/// Step of the differences over a joint's position, origin or axis, rad or m.
pub(super) const JOINT_STEP: f64 = 1.0e-5;

/// A joint that does not move, with the unknown that displaces it.
pub(crate) struct VirtualJoint {
    /// Index of the unknown.
    pub unknown: usize,
    pub motion: SubtreeMotion,
    /// Joint coordinate that the displacement is proportional to; `None` for a constant one.
    pub along: Option<usize>,
}

/// Body that a displaced joint carries, with the slopes of origin and axis.
fn place(kind: &UnknownKind) -> Option<(usize, &Vector3, &Vector3)> {
    match kind {
        UnknownKind::JointPlace {
            link,
            p_PoCo_P,
            axis_C,
        } => Some((*link, p_PoCo_P, axis_C)),
        _ => None,
    }
}

/// Virtual joints of all unknowns.
pub(super) fn virtual_joints(tree: &Tree, parameters: &Parameters) -> Vec<VirtualJoint> {
    let mut all = Vec::new();
    for (unknown, of) in parameters.unknowns.iter().enumerate() {
        let Some((link, p_PoCo_P, axis_C)) = place(&of.kind) else {
            continue;
        };
        let at = &tree.links[link];
        let mut push = |frame: usize, axis: Vector3, turns: bool, along: Option<usize>| {
            all.push(VirtualJoint {
                unknown,
                motion: SubtreeMotion {
                    link,
                    frame,
                    axis,
                    turns,
                },
                along,
            });
        };
        if *p_PoCo_P != Vector3::zeros() {
            push(at.parent, *p_PoCo_P, false, None);
        }
        if *axis_C == Vector3::zeros() {
            continue;
        }
        match at.motion {
            // A turned axis is a turn before the joint and the same turn back behind it.
            Joint::Revolute(_) => {
                let turn_C = at.axis_C.cross(axis_C);
                push(at.parent, at.R_PC_zero * turn_C, true, None);
                push(link, -turn_C, true, None);
            }
            Joint::Prismatic(k) => push(at.parent, at.R_PC_zero * axis_C, false, Some(k)),
            Joint::Fixed | Joint::Free => {}
        }
    }
    all
}

/// The tree at plus and minus [`JOINT_STEP`] of an unknown that displaces a joint; `None` for any other.
pub(super) fn moved_trees(tree: &Tree, kind: &UnknownKind) -> Option<[Tree; 2]> {
    let (link, p_PoCo_P, axis_C) = place(kind)?;
    let end = |step: f64| {
        let mut tree = tree.clone();
        let old = &tree.links[link];
        let axis = old.axis_C + axis_C * step;
        tree.links[link] = Link::new(
            old.parent,
            old.motion,
            old.p_PoCo_P + p_PoCo_P * step,
            old.R_PC_zero,
            axis.try_normalize(0.0).unwrap_or(axis),
        );
        tree
    };
    Some([end(JOINT_STEP), end(-JOINT_STEP)])
}

impl Motion<'_> {
    /// Motion of a joint coordinate that carries a body; virtual joints follow the real ones.
    pub(super) fn carrying(&self, coordinate: usize, body: usize) -> Option<&SubtreeMotion> {
        let motion = self.vehicle.joint_motions.get(coordinate)?;
        let tree = &self.vehicle.tree;
        tree.carries(motion.link, body).then_some(motion)
    }
}
