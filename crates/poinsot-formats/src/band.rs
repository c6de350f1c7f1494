//! Bands for statistics of many trials under a correct uncertainty.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal};

/// Probability outside every band: 99.9 % bands.
const OUTSIDE: f64 = 1.0e-3;
/// Nominal coverage of a 95 % interval.
const STATED: f64 = 0.95;

/// Intervals from which a binomial is normal to a hundredth of its sigma; `statrs` fails for some numbers beyond 10^9.
const NORMAL: u64 = 1_000_000;

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

    /// Band of the mean of `numbers` squared unit normals (chi-square per degree of freedom).
    pub fn of_mean_square(numbers: u64) -> Self {
        let whole = Self {
            low: 0.0,
            high: f64::INFINITY,
        };
        let n = numbers as f64;
        ChiSquared::new(n).map_or(whole, |chi2| Self {
            low: chi2.inverse_cdf(0.5 * OUTSIDE) / n,
            high: chi2.inverse_cdf(1.0 - 0.5 * OUTSIDE) / n,
        })
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
        let whole = Self {
            low: 0.0,
            high: 1.0,
        };
        let n = numbers as f64;
        if numbers >= NORMAL {
            let half = normal_quantile(1.0 - 0.5 * OUTSIDE) * (STATED * (1.0 - STATED) / n).sqrt();
            return Self {
                low: STATED - half,
                high: STATED + half,
            };
        }
        Binomial::new(STATED, numbers).map_or(whole, |binomial| Self {
            low: binomial.inverse_cdf(0.5 * OUTSIDE) as f64 / n,
            high: binomial.inverse_cdf(1.0 - 0.5 * OUTSIDE) as f64 / n,
        })
    }

    /// Band of the absolute mean of `numbers` unit normals.
    pub fn of_bias(numbers: u64) -> Self {
        Self {
            low: 0.0,
            high: normal_quantile(1.0 - 0.5 * OUTSIDE) / (numbers as f64).sqrt(),
        }
    }
}

/// Inverse of the normal distribution function.
fn normal_quantile(p: f64) -> f64 {
    Normal::standard().inverse_cdf(p)
}

#[cfg(test)]
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
        let [below, above] = [NORMAL - 1, NORMAL].map(Band::of_coverage);
        let sigma = (STATED * (1.0 - STATED) / NORMAL as f64).sqrt();
        assert!(
            (below.low - above.low)
                .abs()
                .max((below.high - above.high).abs())
                < 0.01 * sigma
        );
    }
}
