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
    /// From every grid time to the next one: the numbers of both matrices of each step that are not zero all along.
    steps: Vec<f64>,
}

/// From one grid time to the next one: `e' = memory e + w`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorStep {
    /// What stays of the errors.
    pub memory: Matrix3<f64>,
    /// Covariance of what is new.
    pub fresh: Matrix3<f64>,
    /// Variance of the integral of the first error over the step, where the errors at both ends are known.
    pub within: f64,
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
            within: 0.0,
        }
    }

    /// This step and the next one as one, which leaves out of `within` what is not known of the time between them: thinned records
    /// lead to an answer, all samples make it.
    fn then(&self, next: &Self) -> Self {
        Self {
            memory: next.memory * self.memory,
            fresh: next.memory * self.fresh * next.memory.transpose() + next.fresh,
            within: self.within + next.within,
        }
    }

    /// Columns of a root of the covariance of what is new.
    pub(crate) fn root(&self) -> [Vector3<f64>; 3] {
        root(&self.fresh)
    }
}

impl ErrorProcess {
    /// The process with this covariance at the first grid time, and these steps to the next ones.
    pub fn new(initial: Matrix3<f64>, steps: impl IntoIterator<Item = ErrorStep>) -> Self {
        let mut process = Self {
            initial,
            steps: Vec::new(),
        };
        steps.into_iter().for_each(|step| process.push(&step));
        process
    }

    /// Adds the step to one grid time more.
    pub(crate) fn push(&mut self, step: &ErrorStep) {
        for i in 0..self.width() {
            let row = (0..self.width()).map(|j| step.memory[(i, j)]);
            self.steps
                .extend(row.chain((0..=i).map(|j| step.fresh[(i, j)])));
        }
        self.steps.push(step.within);
    }

    /// The step from a grid time to the next one.
    pub fn step(&self, k: usize) -> Option<ErrorStep> {
        let n = self.width();
        let count = n * (3 * n + 1) / 2 + 1;
        let numbers = self.steps.chunks_exact(count).nth(k)?;
        let mut step = ErrorStep {
            memory: Matrix3::zeros(),
            fresh: Matrix3::zeros(),
            within: numbers[count - 1],
        };
        let mut numbers = numbers.iter();
        for i in 0..n {
            let mut next = || numbers.next().copied().unwrap_or(0.0);
            (0..n).for_each(|j| step.memory[(i, j)] = next());
            for j in 0..=i {
                step.fresh[(i, j)] = next();
                step.fresh[(j, i)] = step.fresh[(i, j)];
            }
        }
        Some(step)
    }

    /// All steps.
    pub fn steps(&self) -> impl Iterator<Item = ErrorStep> + '_ {
        (0..).map_while(|k| self.step(k))
    }

    /// The process at some of its grid times.
    #[must_use]
    pub fn at_times(&self, kept: &[usize]) -> Self {
        let nothing = ErrorStep {
            memory: Matrix3::identity(),
            fresh: Matrix3::zeros(),
            within: 0.0,
        };
        let over = |from: usize, to: usize| {
            let steps = (from..to).filter_map(|k| self.step(k));
            steps.fold(nothing, |sum, step| sum.then(&step))
        };
        let before = over(0, kept.first().copied().unwrap_or(0));
        let initial = ErrorStep {
            fresh: self.initial,
            ..nothing
        };
        let steps = kept.windows(2).map(|w| over(w[0], w[1]));
        Self::new(initial.then(&before).fresh, steps)
    }

    /// Columns of a root of the covariance at the first grid time.
    pub(crate) fn initial_root(&self) -> [Vector3<f64>; 3] {
        root(&self.initial)
    }

    /// How many errors it has.
    pub(crate) fn width(&self) -> usize {
        if self.initial[(2, 2)] > 0.0 { 3 } else { 2 }
    }

    /// Correlation of the speed's error at a grid time with that at the next one, where the slope's is at its mean.
    pub(crate) fn memory(&self, k: usize) -> f64 {
        self.step(k)
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
                within: 0.0,
            }
        };
        let initial = Matrix3::new(1.0, 0.2, 0.1, 0.2, 2.0, 0.3, 0.1, 0.3, 1.5);
        let process = ErrorProcess::new(initial, (0..9).map(step));
        let covariance = |p: &ErrorProcess| {
            let along = |P, s: ErrorStep| s.memory * P * s.memory.transpose() + s.fresh;
            p.steps().fold(p.initial, along)
        };
        let thinned = process.at_times(&[2, 3, 7, 9]);
        assert_eq!(thinned.steps().count(), 3);
        assert!((covariance(&thinned) - covariance(&process)).amax() < 1.0e-12);
        let columns = root(&process.initial).into_iter();
        let back: Matrix3<f64> = columns.map(|a| a * a.transpose()).sum();
        assert!((back - process.initial).amax() < 1.0e-15);
    }
}
