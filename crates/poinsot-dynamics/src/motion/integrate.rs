//! What all integrators share: the equation, the tolerance, why they stop.

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
    /// A free joint has no outboard inertia.
    #[error(
        "joint coordinate {coordinate} has no inertia at t = {time} s: give its outboard bodies mass off its axis or inertia about it"
    )]
    Joint {
        /// Time, s.
        time: f64,
        /// Coordinate of the tree.
        coordinate: usize,
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
    /// Why the step at `t` shrank to nothing, with this error of the last one.
    pub(crate) fn stuck(t: f64, error: f64) -> Self {
        match error.is_finite() {
            true => Self::StepTooSmall { time: t },
            false => Self::NotFinite { time: t },
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
    let finite = y.iter().all(|y| y.is_finite()).then_some(());
    finite.ok_or(Halt::NotFinite { time: end })
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
