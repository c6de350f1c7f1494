//! Bands for statistics of many trials under a correct uncertainty, and confidence intervals of statistics.
//!
//! Wilson (1927) for proportions; Student's t for means; chi-square for mean squares of normals, of many by Wilson and
//! Hilferty (1931).

use crate::number::finite;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal, StudentsT};

/// Probability outside every band: 99.9 % bands.
const OUTSIDE: f64 = 1.0e-3;
/// Nominal coverage of a 95 % interval.
const STATED: f64 = 0.95;
/// Intervals from which a binomial is normal to a hundredth of its sigma, and the cube root of a chi-square to 10^-9; `statrs` fails
/// for some numbers beyond 10^9, and does not end at 2^64.
const NORMAL: u64 = 1_000_000;
/// Degrees of freedom from which the series of Student's t has ten digits, for probabilities to 0.9995. `statrs` loses
/// digits beyond 10^5, and does not end at 10^8.
const SERIES: f64 = 1.0e4;

/// Both ends of a 99.9 % band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Band {
    /// Whether a statistic is inside.
    pub fn holds(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The band, widened to hold another one.
    pub(crate) fn and(self, low: f64, high: f64) -> Self {
        let (low, high) = (self.low.min(low), self.high.max(high));
        Self { low, high }
    }

    /// Band of the mean of `numbers` squared unit normals (chi-square per degree of freedom).
    pub fn of_mean_square(numbers: u64) -> Self {
        Self::of_chi2(numbers, OUTSIDE)
    }

    fn of_chi2(numbers: u64, outside: f64) -> Self {
        let n = numbers as f64;
        let (mut low, mut high) = (0.0, f64::INFINITY);
        if let Ok(chi2) = ChiSquared::new(n) {
            let third = 2.0 / (9.0 * n);
            let at = |p| match numbers < NORMAL {
                true => chi2.inverse_cdf(p) / n,
                false => (1.0 - third + normal_quantile(p) * third.sqrt()).powi(3),
            };
            (low, high) = (at(0.5 * outside), at(1.0 - 0.5 * outside));
        }
        Self { low, high }
    }

    /// Band of the RMS of `numbers` unit normals.
    pub fn of_rms(numbers: u64) -> Self {
        let square = Self::of_mean_square(numbers);
        Self {
            low: square.low.sqrt(),
            high: square.high.sqrt(),
        }
    }

    /// Band of the coverage of `numbers` 95 % intervals.
    pub fn of_coverage(numbers: u64) -> Self {
        let n = numbers as f64;
        let (mut low, mut high) = (0.0, 1.0);
        if numbers >= NORMAL {
            let half = normal_quantile(1.0 - 0.5 * OUTSIDE) * (STATED * (1.0 - STATED) / n).sqrt();
            (low, high) = (STATED - half, STATED + half);
        } else if let Ok(binomial) = Binomial::new(STATED, numbers) {
            low = binomial.inverse_cdf(0.5 * OUTSIDE) as f64 / n;
            high = binomial.inverse_cdf(1.0 - 0.5 * OUTSIDE) as f64 / n;
        }
        Self { low, high }
    }

    /// Band of the absolute mean of `numbers` unit normals.
    pub fn of_bias(numbers: u64) -> Self {
        Self {
            low: 0.0,
            high: normal_quantile(1.0 - 0.5 * OUTSIDE) / (numbers as f64).sqrt(),
        }
    }
}

/// A statistic with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct BandedFile {
    /// Value.
    pub value: Option<f64>,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl BandedFile {
    /// A value between two ends; null where not finite.
    pub fn of(value: f64, low: f64, high: f64) -> Self {
        let [value, low, high] = [value, low, high].map(finite);
        Self { value, low, high }
    }

    /// A proportion: `count` of `of`; `outside` is the probability outside.
    pub fn share(count: u64, of: u64, outside: f64) -> Self {
        if of == 0 {
            return Self::of(f64::NAN, 0.0, 1.0);
        }
        let (n, p) = (of as f64, count as f64 / of as f64);
        let z = normal_quantile(1.0 - 0.5 * outside);
        let scale = 1.0 / (1.0 + z * z / n);
        let centre = scale * (p + z * z / (2.0 * n));
        let half = scale * z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        Self::of(p, (centre - half).max(0.0), (centre + half).min(1.0))
    }

    /// A mean of `trials` numbers with standard deviation `scatter`.
    pub fn mean(mean: f64, scatter: f64, trials: u64, outside: f64) -> Self {
        let half = match trials {
            0 | 1 => f64::INFINITY,
            n => {
                let quantile = student_quantile(1.0 - 0.5 * outside, (n - 1) as f64);
                quantile * scatter / (n as f64).sqrt()
            }
        };
        Self::of(mean, mean - half, mean + half)
    }

    /// A mean of squared normals with these degrees of freedom.
    pub fn mean_square(mean: f64, degrees: u64, outside: f64) -> Self {
        let band = Band::of_chi2(degrees, outside);
        Self::of(mean, mean / band.high, mean / band.low)
    }

    /// The square root.
    pub fn root(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Divides by a positive number.
    pub fn over(self, divisor: f64) -> Self {
        self.map(|x| x / divisor)
    }

    /// Half-width; `None` without both ends.
    pub fn half(&self) -> Option<f64> {
        Some(0.5 * (self.high? - self.low?))
    }

    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let [value, low, high] = [self.value, self.low, self.high].map(|x| x.map(&f));
        Self { value, low, high }
    }
}

