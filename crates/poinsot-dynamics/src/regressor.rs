//! The momentum regressor: the 6 x 10(n+1) matrix of linear identification.

use crate::kinematics::Kinematics;
use crate::tree::Tree;
use poinsot_spatial::{Matrix3, Vector3};

/// Fills `Y` with `[l; h] = Y pi`: column `10 i + k` holds the momentum about `Bo` in B (linear first)
/// of one unit of parameter k of body i, parameters in the order of `poinsot_spatial::PARAMETER_NAMES`.
///
/// The kinematics carry joint placement, base twist and joint rates; the columns are linear in the
/// velocities, so a unit base twist gives the sensitivity to that component. `Y` must hold ten columns
/// per body (extra columns are left alone).
#[inline]
pub fn momentum_regressor(kinematics: &Kinematics, Y: &mut [[f64; 6]]) {
    let bodies = kinematics
        .R
        .iter()
        .zip(&kinematics.p)
        .zip(kinematics.v.iter().zip(&kinematics.w));
    for (((R, p), (v, w)), columns) in bodies.zip(Y.as_chunks_mut::<10>().0) {
        body_columns(R, p, v, w, columns);
    }
}

/// The ten columns of one body.
#[inline]
fn body_columns(R: &Matrix3, p: &Vector3, v: &Vector3, w: &Vector3, columns: &mut [[f64; 6]; 10]) {
    // Mass: a point at the body's origin.
    columns[0] = stack(v, &p.cross(v));
    let axes = [0, 1, 2].map(|k| Vector3::new(R[(0, k)], R[(1, k)], R[(2, k)]));
    // First moments: l = w x e, h = e x v + p x l for each body axis e.
    for (k, e) in axes.iter().enumerate() {
        let l = w.cross(e);
        columns[1 + k] = stack(&l, &(e.cross(v) + p.cross(&l)));
    }
    // Tensor elements: h = e_a (e_b . w) + e_b (e_a . w).
    let [x, y, z] = axes;
    let [wx, wy, wz] = [x.dot(w), y.dot(w), z.dot(w)];
    columns[4] = angular(&(x * wx));
    columns[5] = angular(&(x * wy + y * wx));
    columns[6] = angular(&(y * wy));
    columns[7] = angular(&(x * wz + z * wx));
    columns[8] = angular(&(y * wz + z * wy));
    columns[9] = angular(&(z * wz));
}

/// Fills one column per wheel: the momentum `[0; Omega a]` in B of one unit of spin inertia at the
/// relative speeds given, rad/s.
#[inline]
pub fn wheel_regressor(tree: &Tree, kinematics: &Kinematics, speed: &[f64], Y: &mut [[f64; 6]]) {
    for ((rotor, omega), column) in tree.rotors.iter().zip(speed).zip(Y.iter_mut()) {
        let h = kinematics.R[rotor.body] * rotor.axis_B * *omega;
        *column = angular(&h);
    }
}

#[inline]
fn stack(l: &Vector3, h: &Vector3) -> [f64; 6] {
    [l.x, l.y, l.z, h.x, h.y, h.z]
}

#[inline]
fn angular(h: &Vector3) -> [f64; 6] {
    [0.0, 0.0, 0.0, h.x, h.y, h.z]
}
