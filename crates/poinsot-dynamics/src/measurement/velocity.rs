//! Velocity of a point in N; the difference of two is a velocity increment.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use crate::algebra::{M3, V3};

/// `v_NP_N = R_NB v_NP_B`.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let R_NB = scene.pose.matrix();
    let (r, v) = (V3::of(&scene.point.r), V3::of(&scene.point.v));
    Measurement {
        pose: beside(&R_NB.times_skew(&-v), &M3::diagonal(0.0)),
        twist: beside(&R_NB, &R_NB.times_skew(&-r)),
        ..Measurement::new(Ideal::vector(R_NB.times(&v)))
    }
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    let R_NB = scene.pose.matrix();
    let (v, shift) = (V3::of(&joint.v), V3::of(&joint.shift));
    OverJoint::new(R_NB.times(&v), R_NB.times(&shift))
}