/// Inverse of the normal distribution function.
fn normal_quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

/// Quantile of Student's t; for many degrees of freedom by Abramowitz and Stegun 1964, 26.7.5.
fn student_quantile(p: f64, degrees: f64) -> f64 {
    if let Ok(student) = StudentsT::new(0.0, 1.0, degrees)
        && degrees < SERIES
    {
        return student.inverse_cdf(p);
    }
    let z = normal_quantile(p);
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    z + first / degrees + second / (degrees * degrees)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn unit_bands_are_those_of_tables() {
        assert!((crate::HALF_WIDTH_95 - normal_quantile(0.975)).abs() < 1.0e-12);
        // Chi-square with 10 degrees of freedom: 0.05 % at 1.265, 99.95 % at 31.42.
        let band = Band::of_mean_square(10);
        assert!((band.low - 0.1265).abs() < 1.0e-4 && (band.high - 3.1420).abs() < 1.0e-4);
        let coverage = Band::of_coverage(1000);
        assert!(coverage.holds(0.93) && !coverage.holds(0.92) && !coverage.holds(0.98));
        assert!((Band::of_bias(100).high - 0.32905).abs() < 1.0e-4);
        let [below, above] = [NORMAL - 1, NORMAL].map(Band::of_mean_square);
        assert!(
            (below.low - above.low)
                .abs()
                .max((below.high - above.high).abs())
                < 1.0e-8
        );
        let most = Band::of_mean_square(u64::MAX);
        assert!((most.low - 1.0).abs().max((most.high - 1.0).abs()) < 1.0e-8);
        let [below, above] = [NORMAL - 1, NORMAL].map(Band::of_coverage);
        let sigma = (STATED * (1.0 - STATED) / NORMAL as f64).sqrt();
        assert!(
            (below.low - above.low)
                .abs()
                .max((below.high - above.high).abs())
                < 0.01 * sigma
        );
    }

    /// `scipy.stats.t.ppf(p, degrees)` of SciPy 1.17.
    const SCIPY: [(f64, f64, f64); 6] = [
        (0.975, 9999.0, 1.960_201_263_621_357),
        (0.975, 1.0e4, 1.960_201_239_890_626),
        (0.975, 1.0e8, 1.959_964_008_262_766),
        (0.9995, 9999.0, 3.291_500_063_300_963),
        (0.9995, 1.0e6, 3.290_536_461_248_722),
        (0.9995, 1.0e8, 3.290_526_828_789_235),
    ];

    #[test]
    fn xval_student_quantiles_are_those_of_scipy() {
        for (p, degrees, expected) in SCIPY {
            let found = student_quantile(p, degrees);
            assert!((found - expected).abs() < 1.0e-9, "{degrees}: {found}");
        }
    }

    /// Brown, Cai, DasGupta 2001, and R: prop.test(95, 100, correct = FALSE), t.test, qchisq.
    #[test]
    fn xval_intervals_are_those_of_r() {
        let share = BandedFile::share(95, 100, 0.05);
        assert!((share.low.unwrap() - 0.888_25).abs() < 1.0e-5);
        assert!((share.high.unwrap() - 0.978_46).abs() < 1.0e-5);
        let mean = BandedFile::mean(1.0, 2.0, 16, 0.05);
        assert!((mean.half().unwrap() - 2.131_45 * 0.5).abs() < 1.0e-5);
        let square = BandedFile::mean_square(1.0, 10, 0.05);
        assert!((square.low.unwrap() - 10.0 / 20.483_18).abs() < 1.0e-5);
        assert!((square.high.unwrap() - 10.0 / 3.246_973).abs() < 1.0e-5);
    }

    #[test]
    fn exact_nothing_known_is_the_whole_range() {
        let none = BandedFile::share(0, 0, 0.05);
        assert!(none == BandedFile::of(f64::NAN, 0.0, 1.0));
        assert_eq!(BandedFile::mean(1.0, 0.0, 1, 0.05).high, None);
        assert_eq!(BandedFile::mean_square(1.0, 0, 0.05).high, None);
    }
}
