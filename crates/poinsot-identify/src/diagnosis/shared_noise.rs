//! Noise of joints and wheels that a candidate's columns share with the residual.
//!
//! Columns are made at measured inputs, whose noise is in the columns and in the residual: both agree without any fault. At rest
//! the predicted rates are nothing but this noise, and would show a scale of a gyro of about -1. One more draw of the declared
//! noise on the inputs changes columns and residual, and the products of the changes are what noise alone makes of the products of
//! columns and residual. Scores are made without it. Columns along smoothed inputs share no noise with the residual.

use super::projected::{Projected, SHOWN, Score, units};
use super::table::Table;
use crate::problem::segment::{InputErrors, Noise, Segment};
use nalgebra::{DMatrix, DVector};
use poinsot_spatial::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Start of the random numbers: any will do.
const SEED: u64 = 0x0070_6f69_6e73_6f74;
/// Largest variance of a score whose columns and residual are noise of the inputs alone, less one: the product of two errors of
/// one cause has up to twice the variance of one of two causes, in the score and again in the draw that corrects it.
const WIDER: f64 = 3.0;
/// Share of noise in the square of a column from which it is not used, as in the linear method.
const HALF: f64 = 0.5;

/// What noise of the inputs makes of the candidates.
pub(super) struct SharedNoise {
    /// Columns and residual of the noise, clear of all that was fitted.
    changes: Projected,
    /// Share of noise in the square of the residual.
    residual: f64,
}

impl SharedNoise {
    /// `None` where no input is noisy or the rows are not held.
    pub fn new(table: &Table) -> Option<Self> {
        let (experiment, fitted) = (table.experiment, table.fitted);
        let (problem, noise) = (experiment.problem, experiment.problem.noise);
        let smooth = |s: &Segment| s.observations.is_smoothed();
        if table.segments.is_empty()
            || !experiment.has_noisy_inputs()
            || problem.segments.iter().any(smooth)
        {
            return None;
        }
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let segments = problem.segments.iter();
        let segments: Vec<Segment> = segments.map(|s| disturbed(s, noise, &mut random)).collect();
        let problem = problem.with_segments(&segments);
        let disturbed = experiment.with_problem(&problem);
        let other = Table::new(&disturbed, fitted, table.candidates, None)?;
        let changes = other.changes(table);
        Some(Self {
            residual: (changes.residual() / fitted.rows().max(1) as f64).min(1.0),
            changes,
        })
    }

    /// The score of a group of numbers without what noise makes of it. A combination whose column may be half noise has none.
    pub fn score(&self, measured: &Projected, group: &[usize]) -> Score {
        let n = group.len();
        let squares =
            |of: &Projected| DMatrix::from_fn(n, n, |i, j| of.product(group[i], Some(group[j])));
        let (M, N) = (squares(measured), squares(&self.changes));
        let toward = |of: &Projected| DVector::from_fn(n, |i, _| of.product(group[i], None));
        let toward = toward(measured) - toward(&self.changes);
        // Combinations of columns that are orthonormal, and whose noises are orthogonal.
        let unit = units(&M);
        let scaled = DMatrix::from_fn(n, n, |i, j| M[(i, j)] * unit[i] * unit[j]);
        let mut score = Score {
            decrease: 0.0,
            values: vec![0.0; n],
            covariance: DMatrix::zeros(n, n),
        };
        let own = scaled.symmetric_eigen();
        let shown: Vec<usize> = (0..n).filter(|k| own.eigenvalues[*k] > SHOWN).collect();
        if shown.is_empty() {
            return score;
        }
        let white = DMatrix::from_fn(n, shown.len(), |i, k| {
            unit[i] * own.eigenvectors[(i, shown[k])] / own.eigenvalues[shown[k]].sqrt()
        });
        let noise = (white.transpose() * N * &white).symmetric_eigen();
        let combined = white * &noise.eigenvectors;
        for (share, column) in noise.eigenvalues.iter().zip(combined.column_iter()) {
            if *share >= HALF {
                continue;
            }
            let along = column.dot(&toward);
            score.decrease += along * along / (1.0 + WIDER * share * self.residual);
            (0..n).for_each(|i| score.values[i] += column[i] * along);
            score.covariance += column * column.transpose();
        }
        score
    }
}

