//! Numbers of several states side by side in the vector registers of one instruction set.

use crate::algebra::Real;
use core::fmt::{Debug, Formatter};
use core::ops::{Add, Div, Mul, Neg, Sub};
use pulp::{Simd, bytemuck};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Most lanes of any instruction set.
pub(crate) const MOST: usize = 8;

/// One number of each state.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    of: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// Number of states.
    pub const COUNT: usize = S::F64_LANES;

    /// `x` in every lane.
    #[inline(always)]
    pub fn new(simd: S, x: f64) -> Self {
        Self {
            simd,
            of: simd.splat_f64s(x),
        }
    }

    /// The first [`Self::COUNT`] numbers.
    #[inline(always)]
    pub fn from_array(simd: S, numbers: &[f64; MOST]) -> Self {
        let mut lanes = Self::new(simd, 0.0);
        bytemuck::cast_slice_mut(std::slice::from_mut(&mut lanes.of))
            .copy_from_slice(&numbers[..Self::COUNT]);
        lanes
    }

    /// The numbers, the rest zero.
    #[inline(always)]
    pub fn to_array(self) -> [f64; MOST] {
        let mut numbers = [0.0; MOST];
        numbers[..Self::COUNT].copy_from_slice(bytemuck::cast_slice(&[self.of]));
        numbers
    }

    /// Four numbers of every lane, one lane a place; [`Self::order`] names the lane of each place.
    #[inline(always)]
    pub fn four_of_each(four: [Self; 4]) -> [[f64; 4]; MOST] {
        let [a, b, c, d] = four;
        let turned = a.simd.interleave_shfl_f64s([a.of, b.of, c.of, d.of]);
        let mut out = [[0.0; 4]; MOST];
        out[..Self::COUNT].copy_from_slice(bytemuck::cast_slice(&turned));
        out
    }

    /// Four numbers of every lane as four vectors. [`Self::four_of_each`] puts them back into the same places; elsewhere the order of
    /// lanes is that of [`Self::order`].
    #[inline(always)]
    pub fn of_four(simd: S, four: &[[f64; 4]; MOST]) -> [Self; 4] {
        let one = Self::new(simd, 0.0);
        let mut of = [one.of; 4];
        bytemuck::cast_slice_mut(&mut of).copy_from_slice(&four[..Self::COUNT]);
        let [a, b, c, d] = simd.deinterleave_shfl_f64s(of);
        [one.with(a), one.with(b), one.with(c), one.with(d)]
    }

    /// Rounded to whole numbers.
    #[inline(always)]
    fn rounded(self) -> Self {
        self + self.all(WHOLE) - self.all(WHOLE)
    }

    /// The lanes larger than `x`.
    #[inline(always)]
    fn above(self, x: f64) -> S::m64s {
        self.simd.greater_than_f64s(self.of, self.all(x).of)
    }

    /// `other` in the lanes of `mask`.
    #[inline(always)]
    fn or(self, mask: S::m64s, other: Self) -> Self {
        self.with(self.simd.select_f64s(mask, other.of, self.of))
    }

    /// The lane of each place of [`Self::four_of_each`].
    #[inline(always)]
    pub fn order(simd: S) -> [usize; MOST] {
        let lanes = Self::from_array(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let mut order = [0, 1, 2, 3, 4, 5, 6, 7];
        let places = Self::four_of_each([lanes; 4]);
        for (lane, place) in order[..Self::COUNT].iter_mut().zip(places) {
            *lane = place[0] as usize;
        }
        order
    }

    #[inline(always)]
    fn with(self, of: S::f64s) -> Self {
        Self { of, ..self }
    }
}

impl<S: Simd> Debug for Lanes<S> {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        self.of.fmt(f)
    }
}

impl<S: Simd> PartialEq for Lanes<S> {
    fn eq(&self, other: &Self) -> bool {
        self.to_array() == other.to_array()
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.with(self.simd.add_f64s(self.of, b.of))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.with(self.simd.sub_f64s(self.of, b.of))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.with(self.simd.mul_f64s(self.of, b.of))
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: f64) -> Self {
        self * self.all(b)
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.with(self.simd.div_f64s(self.of, b.of))
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.of))
    }
}

