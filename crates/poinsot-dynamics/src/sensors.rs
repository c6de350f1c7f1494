//! Simulated sensors: the truth with all errors of the estimator's model, noise and quantisation.

use crate::measurement::{BasePose, Ideal, PointMotion, Scene};
use crate::motion::sample::MotionSample;
use crate::sensor::{Axes, Nuisance, Sensor, SensorKind, SlowError};
use crate::sensor_errors::{SensorError, SensorErrors};
use crate::tree::Tree;
use nalgebra::Quaternion;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// A simulated sensor: its declared errors, random stream and bias.
///
/// A reading is `(1 + turn) truth + bias + noise`, rounded to the least significant bit ([`SensorErrors`]). Gyro,
/// accelerometer, direction and attitude have errors in the sensor's axes and samples in those of its body; position
/// and velocity both in N; a relative position both in the axes of the body from which it is seen. A lag shifts the times of the samples, not their values: see [`Instrument::lag_s`].
#[derive(Debug, Clone)]
pub struct Instrument {
    /// What is declared; a scalar sensor is of joint coordinates, wheels or thrusters.
    sensor: Sensor,
    /// Absent if the sensor's axes are the body's, to avoid round-off.
    R_BS: Option<Matrix3>,
    /// A square root of the noise covariance.
    noise: Option<Matrix3>,
    /// Each slow error with its value at the previous sample.
    slow: Vec<(SlowError, Vector3)>,
    /// Time of that sample, s.
    last_s: Option<f64>,
    bias: Vec<f64>,
    /// Relative error of each joint, wheel or thruster of a scalar sensor.
    scales: Vec<f64>,
    /// Scale, misalignment and nonorthogonality of a sensor with axes, and the lag; the bias is separate, since a sensor may
    /// measure many joints.
    errors: SensorErrors,
    /// Phase of the quantisation steps, one per channel, in steps.
    phase: Vec<f64>,
    rng: ChaCha8Rng,
    last_velocity: Option<Vector3>,
}

