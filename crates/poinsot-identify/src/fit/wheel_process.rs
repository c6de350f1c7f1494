//! The speed of a wheel whose torque changes at random, from noisy samples.
//!
//! Between two changes the speed is straight, and at each of them its slope changes by a random amount: `x = [speed, slope]`,
//! `x' = F x`, at a change `x+ = x + [0, s v]` with v normal. The samples give the posterior of the whole motion.
//! It is a Markov process itself: with `L` the information that the later samples hold of the state, a change has the
//! variance `s2 / (1 + s2 L_22)` and a mean that follows the state (Fraser and Potter 1969, backward information filter).
//! Its mean is the speed that drives the prediction, and its error has the transitions of [`ErrorProcess`].

use crate::problem::error_process::{ErrorProcess, ErrorStep};
use nalgebra::{Matrix2, Vector2};

/// How much wider than the samples and changes say the speed and slope are before them.
const DIFFUSE: f64 = 1.0e3;
/// Degrees of freedom of the changes: most are small, as between two manoeuvres, and some large. Measured: docs/validation/pyramid.md.
const TAILS: f64 = 2.0;
/// Renewals of their sizes, beyond which a speed moves by a small share of its error.
const RENEWALS: usize = 20;
/// Relative accuracy of the size of the changes.
const ACCURACY: f64 = 0.02;
/// Range of that size: slopes that move the speed by this share of the noise between changes, and by this multiple of it.
const RANGE: [f64; 2] = [1.0e-3, 1.0e4];

/// One sample of a wheel's speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpeedSample {
    /// Grid time.
    pub at: usize,
    /// Speed, rad/s.
    pub speed: f64,
    /// Variance, (rad/s)^2.
    pub variance: f64,
}

/// Samples of a wheel's speed on a grid, and when its torque changes.
pub(crate) struct SpeedSamples<'a> {
    pub time_s: &'a [f64],
    /// Whether the torque changes at each grid time.
    pub changes: &'a [bool],
    /// In order of time.
    pub samples: &'a [SpeedSample],
    /// Changes before and after one with which it shares its size.
    pub shared: usize,
}

/// What the samples say of a wheel's motion.
pub(crate) struct SpeedPosterior {
    /// Mean speed at every grid time, rad/s.
    pub speed: Vec<f64>,
    pub errors: ErrorProcess,
    /// -2 ln of the probability density of the samples, less a constant.
    pub deviance: f64,
    /// Mean square of the change at every grid time, (rad/s2)^2.
    squares: Vec<f64>,
}

/// One interval as the backward pass leaves it.
struct Interval {
    step: ErrorStep,
    /// From its start to just before the change at its end.
    straight: Matrix2<f64>,
    /// How the mean change follows the state there.
    follows: Vector2<f64>,
    /// Mean change of the slope beside what follows the state.
    change: f64,
}

