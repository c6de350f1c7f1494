//! An explicit adaptive Runge-Kutta integrator that steps exactly onto the requested times.

/// Nodes, weights and error weights of Dormand and Prince (1980), table 2, RK5(4)7M.
const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [
        19372.0 / 6561.0,
        -25360.0 / 2187.0,
        64448.0 / 6561.0,
        -212.0 / 729.0,
        0.0,
        0.0,
    ],
    [
        9017.0 / 3168.0,
        -355.0 / 33.0,
        46732.0 / 5247.0,
        49.0 / 176.0,
        -5103.0 / 18656.0,
        0.0,
    ],
    // The last stage is at the fifth-order solution.
    [
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
    ],
];
/// Fifth-order minus fourth-order weights.
const E: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

const CONTROL: Controller = Controller {
    exponent: 0.2,
    range: [0.2, 5.0],
};

/// When a step is accepted, and when the integrator gives up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Error of one step in each component, relative to its magnitude plus its natural scale. The default
    /// 1e-12 keeps the attitude of an hour's slew within about 1e-9 rad.
    pub relative: f64,
    /// Largest number of steps between two output times.
    pub max_steps: usize,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self {
            relative: 1e-12,
            max_steps: 1_000_000,
        }
    }
}

/// Why the integration stopped before its end.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Halt {
    /// The derivative could not be formed.
    #[error(
        "the locked inertia is singular at t = {time} s: a moving body has no mass or inertia; give it both"
    )]
    Singular {
        /// Time, s.
        time: f64,
    },
    /// The state left the finite numbers.
    #[error(
        "the motion is not finite at t = {time} s; check the magnitudes of masses, torques, thrust and speeds"
    )]
    NotFinite {
        /// Time, s.
        time: f64,
    },
    /// The step shrank to round-off.
    #[error(
        "the tolerance cannot be met at t = {time} s: the step reached round-off; increase relative_tolerance in [integration], or smooth the input there"
    )]
    StepTooSmall {
        /// Time, s.
        time: f64,
    },
    /// Too many steps between two outputs.
    #[error(
        "more than the allowed number of steps before t = {time} s; increase relative_tolerance in [integration], or reduce the duration"
    )]
    TooManySteps {
        /// Time, s.
        time: f64,
    },
}

impl Halt {
    /// Why the step at `t` from `y` shrank to nothing.
    pub(crate) fn stuck(t: f64, y: &[f64]) -> Self {
        if y.iter().all(|y| y.is_finite()) {
            Self::StepTooSmall { time: t }
        } else {
            Self::NotFinite { time: t }
        }
    }
}

/// The standard controller of the step (Hairer, Norsett, Wanner 1993, eq. II.4.13).
pub(crate) struct Controller {
    /// One over the order.
    pub exponent: f64,
    /// Limits of the step change.
    pub range: [f64; 2],
}

impl Controller {
    /// Whether a step of `h` with this error, in units of the tolerance, is taken; and the next `step` to try. A step
    /// shortened for the `last` requested time keeps the longer proposal.
    pub fn accept(&self, error: f64, h: f64, last: bool, step: f64) -> (bool, f64) {
        // NaN or infinity: the step was far too long.
        let error = if error.is_finite() {
            error
        } else {
            f64::INFINITY
        };
        let [least, most] = self.range;
        let factor = (0.9 * error.max(1e-10).powf(-self.exponent)).clamp(least, most);
        match (error <= 1.0, last) {
            (true, true) => (true, step.max(h * factor)),
            (true, false) => (true, h * factor),
            (false, _) => (false, h * factor.min(0.9)),
        }
    }
}

/// Calls `advance(t, h)` for every one of the equal steps, of at most `step` seconds, from `start` to `end`.
pub(crate) fn equal_steps(
    (start, end): (f64, f64),
    step: f64,
    mut advance: impl FnMut(f64, f64) -> Result<(), Halt>,
) -> Result<(), Halt> {
    // Round-off above a whole number of steps is ignored.
    let count = ((end - start) / step * (1.0 - 1e-12)).ceil().max(1.0);
    if !count.is_finite() {
        return Err(Halt::StepTooSmall { time: start });
    }
    let (h, mut k) = ((end - start) / count, 0.0);
    while k < count {
        advance(start + k * h, h)?;
        k += 1.0;
    }
    Ok(())
}

/// An error where the state at `end` is not finite.
pub(crate) fn finite(y: &[f64], end: f64) -> Result<(), Halt> {
    match y.iter().all(|y| y.is_finite()) {
        true => Ok(()),
        false => Err(Halt::NotFinite { time: end }),
    }
}

/// An ordinary differential equation on a plain vector.
///
/// ```
/// use poinsot_dynamics::{Flow, Halt};
///
/// /// y'' = -y
/// struct Oscillator;
/// impl Flow for Oscillator {
///     fn derivative(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
///         dy.copy_from_slice(&[y[1], -y[0]]);
///         Ok(())
///     }
///     fn project(&self, _y: &mut [f64]) {}
/// }
/// let mut dy = [0.0; 2];
/// Oscillator.derivative(0.0, &[1.0, 2.0], &mut dy)?;
/// assert_eq!(dy, [2.0, -1.0]);
/// # Ok::<(), Halt>(())
/// ```
pub trait Flow<T = f64> {
    /// Writes the derivative of `y` at `t`.
    ///
    /// # Errors
    /// The derivative does not exist.
    fn derivative(&mut self, t: f64, y: &[T], dy: &mut [T]) -> Result<(), Halt>;

