//! Attitude of body s seen from body r: a camera on a servicer that sees the captured target.
//!
//! No motion of the base changes it, so that it determines joints, not the base.

use super::{Carried, Ideal, Measurement, OverJoint, Scene};
use nalgebra::Rotation3;
use poinsot_spatial::UnitQuaternion;

/// `R_BrBs`. Its changes are small turns in the axes of s.
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (seen, from) = (scene.point, scene.from);
    let R_BrBs = Rotation3::from_matrix_unchecked(from.R.transpose() * seen.R);
    let value = UnitQuaternion::from_rotation_matrix(&R_BrBs);
    Measurement {
        rate: Some(seen.R.transpose() * (seen.w - from.w)),
        ..Measurement::new(Ideal::Rotation(value))
    }
}

pub(super) fn over_joint(scene: &Scene, joint: Carried) -> OverJoint {
    let to_seen = scene.point.R.transpose();
    OverJoint::position(match joint {
        Carried::Point(j) => to_seen * j.turn,
        Carried::From(j) => -(to_seen * j.turn),
    })
}
