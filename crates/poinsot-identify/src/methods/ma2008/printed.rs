//! The increments of option 2 exactly as printed, (14)-(17) and (21)-(24): for comparison only.
//!
//! They subtract velocities of different samples without turning them to common axes, so they hold only
//! while the base does not turn, or where `rho_S = 0` and `I_S` is a multiple of the unit tensor. They
//! also take the joints as stopped.

use super::{Reading, Step, TwoStep, solve, tensor_regressor};
use nalgebra::SMatrix;
use poinsot_spatial::{Matrix3, Vector3, parallel_axis, skew};

/// In which axes the printed velocities are read; the paper does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PrintedAxes {
    /// Both velocities in body axes.
    Body,
    /// The linear velocity in N, the angular one in body axes.
    Mixed,
    /// Both in N, the arm's vectors in body axes.
    Inertial,
}

fn velocities(s: &Reading, axes: PrintedAxes) -> (Vector3, Vector3) {
    match axes {
        PrintedAxes::Body => (s.v_NBo_B, s.w_NB_B),
        PrintedAxes::Mixed => (s.R_NB * s.v_NBo_B, s.w_NB_B),
        PrintedAxes::Inertial => (s.R_NB * s.v_NBo_B, s.R_NB * s.w_NB_B),
    }
}

/// Option 2 of both steps with the increments as printed, on one segment.
pub fn two_step_printed(segment: &[Reading], axes: PrintedAxes) -> Option<TwoStep> {
    let first = segment.first()?;
    let arm_mass = first.arm.mass;
    let (v0, w0) = velocities(first, axes);
    // (17): A_k = [dv + dw x rho_Rk + w_0 x drho_R, [dw]x], b_k = -dv.
    let rows: Vec<_> = segment
        .iter()
        .skip(1)
        .map(|s| {
            let (v, w) = velocities(s, axes);
            let (dv, dw) = (v - v0, w - w0);
            let a = dv + dw.cross(&s.arm.rho_R) + w0.cross(&(s.arm.rho_R - first.arm.rho_R));
            let mut T = SMatrix::<f64, 3, 5>::zeros();
            T.set_column(0, &a);
            T.fixed_columns_mut::<3>(1).copy_from(&skew(&dw));
            T.set_column(4, &dv);
            T
        })
        .collect();
    let linear: Step<4> = solve::<4, 5>(&rows);
    let mut answer = TwoStep {
        linear,
        angular: None,
        arm_mass,
    };
    // (24) with T_k the parallel-axis tensor of a unit mass at rho_S - rho_Rk.
    let (m_S, rho_S) = (answer.mass(), answer.rho_S());
    let mu = m_S * arm_mass / (m_S + arm_mass);
    let locked = |s: &Reading| -> Matrix3 { s.arm.I_R + parallel_axis(mu, &(rho_S - s.arm.rho_R)) };
    let rows: Vec<_> = segment
        .iter()
        .skip(1)
        .map(|s| {
            let dw = velocities(s, axes).1 - w0;
            let c = -locked(s) * dw - (locked(s) - locked(first)) * w0;
            let mut T = SMatrix::<f64, 3, 7>::zeros();
            T.fixed_columns_mut::<6>(0)
                .copy_from(&tensor_regressor(&dw));
            T.set_column(6, &-c);
            T
        })
        .collect();
    answer.angular = Some(solve::<6, 7>(&rows));
    Some(answer)
}
