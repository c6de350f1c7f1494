//! The classical fourth-order Runge-Kutta rule at a fixed step.

use crate::algebra::Real;
use crate::motion::integrate::{Flow, Halt, equal_steps, finite};

/// Scratch of the rule.
///
/// ```
#[doc = include_str!("../../doc/oscillator.txt")]
/// // y'' = -y: after half a period the rate is zero. Halving the step divides its error by 16.
/// let error = |step: f64| {
///     let mut y = [1.0, 0.0];
///     RungeKutta4::new(2).advance(&mut Oscillator, 0.0, PI, step, &mut y)?;
///     Ok::<_, Halt>(y[1].abs())
/// };
/// let ratio = error(PI / 64.0)? / error(PI / 128.0)?;
/// assert!((ratio - 16.0).abs() < 1.0);
/// # Ok::<(), Halt>(())
/// ```
#[derive(Debug, Clone)]
pub struct RungeKutta4<T = f64> {
    stages: [Vec<T>; 4],
    trial: Vec<T>,
}

impl<T: Real> RungeKutta4<T> {
    /// Scratch for a state like `y`.
    pub fn like(y: &[T]) -> Self {
        Self {
            stages: std::array::from_fn(|_| y.to_vec()),
            trial: y.to_vec(),
        }
    }

    /// One step of `h` seconds from `t`, then back onto the manifold.
    ///
    /// # Errors
    /// The derivative fails.
    #[inline(always)]
    pub fn step(
        &mut self,
        flow: &mut impl Flow<T>,
        t: f64,
        h: f64,
        y: &mut [T],
    ) -> Result<(), Halt> {
        let [k1, k2, k3, k4] = &mut self.stages;
        flow.derivative(t, y, k1)?;
        shift(&mut self.trial, y, 0.5 * h, k1);
        flow.derivative(t + 0.5 * h, &self.trial, k2)?;
        shift(&mut self.trial, y, 0.5 * h, k2);
        flow.derivative(t + 0.5 * h, &self.trial, k3)?;
        shift(&mut self.trial, y, h, k3);
        flow.derivative(t + h, &self.trial, k4)?;
        let slopes = k1.iter().zip(k2.iter()).zip(k3.iter().zip(k4.iter()));
        for (y, ((k1, k2), (k3, k4))) in y.iter_mut().zip(slopes) {
            *y = *y + (*k1 + (*k2 + *k3) * 2.0 + *k4) * (h / 6.0);
        }
        flow.project(y);
        Ok(())
    }
}

impl RungeKutta4 {
    /// Scratch for a state of `n` numbers.
    pub fn new(n: usize) -> Self {
        Self::like(&vec![0.0; n])
    }

    /// From `start` to exactly `end` in equal steps of at most `step` seconds.
    ///
    /// # Errors
    /// The derivative fails, or the state leaves the finite numbers.
    pub fn advance(
        &mut self,
        flow: &mut impl Flow,
        start: f64,
        end: f64,
        step: f64,
        y: &mut [f64],
    ) -> Result<(), Halt> {
        equal_steps((start, end), step, |t, h| self.step(flow, t, h, y))?;
        finite(y, end)
    }
}

#[inline(always)]
fn shift<T: Real>(trial: &mut [T], y: &[T], h: f64, k: &[T]) {
    for (trial, (y, k)) in trial.iter_mut().zip(y.iter().zip(k)) {
        *trial = *y + *k * h;
    }
}
