//! Confidence intervals of statistics of many trials.
//!
//! Wilson (1927) for proportions; Student's t for means; chi-square for mean squares of normals.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// A value with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// A proportion: `count` of `of`; `outside` is the probability outside.
    pub fn share(count: u64, of: u64, outside: f64) -> Self {
        if of == 0 {
            return Self::unknown(f64::NAN, 0.0, 1.0);
        }
        let (n, p) = (of as f64, count as f64 / of as f64);
        let z = Normal::standard().inverse_cdf(1.0 - 0.5 * outside);
        let scale = 1.0 / (1.0 + z * z / n);
        let centre = scale * (p + z * z / (2.0 * n));
        let half = scale * z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        Self {
            value: p,
            low: (centre - half).max(0.0),
            high: (centre + half).min(1.0),
        }
    }

    /// A mean of `trials` numbers with standard deviation `scatter`.
    pub fn mean(mean: f64, scatter: f64, trials: u64, outside: f64) -> Self {
        if trials < 2 {
            return Self::unknown(mean, f64::NEG_INFINITY, f64::INFINITY);
        }
        let quantile = student_quantile(1.0 - 0.5 * outside, (trials - 1) as f64);
        let half = quantile * scatter / (trials as f64).sqrt();
        Self {
            value: mean,
            low: mean - half,
            high: mean + half,
        }
    }

    /// A mean of squared normals with these degrees of freedom.
    pub fn mean_square(mean: f64, degrees: u64, outside: f64) -> Self {
        let n = degrees as f64;
        match ChiSquared::new(n) {
            Ok(chi2) if degrees > 0 => Self {
                value: mean,
                low: mean * n / chi2.inverse_cdf(1.0 - 0.5 * outside),
                high: mean * n / chi2.inverse_cdf(0.5 * outside),
            },
            _ => Self::unknown(mean, 0.0, f64::INFINITY),
        }
    }

    /// The square root.
    pub fn root(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Divides by a positive number.
    pub fn over(self, divisor: f64) -> Self {
        self.map(|x| x / divisor)
    }

    /// Half-width.
    pub fn half(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            value: f(self.value),
            low: f(self.low),
            high: f(self.high),
        }
    }

    pub(crate) fn unknown(value: f64, low: f64, high: f64) -> Self {
        Self { value, low, high }
    }
}

/// Degrees of freedom from which the series of Student's t has ten digits, for probabilities to 0.9995. `statrs` loses
/// digits beyond 10^5, and does not end at 10^8.
const SERIES: f64 = 1.0e4;

/// Quantile of Student's t; for many degrees of freedom by Abramowitz and Stegun 1964, 26.7.5.
fn student_quantile(p: f64, degrees: f64) -> f64 {
    if let Ok(student) = StudentsT::new(0.0, 1.0, degrees)
        && degrees < SERIES
    {
        return student.inverse_cdf(p);
    }
    let z = Normal::standard().inverse_cdf(p);
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    z + first / degrees + second / (degrees * degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let share = Interval::share(95, 100, 0.05);
        assert!((share.low - 0.888_25).abs() < 1.0e-5 && (share.high - 0.978_46).abs() < 1.0e-5);
        let mean = Interval::mean(1.0, 2.0, 16, 0.05);
        assert!((mean.half() - 2.131_45 * 0.5).abs() < 1.0e-5);
        let square = Interval::mean_square(1.0, 10, 0.05);
        assert!((square.low - 10.0 / 20.483_18).abs() < 1.0e-5);
        assert!((square.high - 10.0 / 3.246_973).abs() < 1.0e-5);
    }

    #[test]
    fn exact_nothing_known_is_the_whole_range() {
        let none = Interval::share(0, 0, 0.05);
        assert!(none.value.is_nan() && none.low == 0.0 && none.high == 1.0);
        assert_eq!(Interval::mean(1.0, 0.0, 1, 0.05).high, f64::INFINITY);
        assert_eq!(Interval::mean_square(1.0, 0, 0.05).high, f64::INFINITY);
    }
}
