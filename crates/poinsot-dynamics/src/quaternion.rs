//! Unit quaternions `[x, y, z, w]` over any numbers.

use crate::algebra::{M3, Real, V3};
use nalgebra::{Quaternion, Unit};

/// The numbers of a quaternion.
#[inline(always)]
pub(crate) fn numbers<T: Real>(q: &Unit<Quaternion<T>>) -> [T; 4] {
    let q = &q.as_ref().coords;
    [q.x, q.y, q.z, q.w]
}

/// Length one.
#[inline(always)]
pub(crate) fn unit<T: Real>([x, y, z, w]: [T; 4]) -> [T; 4] {
    let size = (x * x + y * y + z * z + w * w).root();
    [x / size, y / size, z / size, w / size]
}

/// `R_NB` of a unit quaternion.
#[inline(always)]
pub(crate) fn rotation<T: Real>(&[i, j, k, w]: &[T; 4]) -> M3<T> {
    let (ii, jj, kk, ww) = (i * i, j * j, k * k, w * w);
    let (ij, ik, jk) = (i * j * 2.0, i * k * 2.0, j * k * 2.0);
    let (wi, wj, wk) = (w * i * 2.0, w * j * 2.0, w * k * 2.0);
    M3([
        V3::new(ww + ii - jj - kk, wk + ij, ik - wj),
        V3::new(ij - wk, ww - ii + jj - kk, wi + jk),
        V3::new(wj + ik, jk - wi, ww - ii - jj + kk),
    ])
}

/// `q' = q (w_NB_B, 0) / 2`.
#[inline(always)]
pub(crate) fn rate<T: Real>(&[i, j, k, w]: &[T; 4], w_NB_B: &V3<T>) -> [T; 4] {
    let V3 { x, y, z } = *w_NB_B * w.all(0.5);
    [
        w * x + j * z - k * y,
        w * y + k * x - i * z,
        w * z + i * y - j * x,
        -(i * x) - j * y - k * z,
    ]
}
