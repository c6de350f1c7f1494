//! Double-double numbers: an unevaluated sum of two doubles, about 31 digits.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `hi + lo`, where `lo` is at most half a unit in the last place of `hi`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DoubleDouble {
    /// The number, rounded.
    pub hi: f64,
    /// The rounding error.
    pub lo: f64,
}

impl DoubleDouble {
    /// `a + b` without error (Knuth 1969, two-sum).
    pub fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let from_b = hi - a;
        Self {
            hi,
            lo: (a - (hi - from_b)) + (b - from_b),
        }
    }

    /// `a b` without error: a fused multiply-add gives the rounding error of the product.
    pub fn product(a: f64, b: f64) -> Self {
        let hi = a * b;
        Self {
            hi,
            lo: a.mul_add(b, -hi),
        }
    }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.hi, other.hi);
        let low = Self::sum(self.lo, other.lo);
        let once = Self::sum(high.hi, high.lo + low.hi);
        Self::sum(once.hi, once.lo + low.lo)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let p = Self::product(self.hi, other.hi);
        Self::sum(p.hi, p.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let left = self - other * Self::from(first);
        let second = left.hi / other.hi;
        let left = left - other * Self::from(second);
        Self::sum(first, second) + Self::from(left.hi / other.hi)
    }
}

mod tests {
    use super::*;

    #[test]
    fn exact_a_sum_and_a_product_lose_nothing() {
        let s = DoubleDouble::sum(1.0e16, 1.0 / 3.0);
        assert_eq!((s.hi - 1.0e16) + s.lo, 1.0 / 3.0);
        // (2^27 + 1)^2 = 2^54 + 2^28 + 1: one bit too many for a double.
        let p = DoubleDouble::product(134_217_729.0, 134_217_729.0);
        assert_eq!((p.hi, p.lo), (18_014_398_777_917_440.0, 1.0));
    }

    #[test]
    fn exact_a_third_times_three_is_one_to_31_digits() {
        let (one, three) = (DoubleDouble::from(1.0), DoubleDouble::from(3.0));
        let left = one / three * three - one;
        assert!(left.hi.abs() < 1.0e-31, "{left:?}");
        let root = DoubleDouble::sum(1.0, 1.0e-20);
        let difference = root * root - one - DoubleDouble::from(2.0e-20);
        assert!(difference.hi.abs() < 1.0e-31, "{difference:?}");
    }
}
