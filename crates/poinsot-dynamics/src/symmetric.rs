//! Symmetric 3 x 3 matrices by their six elements, and the products that the dynamics needs.

use crate::algebra::{M3, Real, V3};
use core::ops::AddAssign;
use nalgebra::Matrix3;

/// A symmetric 3 x 3 matrix.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Symmetric<T = f64> {
    pub xx: T,
    pub xy: T,
    pub yy: T,
    pub xz: T,
    pub yz: T,
    pub zz: T,
}

impl Symmetric {
    /// The lower triangle of a matrix that is symmetric.
    #[inline]
    pub fn of(m: &Matrix3<f64>) -> Self {
        Self::new([m.m11, m.m21, m.m22, m.m31, m.m32, m.m33])
    }
}

impl<T: Real> Symmetric<T> {
    /// From `xx, xy, yy, xz, yz, zz`.
    #[inline(always)]
    pub fn new([xx, xy, yy, xz, yz, zz]: [T; 6]) -> Self {
        Self {
            xx,
            xy,
            yy,
            xz,
            yz,
            zz,
        }
    }

    /// The full matrix.
    #[inline(always)]
    pub fn full(&self) -> M3<T> {
        M3([
            V3::new(self.xx, self.xy, self.xz),
            V3::new(self.xy, self.yy, self.yz),
            V3::new(self.xz, self.yz, self.zz),
        ])
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(&self) -> T {
        self.xx + self.yy + self.zz
    }

    /// `self x`.
    #[inline(always)]
    pub fn times(&self, x: &V3<T>) -> V3<T> {
        V3::new(
            self.xx * x.x + self.xy * x.y + self.xz * x.z,
            self.xy * x.x + self.yy * x.y + self.yz * x.z,
            self.xz * x.x + self.yz * x.y + self.zz * x.z,
        )
    }

    /// `R self R^T`: a tensor in other axes.
    #[inline(always)]
    pub fn turned(&self, R: &M3<T>) -> Self {
        // Rows of R self, then the six dot products with the rows of R.
        let [x, y, z] = R.transposed().0;
        let (p, q, r) = (self.times(&x), self.times(&y), self.times(&z));
        Self::new([
            p.dot(&x),
            q.dot(&x),
            q.dot(&y),
            r.dot(&x),
            r.dot(&y),
            r.dot(&z),
        ])
    }

    /// Subtracts `a b^T`, symmetric because `a` and `b` are parallel.
    #[inline(always)]
    pub fn subtract_outer(&mut self, a: &V3<T>, b: &V3<T>) {
        self.xx = self.xx - a.x * b.x;
        self.xy = self.xy - a.x * b.y;
        self.yy = self.yy - a.y * b.y;
        self.xz = self.xz - a.x * b.z;
        self.yz = self.yz - a.y * b.z;
        self.zz = self.zz - a.z * b.z;
    }

    /// `self + other`.
    #[inline(always)]
    pub fn plus(mut self, other: &Self) -> Self {
        self += *other;
        self
    }

    /// `self - other`.
    #[inline(always)]
    pub fn minus(self, other: &Self) -> Self {
        Self {
            xx: self.xx - other.xx,
            xy: self.xy - other.xy,
            yy: self.yy - other.yy,
            xz: self.xz - other.xz,
            yz: self.yz - other.yz,
            zz: self.zz - other.zz,
        }
    }

    /// The factors of `L D L^T`, without square roots. The caller checks that the pivots are positive.
    #[inline(always)]
    pub fn factor(&self) -> Factor<T> {
        let d1 = self.xx;
        let one = d1.all(1.0);
        let i1 = one / d1;
        let (l21, l31) = (self.xy * i1, self.xz * i1);
        let d2 = self.yy - l21 * self.xy;
        let i2 = one / d2;
        let e32 = self.yz - l21 * self.xz;
        let l32 = e32 * i2;
        let d3 = self.zz - l31 * self.xz - l32 * e32;
        Factor {
            l21,
            l31,
            l32,
            inverse: V3::new(i1, i2, one / d3),
            pivots: V3::new(d1, d2, d3),
        }
    }

    /// The inverse; `None` where the matrix is not positive definite.
    #[inline(always)]
    pub fn inverse(&self) -> Option<Self> {
        let factor = self.factor();
        let (zero, one) = (self.xx.all(0.0), self.xx.all(1.0));
        if !factor.pivots_exceed(zero) {
            return None;
        }
        let [x, y, z] = M3::diagonal(one).0;
        let (x, y, z) = (factor.solve(&x), factor.solve(&y), factor.solve(&z));
        Some(Self::new([x.x, x.y, y.y, x.z, y.z, z.z]))
    }
}

/// `L D L^T` of a symmetric matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factor<T> {
    l21: T,
    l31: T,
    l32: T,
    /// Reciprocals of the pivots.
    pub inverse: V3<T>,
    /// Positive, all of them, for a positive definite matrix.
    pivots: V3<T>,
}

impl<T: Real> Factor<T> {
    /// Whether every pivot, in every lane, is larger than `least`.
    #[inline(always)]
    pub fn pivots_exceed(&self, least: T) -> bool {
        let V3 { x, y, z } = self.pivots;
        x.exceeds(least) && y.exceeds(least) && z.exceeds(least)
    }

    /// The solution for the right-hand side `b`.
    #[inline(always)]
    pub fn solve(&self, b: &V3<T>) -> V3<T> {
        self.back(&self.forward(b).times_each(&self.inverse))
    }

    /// `L^-1 b`.
    #[inline(always)]
    pub fn forward(&self, b: &V3<T>) -> V3<T> {
        let y = b.y - self.l21 * b.x;
        V3::new(b.x, y, b.z - self.l31 * b.x - self.l32 * y)
    }

    /// `L^-T b`.
    #[inline(always)]
    pub fn back(&self, b: &V3<T>) -> V3<T> {
        let y = b.y - self.l32 * b.z;
        V3::new(b.x - self.l21 * y - self.l31 * b.z, y, b.z)
    }
}

impl<T: Real> AddAssign for Symmetric<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.xx = self.xx + other.xx;
        self.xy = self.xy + other.xy;
        self.yy = self.yy + other.yy;
        self.xz = self.xz + other.xz;
        self.yz = self.yz + other.yz;
        self.zz = self.zz + other.zz;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_spatial::Vector3;

    #[test]
    fn exact_products_are_those_of_full_matrices() {
        let full = Matrix3::new(4.0, -1.0, 0.5, -1.0, 3.0, 0.2, 0.5, 0.2, 2.0);
        let s = Symmetric::of(&full);
        let R = *nalgebra::Rotation3::new(Vector3::new(0.3, -1.1, 0.7)).matrix();
        let x = Vector3::new(0.7, -0.2, 1.9);
        let v = V3::of(&x);
        let near = |a: Matrix3<f64>, b: Matrix3<f64>| assert!((a - b).amax() < 4e-15, "{a} {b}");
        near(s.full().stored(), full);
        near(
            s.turned(&M3::of(&R)).full().stored(),
            R * full * R.transpose(),
        );
        let mut less = s;
        less.subtract_outer(&(v * 0.3), &v);
        near(less.full().stored(), full - x * x.transpose() * 0.3);
        assert!((s.times(&v).stored() - full * x).amax() < 1e-15);
        let inverse = s.inverse().unwrap().full().stored();
        near(inverse * full, Matrix3::identity());
        assert!(Symmetric::of(&-full).inverse().is_none());
        assert!(Symmetric::of(&(full * f64::NAN)).inverse().is_none());
        assert!(Symmetric::of(&Matrix3::zeros()).inverse().is_none());
    }
}
