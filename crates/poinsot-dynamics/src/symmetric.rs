//! Symmetric 3 x 3 matrices by their six elements, and the products that the dynamics needs.

use core::ops::AddAssign;
use poinsot_spatial::{Matrix3, Vector3};

/// A symmetric 3 x 3 matrix.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Symmetric {
    pub xx: f64,
    pub xy: f64,
    pub yy: f64,
    pub xz: f64,
    pub yz: f64,
    pub zz: f64,
}

impl Symmetric {
    /// Nothing.
    pub const ZERO: Self = Self {
        xx: 0.0,
        xy: 0.0,
        yy: 0.0,
        xz: 0.0,
        yz: 0.0,
        zz: 0.0,
    };

    /// The lower triangle of a matrix that is symmetric.
    #[inline]
    pub fn of(m: &Matrix3) -> Self {
        Self {
            xx: m.m11,
            xy: m.m21,
            yy: m.m22,
            xz: m.m31,
            yz: m.m32,
            zz: m.m33,
        }
    }

    /// The full matrix.
    #[inline]
    pub fn full(&self) -> Matrix3 {
        let Self {
            xx,
            xy,
            yy,
            xz,
            yz,
            zz,
        } = *self;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// `self x`.
    #[inline]
    pub fn times(&self, x: &Vector3) -> Vector3 {
        Vector3::new(
            self.xx * x.x + self.xy * x.y + self.xz * x.z,
            self.xy * x.x + self.yy * x.y + self.yz * x.z,
            self.xz * x.x + self.yz * x.y + self.zz * x.z,
        )
    }

    /// `R self R^T`: a tensor in other axes.
    #[inline]
    pub fn turned(&self, R: &Matrix3) -> Self {
        // Rows of R self, then the six dot products with the rows of R.
        let row = |i: usize| {
            let (a, b, c) = (R[(i, 0)], R[(i, 1)], R[(i, 2)]);
            [
                a * self.xx + b * self.xy + c * self.xz,
                a * self.xy + b * self.yy + c * self.yz,
                a * self.xz + b * self.yz + c * self.zz,
            ]
        };
        let [x, y, z] = [row(0), row(1), row(2)];
        let dot = |m: &[f64; 3], i: usize| m[0] * R[(i, 0)] + m[1] * R[(i, 1)] + m[2] * R[(i, 2)];
        Self {
            xx: dot(&x, 0),
            xy: dot(&y, 0),
            yy: dot(&y, 1),
            xz: dot(&z, 0),
            yz: dot(&z, 1),
            zz: dot(&z, 2),
        }
    }

    /// Subtracts `a b^T`, symmetric because `a` and `b` are parallel.
    #[inline]
    pub fn subtract_outer(&mut self, a: &Vector3, b: &Vector3) {
        self.xx -= a.x * b.x;
        self.xy -= a.x * b.y;
        self.yy -= a.y * b.y;
        self.xz -= a.x * b.z;
        self.yz -= a.y * b.z;
        self.zz -= a.z * b.z;
    }

    /// The factors of `L D L^T`, without square roots. The caller checks that the pivots are positive.
    #[inline]
    pub fn factor(&self) -> Factor {
        let d1 = self.xx;
        let i1 = 1.0 / d1;
        let (l21, l31) = (self.xy * i1, self.xz * i1);
        let d2 = self.yy - l21 * self.xy;
        let i2 = 1.0 / d2;
        let e32 = self.yz - l21 * self.xz;
        let l32 = e32 * i2;
        let d3 = self.zz - l31 * self.xz - l32 * e32;
        Factor {
            l21,
            l31,
            l32,
            inverse: Vector3::new(i1, i2, 1.0 / d3),
            pivots: Vector3::new(d1, d2, d3),
        }
    }

    /// The solution of `self x = b`; `None` where the matrix is not positive definite.
    #[cfg(feature = "std")]
    #[inline]
    pub fn solve(&self, b: &Vector3) -> Option<Vector3> {
        let factor = self.factor();
        if !factor.pivots.iter().all(|d| *d > 0.0) {
            return None;
        }
        let y = factor.forward(b);
        Some(factor.back(&y.component_mul(&factor.inverse)))
    }
}

/// `L D L^T` of a symmetric matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Factor {
    l21: f64,
    l31: f64,
    l32: f64,
    /// Reciprocals of the pivots.
    pub inverse: Vector3,
    /// Positive, all of them, for a positive definite matrix.
    pub pivots: Vector3,
}

impl Factor {
    /// `L^-1 b`.
    #[inline]
    pub fn forward(&self, b: &Vector3) -> Vector3 {
        let y = b.y - self.l21 * b.x;
        Vector3::new(b.x, y, b.z - self.l31 * b.x - self.l32 * y)
    }

    /// `L^-T b`.
    #[inline]
    pub fn back(&self, b: &Vector3) -> Vector3 {
        let y = b.y - self.l32 * b.z;
        Vector3::new(b.x - self.l21 * y - self.l31 * b.z, y, b.z)
    }
}

impl AddAssign for Symmetric {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
        self.xz += other.xz;
        self.yz += other.yz;
        self.zz += other.zz;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_products_are_those_of_full_matrices() {
        let full = Matrix3::new(4.0, -1.0, 0.5, -1.0, 3.0, 0.2, 0.5, 0.2, 2.0);
        let s = Symmetric::of(&full);
        let R = *nalgebra::Rotation3::new(Vector3::new(0.3, -1.1, 0.7)).matrix();
        let x = Vector3::new(0.7, -0.2, 1.9);
        let near = |a: Matrix3, b: Matrix3| assert!((a - b).amax() < 4e-15, "{a} {b}");
        near(s.full(), full);
        near(s.turned(&R).full(), R * full * R.transpose());
        let mut less = s;
        less.subtract_outer(&(x * 0.3), &x);
        near(less.full(), full - x * x.transpose() * 0.3);
        assert!((s.times(&x) - full * x).amax() < 1e-15);
        assert!((s.times(&s.solve(&x).unwrap()) - x).amax() < 1e-15);
        assert!(Symmetric::of(&-full).solve(&x).is_none());
        assert!(Symmetric::of(&(full * f64::NAN)).solve(&x).is_none());
        assert!(Symmetric::default().solve(&x).is_none());
    }
}
