//! White noise of joint rates, common to all sensors at one time.
//!
//! The sensors of a grid time are taken one by one; the noise estimate of each is subtracted from the next. This is a
//! Kalman filter (Kalman 1960) whose state lasts for one grid time.

use poinsot_spatial::{Matrix3, Vector3};

/// Estimate of the joint-rate noise from the sensors processed at a grid time.
#[derive(Default)]
pub(super) struct RateNoise {
    variances: Vec<f64>,
    /// Covariance, row by row; empty without such noise.
    covariance: Vec<f64>,
    /// Mean for every row and slope, one after the other; empty before the second sensor of a grid time.
    means: Vec<f64>,
    /// What the last sensor of the grid time adds to them: its rows and slopes, times the gain.
    latest: Vec<Vector3>,
    /// `P G^T`, and the gain.
    toward: Vec<Vector3>,
    gain: Vec<Vector3>,
}

impl RateNoise {
    /// `variances` are those of the joint rates.
    pub fn new(variances: &[f64]) -> Self {
        let noisy = variances.iter().any(|v| *v > 0.0);
        let variances = if noisy {
            variances.to_vec()
        } else {
            Vec::new()
        };
        Self {
            covariance: vec![0.0; variances.len() * variances.len()],
            variances,
            ..Self::default()
        }
    }

    /// Before the first sensor of a grid time.
    pub fn begin(&mut self) {
        let n = self.variances.len();
        self.means.clear();
        self.latest.clear();
        self.covariance.fill(0.0);
        for (k, variance) in self.variances.iter().enumerate() {
            self.covariance[k * n + k] = *variance;
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
        let n = self.variances.len();
        if n == 0 || gains.len() != n || gains.iter().all(|g| *g == Vector3::zeros()) {
            return Matrix3::zeros();
        }
        self.add_latest();
        let along = |weights: &[f64]| {
            let pairs = gains.iter().zip(weights);
            pairs.fold(Vector3::zeros(), |sum, (g, w)| sum + g * *w)
        };
        self.toward.clear();
        self.toward
            .extend(self.covariance.chunks_exact(n).map(along));
        let pairs = gains.iter().zip(&self.toward);
        let added = pairs.fold(Matrix3::zeros(), |sum, (g, t)| sum + g * t.transpose());
        let Some(inverse) = (sensor + added).try_inverse() else {
            return added;
        };
        self.gain.clear();
        self.gain.extend(self.toward.iter().map(|t| inverse * t));
        let means = self.means.chunks_exact(n);
        for (row, mean) in rows.iter_mut().chain(&mut *slopes).zip(means) {
            *row -= along(mean);
        }
        self.latest.extend(rows.iter().chain(&*slopes));
        for (row, gain) in self.covariance.chunks_exact_mut(n).zip(&self.gain) {
            for (p, toward) in row.iter_mut().zip(&self.toward) {
                *p -= gain.dot(toward);
            }
        }
        added
    }

    /// Adds to the means what the last sensor tells: not before there is another one at its grid time.
    fn add_latest(&mut self) {
        let n = self.variances.len();
        self.means
            .resize(self.means.len().max(self.latest.len() * n), 0.0);
        let means = self.means.chunks_exact_mut(n);
        for (row, mean) in self.latest.iter().zip(means) {
            for (m, gain) in mean.iter_mut().zip(&self.gain) {
                *m += gain.dot(row);
            }
        }
        self.latest.clear();
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
        noise.begin();
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
