//! Direction of a vector known in N, seen from a body: sun sensor, magnetometer.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, attitude};
use poinsot_spatial::{Vector3, skew};

/// `d_Bi = R_NBi^T d_N`.
fn of(scene: &Scene) -> Option<Vector3> {
    Some(attitude::of(scene).inverse() * scene.reference_N?)
}

/// A small turn `a` of the body changes it by `d_Bi x a`. The reference is constant between two samples.
pub(super) fn measure(scene: &Scene) -> Option<Measurement> {
    let d = of(scene)?;
    let turned = attitude::measure(scene);
    Some(Measurement {
        rate: turned.rate.map(|w_NBi_Bi| d.cross(&w_NBi_Bi)),
        pose: skew(&d) * turned.pose,
        ..Measurement::new(Ideal::Vector(d))
    })
}

pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> Option<OverJoint> {
    let turn = attitude::over_joint(scene, joint).position;
    Some(OverJoint::position(skew(&of(scene)?) * turn))
}
