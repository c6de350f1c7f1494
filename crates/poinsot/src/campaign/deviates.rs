//! The random numbers that a trial draws, as functions of seed and trial.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Seed of streams separate from those of the sensors: a constant of SHA-256.
const DRAWS: u64 = 0x6a09_e667_f3bc_c908;

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
        self.nth(k, |rng| {
            (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
        })
    }
}
