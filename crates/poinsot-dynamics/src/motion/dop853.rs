//! An explicit Runge-Kutta method of eighth order with step control and dense output: for small errors its steps are
//! much longer than those of fifth order (Hairer, Norsett, Wanner 1993, section II.5, code DOP853).

use crate::motion::dop853_table::{A, ALL, C, D, E3, E5, STAGES};
use crate::motion::integrate::{Flow, Halt, Tolerance};

/// One over the order.
const EXPONENT: f64 = 0.125;
/// Limits of the change of a step.
const CHANGE: [f64; 2] = [0.333, 6.0];
/// Share of the tolerance that the estimate may take: the errors of the steps of a spin have one sign and add up.
const SHARE: f64 = 0.1;
/// Coefficients of the dense output.
const DENSE: usize = 7;

/// Scratch and step size of the method.
///
/// ```
#[doc = include_str!("../../doc/oscillator.txt")]
/// // y'' = -y: after half a period the sign has changed.
/// let mut y = [1.0, 0.0];
/// let mut method = DormandPrince8::new(vec![1.0; 2], Tolerance::default());
/// let mut t = 0.0;
/// while t < PI {
///     t = method.step(&mut Oscillator, t, PI, &mut y)?;
/// }
/// assert!((y[0] + 1.0).abs() < 1.0e-11);
/// # Ok::<(), Halt>(())
/// ```
#[derive(Debug, Clone)]
pub struct DormandPrince8 {
    tolerance: Tolerance,
    /// Natural magnitude of each component: the floor of its tolerance.
    scale: Vec<f64>,
    stages: [Vec<f64>; ALL],
    trial: Vec<f64>,
    /// The last step: start, length, state at the start, coefficients.
    from: f64,
    length: f64,
    before: Vec<f64>,
    dense: [Vec<f64>; DENSE],
    dense_ready: bool,
    /// Whether stage 12 holds the derivative at the present state.
    fresh: bool,
    step: f64,
}

impl DormandPrince8 {
    /// Scratch for a state whose components have the natural magnitudes `scale`.
    pub fn new(scale: Vec<f64>, tolerance: Tolerance) -> Self {
        let n = scale.len();
        Self {
            tolerance,
            scale,
            stages: std::array::from_fn(|_| vec![0.0; n]),
            trial: vec![0.0; n],
            from: 0.0,
            length: 0.0,
            before: vec![0.0; n],
            dense: std::array::from_fn(|_| vec![0.0; n]),
            dense_ready: false,
            fresh: false,
            step: 0.0,
        }
    }

    pub(crate) fn tolerance(&self) -> &Tolerance {
        &self.tolerance
    }

    /// Forgets the last derivative: after a discontinuity or a change of state. The last step size is tried first.
    pub fn restart(&mut self) {
        self.fresh = false;
    }

    /// One accepted step from `t`, not beyond `end`; returns the time reached.
    ///
    /// # Errors
    /// The derivative fails, or the tolerance cannot be met.
    pub fn step(
        &mut self,
        flow: &mut impl Flow,
        t: f64,
        end: f64,
        y: &mut [f64],
    ) -> Result<f64, Halt> {
        self.first_stage(flow, t, y)?;
        if self.step <= 0.0 {
            self.step = self.first_step(flow, t, end, y)?;
        }
        loop {
            let last = t + self.step * (1.0 + 1e-9) >= end;
            let h = if last { end - t } else { self.step };
            self.attempt(flow, t, h, y)?;
            let error = self.error(h, y);
            let proposal = proposed_step(error, h);
            if error <= 1.0 {
                // A step shortened for the end keeps the longer proposal.
                self.step = if last {
                    self.step.max(proposal)
                } else {
                    proposal
                };
                let reached = if last { end } else { t + h };
                self.accept(flow, t, h, reached, y)?;
                return Ok(reached);
            }
            self.step = proposal.min(0.9 * h);
            if t + self.step * 1e-3 <= t {
                return Err(Halt::stuck(t, error));
            }
        }
    }

    /// The state at a time within the last step, to seventh order. The first call after a step costs three
    /// evaluations.
    ///
    /// # Errors
    /// The derivative fails.
    pub fn dense(&mut self, flow: &mut impl Flow, t: f64, y: &mut [f64]) -> Result<(), Halt> {
        self.prepare_dense(flow)?;
        let x = (t - self.from) / self.length;
        for (j, (y, before)) in y.iter_mut().zip(&self.before).enumerate() {
            let nested = |(sum, i): (f64, usize), f: &Vec<f64>| {
                let factor = if i % 2 == 0 { x } else { 1.0 - x };
                ((sum + f[j]) * factor, i + 1)
            };
            *y = before + self.dense.iter().rev().fold((0.0, 0), nested).0;
        }
        flow.project(y);
        Ok(())
    }

