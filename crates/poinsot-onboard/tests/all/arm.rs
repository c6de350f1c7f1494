//! A satellite with an arm in time: every body is a set of mass points, which are added up. The joints follow given curves, and the
//! base turns so that the angular momentum about the mass centre of all points stays.

use crate::truth::Motion;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use poinsot_onboard::JOINTS;

/// Longest step of the integration, s.
const STEP: f64 = 0.01;

/// A mass point of a body, kg and m in its frame.
pub type Point = (f64, Vector3<f64>);

/// Six points with these mass properties: on the principal axes of what is left when a point at the mass centre is taken off.
pub fn points(mass: f64, c: Vector3<f64>, I: Matrix3<f64>) -> Vec<Point> {
    let eigen = I.symmetric_eigen();
    let sigma = eigen.eigenvalues.map(|moment| 0.5 * I.trace() - moment);
    let mut out = Vec::new();
    for (axis, second) in sigma.iter().enumerate() {
        let arm = eigen.eigenvectors.column(axis) * (3.0 * second / mass).sqrt();
        out.extend([1.0, -1.0].map(|side| (mass / 6.0, c + arm * side)));
    }
    out
}

/// A joint with its link.
#[derive(Clone)]
pub struct Link {
    /// The link before it, zero for the base.
    pub parent: usize,
    pub slides: bool,
    pub R: UnitQuaternion<f64>,
    pub p: Vector3<f64>,
    pub axis: Vector3<f64>,
    /// Mean, size, frequency in rad/s and phase of two sines.
    pub curve: [f64; 7],
    pub points: Vec<Point>,
}

impl Link {
    /// Position and rate at a time.
    fn at(&self, t: f64) -> (f64, f64) {
        let [mean, a, f, p, b, g, q] = self.curve;
        let position = mean + a * (f * t + p).sin() + b * (g * t + q).sin();
        (
            position,
            a * f * (f * t + p).cos() + b * g * (g * t + q).cos(),
        )
    }
}

/// Links on a base of points; the unknown body is among the points of one of them.
#[derive(Clone)]
pub struct Arm {
    pub base: Vec<Point>,
    pub links: Vec<Link>,
}

/// A point and its velocity in B, the base at rest.
struct Moving {
    mass: f64,
    p: Vector3<f64>,
    v: Vector3<f64>,
}

impl Arm {
    pub fn joints(&self, t: f64) -> ([f64; JOINTS], [f64; JOINTS]) {
        let (mut q, mut rate) = ([0.0; JOINTS], [0.0; JOINTS]);
        for (j, link) in self.links.iter().enumerate() {
            (q[j], rate[j]) = link.at(t);
        }
        (q, rate)
    }

    /// All points at joint positions, and their velocities by a central difference along the rates.
    fn moving(&self, q: &[f64; JOINTS], rate: &[f64; JOINTS]) -> Vec<Moving> {
        let ahead: [f64; JOINTS] = std::array::from_fn(|j| q[j] + 1.0e-5 * rate[j]);
        let behind: [f64; JOINTS] = std::array::from_fn(|j| q[j] - 1.0e-5 * rate[j]);
        let (here, ahead, behind) = (self.placed(q), self.placed(&ahead), self.placed(&behind));
        let each = here.iter().zip(ahead.iter().zip(&behind));
        each.map(|((mass, p), (a, b))| Moving {
            mass: *mass,
            p: *p,
            v: (a.1 - b.1) / 2.0e-5,
        })
        .collect()
    }

    fn placed(&self, q: &[f64; JOINTS]) -> Vec<Point> {
        let mut out = self.base.clone();
        let mut frames = vec![(Rotation3::identity(), Vector3::zeros())];
        for (link, q) in self.links.iter().zip(q) {
            let (R, p) = frames[link.parent];
            let slide = if link.slides { *q } else { 0.0 };
            let turn = if link.slides { 0.0 } else { *q };
            let at_zero = R * link.R.to_rotation_matrix();
            let p = p + R * link.p + at_zero * link.axis * slide;
            let R = at_zero * Rotation3::new(link.axis * turn);
            frames.push((R, p));
            out.extend(link.points.iter().map(|(mass, x)| (*mass, p + R * x)));
        }
        out
    }

    fn rate(&self, t: f64, h: &Vector3<f64>) -> Vector3<f64> {
        let (q, rate) = self.joints(t);
        self.turn(&q, &rate, h)
    }

    /// Angular velocity of the base in B for an angular momentum about the mass centre in B.
    pub fn turn(&self, q: &[f64; JOINTS], rate: &[f64; JOINTS], h: &Vector3<f64>) -> Vector3<f64> {
        let all = self.moving(q, rate);
        let mass: f64 = all.iter().map(|m| m.mass).sum();
        let mean = |of: fn(&Moving) -> Vector3<f64>| {
            all.iter().map(|m| of(m) * m.mass).sum::<Vector3<f64>>() / mass
        };
        let (c, v) = (mean(|m| m.p), mean(|m| m.v));
        let (mut I, mut left) = (Matrix3::zeros(), *h);
        for m in &all {
            let r = m.p - c;
            I += (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * m.mass;
            left -= r.cross(&(m.v - v)) * m.mass;
        }
        I.try_inverse().unwrap() * left
    }

    /// The motion at so many samples; the momentum is that of the base turning at `start.w` with the joints at their first rates.
    pub fn motions(&self, start: &Motion, dt: f64, samples: usize) -> Vec<Motion> {
        let h_N = self.momentum(start);
        let steps = (dt / STEP).ceil() as usize;
        let step = dt / steps as f64;
        let (mut R, mut out) = (start.R, Vec::new());
        let at = |R: UnitQuaternion<f64>, t: f64| self.rate(t, &(R.inverse() * h_N));
        for k in 0..samples {
            let t = k as f64 * dt;
            let (q, rate) = self.joints(t);
            out.push(Motion {
                R,
                w: at(R, t),
                q,
                rate,
                ..*start
            });
            for n in 0..steps {
                let t = t + n as f64 * step;
                let turned = |w: &Vector3<f64>| R * UnitQuaternion::from_scaled_axis(*w);
                let a = at(R, t);
                let b = at(turned(&(a * (0.5 * step))), t + 0.5 * step);
                let c = at(turned(&(b * (0.5 * step))), t + 0.5 * step);
                let d = at(turned(&(c * step)), t + step);
                let mean = (a + (b + c) * 2.0 + d) / 6.0;
                R = turned(&(mean * step + a.cross(&d) * (step * step / 12.0)));
            }
        }
        out
    }

    /// Angular momentum about the mass centre in N, the base turning at `start.w` with the joints at their first rates.
    pub fn momentum(&self, start: &Motion) -> Vector3<f64> {
        let none = self.rate(0.0, &Vector3::zeros());
        let column = |axis| self.rate(0.0, &Vector3::ith(axis, 1.0)) - none;
        let inverse = Matrix3::from_columns(&[column(0), column(1), column(2)]);
        start.R * (inverse.try_inverse().unwrap() * (start.w - none))
    }
}
