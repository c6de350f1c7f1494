//! Attitude of body s seen from body r: a camera on a servicer that sees the captured target.
//!
//! No motion of the base changes it, so that it determines joints, not the base.

use super::{Carried, Ideal, Measurement, OverJoint, Scene, quaternion_of};
use crate::algebra::{M3, V3};

/// `R_BrBs`. Its changes are small turns in the axes of s.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (seen, from) = (scene.point, scene.from);
    let R_BrBs = from.R_BiB().product(&M3::of(&seen.R));
    let value = Ideal::Rotation(quaternion_of(&R_BrBs.stored()));
    let w = V3::of(&seen.w) - V3::of(&from.w);
    Measurement {
        rate: Some(seen.R_BiB().times(&w).stored()),
        ..Measurement::new(value)
    }
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: Carried) -> OverJoint {
    let to_seen = scene.point.R_BiB();
    OverJoint::position(match joint {
        Carried::Point(j) => to_seen.times(&V3::of(&j.turn)),
        Carried::From(j) => -to_seen.times(&V3::of(&j.turn)),
    })
}
