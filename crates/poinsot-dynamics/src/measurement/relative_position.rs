//! Position of a point of body s seen from the origin of body r, in the axes of r: a marker before a camera.
//!
//! No motion of the base changes it, so that it determines joints, not the base.

use super::relative_velocity::apart;
use super::{Carried, Ideal, Measurement, OverJoint, Scene};
use crate::algebra::V3;

/// `p_BrS_Br = R_BBr^T (p_BoS_B - p_BoBr_B)`.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Measurement {
    let (to_from, (r, v)) = (scene.from.R_BiB(), apart(scene));
    Measurement {
        rate: Some(to_from.times(&v).stored()),
        ..Measurement::new(Ideal::vector(to_from.times(&r)))
    }
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: Carried) -> OverJoint {
    let (to_from, (r, _)) = (scene.from.R_BiB(), apart(scene));
    OverJoint::position(match joint {
        Carried::Point(j) => to_from.times(&V3::of(&j.shift)),
        Carried::From(j) => {
            let turned = V3::of(&j.turn).cross(&r);
            -to_from.times(&(V3::of(&j.shift) + turned))
        }
    })
}
