//! Compares methods on the same trials: exact McNemar test of coverage, paired bootstrap of errors.
//!
//! The bootstrap draws every trial a Poisson(1) number of times (Chamandy, Muralidharan, Najmi, Naidu 2012). Its sums
//! are additive, so shards can be processed separately.

use crate::trials::{Row, RowNumber, found_or_new};
use poinsot_formats::{BandedFile, PairNumberFile};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use statrs::distribution::{Binomial, DiscreteCDF};

/// Resamples of the bootstrap.
const RESAMPLES: usize = 200;
/// Seed of the bootstrap weights.
const WEIGHTS: u64 = 0x3c6e_f372_fe94_f82b;

/// One number by two methods.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairNumberSums {
    /// Name.
    pub name: String,
    /// Trials in which both determined it.
    pub trials: u64,
    /// Trials in which both also stated a sigma.
    pub stated: u64,
    /// Trials whose interval holds the truth only by the first method, and only by the other.
    pub alone: [u64; 2],
    /// Sums of squared errors.
    pub squares: [f64; 2],
    /// The same sums in every resample.
    pub resampled: Vec<[f64; 2]>,
}

/// A method compared with the first.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSums {
    /// One entry per number.
    pub numbers: Vec<PairNumberSums>,
}

/// Weight of a trial in each resample.
fn weights(trial: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(WEIGHTS);
    rng.set_stream(trial);
    (0..RESAMPLES)
        .map(|_| {
            let u = super::sampling::unit(&mut rng);
            // Inversion method: P(0) = 1/e, P(k) = P(k - 1) / k.
            let (mut k, mut p) = (0.0, (-1.0_f64).exp());
            let mut sum = p;
            while u > sum && p > f64::MIN_POSITIVE {
                k += 1.0;
                p /= k;
                sum += p;
            }
            k
        })
        .collect()
}

impl PairSums {
    /// Adds a trial that both methods answered.
    pub(super) fn add(&mut self, first: &Row, other: &Row) {
        let weights = weights(first.trial);
        for a in &first.numbers {
            let b = other.numbers.iter().find(|b| b.name == a.name);
            if let Some(sums) = b.and_then(|b| PairNumberSums::of(a, b, &weights)) {
                self.number(&a.name).add(&sums);
            }
        }
    }

    /// Adds the sums of other trials.
    pub(super) fn merge(&mut self, other: &Self) {
        for theirs in &other.numbers {
            self.number(&theirs.name).add(theirs);
        }
    }

    fn number(&mut self, name: &str) -> &mut PairNumberSums {
        let new = || PairNumberSums {
            name: name.to_owned(),
            resampled: vec![[0.0; 2]; RESAMPLES],
            ..PairNumberSums::default()
        };
        found_or_new(&mut self.numbers, 0, |n| n.name == name, new)
    }
}

impl PairNumberSums {
    /// One trial; `None` if a method did not determine the number.
    fn of(a: &RowNumber, b: &RowNumber, weights: &[f64]) -> Option<Self> {
        let errors = [a.error()?, b.error()?];
        let squares = errors.map(|e| e * e);
        let stated = [a, b].iter().all(|n| n.sigma.is_some_and(f64::is_finite));
        let held = [a.holds(errors[0]), b.holds(errors[1])];
        let alone = [held[0] && !held[1], held[1] && !held[0]];
        squares.iter().all(|s| s.is_finite()).then(|| Self {
            trials: 1,
            stated: u64::from(stated),
            alone: alone.map(|alone| u64::from(stated && alone)),
            resampled: weights.iter().map(|w| squares.map(|s| w * s)).collect(),
            squares,
            name: String::new(),
        })
    }

    fn add(&mut self, more: &Self) {
        self.trials += more.trials;
        self.stated += more.stated;
        for k in 0..2 {
            self.alone[k] += more.alone[k];
            self.squares[k] += more.squares[k];
        }
        for (ours, theirs) in self.resampled.iter_mut().zip(&more.resampled) {
            ours.iter_mut().zip(theirs).for_each(|(a, b)| *a += b);
        }
    }

