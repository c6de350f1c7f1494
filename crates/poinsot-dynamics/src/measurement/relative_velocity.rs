//! Velocity of a point of body s seen from body r, in the axes of r: Doppler or optical flow of a camera on a servicer.
//!
//! No motion of the base changes it, so that it determines the motion of joints, not of the base.

use super::{Carried, Ideal, Measurement, OverJoint, Scene};
use crate::algebra::V3;

/// Place and velocity of the point relative to body r, in base axes.
#[inline(always)]
pub(super) fn apart(scene: &Scene) -> (V3<f64>, V3<f64>) {
    let (seen, from) = (scene.point, scene.from);
    let r = V3::of(&seen.r) - V3::of(&from.r);
    let carried = V3::of(&from.w).cross(&r);
    (r, V3::of(&seen.v) - V3::of(&from.v) - carried)
}

/// Rate of change of `p_BrS_Br`.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (_, v) = apart(scene);
    Measurement::new(Ideal::vector(scene.from.R_BiB().times(&v)))
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: Carried) -> OverJoint {
    let (to_from, w) = (scene.from.R_BiB(), V3::of(&scene.from.w));
    let (r, v) = apart(scene);
    let (Carried::Point(j) | Carried::From(j)) = joint;
    let (turn, shift) = (V3::of(&j.turn), V3::of(&j.shift));
    let (dw, dv) = (V3::of(&j.w), V3::of(&j.v));
    match joint {
        Carried::Point(_) => {
            let position = dv - w.cross(&shift);
            OverJoint::new(to_from.times(&position), to_from.times(&shift))
        }
        // The axes turn too.
        Carried::From(_) => {
            let position = dv + dw.cross(&r) - w.cross(&shift) + turn.cross(&v);
            let rate = shift + turn.cross(&r);
            OverJoint::new(-to_from.times(&position), -to_from.times(&rate))
        }
    }
}