impl Instrument {
    /// A sensor of the vehicle. Equal `seed` and `stream` give equal errors; every sensor of every trial
    /// needs its own stream. The bias is the one given (three numbers, or one per scalar channel, or one
    /// for all), else drawn from the declared prior sigma, else zero. Scale, misalignment, nonorthogonality
    /// and lag are zero: [`Self::set_error`] and [`Self::set_scales`] give them.
    pub fn new(sensor: &Sensor, tree: &Tree, seed: u64, stream: u64, bias: Option<&[f64]>) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        let mut sensor = sensor.clone();
        if let SensorKind::JointPosition | SensorKind::JointRate = sensor.kind {
            let place = |j| tree.coordinates.iter().position(|k| k == j);
            sensor.of = sensor.of.iter().filter_map(place).collect();
        }
        let is_scalar = sensor.kind.is_scalar();
        let channels = if is_scalar { sensor.of.len() } else { 3 };
        let bias = (0..channels)
            .map(|i| match (bias, sensor.bias) {
                (Some(given), _) => given.get(i).or(given.first()).copied().unwrap_or(0.0),
                (None, Nuisance::Prior(sigma)) => sigma * normal(&mut rng),
                (None, Nuisance::Known | Nuisance::Estimate) => 0.0,
            })
            .collect();
        Self {
            scales: vec![0.0; if is_scalar { channels } else { 0 }],
            errors: SensorErrors::default(),
            slow: (sensor.slow.iter())
                .map(|s| (*s, Vector3::zeros()))
                .collect(),
            last_s: None,
            R_BS: (sensor.R_BS != Matrix3::identity()).then_some(sensor.R_BS),
            noise: sensor.noise_covariance.as_ref().map(square_root),
            phase: vec![0.0; channels],
            bias,
            rng,
            last_velocity: None,
            sensor,
        }
    }

    /// Draws the phase of the quantisation steps. With a fixed phase, equal motions have equal rounding errors in every
    /// trial, which then appear as a bias.
    pub fn draw_phase(&mut self) {
        for phase in &mut self.phase {
            *phase = self.rng.random::<f64>() - 0.5;
        }
    }

    /// Draws the size of the quantisation steps, uniformly within this share of the declared step. For exactly
    /// repeating motion, the quantisation error is periodic, not white.
    pub fn draw_step(&mut self, share: f64) {
        self.sensor.quantisation *= 1.0 + share * (2.0 * self.rng.random::<f64>() - 1.0);
    }

    /// The current bias, in the sensor's axes.
    pub fn bias(&self) -> &[f64] {
        &self.bias
    }

    /// Sets one error, in the sensor's axes; [`Self::new`] sets the bias.
    pub fn set_error(&mut self, error: SensorError, value: f64) {
        let now = self.error(error);
        self.errors.add(error, value - now);
    }

    /// The current relative errors of a scalar sensor: one per joint, wheel or thruster.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Sets the relative errors of a scalar sensor: one per joint, wheel or thruster, or one for all.
    pub fn set_scales(&mut self, scales: &[f64]) {
        for (i, own) in self.scales.iter_mut().enumerate() {
            *own = scales.get(i).or(scales.first()).copied().unwrap_or(0.0);
        }
    }

    /// A current error other than the bias, in the sensor's axes.
    pub fn error(&self, error: SensorError) -> f64 {
        let turn = &self.errors.turn;
        let pair = |k: usize| {
            (
                turn[((k + 2) % 3, (k + 1) % 3)],
                turn[((k + 1) % 3, (k + 2) % 3)],
            )
        };
        match error {
            SensorError::Bias(k) => self.bias.get(k).copied().unwrap_or(0.0),
            SensorError::Scale(k) => turn[(k, k)],
            SensorError::Misalignment(k) => 0.5 * (pair(k).0 - pair(k).1),
            SensorError::Nonorthogonality(k) => 0.5 * (pair(k).0 + pair(k).1),
            SensorError::Lag => self.errors.lag_s,
        }
    }

    /// Delay of the sensor, s: a sample of the motion at t has the time t + lag.
    pub fn lag_s(&self) -> f64 {
        self.errors.lag_s
    }

    /// Replaces `out` with one reading: three numbers, four for an attitude (xyzw), one per joint, wheel
    /// or thruster. Empty for the first velocity increment, which has no beginning.
    pub fn read(&mut self, sample: &MotionSample, out: &mut Vec<f64>) {
        if self.sensor.kind.is_scalar() {
            let truth = scalars(self.sensor.kind, sample);
            let of = |i: &usize| truth.get(*i).copied().unwrap_or(f64::NAN);
            let exact: Vec<f64> = self.sensor.of.iter().map(of).collect();
            return self.disturb(sample.time, &exact, out);
        }
        let own = &self.sensor;
        let other = (own.seen_from, own.reference_N);
        match ideal(own.kind, sample, (own.body, &own.p_BoS_B), other) {
            Some(Ideal::Rotation(q)) => self.disturb(sample.time, q.coords.as_slice(), out),
            Some(Ideal::Vector(mut x)) => {
                if self.sensor.kind == SensorKind::VelocityIncrement {
                    let Some(last) = self.last_velocity.replace(x) else {
                        return out.clear();
                    };
                    x -= last;
                }
                self.disturb(sample.time, x.as_slice(), out);
            }
            None => out.clear(),
        }
    }

    /// Replaces `out` with the reading at a time, s, for the ideal values `exact`, in the same order.
    pub fn disturb(&mut self, time_s: f64, exact: &[f64], out: &mut Vec<f64>) {
        out.clear();
        match (self.sensor.kind, exact) {
            (kind, &[x, y, z, w]) if kind.is_rotation() => {
                let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
                out.extend(self.attitude(time_s, q).coords.iter());
            }
            (kind, _) if kind.is_scalar() => {
                for (i, x) in exact.iter().enumerate() {
                    let noise = self.noise.map_or(0.0, |root| root[(0, 0)]);
                    let bias = self.bias.get(i).copied().unwrap_or(0.0);
                    let scale = self.scales.get(i).copied().unwrap_or(0.0);
                    let error = bias + noise * normal(&mut self.rng);
                    out.push(self.round(x + scale * x + error, i));
                }
            }
            (kind, &[x, y, z]) => {
                let mut own = self.corrupt(time_s, Vector3::new(x, y, z));
                if kind == SensorKind::Direction {
                    own.try_normalize_mut(0.0);
                }
                out.extend(own.iter());
            }
            _ => {}
        }
    }

    fn corrupt(&mut self, time_s: f64, x: Vector3) -> Vector3 {
        let turn = self
            .R_BS
            .filter(|_| self.sensor.kind.axes() == Axes::Sensor);
        let own = turn.map_or(x, |R| R.transpose() * x);
        let mut own = self.errors.change(&own) + self.bias_and_noise(time_s);
        for (i, x) in own.iter_mut().enumerate() {
            *x = self.round(*x, i);
        }
        turn.map_or(own, |R| R * own)
    }

    /// The attitude turned by a small rotation in the sensor's axes.
    fn attitude(&mut self, time_s: f64, q: UnitQuaternion) -> Quaternion<f64> {
        let error = self.bias_and_noise(time_s);
        let error = self.R_BS.map_or(error, |R| R * error);
        let q = q * UnitQuaternion::from_scaled_axis(error);
        if self.sensor.quantisation == 0.0 {
            return q.into_inner();
        }
        // A rotation of one LSB changes a component by half of it.
        let lsb = 0.5 * self.sensor.quantisation;
        Quaternion::from(q.coords.map(|x| (x / lsb).round() * lsb)).normalize()
    }

    fn bias_and_noise(&mut self, time_s: f64) -> Vector3 {
        let mut error = Vector3::zeros();
        error.iter_mut().zip(&self.bias).for_each(|(e, b)| *e = *b);
        if let Some(root) = self.noise {
            error += root * Vector3::from_fn(|_, _| normal(&mut self.rng));
        }
        let passed_s = self.last_s.replace(time_s).map(|before| time_s - before);
        for (slow, now) in &mut self.slow {
            let (stays, fresh) = match passed_s {
                None => (0.0, slow.first()),
                Some(h) => (slow.stays(h), slow.fresh(h)),
            };
            let drawn = Vector3::from_fn(|_, _| normal(&mut self.rng));
            *now = *now * stays + square_root(&fresh) * drawn;
            error += *now;
        }
        error
    }

    fn round(&self, x: f64, channel: usize) -> f64 {
        if self.sensor.quantisation > 0.0 {
            let phase = self.phase.get(channel).copied().unwrap_or(0.0);
            ((x / self.sensor.quantisation + phase).round() - phase) * self.sensor.quantisation
        } else {
            x
        }
    }
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// The symmetric square root; zero variances are allowed.
fn square_root(covariance: &Matrix3) -> Matrix3 {
    let eigen = covariance.symmetric_eigen();
    let root = Matrix3::from_diagonal(&eigen.eigenvalues.map(|x| x.max(0.0).sqrt()));
    eigen.eigenvectors * root * eigen.eigenvectors.transpose()
}

