//! Limits that need a simulation of the vehicle: body rate, torques, pointing, distances.
//!
//! One eighth of the second difference is added to each value: the most by which it can rise between samples.

use crate::mover::Target;
use poinsot::case::{Capsule, Case, Limits};
use poinsot_dynamics::{MotionSample, Times};
use poinsot_model::{Model, Thruster};
use poinsot_spatial::Vector3;

/// Parts of the manoeuvre whose largest values are limited separately, so that the search locates a violation.
pub const WINDOWS_EACH: usize = 12;

/// Samples of the final check per sample of the case.
const FINE: f64 = 5.0;

/// Times of the final check of the limits.
pub(crate) fn fine_times(case: &Case) -> Times<'static> {
    let mut fine = case.clone();
    fine.rate_hz *= FINE;
    fine.times()
}

/// A limit on the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// Limited quantity.
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
    /// Cone index, and whether the axis must stay inside.
    Cone(usize, bool),
    /// Two capsules.
    Distance(usize, usize),
    /// Plume of a thruster and capsule.
    Plume(usize, usize),
}

/// All limits on the motion of a vehicle.
#[derive(Debug, Clone)]
pub struct Watch {
    /// Limits, in the order of the values.
    pub watched: Vec<Watched>,
    limits: Limits,
    thrusters: Vec<Thruster>,
}

