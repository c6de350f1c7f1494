//! Error model of a sensor with three axes: for the ideal measurement `x(t)` it gives `(1 + turn) x(t - lag) + bias`.
//!
//! Estimator and simulator share it.

use poinsot_spatial::{Matrix3, Vector3, skew};

/// One error parameter of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SensorError {
    /// Component of a constant error, in the unit of the instrument.
    Bias(usize),
    /// Relative error of an axis.
    Scale(usize),
    /// Component of the small rotation between true and assumed axes, rad.
    Misalignment(usize),
    /// Turn of two axes towards each other, rad: of the pair that leaves out this axis.
    Nonorthogonality(usize),
    /// Delay, s.
    Lag,
}

/// Error parameters of one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorErrors {
    /// Constant error, in the unit of the instrument.
    pub bias: Vector3,
    /// Scale on the diagonal, misalignment and nonorthogonality off it; no unit.
    pub turn: Matrix3,
    /// Delay, s.
    pub lag_s: f64,
}

impl SensorErrors {
    /// Adds a value to one error.
    pub fn add(&mut self, error: SensorError, value: f64) {
        match error {
            SensorError::Bias(k) => self.bias[k] += value,
            SensorError::Lag => self.lag_s += value,
            other => self.turn += turn_of(other) * value,
        }
    }

    /// Measurement for the ideal value `x` with rate of change `rate` per second.
    pub fn reading(&self, x: &Vector3, rate: &Vector3) -> Vector3 {
        let then = x - rate * self.lag_s;
        then + self.turn * then + self.bias
    }

    /// Ideal value for the measurement `reading`, without the lag.
    pub fn corrected(&self, reading: &Vector3) -> Vector3 {
        let clear = reading - self.bias;
        let map = Matrix3::identity() + self.turn;
        map.lu().solve(&clear).unwrap_or(clear)
    }

    /// Change of the measurement with the ideal value.
    pub fn change(&self, dx: &Vector3) -> Vector3 {
        dx + self.turn * dx
    }

    /// Derivative of the measurement over one error.
    pub fn slope(&self, error: SensorError, x: &Vector3, rate: &Vector3) -> Vector3 {
        match error {
            SensorError::Bias(k) => Vector3::ith(k, 1.0),
            SensorError::Lag => -self.change(rate),
            other => turn_of(other) * (x - rate * self.lag_s),
        }
    }
}

/// Effect of one unit of an error on the axes.
fn turn_of(error: SensorError) -> Matrix3 {
    match error {
        SensorError::Scale(k) => Matrix3::from_diagonal(&Vector3::ith(k, 1.0)),
        SensorError::Misalignment(k) => skew(&Vector3::ith(k, 1.0)),
        SensorError::Nonorthogonality(k) => {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let mut both = Matrix3::zeros();
            both[(i, j)] = 1.0;
            both[(j, i)] = 1.0;
            both
        }
        SensorError::Bias(_) | SensorError::Lag => Matrix3::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each derivative is the difference of the model over its error, and a corrected measurement returns the original.
    #[test]
    fn exact_slopes_are_those_of_the_law() {
        let (x, rate) = (Vector3::new(0.3, -1.0, 2.0), Vector3::new(0.1, 0.7, -0.4));
        let all = (0..3).flat_map(|k| {
            [
                SensorError::Bias(k),
                SensorError::Scale(k),
                SensorError::Misalignment(k),
                SensorError::Nonorthogonality(k),
            ]
        });
        let all: Vec<SensorError> = all.chain([SensorError::Lag]).collect();
        let mut errors = SensorErrors::default();
        for (k, error) in all.iter().enumerate() {
            errors.add(*error, 0.01 * (k as f64 + 1.0).sin());
        }
        for error in &all {
            let step = 1.0e-6;
            let ends = [step, -step].map(|d| {
                let mut moved = errors;
                moved.add(*error, d);
                moved.reading(&x, &rate)
            });
            let slope = (ends[0] - ends[1]) / (2.0 * step);
            let gap = (slope - errors.slope(*error, &x, &rate)).amax();
            assert!(gap < 1.0e-9, "{error:?}: {gap:e}");
        }
        let then = x - rate * errors.lag_s;
        let back = errors.corrected(&errors.reading(&x, &rate));
        assert!((back - then).amax() < 1.0e-14);
    }
}
