//! Points in the unit cube, and the random numbers of every trial, as functions of seed and trial.

use super::plan::Sampling;
use poinsot_formats::SamplingKind;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Seeds of streams separate from those of the sensors: constants of SHA-256.
const DRAWS: u64 = 0x6a09_e667_f3bc_c908;
const POINTS: u64 = 0xbb67_ae85_84ca_a73b;

/// Uniform in [0, 1).
pub(super) fn unit(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// The points of one replicate, one row per trial.
pub(super) fn points(
    sampling: Sampling,
    dimensions: usize,
    seed: u64,
    replicate: u64,
) -> Vec<Vec<f64>> {
    let n = sampling.points as usize;
    let mut rows = vec![vec![0.0; dimensions]; n];
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ POINTS);
    rng.set_stream(replicate);
    match sampling.kind {
        SamplingKind::LatinHypercube => {
            for d in 0..dimensions {
                let mut order: Vec<usize> = (0..n).collect();
                // Fisher-Yates shuffle; the modulo bias is below n / 2^64.
                for k in (1..n).rev() {
                    order.swap(k, (rng.next_u64() % (k as u64 + 1)) as usize);
                }
                for (row, cell) in rows.iter_mut().zip(order) {
                    row[d] = (cell as f64 + unit(&mut rng)) / n as f64;
                }
            }
        }
        SamplingKind::Sobol => {
            let scramble = rng.next_u32();
            for (k, row) in rows.iter_mut().enumerate() {
                for (d, x) in row.iter_mut().enumerate() {
                    *x = f64::from(sobol_burley::sample(k as u32, d as u32, scramble));
                }
            }
        }
    }
    rows
}

/// The random numbers of one `[[draw]]` in one trial.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deviates {
    pub seed: u64,
    pub trial: u64,
    pub draw: u64,
}

impl Deviates {
    fn stream(self) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ DRAWS);
        rng.set_stream((self.trial << 16) | (self.draw & 0xffff));
        rng
    }

    /// Standard normal, for the k-th number of the address.
    pub fn normal(self, k: usize) -> f64 {
        let mut rng = self.stream();
        let mut x = 0.0;
        for _ in 0..=k {
            x = StandardNormal.sample(&mut rng);
        }
        x
    }

    /// Uniform in [0, 1), for the k-th number of the address.
    pub fn unit(self, k: usize) -> f64 {
        let mut rng = self.stream();
        let mut x = 0.0;
        for _ in 0..=k {
            x = unit(&mut rng);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(kind: SamplingKind, points: u64, replicate: u64) -> Vec<Vec<f64>> {
        super::points(Sampling { kind, points }, 3, 7, replicate)
    }

    #[test]
    fn exact_a_latin_hypercube_has_one_point_in_every_slice() {
        let rows = sampled(SamplingKind::LatinHypercube, 50, 4);
        for d in 0..3 {
            let mut slices: Vec<usize> = rows.iter().map(|r| (50.0 * r[d]) as usize).collect();
            slices.sort_unstable();
            assert_eq!(slices, (0..50).collect::<Vec<_>>());
        }
        assert_ne!(rows, sampled(SamplingKind::LatinHypercube, 50, 5));
        assert_eq!(rows, sampled(SamplingKind::LatinHypercube, 50, 4));
    }

    /// A (t, m, s)-net has one point in every slice of each axis. The mean of a smooth function is much closer than
    /// with independent points (variance 1/12 per number: 0.018 for 256 points).
    #[test]
    fn prop_scrambled_sobol_points_are_balanced() {
        let rows = sampled(SamplingKind::Sobol, 256, 0);
        for d in 0..3 {
            let mut slices: Vec<usize> = rows.iter().map(|r| (256.0 * r[d]) as usize).collect();
            slices.sort_unstable();
            assert_eq!(slices, (0..256).collect::<Vec<_>>());
        }
        let mean: f64 = rows.iter().map(|r| r[0] * r[1] * r[2]).sum::<f64>() / 256.0;
        assert!((mean - 0.125).abs() < 0.004, "{mean}");
        assert_ne!(rows, sampled(SamplingKind::Sobol, 256, 1));
    }

    #[test]
    fn exact_deviates_depend_on_trial_draw_and_index_alone() {
        let of = |trial, draw| Deviates {
            seed: 1,
            trial,
            draw,
        };
        assert_eq!(of(3, 0).normal(2), of(3, 0).normal(2));
        let mut all = vec![
            of(3, 0).normal(0),
            of(3, 0).normal(1),
            of(3, 1).normal(0),
            of(4, 0).normal(0),
        ];
        all.sort_by(f64::total_cmp);
        all.dedup();
        assert_eq!(all.len(), 4);
        let mean = (0..4000).map(|t| of(t, 0).normal(0)).sum::<f64>() / 4000.0;
        assert!(mean.abs() < 4.0 / 4000.0_f64.sqrt(), "{mean}");
    }
}