/// A quarter turn in three parts. The first has 33 bits and the second 20, so that their products with a whole number
/// below 2^20 are exact.
const QUARTER: [f64; 3] = {
    let first = f64::from_bits(FRAC_PI_2.to_bits() & !0xf_ffff);
    [first, FRAC_PI_2 - first, 6.123_233_995_736_766e-17]
};
/// Largest angle that the three parts reduce, rad: below 2^20 quarter turns.
const REDUCED: f64 = 1_048_576.0;
/// A number plus 1.5 x 2^52, less the same, is the number rounded to a whole one.
const WHOLE: f64 = 6_755_399_441_055_744.0;
/// Terms of the series of sine and cosine: at pi/4 the next ones are below 1e-19 and 2e-18.
const TERMS: usize = 18;
/// `1 / k!`.
const INVERSE_FACTORIAL: [f64; TERMS] = {
    let (mut inverse, mut factorial, mut k) = ([1.0; TERMS], 1.0, 1);
    while k < TERMS {
        factorial *= k as f64;
        inverse[k] = 1.0 / factorial;
        k += 1;
    }
    inverse
};

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn all(self, x: f64) -> Self {
        self.with(self.simd.splat_f64s(x))
    }

    /// By Taylor's series about the nearest quarter turn; the error is below 1.2e-16.
    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let quarters = (self * FRAC_2_PI).rounded();
        // self - quarters pi/2 as the sum of `y` and a small `rest`: the first product and difference are exact, the
        // error of the second difference is taken along.
        let (a, b) = (self - quarters * QUARTER[0], quarters * QUARTER[1]);
        let c = a - b;
        let back = c - a;
        let lost = (a - (c - back)) - (b + back);
        let tail = lost - quarters * QUARTER[2];
        let y = c + tail;
        let rest = (c - y) + tail;

        let z = y * y;
        let (sine, cosine) = (series(z, 3), series(z, 4));
        let half = z * 0.5;
        let near_one = self.all(1.0) - half;
        let sine = y + (y * z * -sine + rest * near_one);
        let cosine = near_one + ((self.all(1.0) - near_one - half) + (z * z * cosine - y * rest));

        // The quarter, -2 to 2.
        let quarter = quarters - (quarters * 0.25).rounded() * 4.0;
        let (simd, square) = (self.simd, quarter * quarter);
        let odd = simd.and_m64s(square.above(0.5), simd.not_m64s(square.above(2.0)));
        let (s, c) = (sine.or(odd, cosine), cosine.or(odd, sine));
        let s_turned = simd.or_m64s((-quarter).above(0.5), quarter.above(1.5));
        let c_turned = simd.or_m64s(quarter.above(0.5), (-quarter).above(1.5));
        let found = (s.or(s_turned, -s), c.or(c_turned, -c));
        if self.all(REDUCED).exceeds(self.magnitude()) {
            found
        } else {
            large(self, found)
        }
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.of))
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.with(self.simd.abs_f64s(self.of))
    }

    #[inline(always)]
    fn exceeds(self, other: Self) -> bool {
        // The position of the first lane that is not larger: past the last where there is none.
        let simd = self.simd;
        let larger = simd.greater_than_f64s(self.of, other.of);
        simd.first_true_m64s(simd.not_m64s(larger)) == Self::COUNT
    }
}

/// `1/k! - z/(k+2)! + z^2/(k+4)! - ...`
#[inline(always)]
fn series<S: Simd>(z: Lanes<S>, k: usize) -> Lanes<S> {
    let mut last = k;
    while last + 2 < TERMS {
        last += 2;
    }
    let mut sum = z.all(INVERSE_FACTORIAL[last]);
    while last > k {
        last -= 2;
        sum = z.all(INVERSE_FACTORIAL[last]) - z * sum;
    }
    sum
}

/// The lanes beyond [`REDUCED`], and those that are no number, by the standard library.
#[cold]
fn large<S: Simd>(angle: Lanes<S>, found: (Lanes<S>, Lanes<S>)) -> (Lanes<S>, Lanes<S>) {
    let (mut sine, mut cosine) = (found.0.to_array(), found.1.to_array());
    for (k, x) in angle.to_array()[..S::F64_LANES].iter().enumerate() {
        if x.abs().partial_cmp(&REDUCED) != Some(std::cmp::Ordering::Less) {
            (sine[k], cosine[k]) = x.sin_cos();
        }
    }
    let of = |numbers| Lanes::from_array(angle.simd, &numbers);
    (of(sine), of(cosine))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    /// Largest difference to the standard library over some angles.
    struct Sines<'a>(&'a [f64]);

    impl WithSimd for Sines<'_> {
        type Output = f64;

        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let mut worst = 0.0_f64;
            for angles in self.0.as_chunks::<MOST>().0 {
                let (sine, cosine) = Lanes::from_array(simd, angles).sine_cosine();
                let found = sine.to_array().into_iter().zip(cosine.to_array());
                for (x, (s, c)) in angles.iter().zip(found).take(Lanes::<S>::COUNT) {
                    let off = (s - x.sin()).abs().max((c - x.cos()).abs());
                    assert_eq!(off.is_nan(), !x.is_finite(), "{x}: {s} {c}");
                    worst = worst.max(off);
                }
            }
            worst
        }
    }

    #[test]
    fn exact_sines_are_those_of_the_standard_library() {
        let even = |k: i32| 1e-3 * f64::from(k);
        let near_quarter = |k: i32| f64::from(k) * FRAC_PI_2 * (1.0 + f64::EPSILON);
        let powers = |k: i32| 1.7_f64.powi(k);
        let angles: Vec<f64> = (-40_000..40_000)
            .map(even)
            .chain((-4000..4000).map(near_quarter))
            .chain((-200..200).map(powers))
            .chain([
                0.0,
                -0.0,
                f64::NAN,
                f64::INFINITY,
                1e-310,
                -1e300,
                3.0,
                -3.0,
            ])
            .collect();
        let worst = Arch::new().dispatch(Sines(&angles));
        assert!(worst < 1.2e-16, "{worst:e}");
        let alone = Sines(&angles).with_simd(pulp::Scalar::new());
        assert!(alone < 1.2e-16, "{alone:e}");
    }
}