    /// Brings an accepted state back to its manifold (unit quaternions).
    fn project(&self, y: &mut [T]);
}

/// Scratch and step size of the integrator.
///
/// ```
#[doc = include_str!("../doc/oscillator.txt")]
/// // y'' = -y: after half a period the sign has changed.
/// let mut y = [1.0, 0.0];
/// let mut method = DormandPrince::new(vec![1.0; 2], Tolerance::default());
/// method.advance(&mut Oscillator, 0.0, PI, &mut y)?;
/// assert!((y[0] + 1.0).abs() < 1.0e-11);
/// # Ok::<(), Halt>(())
/// ```
#[derive(Debug, Clone)]
pub struct DormandPrince {
    tolerance: Tolerance,
    /// Natural magnitude of each component: the floor of its tolerance.
    scale: Vec<f64>,
    stages: [Vec<f64>; 7],
    trial: Vec<f64>,
    step: f64,
}

impl DormandPrince {
    /// Scratch for a state whose components have the natural magnitudes `scale`.
    pub fn new(scale: Vec<f64>, tolerance: Tolerance) -> Self {
        let n = scale.len();
        Self {
            tolerance,
            scale,
            stages: std::array::from_fn(|_| vec![0.0; n]),
            trial: vec![0.0; n],
            step: 0.0,
        }
    }

    /// Resets the step size, after a discontinuity of the derivative.
    pub fn restart(&mut self) {
        self.step = 0.0;
    }

    /// Takes `y` from `start` to exactly `end`.
    ///
    /// # Errors
    /// The derivative fails, or the tolerance cannot be met.
    pub fn advance(
        &mut self,
        flow: &mut impl Flow,
        start: f64,
        end: f64,
        y: &mut [f64],
    ) -> Result<(), Halt> {
        let mut t = start;
        if self.step <= 0.0 {
            self.step = (end - start) / 16.0;
        }
        for _ in 0..self.tolerance.max_steps {
            if t >= end {
                return Ok(());
            }
            let last = t + self.step * (1.0 + 1e-9) >= end;
            let h = if last { end - t } else { self.step };
            let error = self.attempt(flow, t, h, y)?;
            let (taken, step) = CONTROL.accept(error, h, last, self.step);
            self.step = step;
            if taken {
                t = if last { end } else { t + h };
                y.copy_from_slice(&self.trial);
                flow.project(y);
            } else if t + step * 1e-3 <= t {
                return Err(Halt::stuck(t, y));
            }
        }
        Err(Halt::TooManySteps { time: end })
    }

    /// One trial step; returns its error in units of the tolerance.
    fn attempt(&mut self, flow: &mut impl Flow, t: f64, h: f64, y: &[f64]) -> Result<f64, Halt> {
        for (i, row) in A.iter().enumerate() {
            let (done, rest) = self.stages.split_at_mut(i);
            for (j, value) in self.trial.iter_mut().enumerate() {
                let sum: f64 = row.iter().zip(done.iter()).map(|(a, k)| a * k[j]).sum();
                *value = y[j] + h * sum;
            }
            if let Some(stage) = rest.first_mut() {
                flow.derivative(t + C[i] * h, &self.trial, stage)?;
            }
        }
        let mut worst = 0.0_f64;
        for (j, (y, scale)) in y.iter().zip(&self.scale).enumerate() {
            let e: f64 = E.iter().zip(&self.stages).map(|(e, k)| e * k[j]).sum();
            let ratio = (h * e).abs() / (self.tolerance.relative * (y.abs() + scale));
            // NaN must exceed every number.
            worst = if ratio.is_nan() {
                ratio
            } else {
                worst.max(ratio)
            };
            if worst.is_nan() {
                break;
            }
        }
        Ok(worst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Oscillator;
    impl Flow for Oscillator {
        fn derivative(&mut self, _: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
            dy[0] = y[1];
            dy[1] = -y[0];
            Ok(())
        }
        fn project(&self, _: &mut [f64]) {}
    }

    fn error_after_ten_seconds(relative: f64) -> f64 {
        let tolerance = Tolerance {
            relative,
            ..Tolerance::default()
        };
        let mut rk = DormandPrince::new(vec![1.0; 2], tolerance);
        let mut y = [0.0, 1.0];
        let ends = [0.1, 3.0, 10.0];
        let mut t = 0.0;
        for end in ends {
            rk.advance(&mut Oscillator, t, end, &mut y).unwrap();
            t = end;
        }
        (y[0] - 10.0_f64.sin()).hypot(y[1] - 10.0_f64.cos())
    }

    #[test]
    fn exact_oscillator_follows_the_tolerance() {
        for relative in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let error = error_after_ten_seconds(relative);
            assert!(error < 100.0 * relative, "{relative:e}: {error:e}");
            assert!(error > 1e-3 * relative, "{relative:e}: {error:e}");
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
        let mut rk = DormandPrince::new(vec![1.0], Tolerance::default());
        let halted = rk.advance(&mut Escape, 0.0, 2.0, &mut [1.0]);
        assert!(matches!(halted, Err(Halt::StepTooSmall { time }) if (time - 1.0).abs() < 1e-6));
        let halted = rk.advance(&mut Escape, 0.0, 2.0, &mut [f64::NAN]);
        assert!(matches!(halted, Err(Halt::NotFinite { .. })));
    }
}
