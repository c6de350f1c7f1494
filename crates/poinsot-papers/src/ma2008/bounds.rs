//! Sec. IV: first-order upper bounds of the identification error, (29)-(45), for both steps and options.
//!
//! Misprint in the paper: row 2 of (39) is `dv(2) + dw(3) rho(1) - dw(1) rho(3)`. Step 2 as printed assumes exact mass
//! and mass centre: (45) has no term for the error of step 1.

use super::arm::Reading;
use super::equations::{AngularRows, Given, LinearRows, TwoStep, put};
use super::solve::Step;
use nalgebra::SMatrix;
use poinsot_spatial::{Matrix3, Vector3, skew, tensor_regressor};

/// An error exceeds this multiple of its RMS with a probability below 0.1 %. A sum of squares of normal numbers with
/// mean m exceeds `m (1 + sqrt(2 t))^2` with probability at most `exp(-t)` (Laurent and Massart 2000).
const LIMIT: f64 = 4.717;

/// The bound for one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
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
///
/// ```
/// use nalgebra::SMatrix;
/// use poinsot_papers::ma2008::{bounds::bound, solve};
///
/// // x = (3, 4) from the unit matrix: |dx| is at most |x| |dA| + |db|.
/// let step = solve::<2, 3>(&[SMatrix::<f64, 3, 3>::new(1.0, 0.0, -3.0, 0.0, 1.0, -4.0, 0.0, 0.0, 0.0)]);
/// let found = bound(&step, 0.01, 0.1);
/// assert!((found.condition - 1.0).abs() < 1.0e-12);
/// assert!((found.absolute - 0.15).abs() < 1.0e-12);
/// ```
pub fn bound<const N: usize>(step: &Step<N>, epsilon_A: f64, epsilon_b: f64) -> Bound {
    // `||A||`, and `||A^+||` as the reciprocal of the smallest singular value.
    let (norm, inverse_norm) = (step.singular[0], 1.0 / step.singular[N - 1]);
    let condition = norm * inverse_norm;
    let (x, b) = (step.x.norm(), step.rhs.sqrt());
    let r = step.residual.max(0.0).sqrt();
    let absolute =
        inverse_norm * inverse_norm * r * epsilon_A + inverse_norm * (x * epsilon_A + epsilon_b);
    let (zeta, gamma) = (r / (norm * x), b / (norm * x));
    let relative = condition * condition * epsilon_A / norm * zeta
        + condition * (epsilon_A / norm + epsilon_b / b * gamma);
    Bound {
        condition,
        epsilon_A,
        epsilon_b,
        absolute,
        relative,
    }
}

/// `[dA | -db]` of step 1 for errors of velocity and angular velocity in base axes, (39) and (41), rotated to N.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// use poinsot_papers::ma2008::bounds::linear_error;
///
/// // The rows are linear in both velocities.
/// let (dv, dw, mut off) = (Vector3::x(), Vector3::y(), samples[0]);
/// off.v_NBo_B += dv;
/// off.w_NB_B += dw;
/// let change = linear_rows(&off) - linear_rows(&samples[0]);
/// assert!((change - linear_error(&samples[0], &dv, &dw)).norm() < 1.0e-12);
/// ```
pub fn linear_error(s: &Reading, dv: &Vector3, dw: &Vector3) -> LinearRows {
    let mut rows = LinearRows::zeros();
    rows.set_column(0, &(s.R_NB * (dv + dw.cross(&s.arm.rho_R))));
    put(&mut rows, 1, &(s.R_NB * skew(dw)));
    rows.set_column(4, &(s.R_NB * dv));
    rows
}

