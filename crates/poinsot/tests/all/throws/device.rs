//! Numbers common to all throws of the box: nonorthogonal gyro axes, a tilted wheel, tachometer lag, accelerometer
//! bias. They are determined by the calibration throws, without the objects.

use super::Fault;
use super::recording::Recording;
use nalgebra::{Matrix3, SVector, Vector3};
use poinsot_model::Model;

/// The numbers of the box: rad, the lag s.
pub const NUMBERS: [&str; 6] = [
    "gyro.nonorthogonality_yz",
    "gyro.nonorthogonality_xz",
    "gyro.nonorthogonality_xy",
    "wheel.misalignment_x",
    "wheel.misalignment_y",
    "tachometer.lag",
];

/// Values of [`NUMBERS`].
pub type Numbers = SVector<f64, 6>;

/// Sums of `f_S = A r + b` with `A = [w'] + [w]^2`, `r` from the mass centre to the sensor, `b` its bias.
#[derive(Debug, Clone, Copy, Default)]
pub struct Lever {
    AA: Matrix3<f64>,
    A: Matrix3<f64>,
    Af: Vector3<f64>,
    f: Vector3<f64>,
    n: f64,
}

impl Lever {
    /// Adds the samples of a throw along this motion. In free flight gravity acts at the mass centre.
    pub fn follow(&mut self, throw: &Recording, w_NB_B: &[Vector3<f64>]) {
        let pairs = w_NB_B.windows(3).zip(&throw.f_S_B[1..]);
        for (k, (w, f_S)) in pairs.enumerate() {
            let dw = (w[2] - w[0]) / (throw.time_s[k + 2] - throw.time_s[k]);
            let turn = w[1].cross_matrix();
            let A = dw.cross_matrix() + turn * turn;
            self.AA += A.transpose() * A;
            self.A += A;
            self.Af += A.transpose() * f_S;
            self.f += f_S;
            self.n += 1.0;
        }
    }

    /// Information of one throw on the bias with its own free lever arm, and the right-hand side.
    fn of_bias(&self) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        let inverse = self.AA.try_inverse()?;
        let project = self.A * inverse;
        Some((
            Matrix3::identity() * self.n - project * self.A.transpose(),
            self.f - project * self.Af,
        ))
    }

    /// Mass centre relative to the sensor, body axes, m, after subtracting an accelerometer bias.
    pub fn p_Sc_B(&self, bias: &Vector3<f64>) -> Option<Vector3<f64>> {
        Some(-(self.AA.try_inverse()? * (self.Af - self.A.transpose() * bias)))
    }

    /// Its derivative with respect to the bias.
    pub fn slope(&self) -> Option<Matrix3<f64>> {
        Some(self.AA.try_inverse()? * self.A.transpose())
    }
}

/// Calibration of the box.
#[derive(Debug, Clone)]
pub struct Device {
    pub numbers: Numbers,
    pub numbers_sigma: Numbers,
    /// Bias of the accelerometer, m/s2, and its covariance from the scatter between throws.
    pub bias: Vector3<f64>,
    pub bias_covariance: Matrix3<f64>,
}

impl Device {
    /// The ideal box: orthogonal axes, no bias.
    pub fn ideal() -> Self {
        Self {
            numbers: Numbers::zeros(),
            numbers_sigma: Numbers::zeros(),
            bias: Vector3::zeros(),
            bias_covariance: Matrix3::zeros(),
        }
    }

    pub fn print(&self) {
        for (k, name) in NUMBERS.iter().enumerate() {
            let [value, sigma] = [self.numbers[k], self.numbers_sigma[k]].map(|x| 1.0e3 * x);
            println!("{name:26} {value:+6.2} +- {sigma:.2} mrad or ms");
        }
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let sigma = self.bias_covariance[(k, k)].sqrt();
            let value = self.bias[k];
            println!("accelerometer.bias_{axis:7} {value:+6.3} +- {sigma:.3} m/s2");
        }
    }

    /// Numbers of the box from several throws, weighted by their sigmas; sigma is widened if throws scatter more than
    /// stated (Birge 1932).
    pub fn of_numbers(found: &[(Numbers, Numbers)]) -> (Numbers, Numbers) {
        let weight = |sigma: f64| 1.0 / (sigma * sigma);
        let mean = Numbers::from_fn(|k, _| {
            let all: f64 = found.iter().map(|(_, s)| weight(s[k])).sum();
            found.iter().map(|(x, s)| x[k] * weight(s[k])).sum::<f64>() / all
        });
        let sigma = Numbers::from_fn(|k, _| {
            let all: f64 = found.iter().map(|(_, s)| weight(s[k])).sum();
            let square: f64 = found
                .iter()
                .map(|(x, s)| (x[k] - mean[k]).powi(2) * weight(s[k]))
                .sum();
            ((square / (found.len() as f64 - 1.0)).max(1.0) / all).sqrt()
        });
        (mean, sigma)
    }

    /// The bias common to these throws, and its covariance from the scatter between them.
    pub fn of_bias(throws: &[&Lever]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let (mut information, mut sum) = (Matrix3::zeros(), Vector3::zeros());
        let each = throws.iter().map(|lever| lever.of_bias());
        let each: Vec<(Matrix3<f64>, Vector3<f64>)> = each.collect::<Option<_>>()?;
        for (own, right) in &each {
            information += own;
            sum += right;
        }
        let inverse = information.try_inverse()?;
        let mean = inverse * sum;
        let mut scatter = Matrix3::zeros();
        for (own, right) in &each {
            let score = right - own * mean;
            scatter += score * score.transpose();
        }
        let share = each.len() as f64 / (each.len() as f64 - 1.0);
        Some((mean, inverse * scatter * inverse * share))
    }

    /// Samples corrected for gyro axes and tachometer lag.
    pub fn corrected(&self, throw: &Recording) -> Result<Recording, Fault> {
        let [yz, xz, xy] = [self.numbers[0], self.numbers[1], self.numbers[2]];
        let map = Matrix3::new(1.0, xy, xz, xy, 1.0, yz, xz, yz, 1.0);
        let inverse = map.try_inverse().ok_or("the gyro has no three axes")?;
        let mut out = throw.clone();
        out.w_NB_B = throw.w_NB_B.iter().map(|w| inverse * w).collect();
        let late = self.numbers[5] * throw.rate_hz;
        let speed = |k: f64| {
            let last = throw.wheel_rad_s.len() - 1;
            let k = k.clamp(0.0, last as f64);
            let (at, share) = (k as usize, k.fract());
            let next = throw.wheel_rad_s[(at + 1).min(last)];
            throw.wheel_rad_s[at] * (1.0 - share) + next * share
        };
        out.wheel_rad_s = (0..throw.wheel_rad_s.len())
            .map(|k| speed(k as f64 + late))
            .collect();
        Ok(out)
    }

    /// The model with the tilted wheel.
    pub fn tilted(&self, model: &Model) -> Model {
        let mut out = model.clone();
        for wheel in &mut out.wheels {
            let (a, about) = (wheel.axis_B, wheel.tilt_axes());
            let tilt = about[0] * self.numbers[3] + about[1] * self.numbers[4];
            wheel.axis_B = (a + tilt.cross(&a)).normalize();
        }
        out
    }
}
