//! Eight numbers in plain arrays, which the compiler converts to vector instructions.
//!
//! Index loops instead of closures: a closure does not inherit the instruction set of its caller.
#![allow(clippy::needless_range_loop)]

use std::ops::{Add, Mul, Sub};

/// Number of lanes.
pub const LANES: usize = 8;

/// Eight numbers.
///
/// ```
/// use poinsot_solve::lanes::V;
///
/// // 1 + 2 * 3, eight times.
/// assert_eq!(V::all(1.0).plus(V::all(2.0), V::all(3.0)), V::all(7.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct V(pub [f64; LANES]);

impl V {
    /// Eight zeros.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// One number, eight times.
    #[inline(always)]
    pub fn all(x: f64) -> Self {
        Self([x; LANES])
    }

    /// `self + a b` with one rounding; correct but slow without such an instruction.
    #[inline(always)]
    pub fn plus(self, a: Self, b: Self) -> Self {
        let mut out = self.0;
        for k in 0..LANES {
            out[k] = a.0[k].mul_add(b.0[k], out[k]);
        }
        Self(out)
    }

    /// `self - a b` with one rounding.
    #[inline(always)]
    pub fn less(self, a: Self, b: Self) -> Self {
        let mut out = self.0;
        for k in 0..LANES {
            out[k] = (-a.0[k]).mul_add(b.0[k], out[k]);
        }
        Self(out)
    }

    /// Square root.
    #[inline(always)]
    pub fn root(self) -> Self {
        let mut out = self.0;
        for k in 0..LANES {
            out[k] = out[k].sqrt();
        }
        Self(out)
    }
}

impl Add for V {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut out = self.0;
        for k in 0..LANES {
            out[k] += other.0[k];
        }
        Self(out)
    }
}

impl Sub for V {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut out = self.0;
        for k in 0..LANES {
            out[k] -= other.0[k];
        }
        Self(out)
    }
}

impl Mul for V {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let mut out = self.0;
        for k in 0..LANES {
            out[k] *= other.0[k];
        }
        Self(out)
    }
}
