//! Velocity of a point in N; the difference of two is a velocity increment.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use crate::algebra::{M3, Real, V3};

/// `v_NP_N = R_NB v_NP_B`.
#[inline(always)]
pub(super) fn measure<T: Real>(scene: &Scene<T>) -> Measurement<T> {
    let R_NB = scene.pose.matrix();
    let (r, v) = (V3::of(&scene.point.r), V3::of(&scene.point.v));
    let zero = v.x.all(0.0);
    Measurement {
        pose: beside(&R_NB.times_skew(&-v), &M3::diagonal(zero)),
        twist: beside(&R_NB, &R_NB.times_skew(&-r)),
        ..Measurement::new(Ideal::vector(R_NB.times(&v)), zero)
    }
}

#[inline(always)]
pub(super) fn over_joint<T: Real>(scene: &Scene<T>, joint: &JointEffect<T>) -> OverJoint<T> {
    let R_NB = scene.pose.matrix();
    let (v, shift) = (V3::of(&joint.v), V3::of(&joint.shift));
    OverJoint::new(R_NB.times(&v), R_NB.times(&shift))
}
