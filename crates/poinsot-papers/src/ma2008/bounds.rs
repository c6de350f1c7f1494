//! Sec. IV: first-order upper bounds of the identification error, (29)-(45), for both steps and options.
//!
//! Misprint in the paper: row 2 of (39) is `dv(2) + dw(3) rho(1) - dw(1) rho(3)`. Step 2 as printed takes
//! mass and mass centre as exact: (45) has no term for the error of step 1.

use super::{AngularRows, LinearRows, Reading, Step, tensor_regressor};
use nalgebra::{DMatrix, SMatrix};
use poinsot_spatial::{Vector3, skew};

/// The bound for one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// `||A||`, the largest singular value.
    pub norm: f64,
    /// `||A^+||`, one over the smallest.
    pub inverse_norm: f64,
    /// Condition number, (37).
    pub condition: f64,
    /// `||dA||`.
    pub epsilon_A: f64,
    /// `||db||`.
    pub epsilon_b: f64,
    /// Upper bound of `||dx||` without terms of second order, (35).
    pub absolute: f64,
    /// Upper bound of `||dx|| / ||x||`, (36).
    pub relative: f64,
}

/// (35) and (36) at a solved step for errors of the sizes given.
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

/// `[dA | -db]` of step 1 for errors of velocity and angular velocity in base axes, (39) and (41), turned
/// to N.
pub fn linear_error(s: &Reading, dv: &Vector3, dw: &Vector3) -> LinearRows {
    let mut rows = LinearRows::zeros();
    rows.set_column(0, &(s.R_NB * (dv + dw.cross(&s.arm.rho_R))));
    rows.fixed_columns_mut::<3>(1)
        .copy_from(&(s.R_NB * skew(dw)));
    rows.set_column(4, &(s.R_NB * dv));
    rows
}

/// `[dB | -dc]` of step 2 for an error of the angular velocity, (43) and (45), turned to N.
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

/// Spectral norm of the first N columns and length of the last, over all rows: `(||dA||, ||db||)`.
pub fn sizes<const N: usize, const W: usize>(rows: &[SMatrix<f64, 3, W>]) -> (f64, f64) {
    const { assert!(W == N + 1) }
    let mut gram = DMatrix::<f64>::zeros(N, N);
    let mut b = 0.0;
    for r in rows {
        let A = r.fixed_columns::<N>(0);
        gram += A.transpose() * A;
        b += r.column(N).norm_squared();
    }
    let largest = gram.symmetric_eigenvalues().max();
    (largest.max(0.0).sqrt(), b.sqrt())
}
