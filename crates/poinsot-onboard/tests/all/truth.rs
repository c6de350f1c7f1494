//! A rigid body with wheels in time: Newton and Euler about the mass centre, Runge-Kutta at a hundredth of a second.

use crate::arm::Arm;
use crate::sprung::{self, Sprung};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use poinsot_onboard::{Configuration, JOINTS, Sample, WHEELS};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Longest step of the integration, s.
const STEP: f64 = 0.01;

/// Mass, mass centre and central inertia of the unknown body, and what drives it.
#[derive(Clone)]
pub struct Truth {
    pub mass: f64,
    pub c: Vector3<f64>,
    pub I: Matrix3<f64>,
    pub start: Motion,
    /// Samples for which what drives it stays.
    pub hold: usize,
    /// Torque of each wheel's motor in interval k of these, N m; it goes straight on to that of the next one where they are `smooth`.
    pub motors: fn(usize) -> [f64; WHEELS],
    pub smooth: bool,
    /// Force and torque about `Bo` in that interval, in B.
    pub wrench: fn(usize) -> (Vector3<f64>, Vector3<f64>),
    pub dt: f64,
    pub samples: usize,
    /// With it the body above is one of its links, and nothing else drives.
    pub arm: Option<Arm>,
    /// Masses on springs.
    pub sprung: Vec<Sprung>,
}

#[derive(Clone, Copy)]
pub struct Motion {
    pub R: UnitQuaternion<f64>,
    pub w: Vector3<f64>,
    pub speeds: [f64; WHEELS],
    /// Positions and rates of the joints.
    pub q: [f64; JOINTS],
    pub rate: [f64; JOINTS],
    /// Of the mass centre, in N.
    pub p: Vector3<f64>,
    pub v: Vector3<f64>,
}

impl Truth {
    /// The ten parameters about `Bo`.
    pub fn parameters(&self) -> [f64; 10] {
        let (m, c) = (self.mass, self.c);
        let I = self.I + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * m;
        [
            m,
            m * c.x,
            m * c.y,
            m * c.z,
            I.m11,
            I.m12,
            I.m22,
            I.m13,
            I.m23,
            I.m33,
        ]
    }

    /// The motion at all samples.
    pub fn motions(&self, configuration: &Configuration) -> Vec<Motion> {
        if let Some(arm) = &self.arm {
            return arm.motions(&self.start, self.dt, self.samples);
        }
        if !self.sprung.is_empty() {
            return sprung::motions(self, configuration);
        }
        let mut now = self.start;
        let mut out = vec![now];
        for k in 1..self.samples {
            now = self.next(configuration, &now, k - 1);
            out.push(now);
        }
        out
    }

    /// The motion one sample after sample k.
    pub fn next(&self, configuration: &Configuration, now: &Motion, k: usize) -> Motion {
        let steps = (self.dt / STEP).ceil() as usize;
        let dt = self.dt / steps as f64;
        let share = |step: usize| step as f64 / steps as f64;
        (0..steps).fold(*now, |now, step| {
            let ends = [share(step), share(step + 1)];
            self.step(configuration, &now, (k, ends), dt)
        })
    }

    /// From one share of an interval to another.
    fn step(
        &self,
        configuration: &Configuration,
        now: &Motion,
        (k, [from, to]): (usize, [f64; 2]),
        dt: f64,
    ) -> Motion {
        let add = |m: &Motion, r: &Rates, dt: f64| Motion {
            R: m.R * UnitQuaternion::from_scaled_axis(r.turn * dt),
            w: m.w + r.w * dt,
            speeds: std::array::from_fn(|j| m.speeds[j] + r.speeds[j] * dt),
            p: m.p + r.p * dt,
            v: m.v + r.v * dt,
            ..*m
        };
        // The turn of a step by the mean rate of Simpson's rule and its commutator (Magnus, fourth order).
        let middle = (k, 0.5 * (from + to));
        let a = self.rates(configuration, now, (k, from));
        let b = self.rates(configuration, &add(now, &a, 0.5 * dt), middle);
        let c = self.rates(configuration, &add(now, &b, 0.5 * dt), middle);
        let d = self.rates(configuration, &add(now, &c, dt), (k, to));
        let mean =
            |f: fn(&Rates) -> Vector3<f64>| (f(&a) + f(&b) * 2.0 + f(&c) * 2.0 + f(&d)) / 6.0;
        let turn = mean(|r| r.turn) + a.turn.cross(&d.turn) * (dt / 12.0);
        Motion {
            R: now.R * UnitQuaternion::from_scaled_axis(turn * dt),
            w: now.w + mean(|r| r.w) * dt,
            speeds: std::array::from_fn(|j| {
                let sum = a.speeds[j] + 2.0 * b.speeds[j] + 2.0 * c.speeds[j] + d.speeds[j];
                now.speeds[j] + sum * dt / 6.0
            }),
            p: now.p + mean(|r| r.p) * dt,
            v: now.v + mean(|r| r.v) * dt,
            ..*now
        }
    }

