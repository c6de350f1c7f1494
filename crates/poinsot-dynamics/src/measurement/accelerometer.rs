//! Accelerometer: specific force at a point, in the axes of its body. N falls freely, so it is the inertial acceleration.

use super::{Ideal, Measurement, Scene};

/// Its derivatives are those of the equation of motion: the ones given are zero.
pub(super) fn measure(scene: &Scene) -> Option<Measurement> {
    let force_Bi = scene.point.R.transpose() * scene.a_NP_B?;
    Some(Measurement::new(Ideal::Vector(force_Bi)))
}
