//! Position of the mass centre from the accelerometer.

use super::recording::Recording;
use nalgebra::{Matrix3, Vector3};

/// Mass centre from the accelerometer, m, in body axes, by least squares over throws of one body.
///
/// In free flight gravity acts at the mass centre, so the specific force at the sensor S is
/// `f_S = w' x r + w x (w x r)` with `r = p_BcmS_B`; both use equally filtered signals.
pub fn p_SBcm_B(throws: &[&Recording]) -> Option<Vector3<f64>> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for throw in throws {
        let w = &throw.w_NB_B;
        for k in 1..w.len().saturating_sub(1) {
            let dw = (w[k + 1] - w[k - 1]) * (0.5 * throw.rate_hz);
            let turn = w[k].cross_matrix();
            let A = dw.cross_matrix() + turn * turn;
            normal += A.transpose() * A;
            right += A.transpose() * throw.f_S_B[k];
        }
    }
    normal.cholesky().map(|c| -c.solve(&right))
}
