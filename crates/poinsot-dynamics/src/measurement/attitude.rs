//! Attitude of a body in N: a star tracker. Its changes are small turns in the body's axes.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use crate::algebra::{M3, Real, V3};
use crate::quaternion;

#[inline(always)]
pub(super) fn measure<T: Real>(scene: &Scene<T>) -> Measurement<T> {
    let (to_body, zero) = (scene.point.R_BiB(), scene.point.r.x.all(0.0));
    // `R_NBi`.
    let of_body = T::quaternion_of(&scene.point.R);
    let q_NB = quaternion::numbers(&scene.pose.R_NB);
    let value = Ideal::rotation(quaternion::product(&q_NB, &of_body));
    Measurement {
        rate: Some(to_body.times(&V3::of(&scene.point.w)).stored()),
        pose: beside(&to_body, &M3::diagonal(zero)),
        ..Measurement::new(value, zero)
    }
}

#[inline(always)]
pub(super) fn over_joint<T: Real>(scene: &Scene<T>, joint: &JointEffect<T>) -> OverJoint<T> {
    OverJoint::position(scene.point.R_BiB().times(&V3::of(&joint.turn)))
}