    /// The comparison with its name; `outside` is the probability outside its interval.
    pub(super) fn entry(&self, outside: f64) -> (String, PairNumberFile) {
        let ratio = |[a, b]: [f64; 2]| (b / a).sqrt();
        let mut resampled: Vec<f64> = self.resampled.iter().map(|s| ratio(*s)).collect();
        resampled.retain(|r| r.is_finite());
        resampled.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = resampled.len().saturating_sub(1) as f64;
            let found = resampled.get((share * last).round() as usize);
            found.copied().unwrap_or(f64::NAN)
        };
        let (low, high) = (at(0.5 * outside), at(1.0 - 0.5 * outside));
        let file = PairNumberFile {
            trials: self.trials,
            held_by_first_alone: self.alone[0],
            held_by_other_alone: self.alone[1],
            mcnemar_p: (self.stated > 0).then(|| mcnemar(self.alone)),
            rmse_ratio: BandedFile::of(ratio(self.squares), low, high),
        };
        (self.name.clone(), file)
    }
}

/// Two-sided exact McNemar test (McNemar 1947): under the null hypothesis each discordant trial favours either method
/// with probability 1/2.
fn mcnemar([first, other]: [u64; 2]) -> f64 {
    let n = first + other;
    match Binomial::new(0.5, n) {
        Ok(binomial) if n > 0 => (2.0 * binomial.cdf(first.min(other))).min(1.0),
        _ => 1.0,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use poinsot_identify::Status;

    /// R: binom.test(5, 20)$p.value, binom.test(10, 10)$p.value.
    #[test]
    fn xval_mcnemar_is_the_exact_binomial_test_of_r() {
        assert!((mcnemar([5, 15]) - 0.041_389_47).abs() < 1.0e-7);
        assert!((mcnemar([10, 0]) - 0.001_953_125).abs() < 1.0e-9);
        assert_eq!(mcnemar([0, 0]), 1.0);
        assert_eq!(mcnemar([7, 7]), 1.0);
    }

    fn row(trial: u64, error: f64) -> Row {
        Row {
            trial,
            status: Some(Status::Converged),
            numbers: vec![RowNumber {
                estimate: Some(error),
                sigma: Some(1.0),
                ..RowNumber::of("a".to_owned(), 0.0)
            }],
            ..Row::default()
        }
    }

    /// The other method's errors are doubled: the interval holds 2, not 1. Equal distributions: it holds 1.
    #[test]
    fn stat_the_paired_bootstrap_holds_the_ratio_of_errors() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let errors: Vec<(f64, f64)> = (0..400)
            .map(|_| {
                let mut sum = || {
                    (0..12)
                        .map(|_| super::super::sampling::unit(&mut rng))
                        .sum::<f64>()
                        - 6.0
                };
                (sum(), 2.0 * sum())
            })
            .collect();
        let sums = |range: std::ops::Range<usize>| {
            let mut sums = PairSums::default();
            for k in range {
                let (a, b) = errors[k];
                sums.add(&row(k as u64, a), &row(k as u64, b));
            }
            sums
        };
        let whole = sums(0..400);
        let file = whole.numbers[0].entry(0.05).1;
        let r = file.rmse_ratio;
        assert!(r.low.unwrap() > 1.6 && r.low.unwrap() < 2.0, "{r:?}");
        assert!(r.high.unwrap() > 2.0 && r.high.unwrap() < 2.4, "{r:?}");
        assert!(file.held_by_first_alone > 100 && file.mcnemar_p.unwrap() < 1.0e-9);
        let mut merged = sums(0..150);
        merged.merge(&sums(150..400));
        assert_eq!(merged.numbers[0].alone, whole.numbers[0].alone);
        let gap = merged.numbers[0].resampled[7][0] / whole.numbers[0].resampled[7][0] - 1.0;
        assert!(gap.abs() < 1.0e-12);
        let mean = (0..2000).flat_map(weights).sum::<f64>() / (2000.0 * RESAMPLES as f64);
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }
}
