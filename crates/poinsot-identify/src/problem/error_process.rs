//! Errors of a wheel's speed and of its slope, or of a joint's position and rate, along the grid of a segment.

use nalgebra::{Matrix2, Vector2};

/// A Markov process: the errors of an input and of its slope over time, in its unit and per second.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorProcess {
    /// Covariance at the first grid time.
    pub initial: Matrix2<f64>,
    /// From every grid time to the next one.
    pub steps: Vec<ErrorStep>,
}

/// From one grid time to the next one: `e' = memory e + w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorStep {
    /// What stays of both errors.
    pub memory: Matrix2<f64>,
    /// Covariance of what is new.
    pub fresh: Matrix2<f64>,
}

impl ErrorStep {
    /// The step of errors with this covariance before it, between both times, and after it.
    pub(crate) fn between([before, together, after]: [Matrix2<f64>; 3]) -> Self {
        let memory = before
            .try_inverse()
            .map_or_else(Matrix2::zeros, |i| together * i);
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
    pub(crate) fn root(&self) -> [Vector2<f64>; 2] {
        root(&self.fresh)
    }
}

impl ErrorProcess {
    /// The process at some of its grid times.
    #[must_use]
    pub fn at_times(&self, kept: &[usize]) -> Self {
        let nothing = ErrorStep {
            memory: Matrix2::identity(),
            fresh: Matrix2::zeros(),
        };
        let over = |from: usize, to: usize| {
            let steps = self.steps.get(from..to).unwrap_or_default();
            steps.iter().fold(nothing, |sum, step| sum.then(step))
        };
        let before = over(0, kept.first().copied().unwrap_or(0));
        let initial = ErrorStep {
            memory: Matrix2::identity(),
            fresh: self.initial,
        };
        Self {
            initial: initial.then(&before).fresh,
            steps: kept.windows(2).map(|w| over(w[0], w[1])).collect(),
        }
    }

    /// Columns of a root of the covariance at the first grid time.
    pub(crate) fn initial_root(&self) -> [Vector2<f64>; 2] {
        root(&self.initial)
    }

    /// Variances of both errors, the mean over all grid times.
    pub(crate) fn mean_variances(&self) -> [f64; 2] {
        let mut P = self.initial;
        let mut sum = P.diagonal();
        for step in &self.steps {
            P = step.memory * P * step.memory.transpose() + step.fresh;
            sum += P.diagonal();
        }
        (sum / (1 + self.steps.len()) as f64).into()
    }

    /// Correlation of the speed's error at a grid time with that at the next one, where the slope's is at its mean.
    pub(crate) fn memory(&self, k: usize) -> f64 {
        self.steps
            .get(k)
            .map_or(0.0, |s| s.memory[(0, 0)].clamp(0.0, 1.0))
    }
}

/// Columns of a lower root of a covariance that may be singular.
fn root(c: &Matrix2<f64>) -> [Vector2<f64>; 2] {
    let a = c[(0, 0)].max(0.0).sqrt();
    let b = if a > 0.0 { c[(1, 0)] / a } else { 0.0 };
    let rest = (c[(1, 1)] - b * b).max(0.0).sqrt();
    [Vector2::new(a, b), Vector2::new(0.0, rest)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thinned, a process has the covariance of the whole one.
    #[test]
    fn exact_a_thinned_process_has_the_covariance_of_the_whole() {
        let step = |k: usize| {
            let h = 0.3 + 0.1 * (k % 3) as f64;
            let fresh = Matrix2::new(0.2, 0.05, 0.05, 0.1 * k as f64 + 0.1);
            ErrorStep {
                memory: Matrix2::new(0.8, h, -0.1, 0.9),
                fresh,
            }
        };
        let process = ErrorProcess {
            initial: Matrix2::new(1.0, 0.2, 0.2, 2.0),
            steps: (0..9).map(step).collect(),
        };
        let covariance = |p: &ErrorProcess| {
            let along = |P, s: &ErrorStep| s.memory * P * s.memory.transpose() + s.fresh;
            p.steps.iter().fold(p.initial, along)
        };
        let thinned = process.at_times(&[2, 3, 7, 9]);
        assert_eq!(thinned.steps.len(), 3);
        assert!((covariance(&thinned) - covariance(&process)).amax() < 1.0e-12);
        let [a, b] = root(&process.initial);
        let back = a * a.transpose() + b * b.transpose();
        assert!((back - process.initial).amax() < 1.0e-15);
    }
}
