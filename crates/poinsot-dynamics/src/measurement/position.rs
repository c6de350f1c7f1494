//! Position of a point in N.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside, times_skew};
use poinsot_spatial::Matrix3;

/// `p_NoP_N = p_NoBo_N + R_NB p_BoP_B`.
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (R_NB, point) = (scene.pose.matrix(), scene.point);
    Measurement {
        rate: Some(R_NB * point.v),
        pose: beside(&-times_skew(&R_NB, &point.r), &Matrix3::identity()),
        ..Measurement::new(Ideal::Vector(scene.pose.p_NoBo_N + R_NB * point.r))
    }
}

pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    OverJoint::position(scene.pose.matrix() * joint.shift)
}
