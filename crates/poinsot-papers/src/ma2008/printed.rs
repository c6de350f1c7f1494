//! The increments of option 2 exactly as printed, (14)-(17) and (21)-(24): for comparison only.
//!
//! They subtract velocities of different samples without rotation to common axes. They hold only if the base does not
//! rotate, or if `rho_S = 0` and `I_S` is a multiple of the unit tensor. They also assume stopped joints.

use super::arm::Reading;
use super::equations::{TwoStep, put};
use super::solve::solve;
use nalgebra::SMatrix;
use poinsot_spatial::{Matrix3, parallel_axis, skew, tensor_regressor};

/// Assumed axes of the printed vectors; the paper does not define them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrintedAxes {
    /// All in body axes.
    Body,
    /// All in N: correct if `rho_S = 0` and `I_S` is a multiple of the unit tensor.
    Inertial,
}

/// One sample in the assumed axes.
fn turned(s: &Reading, axes: PrintedAxes) -> Reading {
    let R = match axes {
        PrintedAxes::Body => Matrix3::identity(),
        PrintedAxes::Inertial => s.R_NB,
    };
    let mut turned = *s;
    turned.v_NBo_B = R * s.v_NBo_B;
    turned.w_NB_B = R * s.w_NB_B;
    turned.arm.rho_R = R * s.arm.rho_R;
    turned.arm.I_R = R * s.arm.I_R * R.transpose();
    turned
}

/// Option 2 of both steps with the increments as printed, for one segment; `None` without samples.
///
/// ```
#[doc = include_str!("../../doc/balanced.txt")]
/// use poinsot_papers::ma2008::printed::{PrintedAxes, two_step_printed};
///
/// // All samples have the attitude of N here, so the printed increments hold.
/// let found = two_step_printed(&samples, PrintedAxes::Body).unwrap();
/// assert!((found.mass() - m_S).abs() < 1.0e-6);
/// ```
pub fn two_step_printed(segment: &[Reading], axes: PrintedAxes) -> Option<TwoStep> {
    let arm_mass = segment.first()?.arm.mass;
    let samples: Vec<Reading> = segment.iter().map(|s| turned(s, axes)).collect();
    let first = samples.first()?;
    // (17): A_k = [dv + dw x rho_Rk + w_0 x drho_R, [dw]x], b_k = -dv.
    let linear_rows = |s: &Reading| {
        let (dv, dw) = (s.v_NBo_B - first.v_NBo_B, s.w_NB_B - first.w_NB_B);
        let a = dv + dw.cross(&s.arm.rho_R) + first.w_NB_B.cross(&(s.arm.rho_R - first.arm.rho_R));
        let mut T = SMatrix::<f64, 3, 5>::zeros();
        T.set_column(0, &a);
        put(&mut T, 1, &skew(&dw));
        T.set_column(4, &dv);
        T
    };
    let rows: Vec<_> = samples.iter().skip(1).map(linear_rows).collect();
    let mut answer = TwoStep::first(&rows, arm_mass);
    // (24), with T_k the parallel-axis tensor of a unit mass at rho_S - rho_Rk.
    let (m_S, rho_S) = (answer.mass(), answer.rho_S());
    let mu = m_S * arm_mass / (m_S + arm_mass);
    let locked = |s: &Reading| -> Matrix3 { s.arm.I_R + parallel_axis(mu, &(rho_S - s.arm.rho_R)) };
    let angular_rows = |s: &Reading| {
        let dw = s.w_NB_B - first.w_NB_B;
        let c = -locked(s) * dw - (locked(s) - locked(first)) * first.w_NB_B;
        let mut T = SMatrix::<f64, 3, 7>::zeros();
        put(&mut T, 0, &tensor_regressor(&dw));
        T.set_column(6, &-c);
        T
    };
    let rows: Vec<_> = samples.iter().skip(1).map(angular_rows).collect();
    answer.angular = Some(solve::<6, 7>(&rows));
    Some(answer)
}