    fn rates(&self, configuration: &Configuration, m: &Motion, (k, share): (usize, f64)) -> Rates {
        let (force, torque) = (self.wrench)(k / self.hold);
        let [motors, next] = [0, 1].map(|more| (self.motors)(k / self.hold + more));
        let next = next.map(|torque| if self.smooth { torque * share } else { 0.0 });
        let left = if self.smooth { 1.0 - share } else { 1.0 };
        let motors: [f64; WHEELS] = std::array::from_fn(|j| motors[j] * left + next[j]);
        let mut h = self.I * m.w;
        let mut inertia = self.I;
        let mut push = torque - self.c.cross(&force);
        let wheels = &configuration.wheels[..configuration.wheel_count];
        for (j, wheel) in wheels.iter().enumerate() {
            let a = Vector3::from(wheel.axis_B);
            h += a * (wheel.spin_inertia * m.speeds[j]);
            inertia -= a * a.transpose() * wheel.spin_inertia;
            push -= a * motors[j];
        }
        let w = inertia.try_inverse().unwrap() * (push - m.w.cross(&h));
        let mut speeds = [0.0; WHEELS];
        for (j, wheel) in wheels.iter().enumerate() {
            let a = Vector3::from(wheel.axis_B);
            speeds[j] = motors[j] / wheel.spin_inertia - a.dot(&w);
        }
        Rates {
            turn: m.w,
            w,
            speeds,
            p: m.v,
            v: m.R * force / self.mass,
        }
    }
}

struct Rates {
    turn: Vector3<f64>,
    w: Vector3<f64>,
    speeds: [f64; WHEELS],
    p: Vector3<f64>,
    v: Vector3<f64>,
}

/// Normal deviates of one trial.
pub struct Noise(ChaCha8Rng);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn one(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    pub fn vector(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.one()) * sigma
    }
}

/// Samples of a motion, with noise of the configuration where `noise` is given.
pub fn samples(
    truth: &Truth,
    configuration: &Configuration,
    motions: &[Motion],
    mut noise: Option<&mut Noise>,
) -> Vec<Sample> {
    let levels = configuration.noise;
    let mut vector = |sigma: f64| noise.as_mut().map_or(Vector3::zeros(), |n| n.vector(sigma));
    let mut bias = vector(levels.bias);
    let mut out = Vec::new();
    for (k, m) in motions.iter().enumerate() {
        let (force, torque) = (truth.wrench)(k / truth.hold);
        let R = m.R * UnitQuaternion::from_scaled_axis(vector(levels.attitude));
        let gyro = m.w + bias + vector(levels.gyro);
        bias += vector(levels.bias_walk * truth.dt.sqrt());
        let mut sample = Sample::at(k as f64 * truth.dt);
        sample.gyro = Some(gyro.into());
        sample.attitude = Some(R.coords.into());
        if levels.position > 0.0 {
            let position = m.p - m.R * truth.c + vector(levels.position);
            sample.position = Some(position.into());
        }
        sample.wheel_speed = m.speeds;
        let wheels = &configuration.wheels[..configuration.wheel_count];
        for (speed, wheel) in sample.wheel_speed.iter_mut().zip(wheels) {
            *speed += vector(wheel.noise).x;
        }
        (sample.joint_position, sample.joint_rate) = (m.q, m.rate);
        let joints = configuration.joints.iter().take(configuration.joint_count);
        for (j, joint) in joints.enumerate() {
            sample.joint_position[j] += vector(joint.position_noise).x;
            sample.joint_rate[j] += vector(joint.rate_noise).x;
        }
        (sample.force_B, sample.torque_B) = (force.into(), torque.into());
        out.push(sample);
    }
    out
}
