//! Compares methods on the same trials: exact McNemar test of coverage, paired bootstrap of errors.
//!
//! The bootstrap draws every trial a Poisson(1) number of times (Chamandy, Muralidharan, Najmi, Naidu 2012). Its sums
//! are additive, so shards can be processed separately.

use crate::trials::{Answer, Interval};
use poinsot_formats::{BandedFile, PairNumberFile, finite};
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
    pub alone: (u64, u64),
    /// Sums of squared errors.
    pub squares: (f64, f64),
    /// The same sums in every resample.
    pub resampled: Vec<(f64, f64)>,
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
    pub fn add(&mut self, trial: u64, first: &Answer, other: &Answer) {
        let weights = weights(trial);
        let reach = poinsot_formats::HALF_WIDTH_95;
        for a in &first.numbers {
            let Some(b) = other.numbers.iter().find(|b| b.name == a.name) else {
                continue;
            };
            if !(a.error.is_finite() && b.error.is_finite()) {
                continue;
            }
            let holds = |n: &crate::trials::TrialNumber| n.error.abs() <= reach * n.sigma;
            let sums = self.number(&a.name);
            sums.trials += 1;
            sums.stated += u64::from(a.sigma.is_finite() && b.sigma.is_finite());
            if a.sigma.is_finite() && b.sigma.is_finite() {
                sums.alone.0 += u64::from(holds(a) && !holds(b));
                sums.alone.1 += u64::from(holds(b) && !holds(a));
            }
            let (a, b) = (a.error * a.error, b.error * b.error);
            sums.squares = (sums.squares.0 + a, sums.squares.1 + b);
            for (sum, w) in sums.resampled.iter_mut().zip(&weights) {
                *sum = (sum.0 + w * a, sum.1 + w * b);
            }
        }
    }

    /// Adds the sums of other trials.
    pub fn merge(&mut self, other: &Self) {
        for theirs in &other.numbers {
            let ours = self.number(&theirs.name);
            ours.trials += theirs.trials;
            ours.stated += theirs.stated;
            ours.alone = (ours.alone.0 + theirs.alone.0, ours.alone.1 + theirs.alone.1);
            ours.squares = (
                ours.squares.0 + theirs.squares.0,
                ours.squares.1 + theirs.squares.1,
            );
            for (ours, theirs) in ours.resampled.iter_mut().zip(&theirs.resampled) {
                *ours = (ours.0 + theirs.0, ours.1 + theirs.1);
            }
        }
    }

    fn number(&mut self, name: &str) -> &mut PairNumberSums {
        let at = self.numbers.iter().position(|n| n.name == name);
        let at = at.unwrap_or_else(|| {
            self.numbers.push(PairNumberSums {
                name: name.to_owned(),
                resampled: vec![(0.0, 0.0); RESAMPLES],
                ..PairNumberSums::default()
            });
            self.numbers.len() - 1
        });
        &mut self.numbers[at]
    }
}

impl PairNumberSums {
    /// The comparison as a file; `outside` is the probability outside its interval.
    pub fn file(&self, outside: f64) -> PairNumberFile {
        let ratio = |(a, b): (f64, f64)| (b / a).sqrt();
        let mut resampled: Vec<f64> = self.resampled.iter().map(|s| ratio(*s)).collect();
        resampled.retain(|r| r.is_finite());
        resampled.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = resampled.len().saturating_sub(1) as f64;
            let found = resampled.get((share * last).round() as usize);
            found.copied().unwrap_or(f64::NAN)
        };
        let interval = Interval {
            value: ratio(self.squares),
            low: at(0.5 * outside),
            high: at(1.0 - 0.5 * outside),
        };
        PairNumberFile {
            trials: self.trials,
            held_by_first_alone: self.alone.0,
            held_by_other_alone: self.alone.1,
            mcnemar_p: (self.stated > 0).then(|| mcnemar(self.alone)),
            rmse_ratio: banded(interval),
        }
    }
}

/// Two-sided exact McNemar test (McNemar 1947): under the null hypothesis each discordant trial favours either method
/// with probability 1/2.
fn mcnemar((first, other): (u64, u64)) -> f64 {
    let n = first + other;
    match Binomial::new(0.5, n) {
        Ok(binomial) if n > 0 => (2.0 * binomial.cdf(first.min(other))).min(1.0),
        _ => 1.0,
    }
}

/// An interval in the format of the file.
pub(super) fn banded(interval: Interval) -> BandedFile {
    BandedFile {
        value: finite(interval.value),
        low: finite(interval.low),
        high: finite(interval.high),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::trials::TrialNumber;
    use poinsot_identify::Status;

    /// R: binom.test(5, 20)$p.value, binom.test(10, 10)$p.value.
    #[test]
    fn xval_mcnemar_is_the_exact_binomial_test_of_r() {
        assert!((mcnemar((5, 15)) - 0.041_389_47).abs() < 1.0e-7);
        assert!((mcnemar((10, 0)) - 0.001_953_125).abs() < 1.0e-9);
        assert_eq!(mcnemar((0, 0)), 1.0);
        assert_eq!(mcnemar((7, 7)), 1.0);
    }

    fn answer(error: f64, sigma: f64) -> Answer {
        Answer {
            status: Status::Converged,
            doubts: Vec::new(),
            iterations: 1,
            chi2_per_dof: 1.0,
            channels: Vec::new(),
            nees: None,
            numbers: vec![TrialNumber {
                name: "a".to_owned(),
                value: error,
                error,
                sigma,
            }],
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
                sums.add(
                    k as u64,
                    &answer(errors[k].0, 1.0),
                    &answer(errors[k].1, 1.0),
                );
            }
            sums
        };
        let whole = sums(0..400);
        let file = whole.numbers[0].file(0.05);
        let r = file.rmse_ratio;
        assert!(r.low.unwrap() > 1.6 && r.low.unwrap() < 2.0, "{r:?}");
        assert!(r.high.unwrap() > 2.0 && r.high.unwrap() < 2.4, "{r:?}");
        assert!(file.held_by_first_alone > 100 && file.mcnemar_p.unwrap() < 1.0e-9);
        let mut merged = sums(0..150);
        merged.merge(&sums(150..400));
        assert_eq!(merged.numbers[0].alone, whole.numbers[0].alone);
        let gap = merged.numbers[0].resampled[7].0 / whole.numbers[0].resampled[7].0 - 1.0;
        assert!(gap.abs() < 1.0e-12);
        let mean = (0..2000).flat_map(weights).sum::<f64>() / (2000.0 * RESAMPLES as f64);
        assert!((mean - 1.0).abs() < 0.01, "{mean}");
    }
}
