//! Limits that only the motion of the vehicle shows: body rate, torques, pointing, distances.
//!
//! Between two samples a value may rise above both by an eighth of its second difference; that much is added.

use poinsot::case::{Capsule, Case, Limits};
use poinsot_dynamics::MotionSample;
use poinsot_model::Model;
use poinsot_spatial::Vector3;

/// Parts of the manoeuvre whose largest values are limited one by one: the search sees where a limit is broken.
const WINDOWS: usize = 12;

/// Samples of the final check for each one of the case.
const FINE: f64 = 5.0;

/// Times on which limits are checked in the end.
pub(crate) fn fine_times(case: &Case) -> Vec<f64> {
    let mut fine = case.clone();
    fine.rate_hz *= FINE;
    fine.times()
}

/// A limit on the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// What is limited, in words.
    pub what: String,
    /// Unit of value and limit.
    pub unit: &'static str,
    /// The limit as declared.
    pub limit: f64,
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    BodyRate,
    WheelTorque(usize),
    JointEffort(usize),
    /// Cone, and whether the axis must stay in it.
    Cone(usize, bool),
    /// Two capsules.
    Distance(usize, usize),
}

/// All limits on the motion of a vehicle.
#[derive(Debug, Clone)]
pub struct Watch {
    /// In the order of the values.
    pub watched: Vec<Watched>,
    limits: Limits,
}

impl Watch {
    /// The limits that a model and a case have.
    pub fn new(model: &Model, limits: &Limits, joint_names: &[String]) -> Self {
        let mut watched = Vec::new();
        let mut push = |what: String, unit, limit: f64, kind| {
            if limit.is_finite() {
                watched.push(Watched {
                    what,
                    unit,
                    limit,
                    kind,
                });
            }
        };
        push(
            "body rate".to_owned(),
            "rad/s",
            limits.body_rate,
            Kind::BodyRate,
        );
        for (k, (wheel, limit)) in model.wheels.iter().zip(&limits.wheels).enumerate() {
            let what = format!("torque of {}", wheel.name);
            push(what, "N m", limit.torque, Kind::WheelTorque(k));
        }
        for (k, (name, limit)) in joint_names.iter().zip(&limits.joints).enumerate() {
            push(
                format!("torque of {name}"),
                "N m",
                limit.effort,
                Kind::JointEffort(k),
            );
        }
        for (k, cone) in limits.cones.iter().enumerate() {
            let what = format!("angle of cone {}", cone.name);
            push(what, "rad", cone.half_angle, Kind::Cone(k, cone.keep_in));
        }
        for (a, first) in limits.capsules.iter().enumerate() {
            for (b, second) in limits.capsules.iter().enumerate().skip(a + 1) {
                if are_apart(model, first.body, second.body) {
                    let name = |c: &Capsule| model.bodies[c.body].name.clone();
                    let what = format!("distance of {} and {}", name(first), name(second));
                    push(what, "m", limits.clearance, Kind::Distance(a, b));
                }
            }
        }
        Self {
            watched,
            limits: limits.clone(),
        }
    }

    /// Whether torques of joint motors are limited: they cost a run of their own.
    pub fn needs_efforts(&self) -> bool {
        let effort = |w: &Watched| matches!(w.kind, Kind::JointEffort(_));
        self.watched.iter().any(effort)
    }

    /// The limited values at one instant, in their units; joint torques are zero where they are not known.
    pub fn values(&self, sample: &MotionSample, motor: &[f64]) -> Vec<f64> {
        let of = |w: &Watched| match w.kind {
            Kind::BodyRate => sample.w_NB_B.norm(),
            Kind::WheelTorque(k) => sample.wheel_torque.get(k).map_or(0.0, |t| t.abs()),
            Kind::JointEffort(k) => motor.get(k).map_or(0.0, |t| t.abs()),
            Kind::Cone(k, _) => {
                let cone = &self.limits.cones[k];
                let axis_N = sample.R_NB * cone.axis_B;
                axis_N
                    .cross(&cone.direction_N)
                    .norm()
                    .atan2(axis_N.dot(&cone.direction_N))
            }
            Kind::Distance(a, b) => self.distance(sample, a, b),
        };
        self.watched.iter().map(of).collect()
    }

    fn distance(&self, sample: &MotionSample, a: usize, b: usize) -> f64 {
        let (a, b) = (&self.limits.capsules[a], &self.limits.capsules[b]);
        let k = &sample.kinematics;
        let in_base = |c: &Capsule| c.ends.map(|p| k.p[c.body] + k.R[c.body] * p);
        between_segments(&in_base(a), &in_base(b)) - a.radius - b.radius
    }

