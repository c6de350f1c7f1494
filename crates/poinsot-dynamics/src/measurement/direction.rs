//! Direction of a vector known in N, seen from a body: sun sensor, magnetometer.

use super::{Ideal, JointEffect, Measurement, OverJoint, Scene, attitude, beside};
use crate::algebra::{M3, V3};

/// `d_Bi = R_NBi^T d_N`.
#[inline(always)]
fn of(scene: &Scene) -> Option<V3<f64>> {
    let d_N = V3::of(scene.reference_N.as_ref()?);
    let d_B = scene.pose.matrix().transpose_times(&d_N);
    Some(scene.point.R_BiB().times(&d_B))
}

/// A small turn `a` of the body changes it by `d_Bi x a`. The reference is constant between two samples.
#[inline(always)]
pub(super) fn measure(scene: &Scene) -> Option<Measurement> {
    let d = of(scene)?;
    let to_body = scene.point.R_BiB();
    let w_NBi_Bi = to_body.times(&V3::of(&scene.point.w));
    Some(Measurement {
        rate: Some(d.cross(&w_NBi_Bi).stored()),
        pose: beside(&to_body.crossed(&d), &M3::diagonal(0.0)),
        ..Measurement::new(Ideal::vector(d))
    })
}

#[inline(always)]
pub(super) fn over_joint(scene: &Scene, joint: &JointEffect) -> Option<OverJoint> {
    let turn = attitude::over_joint(scene, joint).position;
    Some(OverJoint::position(of(scene)?.cross(&V3::of(&turn))))
}
