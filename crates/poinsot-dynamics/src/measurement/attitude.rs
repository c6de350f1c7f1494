//! Attitude of a body in N: a star tracker. Its changes are small turns in the body's axes.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, beside};
use nalgebra::Rotation3;
use poinsot_spatial::{Matrix3, UnitQuaternion};

/// `R_NBi`.
pub(super) fn of(scene: &Scene) -> UnitQuaternion {
    let R_BBi = Rotation3::from_matrix_unchecked(scene.point.R);
    scene.pose.R_NB * UnitQuaternion::from_rotation_matrix(&R_BBi)
}

pub(super) fn measure(scene: &Scene) -> Measurement {
    let to_body = scene.point.R.transpose();
    Measurement {
        rate: Some(to_body * scene.point.w),
        pose: beside(&to_body, &Matrix3::zeros()),
        ..Measurement::new(Ideal::Rotation(of(scene)))
    }
}

pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> OverJoint {
    OverJoint::position(scene.point.R.transpose() * joint.turn)
}