    /// How far a value is beyond its limit, as a share of the limit: at most zero where it holds.
    pub fn beyond(&self, k: usize, value: f64) -> f64 {
        let w = &self.watched[k];
        match w.kind {
            Kind::Cone(_, false) => w.limit - value,
            Kind::Cone(_, true) => value - w.limit,
            // In metres: a clearance may be zero.
            Kind::Distance(..) => w.limit - value,
            _ => value / w.limit - 1.0,
        }
    }
}

/// The course of the limited values.
#[derive(Debug, Clone, Default)]
pub struct Course {
    /// One list of values per limit.
    pub values: Vec<Vec<f64>>,
}

impl Course {
    /// One more instant.
    pub fn push(&mut self, values: Vec<f64>) {
        self.values.resize_with(values.len(), Vec::new);
        for (list, x) in self.values.iter_mut().zip(values) {
            list.push(x);
        }
    }

    /// How far each limit is broken in each window; at most zero where it holds.
    pub fn windows(&self, watch: &Watch) -> Vec<f64> {
        let mut out = Vec::new();
        for (k, list) in self.values.iter().enumerate() {
            let beyond: Vec<f64> = list.iter().map(|x| watch.beyond(k, *x)).collect();
            let peaks = with_bends(&beyond);
            let size = peaks.len().div_ceil(WINDOWS).max(1);
            let largest = |part: &[f64]| part.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            out.extend((0..WINDOWS).map(|w| match peaks.get(w * size..) {
                Some(rest) if !rest.is_empty() => largest(&rest[..size.min(rest.len())]),
                _ => -1.0,
            }));
        }
        out
    }

    /// The value of each limit that comes closest to it or is furthest beyond, and how far it is beyond.
    pub fn worst(&self, watch: &Watch) -> Vec<(f64, f64)> {
        let of = |(k, list): (usize, &Vec<f64>)| {
            let beyond: Vec<f64> = list.iter().map(|x| watch.beyond(k, *x)).collect();
            let peaks = with_bends(&beyond);
            let worst = (0..list.len()).max_by(|a, b| peaks[*a].total_cmp(&peaks[*b]));
            worst.map_or((0.0, -1.0), |i| (list[i], peaks[i]))
        };
        self.values.iter().enumerate().map(of).collect()
    }
}

/// Windows of each limit.
pub const WINDOWS_EACH: usize = WINDOWS;

/// Values with what they may rise by between two samples.
fn with_bends(y: &[f64]) -> Vec<f64> {
    let bend = |i: usize| match (i.checked_sub(1).and_then(|j| y.get(j)), y.get(i + 1)) {
        (Some(a), Some(b)) => (a - 2.0 * y[i] + b).abs() / 8.0,
        _ => 0.0,
    };
    (0..y.len()).map(|i| y[i] + bend(i)).collect()
}

/// Whether two bodies may collide: neither the same nor joined by a joint.
fn are_apart(model: &Model, a: usize, b: usize) -> bool {
    let joined = |j: &poinsot_model::Joint| {
        (j.parent == a && j.child == b) || (j.parent == b && j.child == a)
    };
    a != b && !model.joints.iter().any(joined)
}

/// Least distance of two segments (Ericson 2005, 5.1.9).
fn between_segments(a: &[Vector3; 2], b: &[Vector3; 2]) -> f64 {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, uv, vv) = (u.dot(&u), u.dot(&v), v.dot(&v));
    let (uw, vw) = (u.dot(&w), v.dot(&w));
    let determinant = uu * vv - uv * uv;
    let share = |x: f64, of: f64| {
        if of > 0.0 {
            (x / of).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let mut s = match determinant > 1.0e-12 * uu * vv {
        true => share(uv * vw - vv * uw, determinant),
        false => 0.0,
    };
    let t = share(uv * s + vw, vv);
    s = share(uv * t - uw, uu);
    // Once more: the first end may have been clamped.
    let t = share(uv * s + vw, vv);
    (w + u * s - v * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// Against the least of a fine grid over both segments, parallel and degenerate ones included.
    #[test]
    fn prop_the_distance_of_two_segments_is_the_least_of_all_pairs_of_points() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        for trial in 0..200 {
            let mut point = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            let mut a = [point(), point()];
            let mut b = [point(), point()];
            if trial % 5 == 0 {
                b[1] = b[0] + (a[1] - a[0]) * 0.7;
            }
            if trial % 7 == 0 {
                a[1] = a[0];
            }
            let mut least = f64::INFINITY;
            for i in 0..=200 {
                for j in 0..=200 {
                    let p = a[0] + (a[1] - a[0]) * (f64::from(i) / 200.0);
                    let q = b[0] + (b[1] - b[0]) * (f64::from(j) / 200.0);
                    least = least.min((p - q).norm());
                }
            }
            let found = between_segments(&a, &b);
            assert!(
                found <= least + 1.0e-12 && found > least - 0.02,
                "{found} {least}"
            );
        }
    }
}
