//! Velocity of a point of body s seen from body r, in the axes of r: Doppler or optical flow of a camera on a servicer.
//!
//! No motion of the base changes it, so that it determines the motion of joints, not of the base.

use super::{Carried, Ideal, Measurement, OverJoint, Scene};
use poinsot_spatial::Vector3;

/// Place and velocity of the point relative to body r, in base axes.
fn apart(scene: &Scene) -> (Vector3, Vector3) {
    let (seen, from) = (scene.point, scene.from);
    let r = seen.r - from.r;
    (r, seen.v - from.v - from.w.cross(&r))
}

/// Rate of change of `p_BrS_Br`.
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (_, v) = apart(scene);
    Measurement::new(Ideal::Vector(scene.from.R.transpose() * v))
}

pub(super) fn over_joint(scene: &Scene, joint: Carried) -> OverJoint {
    let (to_from, w) = (scene.from.R.transpose(), scene.from.w);
    let (r, v) = apart(scene);
    match joint {
        Carried::Point(j) => OverJoint {
            position: to_from * (j.v - w.cross(&j.shift)),
            rate: to_from * j.shift,
        },
        // The axes turn too.
        Carried::From(j) => OverJoint {
            position: -(to_from * (j.v + j.w.cross(&r) - w.cross(&j.shift) + j.turn.cross(&v))),
            rate: -(to_from * (j.shift + j.turn.cross(&r))),
        },
    }
}
