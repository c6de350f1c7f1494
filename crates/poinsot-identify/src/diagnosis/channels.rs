//! Size, outliers and whiteness of the residual, sensor by sensor.

use super::types::ChannelDiagnosis;
use crate::fit::Fitted;
use crate::likelihood::ChannelResidual;
use poinsot_spatial::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability that a sample of pure noise counts as an outlier.
const BY_CHANCE: f64 = 1.0e-6;
/// Lags of the whiteness test.
const WHITENESS_LAGS: usize = 10;

/// Squared length of a whitened reading of so many numbers beyond which it is an outlier.
pub(crate) fn outlier_threshold(numbers: usize) -> f64 {
    chi_square(numbers, 1.0 - BY_CHANCE)
}

/// Quantile of chi-square at this probability.
fn chi_square(numbers: usize, probability: f64) -> f64 {
    let known = ChiSquared::new(numbers as f64).ok();
    known.map_or(f64::INFINITY, |c| c.inverse_cdf(probability))
}

/// One entry per sensor, all segments together.
pub(super) fn channels(fitted: &Fitted) -> Vec<ChannelDiagnosis> {
    let mut names: Vec<&str> = Vec::new();
    for channel in fitted.evaluated.iter().flat_map(|e| &e.channels) {
        if !names.contains(&channel.name.as_str()) {
            names.push(&channel.name);
        }
    }
    names
        .into_iter()
        .map(|name| of_sensor(name, fitted))
        .collect()
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

/// Probability of so much correlation by chance. `None` for records too short or without residual.
pub(crate) fn whiteness(white: &[Vector3], numbers: usize) -> Option<f64> {
    let (q, dof) = ljung_box(white, numbers)?;
    Some(ChiSquared::new(dof).ok()?.sf(q))
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
        if variance < 1.0e-12 * n as f64 {
            return None;
        }
        for lag in 1..=WHITENESS_LAGS {
            let product = |(a, b): (&f64, &f64)| a * b;
            let r = series.iter().zip(&series[lag..]).map(product).sum::<f64>() / variance;
            q += n as f64 * (n as f64 + 2.0) * r * r / (n - lag) as f64;
        }
    }
    Some((q, (numbers * WHITENESS_LAGS) as f64))
}
