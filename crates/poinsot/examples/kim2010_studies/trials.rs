//! Many noisy records of the paper's slew, and the printed Table 2 among them.

pub use crate::printed::{COLUMNS, PRINTED, SIGMA};
use crate::slew::Slew;
use poinsot_papers::kim2010::{Kim2010Error, Sums};
use poinsot_spatial::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

pub const SEEDS: u64 = 200;
/// The four columns of Table 2.
pub type Columns = [[f64; 6]; 4];

pub fn columns(sums: &Sums) -> Result<Columns, Kim2010Error> {
    Ok([
        sums.batch()?.0.printed,
        sums.conventional()?.printed,
        sums.pre_estimate()?.printed,
        sums.suggested()?.printed,
    ])
}

/// Noise of one record, one vector per sample.
pub fn noise(seed: u64, samples: usize) -> Vec<Vector3> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    (0..samples)
        .map(|_| Vector3::new(normal(), normal(), normal()) * SIGMA)
        .collect()
}

/// The sums of every seed for each length, all of one rate: longer records continue shorter ones.
pub fn sums(slew: &Slew, step: usize, lengths: &[usize]) -> Result<Vec<Vec<Sums>>, Kim2010Error> {
    let longest = lengths.iter().max().copied().unwrap_or(0) * crate::slew::RATE / step + 1;
    let mut all: Vec<Vec<Sums>> = lengths.iter().map(|_| Vec::new()).collect();
    for seed in 0..SEEDS {
        let noise = noise(seed * 16 + step as u64 % 16, longest);
        for (list, length) in all.iter_mut().zip(lengths) {
            list.push(slew.sums(*length, step, &noise)?);
        }
    }
    Ok(all)
}

/// The quantile of values, linear between order statistics.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = p * (sorted.len().saturating_sub(1)) as f64;
    let (low, share) = (at.floor() as usize, at.fract());
    match (sorted.get(low), sorted.get(low + 1)) {
        (Some(a), Some(b)) => a + share * (b - a),
        (Some(a), None) => *a,
        _ => f64::NAN,
    }
}

/// Squared distance of the printed numbers from the mean of the trials in their covariance.
pub fn chi_square(trials: &[Vec<f64>], printed: &[f64]) -> f64 {
    let (n, p) = (trials.len() as f64, printed.len());
    let mean: Vec<f64> = (0..p)
        .map(|i| trials.iter().map(|t| t[i]).sum::<f64>() / n)
        .collect();
    let covariance = nalgebra::DMatrix::from_fn(p, p, |i, j| {
        let products = trials.iter().map(|t| (t[i] - mean[i]) * (t[j] - mean[j]));
        products.sum::<f64>() / (n - 1.0)
    });
    let gap = nalgebra::DVector::from_fn(p, |i, _| printed[i] - mean[i]);
    covariance
        .cholesky()
        .map_or(f64::NAN, |c| gap.dot(&c.solve(&gap)))
}
