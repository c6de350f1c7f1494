//! Attitude of a body in N: a star tracker. Its changes are small turns in the body's axes.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside, quaternion_of};
use crate::algebra::{M3, V3};

#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let to_body = scene.point.R_BiB();
    let R_NBi = scene.pose.R_NB * quaternion_of(&scene.point.R);
    Measurement {
        rate: Some(to_body.times(&V3::of(&scene.point.w)).stored()),
        pose: beside(&to_body, &M3::diagonal(0.0)),
        ..Measurement::new(Ideal::Rotation(R_NBi))
    }
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    OverJoint::position(scene.point.R_BiB().times(&V3::of(&joint.turn)))
}