    /// Stage 0 from the end of the last step, or evaluated again.
    fn first_stage(&mut self, flow: &mut impl Flow, t: f64, y: &[f64]) -> Result<(), Halt> {
        if self.fresh {
            let (head, tail) = self.stages.split_at_mut(STAGES);
            head[0].copy_from_slice(&tail[0]);
            return Ok(());
        }
        flow.derivative(t, y, &mut self.stages[0])
    }

    /// A first step from the sizes of the state and its first two derivatives (Hairer, Norsett, Wanner 1993,
    /// section II.4).
    fn first_step(
        &mut self,
        flow: &mut impl Flow,
        t: f64,
        end: f64,
        y: &[f64],
    ) -> Result<f64, Halt> {
        let d0 = self.size(y.iter().copied(), y);
        let d1 = self.size(self.stages[0].iter().copied(), y);
        let h0 = if d0.min(d1) < 1e-5 {
            1e-6
        } else {
            0.01 * d0 / d1
        };
        let h0 = h0.min(end - t);
        combine(&mut self.trial, y, h0, &self.stages, &[(0, 1.0)]);
        flow.derivative(t + h0, &self.trial, &mut self.stages[1])?;
        let change = self.stages[1].iter().zip(&self.stages[0]);
        let d2 = self.size(change.map(|(b, a)| b - a), y) / h0;
        let h1 = if d1.max(d2) <= 1e-15 {
            (h0 * 1e-3).max(1e-6)
        } else {
            (0.01 / d1.max(d2)).powf(EXPONENT)
        };
        let h = (100.0 * h0).min(h1).min(end - t);
        Ok(if h.is_finite() && h > 0.0 { h } else { end - t })
    }

    /// Root mean square in units of the tolerance.
    fn size(&self, values: impl Iterator<Item = f64>, y: &[f64]) -> f64 {
        let squares = values
            .zip(y.iter().zip(&self.scale))
            .map(|(v, (y, scale))| (v / self.unit(*y, *scale)).powi(2));
        (squares.sum::<f64>() / y.len() as f64).sqrt()
    }

    fn unit(&self, y: f64, scale: f64) -> f64 {
        self.tolerance.relative * (y.abs() + scale)
    }

    /// The stages of a trial step from `y`, which ends in `trial`.
    #[inline]
    fn attempt(&mut self, flow: &mut impl Flow, t: f64, h: f64, y: &[f64]) -> Result<(), Halt> {
        for i in 1..STAGES {
            combine(&mut self.trial, y, h, &self.stages, A[i]);
            flow.derivative(t + C[i] * h, &self.trial, &mut self.stages[i])?;
        }
        combine(&mut self.trial, y, h, &self.stages, A[STAGES]);
        Ok(())
    }

    /// Error of the trial step in units of the tolerance, the largest of all components: the two estimates, blended to
    /// order 8.
    fn error(&self, h: f64, y: &[f64]) -> f64 {
        let mut worst = 0.0_f64;
        for (j, (y, scale)) in y.iter().zip(&self.scale).enumerate() {
            let sum = |weights: &[(usize, f64)]| -> f64 {
                weights.iter().map(|(i, e)| e * self.stages[*i][j]).sum()
            };
            let fifth = sum(E5).abs();
            if fifth == 0.0 {
                continue;
            }
            let blended = fifth * fifth / fifth.hypot(0.1 * sum(E3));
            let ratio = h.abs() * blended / self.unit(y.abs().max(self.trial[j].abs()), *scale);
            if ratio.is_nan() {
                return ratio;
            }
            worst = worst.max(ratio);
        }
        worst / SHARE
    }

    /// Takes the trial step: state, its derivative, what dense output needs.
    fn accept(
        &mut self,
        flow: &mut impl Flow,
        t: f64,
        h: f64,
        reached: f64,
        y: &mut [f64],
    ) -> Result<(), Halt> {
        self.before.copy_from_slice(y);
        y.copy_from_slice(&self.trial);
        flow.project(y);
        flow.derivative(reached, y, &mut self.stages[STAGES])?;
        self.fresh = true;
        self.dense_ready = false;
        (self.from, self.length) = (t, h);
        Ok(())
    }

    fn prepare_dense(&mut self, flow: &mut impl Flow) -> Result<(), Halt> {
        if self.dense_ready {
            return Ok(());
        }
        let (t, h) = (self.from, self.length);
        for j in 0..self.before.len() {
            let (f0, f1) = (h * self.stages[0][j], h * self.stages[STAGES][j]);
            let rise = self.trial[j] - self.before[j];
            self.dense[0][j] = rise;
            self.dense[1][j] = f0 - rise;
            self.dense[2][j] = 2.0 * rise - (f0 + f1);
        }
        for i in STAGES + 1..ALL {
            combine(&mut self.trial, &self.before, h, &self.stages, A[i]);
            flow.derivative(t + C[i] * h, &self.trial, &mut self.stages[i])?;
        }
        for (row, weights) in self.dense[3..].iter_mut().zip(D) {
            for (j, value) in row.iter_mut().enumerate() {
                *value = h * weights
                    .iter()
                    .map(|(i, d)| d * self.stages[*i][j])
                    .sum::<f64>();
            }
        }
        self.dense_ready = true;
        Ok(())
    }
}