impl SpeedSamples<'_> {
    /// Standard deviation of the best sample, rad/s.
    fn noise(&self) -> Option<f64> {
        let all = self.samples.iter().map(|s| s.variance.sqrt());
        all.reduce(f64::min)
    }

    /// The posterior if slopes change by this standard deviation, rad/s2; `None` without samples.
    pub fn posterior(&self, change: f64) -> Option<SpeedPosterior> {
        self.posterior_of(&vec![change; self.time_s.len()])
    }

    /// The same with a standard deviation of the change at each grid time.
    fn posterior_of(&self, sizes: &[f64]) -> Option<SpeedPosterior> {
        let n = self.time_s.len();
        let level = self.samples.first()?.speed;
        let mut samples = self.samples.iter().rev().peekable();
        let mut take = |k: usize, L: &mut Matrix2<f64>, eta: &mut Vector2<f64>| {
            while let Some(sample) = samples.next_if(|s| s.at == k) {
                L[(0, 0)] += 1.0 / sample.variance;
                eta[0] += (sample.speed - level) / sample.variance;
            }
        };
        let (mut L, mut eta) = (Matrix2::zeros(), Vector2::zeros());
        take(n - 1, &mut L, &mut eta);
        let mut log_det = 0.0;
        let mut intervals = Vec::with_capacity(n - 1);
        for k in (0..n - 1).rev() {
            let h = self.time_s[k + 1] - self.time_s[k];
            let F = Matrix2::new(1.0, h, 0.0, 1.0);
            let mut interval = Interval {
                step: ErrorStep {
                    memory: F,
                    fresh: Matrix2::zeros(),
                },
                straight: F,
                follows: Vector2::zeros(),
                change: 0.0,
            };
            if self.changes[k + 1] {
                let change = sizes[k + 1];
                let unit = 1.0 + change * change * L[(1, 1)];
                let own = change * change / unit;
                let held: Vector2<f64> = L.column(1).into();
                interval.follows = -held * own;
                interval.change = own * eta[1];
                interval.step.fresh[(1, 1)] = own;
                let mut kept = Matrix2::<f64>::identity();
                kept[(1, 0)] -= own * held[0];
                kept[(1, 1)] -= own * held[1];
                interval.step.memory = kept * F;
                eta -= held * (own * eta[1]);
                L -= held * held.transpose() * own;
                log_det += unit.ln();
            }
            eta = F.transpose() * eta;
            L = F.transpose() * L * F;
            take(k, &mut L, &mut eta);
            intervals.push(interval);
        }
        intervals.reverse();
        let span = self.time_s[n - 1] - self.time_s[0];
        let largest = sizes.iter().fold(0.0, |a: f64, b| a.max(*b));
        let wide = DIFFUSE * (self.noise()? + largest * span);
        let prior = Matrix2::from_diagonal(&Vector2::new(wide, wide / span)).map(|x| x * x);
        let initial = (Matrix2::identity() + prior * L).try_inverse()? * prior;
        let initial = (initial + initial.transpose()) * 0.5;
        log_det += (Matrix2::identity() + prior * L).determinant().ln();
        let first = initial * eta;
        let deviance = log_det + self.squares(level, first, &intervals, (sizes, &prior));
        let (mut x, mut P) = (first, initial);
        let mut speed = vec![level + x[0]];
        let mut squares = vec![0.0; n];
        for (k, interval) in intervals.iter().enumerate() {
            let follows = interval.straight.transpose() * interval.follows;
            let own = interval.step.fresh[(1, 1)] + follows.dot(&(P * follows));
            squares[k + 1] = (interval.change + follows.dot(&x)).powi(2) + own;
            x = interval.step.memory * x + Vector2::new(0.0, interval.change);
            P = interval.step.memory * P * interval.step.memory.transpose() + interval.step.fresh;
            speed.push(level + x[0]);
        }
        Some(SpeedPosterior {
            speed,
            errors: ErrorProcess {
                initial,
                steps: intervals.iter().map(|i| i.step).collect(),
            },
            deviance,
            squares,
        })
    }

    /// Squares of samples, changes and start along the mean motion, each over its variance.
    fn squares(
        &self,
        level: f64,
        first: Vector2<f64>,
        intervals: &[Interval],
        (sizes, prior): (&[f64], &Matrix2<f64>),
    ) -> f64 {
        let mut samples = self.samples.iter().peekable();
        let mut sum = first[0].powi(2) / prior[(0, 0)] + first[1].powi(2) / prior[(1, 1)];
        let mut x = first;
        for (k, size) in sizes.iter().enumerate() {
            if let Some(interval) = k.checked_sub(1).and_then(|before| intervals.get(before)) {
                let slope = x[1];
                x = interval.step.memory * x + Vector2::new(0.0, interval.change);
                if self.changes[k] {
                    sum += ((x[1] - slope) / size).powi(2);
                }
            }
            while let Some(sample) = samples.next_if(|s| s.at == k) {
                sum += (sample.speed - level - x[0]).powi(2) / sample.variance;
            }
        }
        sum
    }

    /// The posterior that the samples make most probable.
    pub fn most_probable(&self) -> Option<SpeedPosterior> {
        let size = self.most_probable_size()?;
        self.with_tails(size, self.posterior(size)?)
    }

    /// The size of normal changes that the samples make most probable, rad/s2.
    fn most_probable_size(&self) -> Option<f64> {
        let count = self.changes.iter().filter(|c| **c).count().max(1);
        let span = self.time_s.last()? - self.time_s.first()?;
        let unit = self.noise()? * count as f64 / span;
        let cost = |log: f64| {
            let found = self.posterior(unit * log.exp());
            found.map_or(f64::INFINITY, |p| p.deviance)
        };
        Some(unit * least(cost, RANGE.map(f64::ln), ACCURACY).exp())
    }

    /// The posterior with changes of Student's t-distribution, from that of normal ones: each change has a size of its own,
    /// renewed from the mean squares of those about it (Lange, Little and Taylor 1989). When exactly a torque changed between
    /// two samples they do not tell, so that neighbours share a size.
    fn with_tails(&self, mut size: f64, mut found: SpeedPosterior) -> Option<SpeedPosterior> {
        let places = self.changes.iter().enumerate().skip(1);
        let places: Vec<usize> = places.filter(|(_, c)| **c).map(|(k, _)| k).collect();
        for _ in 0..RENEWALS {
            let own: Vec<f64> = places.iter().map(|k| found.squares[*k]).collect();
            let width = |i: usize| {
                let near = i.saturating_sub(self.shared)..(i + self.shared + 1).min(own.len());
                let (count, sum) = (near.len() as f64, own[near].iter().sum::<f64>());
                (TAILS + sum / (size * size)) / (TAILS + count)
            };
            let widths: Vec<f64> = (0..own.len()).map(width).collect();
            let sum: f64 = own.iter().zip(&widths).map(|(s, w)| s / w).sum();
            size = (sum / own.len().max(1) as f64).sqrt();
            let mut sizes = vec![0.0; self.time_s.len()];
            let pairs = places.iter().zip(&widths);
            pairs.for_each(|(k, w)| sizes[*k] = size * w.sqrt());
            found = self.posterior_of(&sizes)?;
        }
        Some(found)
    }
}

