//! Sec. IV: first-order upper bounds of the identification error, (29)-(45), for both steps and options.
//!
//! Misprint in the paper: row 2 of (39) is `dv(2) + dw(3) rho(1) - dw(1) rho(3)`. Step 2 as printed assumes exact mass
//! and mass centre: (45) has no term for the error of step 1.

use super::arm::Reading;
use super::equations::{AngularRows, LinearRows};
use super::influence::Influence;
use super::solve::Step;
use nalgebra::SMatrix;
use poinsot_spatial::{Vector3, skew, tensor_regressor};

/// An error exceeds this multiple of its RMS with a probability below 0.1 %. A sum of squares of normal numbers with
/// mean m exceeds `m (1 + sqrt(2 t))^2` with probability at most `exp(-t)` (Laurent and Massart 2000).
const LIMIT: f64 = 4.717;

/// The bound for one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// `||A||`, the largest singular value.
    pub norm: f64,
    /// `||A^+||`, the reciprocal of the smallest singular value.
    pub inverse_norm: f64,
    /// Condition number, (37).
    pub condition: f64,
    /// `||dA||`, Frobenius.
    pub epsilon_A: f64,
    /// `||db||`.
    pub epsilon_b: f64,
    /// Upper bound of `||dx||` without terms of second order, (35).
    pub absolute: f64,
    /// Upper bound of `||dx|| / ||x||`, (36).
    pub relative: f64,
}

/// (35) and (36) for a solved step and given error sizes.
pub fn bound<const N: usize>(step: &Step<N>, epsilon_A: f64, epsilon_b: f64) -> Bound {
    let (norm, smallest) = (step.singular[0], step.singular[N - 1]);
    let inverse_norm = 1.0 / smallest;
    let condition = norm * inverse_norm;
    let (x, r, b) = (
        step.x.norm(),
        step.residual.max(0.0).sqrt(),
        step.rhs.sqrt(),
    );
    let absolute =
        inverse_norm * inverse_norm * r * epsilon_A + inverse_norm * (x * epsilon_A + epsilon_b);
    let (zeta, gamma) = (r / (norm * x), b / (norm * x));
    let relative = condition * condition * epsilon_A / norm * zeta
        + condition * (epsilon_A / norm + epsilon_b / b * gamma);
    Bound {
        norm,
        inverse_norm,
        condition,
        epsilon_A,
        epsilon_b,
        absolute,
        relative,
    }
}

/// `[dA | -db]` of step 1 for errors of velocity and angular velocity in base axes, (39) and (41), rotated to N.
pub fn linear_error(s: &Reading, dv: &Vector3, dw: &Vector3) -> LinearRows {
    let mut rows = LinearRows::zeros();
    rows.set_column(0, &(s.R_NB * (dv + dw.cross(&s.arm.rho_R))));
    rows.fixed_columns_mut::<3>(1)
        .copy_from(&(s.R_NB * skew(dw)));
    rows.set_column(4, &(s.R_NB * dv));
    rows
}

/// `[dB | -dc]` of step 2 for an error of the angular velocity, (43) and (45), rotated to N.
pub fn angular_error(s: &Reading, m_S: f64, rho_S: &Vector3, dw: &Vector3) -> AngularRows {
    let mu = s.arm.mass * m_S / (m_S + s.arm.mass);
    let d = rho_S - s.arm.rho_R;
    let dc = -s.arm.I_R * dw - d.cross(&dw.cross(&d)) * mu;
    let mut rows = AngularRows::zeros();
    rows.fixed_columns_mut::<6>(0)
        .copy_from(&(s.R_NB * tensor_regressor(dw)));
    rows.set_column(6, &(s.R_NB * -dc));
    rows
}

/// The bound of step 1 for an error size that the declared noise exceeds with a probability below 0.1 %.
pub fn stated_linear(step: &Step<4>, effect: &Influence) -> Bound {
    let noise = &effect.linear;
    bound(step, limit(noise.epsilon_A), limit(noise.epsilon_b))
}

/// The same bound for step 2, including the effect of the error of step 1 on its right-hand side.
pub fn stated_angular(step: &Step<6>, effect: &Influence) -> Bound {
    let noise = &effect.angular;
    let right = limit(noise.epsilon_b) + limit(effect.passed_on);
    bound(step, limit(noise.epsilon_A), right)
}

/// Upper limit of an error with this mean square.
fn limit(mean_square: f64) -> f64 {
    LIMIT * mean_square.sqrt()
}

/// Frobenius norm of the first N columns and norm of the last, over all rows: `(||dA||, ||db||)`. It is at least the
/// spectral norm, so (35) remains an upper bound.
pub fn sizes<const N: usize, const W: usize>(rows: &[SMatrix<f64, 3, W>]) -> (f64, f64) {
    const { assert!(W == N + 1) }
    let square = |r: &SMatrix<f64, 3, W>| r.fixed_columns::<N>(0).norm_squared();
    let matrix = rows.iter().map(square).sum::<f64>();
    let right = rows.iter().map(|r| r.column(N).norm_squared()).sum::<f64>();
    (matrix.sqrt(), right.sqrt())
}
