//! The momentum regressor: the 6 x 10(n+1) matrix of linear identification.

use crate::algebra::{M3, Real, V3, stack};
use crate::kinematics::Kinematics;
use crate::tree::Tree;
use nalgebra::{Matrix3, Vector3};

/// Fills `Y` with `[l; h] = Y pi`: column `10 i + k` holds the momentum about `Bo` in B (linear first)
/// of one unit of parameter k of body i, parameters in the order of `poinsot_spatial::PARAMETER_NAMES`.
///
/// The kinematics carry joint placement, base twist and joint rates; the columns are linear in the
/// velocities, so a unit base twist gives the sensitivity to that component. `Y` must hold ten columns
/// per body (extra columns are left alone).
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// kinematics.set_velocities(&tree, &Vector3::x(), &Vector3::z(), &[0.5]);
/// let mut Y = [[0.0; 6]; 20];
/// momentum_regressor(&kinematics, &mut Y);
/// // The columns times the parameters are the momentum.
/// let parameters = bodies.iter().flat_map(|b| b.to_array());
/// let product: Vector6 = Y.iter().zip(parameters).map(|(y, x)| Vector6::from(*y) * x).sum();
/// assert!((product - momentum(&bodies, &kinematics)).norm() < 1.0e-14);
/// ```
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

/// The ten columns of one body of [`momentum_regressor`].
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// kinematics.set_velocities(&tree, &Vector3::x(), &Vector3::z(), &[0.5]);
/// let (mut Y, mut columns) = ([[0.0; 6]; 20], [[0.0; 6]; 10]);
/// momentum_regressor(&kinematics, &mut Y);
/// body_regressor(&kinematics, 1, &mut columns);
/// assert_eq!(columns, Y[10..]);
/// ```
#[inline]
pub fn body_regressor(kinematics: &Kinematics, body: usize, columns: &mut [[f64; 6]; 10]) {
    let k = kinematics;
    body_columns(&k.R[body], &k.p[body], &k.v[body], &k.w[body], columns);
}

/// The ten columns of one body.
#[inline(always)]
pub(crate) fn body_columns<T: Real>(
    R: &Matrix3<T>,
    p: &Vector3<T>,
    v: &Vector3<T>,
    w: &Vector3<T>,
    columns: &mut [[T; 6]; 10],
) {
    let (R, p) = (M3::of(R), V3::of(p));
    let (v, w) = (V3::of(v), V3::of(w));
    let [x, y, z] = R.0;
    // Tensor elements: h = e_a (e_b . w) + e_b (e_a . w).
    let [wx, wy, wz] = [x.dot(&w), y.dot(&w), z.dot(&w)];
    // Mass: a point at the body's origin.
    columns[0] = stack(&v, &p.cross(&v));
    columns[1] = first_moment(&x, &p, &v, &w);
    columns[2] = first_moment(&y, &p, &v, &w);
    columns[3] = first_moment(&z, &p, &v, &w);
    columns[4] = angular(&(x * wx));
    columns[5] = angular(&(x * wy + y * wx));
    columns[6] = angular(&(y * wy));
    columns[7] = angular(&(x * wz + z * wx));
    columns[8] = angular(&(y * wz + z * wy));
    columns[9] = angular(&(z * wz));
}

/// First moment about a body axis e: `l = w x e`, `h = e x v + p x l`.
#[inline(always)]
fn first_moment<T: Real>(e: &V3<T>, p: &V3<T>, v: &V3<T>, w: &V3<T>) -> [T; 6] {
    let l = w.cross(e);
    stack(&l, &(e.cross(v) + p.cross(&l)))
}

/// Fills one column per wheel: the momentum `[0; Omega a]` in B of one unit of spin inertia at the
/// relative speeds given, rad/s.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let mut Y = [[0.0; 6]];
/// wheel_regressor(&tree, &kinematics, &[100.0], &mut Y);
/// assert_eq!(Y, [[0.0, 0.0, 0.0, 0.0, 0.0, 100.0]]);
/// ```
#[inline]
pub fn wheel_regressor(tree: &Tree, kinematics: &Kinematics, speed: &[f64], Y: &mut [[f64; 6]]) {
    for ((rotor, omega), column) in tree.rotors.iter().zip(speed).zip(Y.iter_mut()) {
        let h = kinematics.R[rotor.body] * rotor.axis_B * *omega;
        *column = angular(&V3::of(&h));
    }
}

#[inline(always)]
fn angular<T: Real>(h: &V3<T>) -> [T; 6] {
    stack(&V3::all(h.x.all(0.0)), h)
}
