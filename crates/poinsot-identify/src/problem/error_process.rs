//! Errors of a wheel's speed and of its slope, or of a joint's position, rate and acceleration, along the grid of a segment.

use nalgebra::{Matrix3, Vector3};

/// Added to correlations before they are inverted.
const ROUND_OFF: f64 = 1.0e-13;

/// A Markov process: the errors of an input, of its slope, and of the slope of that over time, in its unit, per second and per second
/// squared. The last one is zero all along where it has no part in the process.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorProcess {
    /// Covariance at the first grid time.
    pub initial: Matrix3<f64>,
    /// From every grid time to the next one.
    pub steps: Vec<ErrorStep>,
}

/// From one grid time to the next one: `e' = memory e + w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorStep {
    /// What stays of the errors.
    pub memory: Matrix3<f64>,
    /// Covariance of what is new.
    pub fresh: Matrix3<f64>,
}

impl ErrorStep {
    /// The step of errors with this covariance before it, between both times, and after it.
    pub(crate) fn between([before, together, after]: [Matrix3<f64>; 3]) -> Self {
        // In units of the errors before it: their variances are many powers of ten apart.
        let unit = |v: f64| if v > 0.0 { v.sqrt().recip() } else { 0.0 };
        let inverse = Matrix3::from_diagonal(&before.diagonal().map(unit));
        let mut alike = inverse * before * inverse;
        (0..3).for_each(|i| alike[(i, i)] = 1.0 + ROUND_OFF);
        let memory = alike.cholesky().map_or_else(Matrix3::zeros, |alike| {
            let own = together * inverse;
            alike.solve(&own.transpose()).transpose() * inverse
        });
        let fresh = after - memory * together.transpose();
        Self {
            memory,
            fresh: (fresh + fresh.transpose()) * 0.5,
        }
    }

    /// This step and the next one as one.
    fn then(&self, next: &Self) -> Self {
        Self {
            memory: next.memory * self.memory,
            fresh: next.memory * self.fresh * next.memory.transpose() + next.fresh,
        }
    }

    /// Columns of a root of the covariance of what is new.
    pub(crate) fn root(&self) -> [Vector3<f64>; 3] {
        root(&self.fresh)
    }
}

impl ErrorProcess {
    /// The process at some of its grid times.
    #[must_use]
    pub fn at_times(&self, kept: &[usize]) -> Self {
        let nothing = ErrorStep {
            memory: Matrix3::identity(),
            fresh: Matrix3::zeros(),
        };
        let over = |from: usize, to: usize| {
            let steps = self.steps.get(from..to).unwrap_or_default();
            steps.iter().fold(nothing, |sum, step| sum.then(step))
        };
        let before = over(0, kept.first().copied().unwrap_or(0));
        let initial = ErrorStep {
            memory: Matrix3::identity(),
            fresh: self.initial,
        };
        Self {
            initial: initial.then(&before).fresh,
            steps: kept.windows(2).map(|w| over(w[0], w[1])).collect(),
        }
    }

    /// Columns of a root of the covariance at the first grid time.
    pub(crate) fn initial_root(&self) -> [Vector3<f64>; 3] {
        root(&self.initial)
    }

    /// How many errors it has.
    pub(crate) fn width(&self) -> usize {
        if self.initial[(2, 2)] > 0.0 { 3 } else { 2 }
    }

    /// Variances of the errors of value and slope, the mean over all grid times.
    pub(crate) fn mean_variances(&self) -> [f64; 2] {
        let mut P = self.initial;
        let mut sum = P.diagonal();
        for step in &self.steps {
            P = step.memory * P * step.memory.transpose() + step.fresh;
            sum += P.diagonal();
        }
        let mean = sum / (1 + self.steps.len()) as f64;
        [mean.x, mean.y]
    }

    /// Correlation of the speed's error at a grid time with that at the next one, where the slope's is at its mean.
    pub(crate) fn memory(&self, k: usize) -> f64 {
        self.steps
            .get(k)
            .map_or(0.0, |s| s.memory[(0, 0)].clamp(0.0, 1.0))
    }
}

/// Columns of a lower root of a covariance that may be singular.
fn root(c: &Matrix3<f64>) -> [Vector3<f64>; 3] {
    let mut left = *c;
    [0, 1, 2].map(|j| {
        let pivot = left[(j, j)].max(0.0).sqrt();
        let column = if pivot > 0.0 {
            Vector3::from_fn(|i, _| if i < j { 0.0 } else { left[(i, j)] / pivot })
        } else {
            Vector3::zeros()
        };
        left -= column * column.transpose();
        column
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thinned, a process has the covariance of the whole one.
    #[test]
    fn exact_a_thinned_process_has_the_covariance_of_the_whole() {
        let step = |k: usize| {
            let h = 0.3 + 0.1 * (k % 3) as f64;
            let fresh = Matrix3::from_diagonal(&Vector3::new(0.2, 0.1 * k as f64 + 0.1, 0.3))
                + Matrix3::repeat(0.05);
            ErrorStep {
                memory: Matrix3::new(0.8, h, 0.1, -0.1, 0.9, h, 0.0, 0.1, 0.7),
                fresh,
            }
        };
        let process = ErrorProcess {
            initial: Matrix3::new(1.0, 0.2, 0.1, 0.2, 2.0, 0.3, 0.1, 0.3, 1.5),
            steps: (0..9).map(step).collect(),
        };
        let covariance = |p: &ErrorProcess| {
            let along = |P, s: &ErrorStep| s.memory * P * s.memory.transpose() + s.fresh;
            p.steps.iter().fold(p.initial, along)
        };
        let thinned = process.at_times(&[2, 3, 7, 9]);
        assert_eq!(thinned.steps.len(), 3);
        assert!((covariance(&thinned) - covariance(&process)).amax() < 1.0e-12);
        let columns = root(&process.initial).into_iter();
        let back: Matrix3<f64> = columns.map(|a| a * a.transpose()).sum();
        assert!((back - process.initial).amax() < 1.0e-15);
    }
}
