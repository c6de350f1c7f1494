//! Vectors and matrices of three over one number or over several side by side.
//!
//! The recursions are written once over [`Real`]. Everything here is inlined by force, and there are no closures: what
//! is not inlined into a kernel is not compiled for the kernel's instruction set. The order of every sum is fixed, and no product is fused
//! with a sum, so that all instruction sets give the same bits.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use nalgebra::{Matrix3, Vector3};

/// One real number, or the numbers of several states side by side.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    /// `x` in every lane of `self`.
    fn all(self, x: f64) -> Self;

    /// Sine and cosine.
    fn sine_cosine(self) -> (Self, Self);

    /// Square root.
    fn root(self) -> Self;

    /// Magnitude.
    fn magnitude(self) -> Self;

    /// Whether every lane of `self` is larger than that of `other`; never for NaN.
    fn exceeds(self, other: Self) -> bool;
}

impl Real for f64 {
    #[inline(always)]
    fn all(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        self.sin_cos()
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn exceeds(self, other: Self) -> bool {
        self > other
    }
}

/// A vector.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct V3<T> {
    pub x: T,
    pub y: T,
    pub z: T,
}

impl<T: Real> V3<T> {
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }

    /// `x` three times.
    #[inline(always)]
    pub fn all(x: T) -> Self {
        Self::new(x, x, x)
    }

    #[inline(always)]
    pub fn of(v: &Vector3<T>) -> Self {
        Self::new(v.x, v.y, v.z)
    }

    #[inline(always)]
    pub fn stored(self) -> Vector3<T> {
        Vector3::new(self.x, self.y, self.z)
    }

    #[inline(always)]
    pub fn cross(&self, b: &Self) -> Self {
        Self::new(
            self.y * b.z - self.z * b.y,
            self.z * b.x - self.x * b.z,
            self.x * b.y - self.y * b.x,
        )
    }

    #[inline(always)]
    pub fn dot(&self, b: &Self) -> T {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    /// Element by element.
    #[inline(always)]
    pub fn times_each(&self, b: &Self) -> Self {
        Self::new(self.x * b.x, self.y * b.y, self.z * b.z)
    }
}

impl V3<f64> {
    /// The same vector in every lane of `like`.
    #[inline(always)]
    pub fn spread<T: Real>(&self, like: T) -> V3<T> {
        V3::new(like.all(self.x), like.all(self.y), like.all(self.z))
    }
}

impl<T: Real> Add for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<T: Real> Sub for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<T: Real> Neg for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<T: Real> Mul<T> for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<T: Real> Div<T> for V3<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: T) -> Self {
        Self::new(self.x / s, self.y / s, self.z / s)
    }
}

impl<T: Real> AddAssign for V3<T> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

/// `[a; b]`.
#[inline(always)]
pub(crate) fn stack<T: Real>(a: &V3<T>, b: &V3<T>) -> [T; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

/// The two vectors of a twist or momentum.
#[inline(always)]
pub(crate) fn parts<T: Real>(x: &[T; 6]) -> (V3<T>, V3<T>) {
    (V3::new(x[0], x[1], x[2]), V3::new(x[3], x[4], x[5]))
}

/// A matrix by its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct M3<T>(pub [V3<T>; 3]);

impl<T: Real> M3<T> {
    #[inline(always)]
    pub fn of(m: &Matrix3<T>) -> Self {
        Self([
            V3::new(m.m11, m.m21, m.m31),
            V3::new(m.m12, m.m22, m.m32),
            V3::new(m.m13, m.m23, m.m33),
        ])
    }

    #[inline(always)]
    pub fn stored(self) -> Matrix3<T> {
        let [a, b, c] = self.0;
        Matrix3::from([[a.x, a.y, a.z], [b.x, b.y, b.z], [c.x, c.y, c.z]])
    }

    /// `x` times the identity.
    #[inline(always)]
    pub fn diagonal(x: T) -> Self {
        let zero = x.all(0.0);
        Self([
            V3::new(x, zero, zero),
            V3::new(zero, x, zero),
            V3::new(zero, zero, x),
        ])
    }

    /// `self x`, `x` of one number or of several.
    #[inline(always)]
    pub fn times<U: Copy>(&self, x: &V3<U>) -> V3<T>
    where
        T: Mul<U, Output = T>,
    {
        let [a, b, c] = &self.0;
        V3::new(
            a.x * x.x + b.x * x.y + c.x * x.z,
            a.y * x.x + b.y * x.y + c.y * x.z,
            a.z * x.x + b.z * x.y + c.z * x.z,
        )
    }

    /// `self^T x`.
    #[inline(always)]
    pub fn transpose_times(&self, x: &V3<T>) -> V3<T> {
        let [a, b, c] = &self.0;
        V3::new(a.dot(x), b.dot(x), c.dot(x))
    }

    /// `self^T`.
    #[inline(always)]
    pub fn transposed(&self) -> Self {
        let [a, b, c] = &self.0;
        Self([
            V3::new(a.x, b.x, c.x),
            V3::new(a.y, b.y, c.y),
            V3::new(a.z, b.z, c.z),
        ])
    }

    /// `self [a]x`.
    #[inline(always)]
    pub fn times_skew(&self, a: &V3<T>) -> Self {
        let [x, y, z] = self.0;
        Self([y * a.z - z * a.y, z * a.x - x * a.z, x * a.y - y * a.x])
    }

    /// `self B`.
    #[inline(always)]
    pub fn product<U: Copy>(&self, B: &M3<U>) -> Self
    where
        T: Mul<U, Output = T>,
    {
        let [a, b, c] = &B.0;
        Self([self.times(a), self.times(b), self.times(c)])
    }

    /// `r x` every column.
    #[inline(always)]
    pub fn crossed(&self, r: &V3<T>) -> Self {
        let [a, b, c] = &self.0;
        Self([r.cross(a), r.cross(b), r.cross(c)])
    }
}

impl M3<f64> {
    /// The same matrix in every lane of `like`.
    #[inline(always)]
    pub fn spread<T: Real>(&self, like: T) -> M3<T> {
        let [a, b, c] = &self.0;
        M3([a.spread(like), b.spread(like), c.spread(like)])
    }
}

impl<T: Real> Mul<T> for M3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        let [a, b, c] = self.0;
        Self([a * s, b * s, c * s])
    }
}

impl<T: Real> Add for M3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, B: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, B.0);
        Self([a + d, b + e, c + f])
    }
}

impl<T: Real> Sub for M3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, B: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, B.0);
        Self([a - d, b - e, c - f])
    }
}
