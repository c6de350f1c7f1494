//! Numbers of several states side by side in the vector registers of one instruction set.

use crate::algebra::Real;
use core::fmt::{Debug, Formatter};
use core::ops::{Add, Div, Mul, Neg, Sub};
use fearless_simd::{Level, Simd, dispatch, prelude::*};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Most lanes of any instruction set.
pub(crate) const MOST: usize = 8;

/// What is compiled for every instruction set that the machine may have.
pub(crate) trait Work {
    type Output;

    /// Does it with the lanes of one instruction set. To be inlined by force.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Does the work with as many lanes as the vectors of this machine hold.
pub(crate) fn in_lanes<W: Work>(work: W) -> W::Output {
    at_level(Level::new(), work)
}

/// The same with the instructions of `level`.
pub(crate) fn at_level<W: Work>(level: Level, work: W) -> W::Output {
    dispatch!(level, simd => work.run(simd))
}

/// Runs plain loops with the vector instructions of this machine. What is inlined into `work` is compiled for each of its
/// instruction sets; the order of every sum stays, and so do the bits.
///
/// ```
/// let mut sums = [1.0, 2.0];
/// poinsot_dynamics::vectorised(|| sums.iter_mut().for_each(|s| *s += 1.0));
/// assert_eq!(sums, [2.0, 3.0]);
/// ```
#[inline]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    in_lanes(Loops(work))
}

struct Loops<F>(F);

impl<F: FnOnce() -> R, R> Work for Loops<F> {
    type Output = R;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> R {
        (self.0)()
    }
}

/// One number of each state.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd>(S::f64s);

impl<S: Simd> Lanes<S> {
    /// Number of states.
    pub const COUNT: usize = S::f64s::LEN;

    /// `x` in every lane.
    #[inline(always)]
    pub fn new(simd: S, x: f64) -> Self {
        Self(S::f64s::splat(simd, x))
    }

    /// The first [`Self::COUNT`] numbers.
    #[inline(always)]
    pub fn from_array(simd: S, numbers: &[f64; MOST]) -> Self {
        Self(S::f64s::from_slice(simd, &numbers[..Self::COUNT]))
    }

    /// The numbers, the rest zero.
    #[inline(always)]
    pub fn to_array(self) -> [f64; MOST] {
        let mut numbers = [0.0; MOST];
        self.0.store_slice(&mut numbers[..Self::COUNT]);
        numbers
    }

    /// Four numbers of every lane.
    #[inline(always)]
    pub fn four_of_each([a, b, c, d]: [Self; 4]) -> [[f64; 4]; MOST] {
        let (ac, bd) = (a.0.interleave(c.0), b.0.interleave(d.0));
        let (first, last) = (ac.0.interleave(bd.0), ac.1.interleave(bd.1));
        let turned = [first.0, first.1, last.0, last.1];
        let mut out = [[0.0; 4]; MOST];
        for (k, turned) in turned.iter().enumerate() {
            turned.store_slice(&mut out.as_flattened_mut()[k * Self::COUNT..][..Self::COUNT]);
        }
        out
    }

    /// Four numbers of every lane as four vectors: back from [`Self::four_of_each`].
    #[inline(always)]
    pub fn of_four(simd: S, four: &[[f64; 4]; MOST]) -> [Self; 4] {
        let numbers = four.as_flattened();
        let part = |k: usize| S::f64s::from_slice(simd, &numbers[k * Self::COUNT..][..Self::COUNT]);
        let (first, last) = (part(0).deinterleave(part(1)), part(2).deinterleave(part(3)));
        let (a, c) = first.0.deinterleave(last.0);
        let (b, d) = first.1.deinterleave(last.1);
        [Self(a), Self(b), Self(c), Self(d)]
    }

    /// Rounded to whole numbers.
    #[inline(always)]
    fn rounded(self) -> Self {
        self + self.all(WHOLE) - self.all(WHOLE)
    }

    /// The lanes larger than `x`.
    #[inline(always)]
    fn above(self, x: f64) -> <S::f64s as SimdBase<S>>::Mask {
        self.0.simd_gt(self.all(x).0)
    }

    /// `other` in the lanes of `mask`.
    #[inline(always)]
    fn or(self, mask: <S::f64s as SimdBase<S>>::Mask, other: Self) -> Self {
        Self(mask.select(other.0, self.0))
    }

    /// The instruction set.
    #[inline(always)]
    fn simd(self) -> S {
        self.0.token()
    }
}

impl<S: Simd> Debug for Lanes<S> {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        self.0.fmt(f)
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
        Self(self.0 + b.0)
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0)
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0)
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
        Self(self.0 / b.0)
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
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
        Self::new(self.simd(), x)
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
        let square = quarter * quarter;
        let odd = square.above(0.5) & !square.above(2.0);
        let (s, c) = (sine.or(odd, cosine), cosine.or(odd, sine));
        let s_turned = (-quarter).above(0.5) | quarter.above(1.5);
        let c_turned = quarter.above(0.5) | (-quarter).above(1.5);
        let found = (s.or(s_turned, -s), c.or(c_turned, -c));
        if self.all(REDUCED).exceeds(self.magnitude()) {
            found
        } else {
            large(self, found)
        }
    }

    #[inline(always)]
    fn root(self) -> Self {
        Self(self.0.sqrt())
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(always)]
    fn exceeds(self, other: Self) -> bool {
        self.0.simd_gt(other.0).all_true()
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
    for (k, x) in angle.to_array()[..Lanes::<S>::COUNT].iter().enumerate() {
        if x.abs().partial_cmp(&REDUCED) != Some(std::cmp::Ordering::Less) {
            (sine[k], cosine[k]) = x.sin_cos();
        }
    }
    let of = |numbers| Lanes::from_array(angle.simd(), &numbers);
    (of(sine), of(cosine))
}

/// The instruction sets of this machine with two, four and eight lanes.
#[cfg(test)]
pub(crate) fn levels() -> Vec<Level> {
    let mut levels = vec![Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    {
        let level = Level::new();
        levels.extend(level.as_avx2().map(Level::Avx2));
        levels.extend(level.as_avx512().map(Level::Avx512));
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest difference to the standard library over some angles.
    struct Sines<'a>(&'a [f64]);

    impl Work for Sines<'_> {
        type Output = f64;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> f64 {
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
        for level in levels() {
            let worst = at_level(level, Sines(&angles));
            assert!(worst < 1.2e-16, "{level:?}: {worst:e}");
        }
    }
}
