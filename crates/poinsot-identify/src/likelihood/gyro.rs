//! What may be wrong with the gyro.

use crate::parameters::{Parameters, UnknownKind};
use poinsot_spatial::{Matrix3, Vector3, skew};

/// What may be wrong with the gyro: it reads `(1 + turn) w(t - lag) + bias`.
#[derive(Default)]
pub(crate) struct GyroErrors {
    bias: Vector3,
    /// Scale errors on the diagonal, misalignment beside it.
    turn: Matrix3,
    lag: f64,
}

impl GyroErrors {
    /// The errors of the gyro, and how late the attitude reads.
    pub fn of(parameters: &Parameters, x: &[f64]) -> (Self, f64) {
        let mut gyro = Self::default();
        let mut attitude_lag = 0.0;
        for (u, value) in parameters.unknowns.iter().zip(x) {
            match u.kind {
                UnknownKind::GyroBias(k) => gyro.bias[k] = *value,
                UnknownKind::GyroScale(k) => gyro.turn[(k, k)] += *value,
                UnknownKind::GyroMisalignment(k) => gyro.turn += skew(&axis(k)) * *value,
                UnknownKind::GyroShear(k) => gyro.turn += shear(k) * *value,
                UnknownKind::GyroLag => gyro.lag = *value,
                UnknownKind::AttitudeLag => attitude_lag = *value,
                _ => {}
            }
        }
        (gyro, attitude_lag)
    }

    /// The rate that a reading stands for, its lag left aside.
    pub fn corrected(&self, reading: &Vector3) -> Vector3 {
        let map = Matrix3::identity() + self.turn;
        let clear = reading - self.bias;
        map.lu().solve(&clear).unwrap_or(clear)
    }

    pub fn reading(&self, w: &Vector3, acceleration: &Vector3) -> Vector3 {
        let then = w - acceleration * self.lag;
        then + self.turn * then + self.bias
    }

    /// Change of the reading with the rate and with one unknown.
    pub(super) fn change(
        &self,
        w: &Vector3,
        acceleration: &Vector3,
        dw: &Vector3,
        unknown: Option<&UnknownKind>,
    ) -> Vector3 {
        let mut change = dw + self.turn * dw;
        match unknown {
            Some(UnknownKind::GyroBias(k)) => change[*k] += 1.0,
            Some(UnknownKind::GyroScale(k)) => change[*k] += w[*k],
            Some(UnknownKind::GyroMisalignment(k)) => change += axis(*k).cross(w),
            Some(UnknownKind::GyroShear(k)) => change += shear(*k) * w,
            Some(UnknownKind::GyroLag) => change -= acceleration + self.turn * acceleration,
            _ => {}
        }
        change
    }
}

/// Each of the two axes other than `k` reads of the other what it should not.
fn shear(k: usize) -> Matrix3 {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let mut both = Matrix3::zeros();
    both[(i, j)] = 1.0;
    both[(j, i)] = 1.0;
    both
}

fn axis(k: usize) -> Vector3 {
    let mut e = Vector3::zeros();
    e[k] = 1.0;
    e
}