/// Where a function of one number with one minimum is least, by golden section (Kiefer 1953).
fn least(f: impl Fn(f64) -> f64, [mut a, mut b]: [f64; 2], accuracy: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut c = b - golden * (b - a);
    let mut d = a + golden * (b - a);
    let (mut at_c, mut at_d) = (f(c), f(d));
    while b - a > accuracy {
        if at_c <= at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = f(d);
        }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Posterior mean, covariance of the speeds at two times, and deviance, against the dense normal distribution of all
    /// samples.
    #[test]
    fn exact_the_posterior_is_that_of_the_dense_normal_distribution() {
        let time_s = [0.0, 0.4, 0.5, 0.9, 1.3, 1.5, 2.1, 2.5];
        let changes = [false, false, true, false, true, false, true, false];
        let (variance, change) = (0.01, 0.7);
        let samples = [(0, 3.0), (1, 3.2), (3, 3.9), (5, 3.8), (6, 3.1), (7, 2.9)];
        let samples = samples.map(|(at, speed)| SpeedSample {
            at,
            speed,
            variance,
        });
        let all = SpeedSamples {
            time_s: &time_s,
            changes: &changes,
            samples: &samples,
            shared: 0,
        };
        let found = all.posterior(change).unwrap();
        // Speed at every time, of start, slope and the three changes.
        let from = [None, Some(0.0), Some(0.5), Some(1.3), Some(2.1)];
        let row = |t: f64| from.map(|s: Option<f64>| s.map_or(1.0, |s| (t - s).max(0.0)));
        let A = DMatrix::from_fn(8, 5, |i, j| row(time_s[i])[j]);
        let span = 2.5;
        let wide = DIFFUSE * (variance.sqrt() + change * span);
        let sizes = [wide, wide / span, change, change, change];
        let P = DMatrix::from_diagonal(&DVector::from_iterator(5, sizes.map(|s| s * s)));
        let C = &A * &P * A.transpose();
        let at: Vec<usize> = samples.iter().map(|s| s.at).collect();
        let S = DMatrix::from_fn(6, 6, |i, j| {
            C[(at[i], at[j])] + if i == j { variance } else { 0.0 }
        });
        let y = DVector::from_iterator(6, samples.iter().map(|s| s.speed - 3.0));
        let own = DMatrix::from_fn(6, 5, |i, j| A[(at[i], j)]);
        let weights = P.clone().try_inverse().unwrap();
        let information = own.transpose() * &own / variance + &weights;
        let covariance = information.try_inverse().unwrap();
        let numbers = &covariance * own.transpose() * &y / variance;
        let mean = &A * &numbers;
        let left = &A * &covariance * A.transpose();
        for (k, j) in [(2, 2), (4, 3), (6, 4)] {
            let square = numbers[j].powi(2) + covariance[(j, j)];
            assert!((found.squares[k] - square).abs() < 1.0e-6 * square, "{k}");
        }
        for (k, speed) in found.speed.iter().enumerate() {
            assert!((speed - 3.0 - mean[k]).abs() < 1.0e-5, "{k}");
        }
        let square = (&y - &own * &numbers).norm_squared() / variance;
        let square = square + numbers.dot(&(weights * &numbers));
        let expected = S.determinant().ln() - 6.0 * variance.ln() + square;
        assert!(
            (found.deviance - expected).abs() < 1.0e-5 * expected.abs(),
            "{}",
            found.deviance
        );
        let mut P = found.errors.initial;
        let mut cross = P;
        for (k, step) in found.errors.steps.iter().enumerate() {
            assert!(
                (P[(0, 0)] - left[(k, k)]).abs() < 1.0e-4 * left[(0, 0)],
                "{k}"
            );
            assert!(
                (cross[(0, 0)] - left[(k, 0)]).abs() < 1.0e-4 * left[(0, 0)],
                "{k}"
            );
            P = step.memory * P * step.memory.transpose() + step.fresh;
            cross = step.memory * cross;
        }
    }

    /// The size of the changes that made the samples is found.
    #[test]
    fn stat_the_size_of_the_changes_is_found() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let (sigma, change) = (0.05, 0.2);
        let time_s: Vec<f64> = (0..1200).map(|k| 0.25 * f64::from(k)).collect();
        let changes: Vec<bool> = (0..1200).map(|k| k % 2 == 1).collect();
        let (mut speed, mut slope) = (100.0, 0.0);
        let mut samples = Vec::new();
        for (k, changes) in changes.iter().enumerate() {
            samples.push(SpeedSample {
                at: k,
                speed: speed + sigma * normal(),
                variance: sigma * sigma,
            });
            if *changes {
                slope += change * normal();
            }
            speed += 0.25 * slope;
        }
        let all = SpeedSamples {
            time_s: &time_s,
            changes: &changes,
            samples: &samples,
            shared: 0,
        };
        let size = all.most_probable_size().unwrap();
        // 600 changes: their size is known to 3 %, and less by what noise hides of them.
        assert!((size / change - 1.0).abs() < 0.2, "{size}");
    }
}
