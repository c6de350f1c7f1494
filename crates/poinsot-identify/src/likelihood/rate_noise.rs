//! White noise of joint rates, common to all sensors that feel it at one time.
//!
//! The sensors of a grid time are taken one by one; what each tells of the noise is taken off the next. This is a Kalman
//! filter (Kalman 1960) whose state lasts for one grid time.

use nalgebra::{DMatrix, DVector, Matrix3xX};
use poinsot_spatial::{Matrix3, Vector3};

/// What the sensors taken so far at a grid time say of the noise of the joint rates.
pub(super) struct RateNoise {
    /// Covariance of what is not known of it yet; empty without such noise.
    covariance: DMatrix<f64>,
    /// What is known of it, for every row and slope; empty before the first sensor.
    means: Vec<DVector<f64>>,
}

impl RateNoise {
    /// Before the first sensor; `variances` are those of the joint rates.
    pub fn new(variances: &[f64]) -> Self {
        let noisy = variances.iter().any(|v| *v > 0.0);
        let all = DVector::from_column_slice(if noisy { variances } else { &[] });
        Self {
            covariance: DMatrix::from_diagonal(&all),
            means: Vec::new(),
        }
    }

    /// Takes what is known of the noise off a reading, rows and slopes, and gives the covariance of what is left of it.
    /// `gains` is the change of the reading with every joint rate, `sensor` the covariance of its own noise.
    pub fn take(
        &mut self,
        gains: &[Vector3],
        sensor: &Matrix3,
        rows: &mut [Vector3],
        slopes: &mut [Vector3],
    ) -> Matrix3 {
        let n = self.covariance.nrows();
        if n == 0 || gains.len() != n || gains.iter().all(|g| *g == Vector3::zeros()) {
            return Matrix3::zeros();
        }
        let G = Matrix3xX::from_columns(gains);
        let toward = &self.covariance * G.transpose();
        let added: Matrix3 = &G * &toward;
        if self.means.is_empty() {
            self.means = vec![DVector::zeros(n); rows.len() + slopes.len()];
        }
        let Some(inverse) = (sensor + added).try_inverse() else {
            return added;
        };
        let gain = &toward * inverse;
        for (row, mean) in rows.iter_mut().chain(slopes).zip(&mut self.means) {
            *row -= &G * &*mean;
            *mean += &gain * *row;
        }
        self.covariance -= &gain * toward.transpose();
        added
    }
}
