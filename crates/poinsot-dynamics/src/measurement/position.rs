//! Position of a point in N.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use crate::algebra::{M3, V3};

/// `p_NoP_N = p_NoBo_N + R_NB p_BoP_B`.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (R_NB, r) = (scene.pose.matrix(), V3::of(&scene.point.r));
    let value = V3::of(&scene.pose.p_NoBo_N) + R_NB.times(&r);
    Measurement {
        rate: Some(R_NB.times(&V3::of(&scene.point.v)).stored()),
        pose: beside(&R_NB.times_skew(&-r), &M3::diagonal(1.0)),
        ..Measurement::new(Ideal::vector(value))
    }
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    OverJoint::position(scene.pose.matrix().times(&V3::of(&joint.shift)))
}
