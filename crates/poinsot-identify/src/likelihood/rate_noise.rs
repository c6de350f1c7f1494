//! White noise of joint rates, common to all sensors at one time.
//!
//! The sensors of a grid time are taken one by one; the noise estimate of each is subtracted from the next. This is a
//! Kalman filter (Kalman 1960) whose state lasts for one grid time.

use nalgebra::{DMatrix, DVector, Matrix3xX};
use poinsot_spatial::{Matrix3, Vector3};

/// Estimate of the joint-rate noise from the sensors processed at a grid time.
pub(super) struct RateNoise {
    /// Its covariance; empty without such noise.
    covariance: DMatrix<f64>,
    /// Its mean for every row and slope; empty before the first sensor.
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

    /// Subtracts the estimated noise from a sample, rows and slopes, and returns the remaining covariance. `gains` is
    /// the change of the reading with every joint rate, `sensor` the covariance of its own noise.
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Two sensors that feel the same joint rates, one after the other, against their covariance together.
    #[test]
    fn exact_sensors_one_by_one_are_those_of_the_whole_covariance() {
        let variances = [0.4, 0.0, 0.9];
        let gains = |phase: f64| -> Vec<Vector3> {
            let one = |j: usize| Vector3::from_fn(|i, _| (phase + (3 * j + i) as f64).sin());
            (0..3).map(one).collect()
        };
        let all = [gains(0.3), gains(1.7)];
        let sensors = [Matrix3::identity() * 0.2, Matrix3::identity() * 0.05];
        let residuals = [Vector3::new(0.5, -1.0, 0.2), Vector3::new(0.1, 0.7, -0.3)];
        let mut whole = DMatrix::zeros(6, 6);
        for i in 0..6 {
            for j in 0..6 {
                let joints = variances.iter().enumerate();
                whole[(i, j)] = joints
                    .map(|(k, v)| all[i / 3][k][i % 3] * all[j / 3][k][j % 3] * v)
                    .sum();
            }
            whole[(i, i)] += sensors[i / 3][(0, 0)];
        }
        let stacked = DVector::from_iterator(6, residuals.iter().flat_map(|r| r.iter().copied()));
        let solution = whole.clone().cholesky().unwrap().solve(&stacked);
        let expected = (stacked.dot(&solution), whole.determinant().ln());
        let mut noise = RateNoise::new(&variances);
        let mut found = (0.0, 0.0);
        for k in 0..2 {
            let mut rows = [residuals[k]];
            let added = noise.take(&all[k], &sensors[k], &mut rows, &mut []);
            let own = sensors[k] + added;
            found.0 += rows[0].dot(&(own.try_inverse().unwrap() * rows[0]));
            found.1 += own.determinant().ln();
        }
        assert!((found.0 - expected.0).abs() < 1.0e-12);
        assert!((found.1 - expected.1).abs() < 1.0e-12);
    }
}