/// The segment with one more draw of the noise of its inputs.
fn disturbed(segment: &Segment, noise: &Noise, random: &mut ChaCha8Rng) -> Segment {
    let mut new = segment.clone();
    let o = &segment.observations;
    let n = o.time_s.len();
    let own = &mut new.observations;
    let wheels = o.wheel_speed.len() / n.max(1);
    for w in 0..wheels {
        let of = &o.wheel(w).errors;
        let error = errors(of, noise.wheel_speed.get(w), n, random);
        for (k, [e, _]) in error.into_iter().enumerate() {
            own.wheel_speed[k * wheels + w] += e;
            if let Some(speed) = own.smooth_wheel_speed.get_mut(k * wheels + w) {
                *speed += e;
            }
        }
    }
    let dof = o.joint_position.len() / n.max(1);
    for j in 0..dof {
        let of = &o.joint(j).errors;
        let error = errors(of, noise.joint_position.get(j), n, random);
        for (k, [position, rate]) in error.into_iter().enumerate() {
            own.joint_position[k * dof + j] += position;
            own.joint_rate[k * dof + j] += rate;
        }
    }
    new
}

/// Errors of one input at every grid time, and of its slope where they are one process.
fn errors(
    of: &InputErrors,
    variance: Option<&f64>,
    n: usize,
    random: &mut ChaCha8Rng,
) -> Vec<[f64; 2]> {
    let sigma = variance.copied().unwrap_or(0.0).max(0.0).sqrt();
    match of {
        InputErrors::None | InputErrors::Locked => vec![[0.0; 2]; n],
        InputErrors::Interpolated(places) => {
            let readings = places.iter().map(|p| p.reading + 2).max().unwrap_or(0);
            let drawn: Vec<f64> = (0..readings).map(|_| sigma * normal(random)).collect();
            let at = |k: usize| {
                places.get(k).map_or([0.0; 2], |p| {
                    let error = (1.0 - p.share) * drawn[p.reading] + p.share * drawn[p.reading + 1];
                    [error, 0.0]
                })
            };
            (0..n).map(at).collect()
        }
        InputErrors::Process(process) => {
            let mut drawn = |root: [Vector3; 3]| -> Vector3 {
                root.into_iter().map(|column| column * normal(random)).sum()
            };
            let mut now = drawn(process.initial_root());
            let mut all = vec![[now.x, now.y]];
            for step in process.steps() {
                now = step.memory * now + drawn(step.root());
                all.push([now.x, now.y]);
            }
            all.resize(n, [0.0; 2]);
            all
        }
        InputErrors::Independent | InputErrors::Kept(_) | InputErrors::Rounded(_) => {
            let mut now = sigma * normal(random);
            let next = |k: usize| {
                let error = now;
                let stays = of.memory(k);
                now = stays * now + sigma * (1.0 - stays * stays).max(0.0).sqrt() * normal(random);
                [error, 0.0]
            };
            (0..n).map(next).collect()
        }
    }
}

/// A number with mean zero and sigma one.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::error_process::{ErrorProcess, ErrorStep};
    use crate::problem::segment::BetweenReadings;
    use nalgebra::Matrix3;

    /// Errors have the variance and the correlation that they stand for.
    #[test]
    fn stat_drawn_errors_have_their_covariance() {
        let n = 40_000;
        let halves = (0..n).map(|k| BetweenReadings {
            reading: k / 2,
            share: 0.5 * (k % 2) as f64,
        });
        let step = ErrorStep {
            memory: Matrix3::from_diagonal(&Vector3::new(0.6, 0.5, 0.0)),
            fresh: Matrix3::from_diagonal(&Vector3::new(0.64, 1.0, 0.0)),
            within: 0.0,
        };
        let initial = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
        let process = ErrorProcess::new(initial, vec![step; n - 1]);
        // Variance at even and odd times, and covariance from even ones to the next.
        for (of, expected) in [
            (InputErrors::Independent, [4.0, 4.0, 0.0]),
            (InputErrors::Kept(vec![0.8; n]), [4.0, 4.0, 3.2]),
            (InputErrors::Interpolated(halves.collect()), [4.0, 2.0, 2.0]),
            (InputErrors::Process(process), [1.0, 1.0, 0.6]),
            (InputErrors::Locked, [0.0; 3]),
        ] {
            let all = errors(&of, Some(&4.0), n, &mut ChaCha8Rng::seed_from_u64(SEED));
            let all: Vec<f64> = all.into_iter().map(|[value, _]| value).collect();
            let mean = |f: fn(&[f64]) -> f64| {
                let sum: f64 = all.chunks_exact(2).map(f).sum();
                sum / (n / 2) as f64
            };
            let found = [
                mean(|e| e[0] * e[0]),
                mean(|e| e[1] * e[1]),
                mean(|e| e[0] * e[1]),
            ];
            for (found, expected) in found.iter().zip(expected) {
                // 20,000 pairs, correlated over up to nine samples: five sigma.
                assert!((found - expected).abs() < 0.6, "{of:?}: {found} {expected}");
            }
        }
    }
}
