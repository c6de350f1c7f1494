//! Attitude of body s seen from body r: a camera on a servicer that sees the captured target.
//!
//! No motion of the base changes it, so that it determines joints, not the base.

use super::{Carried, Ideal, Measurement, OverJoint, Scene};
use crate::algebra::{M3, Real, V3};

/// `R_BrBs`. Its changes are small turns in the axes of s.
#[inline(always)]
pub(super) fn measure<T: Real>(scene: &Scene<T>) -> Measurement<T> {
    let (seen, from) = (scene.point, scene.from);
    let R_BrBs = from.R_BiB().product(&M3::of(&seen.R));
    let value = Ideal::rotation(T::quaternion_of(&R_BrBs.stored()));
    let w = V3::of(&seen.w) - V3::of(&from.w);
    Measurement {
        rate: Some(seen.R_BiB().times(&w).stored()),
        ..Measurement::new(value, w.x.all(0.0))
    }
}

#[inline(always)]
pub(super) fn over_joint<T: Real>(scene: &Scene<T>, joint: Carried<T>) -> OverJoint<T> {
    let to_seen = scene.point.R_BiB();
    OverJoint::position(match joint {
        Carried::Point(j) => to_seen.times(&V3::of(&j.turn)),
        Carried::From(j) => -to_seen.times(&V3::of(&j.turn)),
    })
}