fn scalars(kind: SensorKind, sample: &MotionSample) -> &[f64] {
    match kind {
        SensorKind::JointPosition => &sample.q,
        SensorKind::JointRate => &sample.rates,
        SensorKind::WheelSpeed => &sample.wheel_speed,
        SensorKind::Thrust => &sample.thrust,
        _ => &[],
    }
}

/// Ideal measurement of a sensor with axes at a point of a body; `other` is the body from which a relative kind sees it,
/// and the vector in N of a direction.
fn ideal(
    kind: SensorKind,
    sample: &MotionSample,
    (body, p_BoS_B): (usize, &Vector3),
    other: (usize, Option<Vector3>),
) -> Option<Ideal> {
    let k = &sample.kinematics;
    let pose = BasePose {
        R_NB: sample.R_NB,
        p_NoBo_N: sample.p_NoBo_N,
    };
    let scene = Scene {
        pose: &pose,
        point: &PointMotion::new(k, body, p_BoS_B),
        from: &PointMotion::new(k, other.0, &Vector3::zeros()),
        reference_N: other.1,
        a_NP_B: Some(sample.body.of_point(k, body, p_BoS_B)),
    };
    Some(kind.measure(&scene)?.value)
}

/// Ideal measurement of a sensor with three axes at a point fixed in a body; for a velocity increment the velocity
/// itself. Zero for a rotation, a direction and a relative kind.
pub fn vector_reading(
    kind: SensorKind,
    sample: &MotionSample,
    body: usize,
    p_BoS_B: &Vector3,
) -> Vector3 {
    match ideal(kind, sample, (body, p_BoS_B), (0, None)) {
        Some(Ideal::Vector(x)) if !kind.is_relative() => x,
        _ => Vector3::zeros(),
    }
}
