//! Points in the unit cube, and the random numbers of every trial, as functions of seed and trial.

use poinsot_formats::{SamplingFile, SamplingKind};
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
    sampling: SamplingFile,
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
    /// What the stream of a draw gives for the k-th number of the address.
    fn nth(self, k: usize, draw: impl Fn(&mut ChaCha8Rng) -> f64) -> f64 {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ DRAWS);
        rng.set_stream((self.trial << 16) | (self.draw & 0xffff));
        (0..=k).fold(0.0, |_, _| draw(&mut rng))
    }

    /// Standard normal, for the k-th number of the address.
    pub fn normal(self, k: usize) -> f64 {
        self.nth(k, |rng| StandardNormal.sample(rng))
    }

    /// Uniform in [0, 1), for the k-th number of the address.
    pub fn unit(self, k: usize) -> f64 {
        self.nth(k, unit)
    }
}
