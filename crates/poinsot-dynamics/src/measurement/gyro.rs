//! Gyro: the angular velocity of its body, in the body's axes.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use crate::algebra::{M3, V3};

/// `w_NBi_Bi = R_BBi^T w_NBi_B`.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (to_body, w) = (scene.point.R_BiB(), V3::of(&scene.point.w));
    Measurement {
        twist: beside(&M3::diagonal(0.0), &to_body),
        ..Measurement::new(Ideal::vector(to_body.times(&w)))
    }
}

/// A joint turns the axes and all outboard bodies.
#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    let (to_body, w) = (scene.point.R_BiB(), V3::of(&scene.point.w));
    let turn = V3::of(&joint.turn);
    let change = V3::of(&joint.w) - turn.cross(&w);
    OverJoint::new(to_body.times(&change), to_body.times(&turn))
}
