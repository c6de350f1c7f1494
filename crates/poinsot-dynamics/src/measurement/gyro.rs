//! Gyro: the angular velocity of its body, in the body's axes.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use poinsot_spatial::Matrix3;

/// `w_NBi_Bi = R_BBi^T w_NBi_B`.
pub(super) fn measure(scene: &Scene) -> Measurement {
    let to_body = scene.point.R.transpose();
    Measurement {
        twist: beside(&Matrix3::zeros(), &to_body),
        ..Measurement::new(Ideal::Vector(to_body * scene.point.w))
    }
}

/// A joint turns the axes and all outboard bodies.
pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    let to_body = scene.point.R.transpose();
    OverJoint {
        position: to_body * (joint.w - joint.turn.cross(&scene.point.w)),
        rate: to_body * joint.turn,
    }
}
