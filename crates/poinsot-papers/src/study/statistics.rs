//! Random numbers for trials, and statistics.

use poinsot_spatial::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Standard normal numbers.
pub struct Normals(ChaCha8Rng);

impl Normals {
    /// One stream of a seed; deterministic.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Self(rng)
    }

    /// Next number.
    pub fn number(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Next three numbers.
    pub fn vector(&mut self) -> Vector3 {
        Vector3::from_fn(|_, _| self.number())
    }
}

/// Quantile, linear between order statistics.
///
/// ```
/// use poinsot_papers::study::statistics::quantile;
///
/// assert_eq!(quantile([3.0, 1.0, 2.0], 0.75), 2.5);
/// ```
pub fn quantile(values: impl IntoIterator<Item = f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_by(f64::total_cmp);
    let at = share * sorted.len().saturating_sub(1) as f64;
    let (low, rest) = (at.floor() as usize, at.fract());
    match (sorted.get(low), sorted.get(low + 1)) {
        (Some(a), Some(b)) if rest > 0.0 => a + rest * (b - a),
        (Some(a), _) => *a,
        _ => f64::NAN,
    }
}

/// Median.
///
/// ```
/// use poinsot_papers::study::statistics::median;
///
/// assert_eq!(median([3.0, 1.0, 2.0, 4.0]), 2.5);
/// ```
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    quantile(values, 0.5)
}

/// Root mean square.
///
/// ```
/// use poinsot_papers::study::statistics::rms;
///
/// assert_eq!(rms([3.0, -3.0]), 3.0);
/// ```
pub fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values
        .into_iter()
        .fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    (sum / count).sqrt()
}

/// Mean and standard deviation.
///
/// ```
/// use poinsot_papers::study::statistics::mean_and_scatter;
///
/// assert_eq!(mean_and_scatter(&[1.0, 3.0]), [2.0, 1.0]);
/// ```
pub fn mean_and_scatter(values: &[f64]) -> [f64; 2] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    [mean, rms(values.iter().map(|x| x - mean))]
}

/// The largest.
///
/// ```
/// use poinsot_papers::study::statistics::largest;
///
/// assert_eq!(largest([1.0, 3.0, 2.0]), 3.0);
/// ```
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_quantiles_and_moments() {
        let x = [3.0, 1.0, 2.0, 4.0];
        assert_eq!(quantile(x, 0.0), 1.0);
        assert_eq!(median(x), 2.5);
        assert_eq!(quantile(x, 1.0), 4.0);
        assert!(median([]).is_nan());
        assert_eq!(mean_and_scatter(&[1.0, 3.0]), [2.0, 1.0]);
        assert_eq!(median([1.0, f64::INFINITY, f64::INFINITY]), f64::INFINITY);
    }
}
