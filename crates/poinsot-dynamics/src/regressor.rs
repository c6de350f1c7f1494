//! The momentum regressor: the 6 x 10(n+1) matrix that is the whole idea of linear identification.

use crate::kinematics::Kinematics;
use crate::tree::Tree;
use poinsot_spatial::Vector3;

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
    for (((R, p), (v, w)), columns) in bodies.zip(Y.chunks_exact_mut(10)) {
        // Mass: a point at the body's origin.
        columns[0] = stack(v, &p.cross(v));
        let axes = [0, 1, 2].map(|k| R.column(k).into_owned());
        // First moments: l = w x e, h = e x v + p x l for each body axis e.
        for (column, e) in columns[1..4].iter_mut().zip(&axes) {
            let l = w.cross(e);
            *column = stack(&l, &(e.cross(v) + p.cross(&l)));
        }
        // Tensor elements: h = e_a (e_b . w) + e_b (e_a . w).
        let rate = axes.map(|e| e.dot(w));
        let h = [
            axes[0] * rate[0],
            axes[0] * rate[1] + axes[1] * rate[0],
            axes[1] * rate[1],
            axes[0] * rate[2] + axes[2] * rate[0],
            axes[1] * rate[2] + axes[2] * rate[1],
            axes[2] * rate[2],
        ];
        for (column, h) in columns[4..10].iter_mut().zip(&h) {
            *column = [0.0, 0.0, 0.0, h.x, h.y, h.z];
        }
    }
}

/// Fills one column per wheel: the momentum `[0; Omega a]` in B of one unit of spin inertia at the
/// relative speeds given, rad/s.
#[inline]
pub fn wheel_regressor(tree: &Tree, kinematics: &Kinematics, speed: &[f64], Y: &mut [[f64; 6]]) {
    for ((rotor, omega), column) in tree.rotors.iter().zip(speed).zip(Y.iter_mut()) {
        let h = kinematics.R[rotor.body] * rotor.axis_B * *omega;
        *column = [0.0, 0.0, 0.0, h.x, h.y, h.z];
    }
}

#[inline]
fn stack(l: &Vector3, h: &Vector3) -> [f64; 6] {
    [l.x, l.y, l.z, h.x, h.y, h.z]
}