/// The next step to try after one of `h` with this error in units of the tolerance (Hairer, Norsett, Wanner 1993,
/// eq. II.4.13).
fn proposed_step(error: f64, h: f64) -> f64 {
    let [least, most] = CHANGE;
    // NaN or infinity: the step was far too long.
    let finite = if error.is_finite() { error } else { f64::MAX };
    h * (0.9 * finite.max(1e-10).powf(-EXPONENT)).clamp(least, most)
}

/// `out = y + h sum weight stage`.
#[inline]
fn combine(out: &mut [f64], y: &[f64], h: f64, stages: &[Vec<f64>], weights: &[(usize, f64)]) {
    out.fill(0.0);
    for (i, weight) in weights {
        for (out, k) in out.iter_mut().zip(&stages[*i]) {
            *out += weight * k;
        }
    }
    for (out, y) in out.iter_mut().zip(y) {
        *out = y + h * *out;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::integrate::equal_steps;

    /// `y'' = -y` as a pair.
    struct Oscillator;
    impl Flow for Oscillator {
        fn derivative(&mut self, _: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
            dy[0] = y[1];
            dy[1] = -y[0];
            Ok(())
        }
        fn project(&self, _: &mut [f64]) {}
    }

    fn method(relative: f64) -> DormandPrince8 {
        let tolerance = Tolerance {
            relative,
            ..Tolerance::default()
        };
        DormandPrince8::new(vec![1.0; 2], tolerance)
    }

    #[test]
    fn exact_weights_are_consistent() {
        for (i, row) in A.iter().enumerate() {
            let sum: f64 = row.iter().map(|(_, a)| a).sum();
            assert!((sum - C[i]).abs() < 2e-14, "stage {i}: {sum} {}", C[i]);
        }
        for weights in [E5, E3] {
            assert!(weights.iter().map(|(_, e)| e).sum::<f64>().abs() < 1e-15);
        }
    }

    #[test]
    fn exact_error_falls_with_the_eighth_power_of_the_step() {
        let errors = [1.0, 0.5, 0.25].map(|step| {
            let (mut y, mut rk, flow) = ([0.0, 1.0], method(1e-12), &mut Oscillator);
            let advance = |t: f64, h: f64| {
                rk.first_stage(flow, t, &y)?;
                rk.attempt(flow, t, h, &y)?;
                rk.accept(flow, t, h, t + h, &mut y)
            };
            equal_steps((0.0, 10.0), step, advance).unwrap();
            (y[0] - 10.0_f64.sin()).hypot(y[1] - 10.0_f64.cos())
        });
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((7.5..9.5).contains(&order), "{errors:?}");
        }
    }

    #[test]
    fn exact_step_control_and_dense_output_follow_the_tolerance() {
        for relative in [1e-5, 1e-8, 1e-11, 1e-13] {
            let (mut rk, mut t, mut y) = (method(relative), 0.0, [0.0, 1.0]);
            let (mut worst, mut steps, mut inside) = (0.0_f64, 0, [0.0; 2]);
            while t < 10.0 {
                let from = t;
                t = rk.step(&mut Oscillator, t, 10.0, &mut y).unwrap();
                steps += 1;
                for k in 0..=8 {
                    let at = from + (t - from) * f64::from(k) / 8.0;
                    rk.dense(&mut Oscillator, at, &mut inside).unwrap();
                    worst = worst.max((inside[0] - at.sin()).hypot(inside[1] - at.cos()));
                }
            }
            assert!(t == 10.0 && steps < 100, "{relative:e}: {steps}");
            assert!(worst < 200.0 * relative, "{relative:e}: {worst:e}");
            assert!(worst > 1e-3 * relative, "{relative:e}: {worst:e}");
        }
    }

    #[test]
    fn unit_blow_up_is_an_error_and_not_a_number() {
        struct Escape;
        impl Flow for Escape {
            fn derivative(&mut self, _: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
                dy[0] = y[0] * y[0];
                Ok(())
            }
            fn project(&self, _: &mut [f64]) {}
        }
        let mut rk = DormandPrince8::new(vec![1.0], Tolerance::default());
        let mut end = |mut y: [f64; 1]| {
            let mut t = 0.0;
            while t < 2.0 {
                t = rk.step(&mut Escape, t, 2.0, &mut y)?;
            }
            rk.restart();
            Ok::<_, Halt>(t)
        };
        let halted = end([1.0]);
        assert!(
            matches!(halted, Err(Halt::NotFinite { time }) if (time - 1.0).abs() < 1e-6),
            "{halted:?}"
        );
        let halted = end([f64::NAN]);
        assert!(matches!(halted, Err(Halt::NotFinite { .. })), "{halted:?}");
    }
}
