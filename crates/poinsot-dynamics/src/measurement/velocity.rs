//! Velocity of a point in N; the difference of two is a velocity increment.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside, times_skew};
use poinsot_spatial::Matrix3;

/// `v_NP_N = R_NB v_NP_B`.
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (R_NB, point) = (scene.pose.matrix(), scene.point);
    Measurement {
        pose: beside(&-times_skew(&R_NB, &point.v), &Matrix3::zeros()),
        twist: beside(&R_NB, &-times_skew(&R_NB, &point.r)),
        ..Measurement::new(Ideal::Vector(R_NB * point.v))
    }
}

pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    let R_NB = scene.pose.matrix();
    OverJoint {
        position: R_NB * joint.v,
        rate: R_NB * joint.shift,
    }
}
