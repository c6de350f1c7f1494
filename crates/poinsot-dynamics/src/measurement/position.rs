//! Position of a point in N.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use crate::algebra::{M3, Real, V3};

/// `p_NoP_N = p_NoBo_N + R_NB p_BoP_B`.
#[inline(always)]
pub(super) fn measure<T: Real>(scene: &Scene<T>) -> Measurement<T> {
    let (R_NB, point) = (scene.pose.matrix(), scene.point);
    let (r, zero) = (V3::of(&point.r), point.r.x.all(0.0));
    let value = V3::of(&scene.pose.p_NoBo_N) + R_NB.times(&r);
    Measurement {
        rate: Some(R_NB.times(&V3::of(&point.v)).stored()),
        pose: beside(&R_NB.times_skew(&-r), &M3::diagonal(zero.all(1.0))),
        ..Measurement::new(Ideal::vector(value), zero)
    }
}

#[inline(always)]
pub(super) fn over_joint<T: Real>(scene: &Scene<T>, joint: &JointEffect<T>) -> OverJoint<T> {
    OverJoint::position(scene.pose.matrix().times(&V3::of(&joint.shift)))
}
