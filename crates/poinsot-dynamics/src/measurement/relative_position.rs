//! Position of a point of body s seen from the origin of body r, in the axes of r: a marker before a camera.
//!
//! No motion of the base changes it, so that it determines joints, not the base.

use super::{Carried, Ideal, Measurement, OverJoint, Scene};

/// `p_BrS_Br = R_BBr^T (p_BoS_B - p_BoBr_B)`.
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (seen, from) = (scene.point, scene.from);
    let to_from = from.R.transpose();
    let apart = seen.r - from.r;
    Measurement {
        rate: Some(to_from * (seen.v - from.v - from.w.cross(&apart))),
        ..Measurement::new(Ideal::Vector(to_from * apart))
    }
}

pub(super) fn over_joint(scene: &Scene, joint: Carried) -> OverJoint {
    let to_from = scene.from.R.transpose();
    let apart = scene.point.r - scene.from.r;
    OverJoint::position(match joint {
        Carried::Point(j) => to_from * j.shift,
        Carried::From(j) => -(to_from * (j.shift + j.turn.cross(&apart))),
    })
}
