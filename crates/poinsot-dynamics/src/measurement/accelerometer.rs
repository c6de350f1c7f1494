//! Accelerometer: specific force at a point, in the axes of its body. N falls freely, so it is the inertial acceleration.

use super::{Ideal, Measurement, Scene};
use crate::algebra::V3;

/// Its derivatives are those of the equation of motion: the ones given are zero.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Option<Measurement> {
    let a = V3::of(scene.a_NP_B.as_ref()?);
    let force_Bi = scene.point.R_BiB().times(&a);
    Some(Measurement::new(Ideal::vector(force_Bi)))
}