impl Watch {
    /// Creates the limits declared in model and case.
    pub fn new(model: &Model, limits: &Limits) -> Self {
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
        for (k, limit) in limits.joints.iter().enumerate() {
            push(
                format!("torque of {}", Target::Joint(k).name(model)),
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
        for (k, thruster) in model.thrusters.iter().enumerate() {
            let others = limits.capsules.iter().enumerate();
            let has_plume = limits.thrusters[k].plume.is_some();
            let others = others.filter(|(_, c)| has_plume && c.body != thruster.body);
            for (c, capsule) in others {
                let body = &model.bodies[capsule.body].name;
                let what = format!("plume of {} and {body}", thruster.name);
                push(what, "m", limits.clearance, Kind::Plume(k, c));
            }
        }
        Self {
            watched,
            limits: limits.clone(),
            thrusters: model.thrusters.clone(),
        }
    }

    /// Limited values at one instant, in their units.
    pub fn values(&self, sample: &MotionSample) -> Vec<f64> {
        let of = |w: &Watched| match w.kind {
            Kind::BodyRate => sample.w_NB_B.norm(),
            Kind::WheelTorque(k) => sample.wheel_torque.get(k).map_or(0.0, |t| t.abs()),
            Kind::JointEffort(k) => sample.motor_force.get(k).map_or(0.0, |t| t.abs()),
            Kind::Cone(k, _) => {
                let cone = &self.limits.cones[k];
                let axis_N = sample.R_NB * cone.axis_B;
                axis_N
                    .cross(&cone.direction_N)
                    .norm()
                    .atan2(axis_N.dot(&cone.direction_N))
            }
            Kind::Distance(a, b) => self.distance(sample, a, b),
            Kind::Plume(k, c) => self.outside_plume(sample, k, c),
        };
        self.watched.iter().map(of).collect()
    }

    fn distance(&self, sample: &MotionSample, a: usize, b: usize) -> f64 {
        let (a, b) = (&self.limits.capsules[a], &self.limits.capsules[b]);
        let k = &sample.kinematics;
        let in_base = |c: &Capsule| c.ends.map(|p| k.p[c.body] + k.R[c.body] * p);
        between_segments(&in_base(a), &in_base(b)) - a.radius - b.radius
    }

    /// Distance of a capsule from the plume of a thruster, m; infinite while the thruster is off.
    fn outside_plume(&self, sample: &MotionSample, k: usize, c: usize) -> f64 {
        let fires = sample.thrust.get(k).is_some_and(|f| *f != 0.0);
        let (Some(half_angle), true) = (self.limits.thrusters[k].plume, fires) else {
            return f64::INFINITY;
        };
        let thruster = &self.thrusters[k];
        let (capsule, frame) = (&self.limits.capsules[c], &sample.kinematics);
        let in_base = |body: usize, p: Vector3| frame.p[body] + frame.R[body] * p;
        let nozzle = in_base(thruster.body, thruster.p_BoT_B);
        let exhaust = frame.R[thruster.body] * -thruster.direction_B;
        let ends = capsule.ends.map(|p| in_base(capsule.body, p) - nozzle);
        outside_cone(&exhaust, half_angle, &ends) - capsule.radius
    }

    /// Relative excess of a value over its limit; not positive if the limit holds.
    pub fn beyond(&self, k: usize, value: f64) -> f64 {
        let w = &self.watched[k];
        match w.kind {
            Kind::Cone(_, false) => w.limit - value,
            Kind::Cone(_, true) => value - w.limit,
            // Absolute, in metres: the clearance may be zero.
            Kind::Distance(..) | Kind::Plume(..) => w.limit - value,
            _ => value / w.limit - 1.0,
        }
    }

    /// Relative excess of the values over their limit, each with its largest rise between samples.
    fn peaks(&self, k: usize, values: &[f64]) -> Vec<f64> {
        let beyond: Vec<f64> = values.iter().map(|x| self.beyond(k, *x)).collect();
        with_bends(&beyond)
    }
}

/// History of the limited values.
#[derive(Debug, Clone, Default)]
pub struct Course {
    /// One list of values per limit.
    pub values: Vec<Vec<f64>>,
}

impl Course {
    /// Appends the values of one instant.
    pub fn push(&mut self, values: Vec<f64>) {
        self.values.resize_with(values.len(), Vec::new);
        for (list, x) in self.values.iter_mut().zip(values) {
            list.push(x);
        }
    }

    /// Relative excess of each limit in each window; not positive if it holds.
    pub fn windows(&self, watch: &Watch) -> Vec<f64> {
        let mut out = Vec::new();
        for (k, list) in self.values.iter().enumerate() {
            let peaks = watch.peaks(k, list);
            let size = peaks.len().div_ceil(WINDOWS_EACH).max(1);
            // A finite value also for a thruster that never fires.
            let largest = |part: &[f64]| part.iter().fold(-1.0, |a: f64, b| a.max(*b));
            out.extend((0..WINDOWS_EACH).map(|w| match peaks.get(w * size..) {
                Some(rest) if !rest.is_empty() => largest(&rest[..size.min(rest.len())]),
                _ => -1.0,
            }));
        }
        out
    }

    /// For each limit: the value nearest to it or furthest beyond, and its relative excess.
    pub fn worst(&self, watch: &Watch) -> Vec<(f64, f64)> {
        let of = |(k, list): (usize, &Vec<f64>)| {
            let peaks = watch.peaks(k, list);
            let worst = (0..list.len()).max_by(|a, b| peaks[*a].total_cmp(&peaks[*b]));
            worst.map_or((0.0, -1.0), |i| (list[i], peaks[i].max(-1.0)))
        };
        self.values.iter().enumerate().map(of).collect()
    }
}

/// Values plus their largest rise between samples.
fn with_bends(y: &[f64]) -> Vec<f64> {
    let bend = |i: usize| match (i.checked_sub(1).and_then(|j| y.get(j)), y.get(i + 1)) {
        // At the start or end of a firing no curvature is defined.
        (Some(a), Some(b)) if a.is_finite() && b.is_finite() => (a - 2.0 * y[i] + b).abs() / 8.0,
        _ => 0.0,
    };
    (0..y.len()).map(|i| y[i] + bend(i)).collect()
}

/// Whether two bodies can collide: different and not joined by a joint.
fn are_apart(model: &Model, a: usize, b: usize) -> bool {
    let joined = |j: &poinsot_model::Joint| {
        (j.parent == a && j.child == b) || (j.parent == b && j.child == a)
    };
    a != b && !model.joints.iter().any(joined)
}

/// Steps of the search along a segment; each divides its length by 1.5.
const THIRDS: usize = 60;

/// Least `r cos(a) - z sin(a)` over a segment, `z` along the axis of a cone with its tip at the origin and `r` across.
/// It is the distance from a cone of half angle `a`, and less than it behind the tip. Convex along the segment.
fn outside_cone(axis: &Vector3, half_angle: f64, ends: &[Vector3; 2]) -> f64 {
    let at = |s: f64| {
        let p = ends[0] + (ends[1] - ends[0]) * s;
        let along = p.dot(axis);
        (p - axis * along).norm() * half_angle.cos() - along * half_angle.sin()
    };
    let (mut from, mut to) = (0.0, 1.0);
    for _ in 0..THIRDS {
        let (a, b) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
        match at(a) < at(b) {
            true => to = b,
            false => from = a,
        }
    }
    at(0.5 * (from + to)).min(at(0.0)).min(at(1.0))
}

/// Distance of two segments (Ericson 2005, 5.1.9).
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
    // Repeat: the first parameter may have been clamped.
    let t = share(uv * s + vw, vv);
    (w + u * s - v * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// Compared with fine grids on cone and segment; where the tip is nearest, the value is a lower bound.
    #[test]
    fn prop_a_segment_is_outside_a_cone_by_its_distance_from_the_surface() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
        for _ in 0..50 {
            let mut point = || Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            let (axis, ends) = (point().normalize(), [point(), point()]);
            let half = 0.4_f64;
            let found = outside_cone(&axis, half, &ends);
            let mut least = f64::INFINITY;
            for i in 0..=400 {
                let p = ends[0] + (ends[1] - ends[0]) * (f64::from(i) / 400.0);
                let along = p.dot(&axis);
                let across = (p - axis * along).norm();
                let (mut inside, mut near) = (false, f64::INFINITY);
                for j in 0..=2000 {
                    let z = 3.0 * f64::from(j) / 2000.0;
                    near = near.min((along - z * half.cos()).hypot(across - z * half.sin()));
                    inside |= across < along * half.tan();
                }
                least = least.min(if inside { -near } else { near });
            }
            let behind = found < least;
            assert!(found <= least + 1.0e-3, "{found} {least}");
            assert!(behind || found > least - 0.01, "{found} {least}");
        }
    }

    /// Compared with a fine grid over both segments, including parallel and degenerate ones.
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