/// `[dB | -dc]` of step 2 for an error of the angular velocity, (43) and (45), rotated to N.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// use poinsot_papers::ma2008::bounds::angular_error;
///
/// // The rows are linear in the angular velocity.
/// let (dw, mut off) = (Vector3::y(), samples[0]);
/// off.w_NB_B += dw;
/// let change = angular_rows(&off, m_S, &rho_S) - angular_rows(&samples[0], m_S, &rho_S);
/// assert!((change - angular_error(&samples[0], m_S, &rho_S, &dw)).norm() < 1.0e-10);
/// ```
pub fn angular_error(s: &Reading, m_S: f64, rho_S: &Vector3, dw: &Vector3) -> AngularRows {
    let mu = s.arm.mass * m_S / (m_S + s.arm.mass);
    let d = rho_S - s.arm.rho_R;
    let dc = -s.arm.I_R * dw - d.cross(&dw.cross(&d)) * mu;
    let mut rows = AngularRows::zeros();
    put(&mut rows, 0, &(s.R_NB * tensor_regressor(dw)));
    rows.set_column(6, &(s.R_NB * -dc));
    rows
}

/// Sizes of the error matrices of both steps, `(||dA||, ||db||)`, that the noise of the velocities exceeds with a probability
/// below 0.1 %. Those of step 2 are of (43) and (45), without the error of step 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Of step 1.
    pub linear: (f64, f64),
    /// Of step 2.
    pub angular: (f64, f64),
}

impl Limits {
    /// From independent errors: `errors` gives, for a sample and its place in the segment, three errors of the velocity and three
    /// of the angular velocity, in base axes, one a column.
    pub fn of(
        segments: &[Vec<Reading>],
        given: Given,
        solved: &TwoStep,
        errors: impl Fn(&Reading, usize) -> [Matrix3; 2],
    ) -> Self {
        let (m_S, rho_S) = (solved.mass(), solved.rho_S());
        let (mut linear, mut angular) = (Vec::new(), Vec::new());
        for segment in segments {
            // The error of the first sample is in every increment.
            let increments = segment.len().saturating_sub(1) as f64;
            for (k, s) in segment.iter().enumerate() {
                let times = |known: bool| {
                    if k > 0 || known {
                        1.0
                    } else {
                        increments.sqrt()
                    }
                };
                let times = [given.p_C_N, given.h_C_N].map(|known| times(known.is_some()));
                let [dv, dw] = errors(s, k);
                let none = Vector3::zeros();
                for (dv, dw) in dv.column_iter().zip(dw.column_iter()) {
                    let dw = dw.into_owned();
                    linear.push(linear_error(s, &dv.into_owned(), &none) * times[0]);
                    linear.push(linear_error(s, &none, &dw) * times[0]);
                    angular.push(angular_error(s, m_S, &rho_S, &dw) * times[1]);
                }
            }
        }
        let limit = |(A, b): (f64, f64)| (LIMIT * A, LIMIT * b);
        Self {
            linear: limit(sizes::<4, 5>(&linear)),
            angular: limit(sizes::<6, 7>(&angular)),
        }
    }

    /// The bound of each step that is solved.
    pub fn bounds(&self, solved: &TwoStep) -> Vec<Bound> {
        let first = bound(&solved.linear, self.linear.0, self.linear.1);
        let second = solved.angular.as_ref();
        let second = second.map(|step| bound(step, self.angular.0, self.angular.1));
        std::iter::once(first).chain(second).collect()
    }
}

/// Frobenius norm of the first N columns and norm of the last, over all rows: `(||dA||, ||db||)`. It is at least the
/// spectral norm, so (35) remains an upper bound.
///
/// ```
/// use nalgebra::SMatrix;
/// use poinsot_papers::ma2008::bounds::sizes;
///
/// // [dA | db] with dA of norm 5 and db of norm 2.
/// let rows = SMatrix::<f64, 3, 3>::new(3.0, 0.0, 2.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0);
/// assert_eq!(sizes::<2, 3>(&[rows]), (5.0, 2.0));
/// ```
pub fn sizes<const N: usize, const W: usize>(rows: &[SMatrix<f64, 3, W>]) -> (f64, f64) {
    const { assert!(W == N + 1) }
    let square = |r: &SMatrix<f64, 3, W>| r.fixed_columns::<N>(0).norm_squared();
    let matrix = rows.iter().map(square).sum::<f64>();
    let right = rows.iter().map(|r| r.column(N).norm_squared()).sum::<f64>();
    (matrix.sqrt(), right.sqrt())
}
