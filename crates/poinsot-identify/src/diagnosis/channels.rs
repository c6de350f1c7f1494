//! Size, outliers and whiteness of the residual, sensor by sensor.

use super::types::ChannelDiagnosis;
use crate::fit::Fitted;
use crate::likelihood::ChannelResidual;
use poinsot_files::each_once;
use poinsot_spatial::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::PI;

/// Probability that a sample of pure noise counts as an outlier.
const BY_CHANCE: f64 = 1.0e-6;
/// Mean square of a sensor's residual, in its noise, below which it is far less than declared.
pub(super) const QUIET: f64 = 0.04;
/// Lags of the whiteness test.
const WHITENESS_LAGS: usize = 10;

/// Squared length of a whitened reading of so many numbers beyond which it is an outlier.
pub(crate) fn outlier_threshold(numbers: usize) -> f64 {
    chi_square(numbers, 1.0 - BY_CHANCE)
}

/// Quantile of chi-square at this probability.
pub(crate) fn chi_square(numbers: usize, probability: f64) -> f64 {
    let known = ChiSquared::new(numbers as f64).ok();
    known.map_or(f64::INFINITY, |c| c.inverse_cdf(probability))
}

/// One entry per sensor, all segments together.
pub(super) fn channels(fitted: &Fitted) -> Vec<ChannelDiagnosis> {
    let all = fitted.evaluated.iter().flat_map(|e| &e.channels);
    let names = each_once(all.map(|c| c.name.as_str())).into_iter();
    names.map(|name| of_sensor(name, fitted)).collect()
}

fn of_sensor(name: &str, fitted: &Fitted) -> ChannelDiagnosis {
    let own = || {
        let all = fitted.evaluated.iter().flat_map(|e| &e.channels);
        all.filter(move |c| c.name == name)
    };
    let mut squares: Vec<f64> = own()
        .flat_map(|c: &ChannelResidual| c.white.iter().map(|w| w.norm_squared()))
        .collect();
    let readings = squares.len();
    let each = own().next().map_or(3, |c| c.numbers);
    let numbers = each * readings.max(1);
    let mean = squares.iter().sum::<f64>() / numbers as f64;
    squares.sort_by(f64::total_cmp);
    let typical = squares.get(readings / 2).copied().unwrap_or(0.0) / chi_square(each, 0.5);
    let limit = outlier_threshold(each) * typical.max(1.0);
    let whiteness: Vec<f64> = own().filter_map(|c| whiteness(&c.white, each)).collect();
    let least = whiteness.iter().copied().reduce(f64::min);
    ChannelDiagnosis {
        name: name.to_owned(),
        readings,
        numbers,
        chi2_per_number: mean,
        typical_chi2_per_number: typical,
        outliers: readings - squares.partition_point(|s| *s <= limit),
        whiteness_p: least.map(|p| (p * whiteness.len() as f64).min(1.0)),
    }
}

/// Probability of so much correlation by chance. `None` for records too short.
pub(crate) fn whiteness(white: &[Vector3], numbers: usize) -> Option<f64> {
    let (q, dof) = ljung_box(white, numbers)?;
    Some(ChiSquared::new(dof).ok()?.sf(q))
}

/// Probability that white noise as declared has as much power at some frequency: the spectrum by ten lags on each axis, each value as a
/// chi-square of equal mean and variance (Blackman and Tukey 1958). `None` for short records.
pub(crate) fn power(white: &[Vector3], numbers: usize) -> Option<f64> {
    let n = white.len();
    if n < 4 * WHITENESS_LAGS {
        return None;
    }
    let lags = WHITENESS_LAGS as f64;
    let mut least = 1.0_f64;
    for axis in 0..numbers {
        let series: Vec<f64> = white.iter().map(|w| w[axis]).collect();
        let product = |k: usize| series.iter().zip(&series[k..]).map(|(a, b)| a * b);
        let covariance = |k: usize| product(k).sum::<f64>() / n as f64;
        let all: Vec<f64> = (0..=WHITENESS_LAGS).map(covariance).collect();
        for at in 0..=WHITENESS_LAGS {
            let of = |k: usize| match k {
                0 => 1.0,
                k => 2.0 * (1.0 - k as f64 / (lags + 1.0)) * (PI * (at * k) as f64 / lags).cos(),
            };
            let spectrum: f64 = all.iter().enumerate().map(|(k, c)| of(k) * c).sum();
            let variance = (0..=WHITENESS_LAGS).map(|k| of(k).powi(2)).sum::<f64>() + 1.0;
            let dof = 2.0 * n as f64 / variance;
            least = least.min(ChiSquared::new(dof).ok()?.sf(dof * spectrum.max(0.0)));
        }
    }
    Some((least * numbers as f64 * (lags + 1.0)).min(1.0))
}

/// Share of the variance that earlier samples predict.
pub(super) fn predictable(white: &[Vector3], numbers: usize) -> Option<f64> {
    let (q, dof) = ljung_box(white, numbers)?;
    Some((q / dof - 1.0) * WHITENESS_LAGS as f64 / white.len() as f64)
}

/// Ljung and Box 1978: `Q = n (n + 2) sum r_k^2 / (n - k)` over ten lags, summed over the axes, and its degrees of freedom.
fn ljung_box(white: &[Vector3], numbers: usize) -> Option<(f64, f64)> {
    let n = white.len();
    if n < 4 * WHITENESS_LAGS {
        return None;
    }
    let mut q = 0.0;
    for axis in 0..numbers {
        let mean = white.iter().map(|w| w[axis]).sum::<f64>() / n as f64;
        let series: Vec<f64> = white.iter().map(|w| w[axis] - mean).collect();
        let variance: f64 = series.iter().map(|e| e * e).sum();
        // Far below the declared noise, no colour has an effect.
        let variance = variance.max(QUIET * n as f64);
        for lag in 1..=WHITENESS_LAGS {
            let product = |(a, b): (&f64, &f64)| a * b;
            let r = series.iter().zip(&series[lag..]).map(product).sum::<f64>() / variance;
            q += n as f64 * (n as f64 + 2.0) * r * r / (n - lag) as f64;
        }
    }
    Some((q, (numbers * WHITENESS_LAGS) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::octaves::tests::white;

    /// Noise as declared has that power by chance, less than declared is none, whatever its colour, and a weak line is found.
    #[test]
    fn stat_power_beyond_what_is_declared_is_found_and_less_is_none() {
        let n = 2000;
        let seeds = 0..200;
        let below = seeds
            .clone()
            .filter(|s| power(&white(n, *s), 3).unwrap() < 0.05);
        assert!((1..=18).contains(&below.count()));
        let mean = |w: &[Vector3]| {
            w.windows(2)
                .map(|w| (w[0] + w[1]) * 0.45)
                .collect::<Vec<_>>()
        };
        let dull = seeds.filter(|s| power(&mean(&white(n, *s)), 3).unwrap() < 0.05);
        assert!(dull.count() <= 1);
        let line = |(k, w): (usize, Vector3)| w + Vector3::x() * (0.5 * (1.1 * k as f64).sin());
        let seen = white(n, 7).into_iter().enumerate().map(line);
        assert!(power(&seen.collect::<Vec<_>>(), 3).unwrap() < 1.0e-4);
        assert!(power(&white(30, 1), 3).is_none());
    }
}
