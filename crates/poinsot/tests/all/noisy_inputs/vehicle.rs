//! Vehicles that nobody tuned for: bodies drawn at random, joints and wheels that follow sums of sines.
//!
//! Nothing acts from outside, so the momentum about the mass centre is constant in N; the rate of the base is what makes the sums
//! over the bodies (`poinsot_testkit::momentum_sum`) agree with it. The attitude follows by Runge-Kutta on the rotation vector.

use nalgebra::UnitQuaternion;
use poinsot_telemetry::{Channel, Table};
use poinsot_testkit::momentum_sum::{
    KitBody, KitJoint, KitState, KitWheel, locked_inertia, momentum_about_base,
};
use poinsot_testkit::vehicles::ModelText;
use poinsot_testkit::{Matrix3, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

const DURATION_S: f64 = 120.0;
/// Samples per second of all but the tracker, and grid steps between those of the tracker.
const RATE_HZ: f64 = 10.0;
const EVERY: usize = 5;
const TRACKER: f64 = 5.0e-5;
const GYRO_BIAS: f64 = 3.0e-5;
/// Spin inertia of a wheel, kg m2.
const SPIN: f64 = 0.07;

/// What is noisy beside the gyro.
#[derive(Debug, Clone, Copy)]
pub enum Inputs {
    /// Three wheels; tachometer noise in what it does to the rate about the axis of least inertia, over the gyro's noise.
    Wheels { q: f64 },
    /// An arm of two links with encoders, and sensors of the rates with the same number per second.
    Joints { noise_rad: f64 },
}

/// Errors of the sensors that last over samples.
#[derive(Debug, Clone, Copy, Default)]
pub struct Slow {
    /// Of the tracker, rad, beside white noise, and of the gyro, rad/s.
    pub tracker: f64,
    pub gyro: f64,
    /// How long both last, s.
    pub correlation_s: f64,
    /// What the bias of the gyro gains in 1 s, rad/s.
    pub walk: f64,
    /// Whether the model has them.
    pub declared: bool,
}

/// A process of Gauss and Markov, as an autoregression.
fn lasting(
    random: &mut ChaCha8Rng,
    (sigma, time_s): (f64, f64),
    h_s: f64,
) -> impl FnMut() -> Vector3 + use<> {
    let a = if sigma > 0.0 {
        (-h_s / time_s).exp()
    } else {
        0.0
    };
    let mut own = ChaCha8Rng::seed_from_u64(random.random());
    let mut now = normals(&mut own) * sigma;
    move || {
        let before = now;
        now = now * a + normals(&mut own) * (sigma * (1.0 - a * a).sqrt());
        before
    }
}

/// Sum of sines about a mean.
struct Wave {
    mean: f64,
    /// Amplitude, angular frequency, phase.
    terms: [Vector3; 3],
}

impl Wave {
    fn drawn(random: &mut ChaCha8Rng, mean: f64, size: f64, periods_s: [f64; 2]) -> Self {
        let mut between = |a: f64, b: f64| random.random_range(a..b);
        let terms = std::array::from_fn(|_| {
            let frequency = TAU / between(periods_s[0], periods_s[1]);
            Vector3::new(size * between(0.3, 1.0), frequency, between(0.0, TAU))
        });
        Self { mean, terms }
    }

    fn value(&self, t: f64) -> f64 {
        let terms = self.terms.iter();
        self.mean + terms.map(|s| s.x * (s.y * t + s.z).sin()).sum::<f64>()
    }

    fn rate(&self, t: f64) -> f64 {
        let terms = self.terms.iter();
        terms.map(|s| s.x * s.y * (s.y * t + s.z).cos()).sum()
    }
}

/// The true vehicle and its motion.
pub struct Vehicle {
    bodies: Vec<KitBody>,
    wheels: Vec<KitWheel>,
    joints: Vec<Wave>,
    speeds: Vec<Wave>,
    start: UnitQuaternion<f64>,
    h_SScm_N: Vector3,
    gyro: f64,
    input: f64,
    pub slow: Slow,
    random: ChaCha8Rng,
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

fn normals(random: &mut ChaCha8Rng) -> Vector3 {
    Vector3::from_fn(|_, _| normal(random))
}

/// Inertia about the mass centre of six point masses, with this mean of the principal moments.
fn inertia(random: &mut ChaCha8Rng, mean: f64) -> Matrix3 {
    let sum: Matrix3 = (0..6)
        .map(|_| {
            let p = normals(random).component_mul(&Vector3::new(1.0, 0.8, 0.9));
            (Matrix3::identity() * p.norm_squared() - p * p.transpose())
                * random.random_range(0.5..1.5)
        })
        .sum();
    sum * (3.0 * mean / sum.trace())
}

fn body(parent: usize, axis: Vector3, origin: Vector3, mass: f64, com: Vector3) -> KitBody {
    KitBody {
        parent,
        joint: match axis == Vector3::zeros() {
            true => KitJoint::Base,
            false => KitJoint::Revolute,
        },
        p_PoCo_P: origin,
        R_PC_zero: Matrix3::identity(),
        axis_C: axis,
        mass,
        p_CoCcm_C: com,
        I_CCcm_C: Matrix3::zeros(),
    }
}

impl Vehicle {
    pub fn drawn(inputs: Inputs, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let rng = &mut random;
        let still = Vector3::zeros();
        let mut bodies = vec![body(0, still, still, 250.0, still)];
        bodies[0].I_CCcm_C = inertia(rng, 130.0);
        let (mut wheels, mut joints, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        let least = bodies[0].I_CCcm_C.symmetric_eigenvalues().min();
        let (gyro, input, w_NB_B) = match inputs {
            Inputs::Wheels { q } => {
                for axis_C in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    wheels.push(KitWheel {
                        host: 0,
                        axis_C,
                        spin_inertia: SPIN,
                    });
                    let mean = rng.random_range(-100.0..100.0);
                    speeds.push(Wave::drawn(rng, mean, 8.0, [20.0, 90.0]));
                }
                (2.0e-5, q * 2.0e-5 * least / SPIN, normals(rng) * 3.0e-4)
            }
            Inputs::Joints { noise_rad } => {
                bodies[0].I_CCcm_C /= 3.0;
                let axes = [Vector3::new(0.0, 0.6, 0.8), Vector3::y()];
                let origins = [Vector3::new(0.5, 0.2, 0.3), Vector3::new(0.8, 0.0, 0.0)];
                for (k, (axis, origin)) in axes.into_iter().zip(origins).enumerate() {
                    let com = Vector3::new(0.4 - 0.1 * k as f64, 0.0, 0.0) + normals(rng) * 0.03;
                    let mut link = body(k, axis, origin, 12.0 / (k + 1) as f64, com);
                    link.I_CCcm_C = inertia(rng, 2.0 / (k + 1) as f64);
                    bodies.push(link);
                    joints.push(Wave::drawn(rng, 0.0, 0.5, [15.0, 60.0]));
                }
                (5.0e-5, noise_rad, normals(rng) * 3.0e-3)
            }
        };
        let start = UnitQuaternion::from_scaled_axis(normals(rng));
        let mut all = Self {
            bodies,
            wheels,
            joints,
            speeds,
            start,
            h_SScm_N: Vector3::zeros(),
            gyro,
            input,
            slow: Slow::default(),
            random,
        };
        let (H, joints) = all.momentum(0.0);
        let still = H.fixed_view::<3, 3>(0, 0).try_inverse().unwrap();
        // The mass centre rests.
        let v = -still * (H.fixed_view::<3, 3>(0, 3) * w_NB_B + joints.fixed_rows::<3>(0));
        let twist = Vector6::new(v.x, v.y, v.z, w_NB_B.x, w_NB_B.y, w_NB_B.z);
        let now: Vector6 = H * twist + joints;
        all.h_SScm_N = start * now.fixed_rows::<3>(3).into_owned();
        all
    }

    /// True inertia of the base about its mass centre: xx, yy, zz, xy, xz, yz.
    pub fn truth(&self) -> [f64; 6] {
        elements(&self.bodies[0].I_CCcm_C)
    }

    /// Locked inertia in base axes, and the momentum of joints and wheels.
    fn momentum(&self, t: f64) -> (poinsot_testkit::Matrix6, Vector6) {
        let still = KitState {
            R_NB: Matrix3::identity(),
            p_NBo_N: Vector3::zeros(),
            v_NBo_B: Vector3::zeros(),
            w_NB_B: Vector3::zeros(),
            q: self.joints.iter().map(|j| j.value(t)).collect(),
            qd: self.joints.iter().map(|j| j.rate(t)).collect(),
            wheel_speeds: self.speeds.iter().map(|s| s.value(t)).collect(),
        };
        let H = locked_inertia(&self.bodies, &still);
        (H, momentum_about_base(&self.bodies, &self.wheels, &still))
    }

    fn rate(&self, R_NB: &UnitQuaternion<f64>, t: f64) -> Vector3 {
        let (H, joints) = self.momentum(t);
        let h = R_NB.inverse() * self.h_SScm_N;
        let whole = Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z) - joints;
        let twist = H.cholesky().unwrap().solve(&whole);
        twist.fixed_rows::<3>(3).into_owned()
    }

    fn stepped(&self, R_NB: &UnitQuaternion<f64>, t: f64, h: f64) -> UnitQuaternion<f64> {
        let turned = |a: &Vector3| R_NB * UnitQuaternion::from_scaled_axis(*a);
        let slope = |a: &Vector3, t: f64| {
            let w = self.rate(&turned(a), t);
            w + a.cross(&w) * 0.5 + a.cross(&a.cross(&w)) / 12.0
        };
        let k1 = slope(&Vector3::zeros(), t);
        let k2 = slope(&(k1 * (0.5 * h)), t + 0.5 * h);
        let k3 = slope(&(k2 * (0.5 * h)), t + 0.5 * h);
        let k4 = slope(&(k3 * h), t + h);
        turned(&((k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)))
    }

    /// The model file, with a nominal inertia of the base some 10 % off, and one record.
    pub fn record(mut self) -> (String, Table) {
        let n = (DURATION_S * RATE_HZ) as usize;
        let h = 1.0 / RATE_HZ;
        let times: Vec<f64> = (0..=n).map(|k| k as f64 * h).collect();
        let mut attitudes = vec![self.start];
        for t in &times[..n] {
            let last = attitudes[attitudes.len() - 1];
            attitudes.push(self.stepped(&last, *t, h));
        }
        let pairs = attitudes.iter().zip(&times);
        let rates: Vec<Vector3> = pairs.map(|(R, t)| self.rate(R, *t)).collect();
        let mut random = self.random.clone();
        let bias = normals(&mut random) * GYRO_BIAS;
        let slow = self.slow;
        let mut own = random.clone();
        let mut seen = lasting(
            &mut own,
            (slow.tracker, slow.correlation_s),
            EVERY as f64 * h,
        );
        let mut turning = lasting(&mut own, (slow.gyro, slow.correlation_s), h);
        let mut walk = Vector3::zeros();
        let drift: Vec<Vector3> = times
            .iter()
            .map(|_| {
                let now = walk + turning();
                walk += normals(&mut own) * (slow.walk * h.sqrt());
                now
            })
            .collect();
        let mut read = |sigma: f64| sigma * normal(&mut random);
        let mut channels = Vec::new();
        for (axis, name) in ["omega_x", "omega_y", "omega_z"].into_iter().enumerate() {
            let pairs = rates.iter().zip(&drift);
            let values = pairs.map(|(w, d)| w[axis] + d[axis] + bias[axis] + read(self.gyro));
            add(&mut channels, name.to_owned(), &times, values.collect());
        }
        let seen: Vec<UnitQuaternion<f64>> = attitudes
            .iter()
            .step_by(EVERY)
            .map(|R| {
                let off = Vector3::from_fn(|_, _| read(TRACKER));
                R * UnitQuaternion::from_scaled_axis(off + seen())
            })
            .collect();
        let seldom: Vec<f64> = times.iter().copied().step_by(EVERY).collect();
        for (k, name) in ["q_x", "q_y", "q_z", "q_w"].into_iter().enumerate() {
            let values = seen.iter().map(|R| R.coords[k]).collect();
            add(&mut channels, name.to_owned(), &seldom, values);
        }
        for (k, wave) in self.speeds.iter().enumerate() {
            let values = times.iter().map(|t| wave.value(*t) + read(self.input));
            add(
                &mut channels,
                format!("wheel{k}_rad_s"),
                &times,
                values.collect(),
            );
        }
        for (k, wave) in self.joints.iter().enumerate() {
            let angles = times.iter().map(|t| wave.value(*t) + read(self.input));
            add(
                &mut channels,
                format!("joint{k}_rad"),
                &times,
                angles.collect(),
            );
            let rates = times.iter().map(|t| wave.rate(*t) + read(self.input));
            add(
                &mut channels,
                format!("joint{k}_rad_s"),
                &times,
                rates.collect(),
            );
        }
        self.random = random;
        let model = self.model();
        let table = Table {
            channels,
            ..Table::default()
        };
        (model, table)
    }

    fn model(&mut self) -> String {
        let mut text = ModelText::new("drawn");
        for (k, body) in self.bodies.iter().enumerate() {
            let name = format!("body{k}");
            let mut I = body.I_CCcm_C;
            let rest = if k == 0 {
                "estimate = [\"inertia\"]"
            } else {
                ""
            };
            if k == 0 {
                // The second moments, stretched and turned.
                let off = Matrix3::from_fn(|_, _| 0.05 * normal(&mut self.random));
                let A = Matrix3::identity() + off;
                let J = A * (Matrix3::identity() * (0.5 * I.trace()) - I) * A.transpose();
                I = Matrix3::identity() * J.trace() - J;
            }
            text = text.body(&name, body.mass, body.p_CoCcm_C.into(), elements(&I), rest);
            if k > 0 {
                let axis: [f64; 3] = body.axis_C.into();
                let of = [format!("body{}", body.parent), name];
                text = text.joint(
                    (&format!("joint{}", k - 1), "revolute"),
                    [&of[0], &of[1]],
                    body.p_PoCo_P.into(),
                    &format!("axis = {axis:?}"),
                );
            }
        }
        for (k, wheel) in self.wheels.iter().enumerate() {
            text = text.wheel(&format!("wheel{k}"), "body0", wheel.axis_C.into(), SPIN);
        }
        let rad = format!("noise_rad = {:?}", self.input);
        let rad_s = format!("noise_rad_s = {:?}", self.input);
        let mut gyro = format!("noise_rad_s = {:?}\nbias = \"estimate\"", self.gyro);
        let mut tracker = format!("noise_rad = {TRACKER:?}");
        let slow = self.slow;
        let lasts = |key: &str, sigma: f64| match slow.declared && sigma > 0.0 {
            true => format!(
                "\n{key} = {sigma:?}\ncorrelation_s = {:?}",
                slow.correlation_s
            ),
            false => String::new(),
        };
        gyro += &lasts("slow_rad_s", slow.gyro);
        tracker += &lasts("slow_rad", slow.tracker);
        if slow.declared && slow.walk > 0.0 {
            gyro += &format!("\nwalk_rad_s_s05 = {:?}", slow.walk);
        }
        text = text
            .sensor("gyro", "gyro", &gyro)
            .sensor("tracker", "attitude", &tracker);
        if !self.wheels.is_empty() {
            text = text.sensor("tachometers", "wheel_speed", &rad_s);
        }
        if !self.joints.is_empty() {
            text = text.sensor("encoders", "joint_position", &rad).sensor(
                "rates",
                "joint_rate",
                &rad_s,
            );
        }
        text.text()
    }
}

fn elements(I: &Matrix3) -> [f64; 6] {
    [
        I[(0, 0)],
        I[(1, 1)],
        I[(2, 2)],
        I[(0, 1)],
        I[(0, 2)],
        I[(1, 2)],
    ]
}

fn add(channels: &mut Vec<Channel>, name: String, time_s: &[f64], values: Vec<f64>) {
    channels.push(Channel {
        name,
        time_s: time_s.into(),
        values,
        ..Channel::default()
    });
}
