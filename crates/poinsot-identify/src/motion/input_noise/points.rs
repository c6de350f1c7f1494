//! Input errors in accelerometer samples, at several grid times together.

use super::{Filter, Input, InputNoise, SparseRows};
use crate::motion::slope_weights;
use crate::motion::{BodyPoint, Instant, Motion, State};
use crate::problem::Problem;
use crate::problem::segment::{Observations, SensorRecord};
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;

/// Positions in a derived rate, and the distance of the outermost from an acceleration that uses it.
const STENCIL: usize = 5;

/// Where the noise of the inputs at instruments at points is only roughly right: samples between two of a joint, or of a wheel
/// whose rounding errors last, have another error correlation than the filter assumes.
pub(crate) fn approximate(problem: &Problem) -> Option<String> {
    let noise = problem.noise;
    let mut joints = noise.joint_position.iter().chain(&noise.joint_rate);
    let noisy = joints.any(|v| *v > 0.0);
    let mut segments = problem.segments.iter().map(|s| &s.observations);
    let rough = |o: &Observations| noisy || o.wheels.iter().any(|w| w.errors.lasts());
    let between = segments.any(|o| o.between_readings && o.reads_points() && rough(o));
    between.then(|| {
        "accelerometer or velocity-increment samples fall between joint or rounded wheel samples, which are interpolated; their noise contribution is approximate. Samples at equal times are exact"
            .to_owned()
    })
}

/// Sensors whose readings are changes of velocity.
pub(crate) fn increments(sensors: &[SensorRecord]) -> usize {
    let kinds = sensors.iter().map(|r| r.kind);
    kinds
        .filter(|k| *k == SensorKind::VelocityIncrement)
        .count()
}

/// Grid times on each side whose errors show in a reading at a point.
pub(super) fn reach(o: &Observations, derived: &[bool]) -> usize {
    match (o.reads_points(), derived.contains(&true)) {
        (true, true) => STENCIL - 1,
        _ => usize::from(o.reads(SensorKind::Accelerometer)),
    }
}

/// Weights of the positions in the slope at grid time k of the polynomial through the five nearest.
pub(super) fn rate_weights(t: &[f64], k: usize) -> [(usize, f64); STENCIL] {
    let width = STENCIL.min(t.len());
    let first = k.saturating_sub(STENCIL / 2).min(t.len() - width);
    let others = |i: usize| (first..first + width).filter(move |j| *j != i);
    let weight = |i: usize| -> f64 {
        let scale: f64 = others(i).map(|j| t[i] - t[j]).product();
        let slope: f64 = others(i)
            .map(|left_out| {
                let rest = others(i).filter(|j| *j != left_out);
                rest.map(|j| t[k] - t[j]).product::<f64>()
            })
            .sum();
        slope / scale
    };
    // A record shorter than that has fewer.
    std::array::from_fn(|i| match i < width {
        true => (first + i, weight(first + i)),
        false => (k, 0.0),
    })
}

impl InputNoise {
    /// Joints whose rate is made of positions: what it errs by, as change of the twist.
    pub(super) fn add_derived_rates(&mut self, k: usize) {
        let mut twists = std::mem::take(&mut self.twists);
        for (at, weight, joint) in self.derived_errors(k, k) {
            twists[at] += self.rate_gain[joint] * weight;
        }
        self.twists = twists;
    }

    /// Errors of positions in the derived rates at grid time `of`, seen from grid time k: place in the state, weight
    /// and joint.
    fn derived_errors(
        &self,
        k: usize,
        of: usize,
    ) -> impl Iterator<Item = (usize, f64, usize)> + '_ {
        let inputs = self.inputs.iter().enumerate();
        let derived = inputs.filter_map(|(c, (input, _))| match input {
            Input::Joint(joint) => (self.derived.get(*joint) == Some(&true)).then_some((c, *joint)),
            _ => None,
        });
        derived.flat_map(move |(c, joint)| {
            let weights = rate_weights(&self.time_s, of).into_iter();
            weights.map(move |(i, w)| (self.place(c, i as isize - k as isize), w, joint))
        })
    }

    /// Change of the specific force at a point, in its body, with every error in the filter's state: added to a list.
    pub fn force_slopes(
        &self,
        motion: &Motion,
        (state, k): (&State, usize),
        instant: &Instant,
        point: &BodyPoint,
        slopes: &mut Vec<Vector3>,
    ) {
        if self.is_silent() {
            return;
        }
        let mut around = motion.force_around((state, k), instant, point);
        let pairs = self.columns.iter().zip(&self.twists);
        slopes.extend(pairs.map(|(x, twist)| around.state(x, twist)));
        for (c, (input, _)) in self.inputs.iter().enumerate() {
            let here = self.place(c, 0);
            match *input {
                Input::Joint(j) => slopes[here] += around.joint_position(j),
                Input::WheelSlope => {}
                Input::Rate(j) => {
                    slopes[here] += around.joint_rate(j);
                    let acceleration = around.joint_acceleration(j);
                    for (i, w) in slope_weights(&self.time_s, k) {
                        let after = i as isize - k as isize;
                        slopes[self.place(c, after)] += acceleration * w;
                    }
                }
                Input::Wheel(j) => {
                    slopes[here] += around.wheel_speed(j) * self.share(c, k);
                    let acceleration = around.wheel_acceleration(j);
                    for (i, w) in around.wheel_weights(j) {
                        let after = i as isize - k as isize;
                        slopes[self.place(c, after)] += acceleration * (w * self.share(c, i));
                    }
                }
            }
        }
        if let Some(at) = self.torque_at() {
            (0..3).for_each(|axis| slopes[at + axis] += around.outside_torque(axis));
        }
        for joint in (0..self.derived.len()).filter(|j| self.derived[*j]) {
            let (rate, acceleration) = (around.joint_rate(joint), around.joint_acceleration(joint));
            let own = |all: &(usize, f64, usize)| all.2 == joint;
            for (at, weight, _) in self.derived_errors(k, k).filter(own) {
                slopes[at] += rate * weight;
            }
            for (i, share) in slope_weights(&self.time_s, k) {
                for (at, weight, _) in self.derived_errors(k, i).filter(own) {
                    slopes[at] += acceleration * (weight * share);
                }
            }
        }
    }

    /// Direct effect of errors on joints at grid time k: place in the filter's state, joint, change of its position and
    /// rate.
    pub fn at_once(&self, k: usize) -> impl Iterator<Item = (usize, usize, f64, f64)> + '_ {
        let inputs = self.inputs.iter().enumerate();
        let all = inputs.filter_map(|(c, (input, _))| match *input {
            Input::Joint(j) => Some((self.place(c, 0), j, 1.0, 0.0)),
            Input::Rate(j) => Some((self.place(c, 0), j, 0.0, 1.0)),
            Input::Wheel(_) | Input::WheelSlope => None,
        });
        let derived = self.derived_errors(k, k);
        all.chain(derived.map(|(at, weight, j)| (at, j, 0.0, weight)))
    }

    /// Keeps the errors of the velocity at the beginning of an increment until its end, at place `which`.
    pub fn keep(&mut self, which: usize, slopes: &[Vector3]) {
        if !self.is_silent() {
            let at = self.kept(which);
            let mut rows = std::mem::take(&mut self.scratch.rows);
            self.filter.assign(at, slopes, &mut rows);
            self.scratch.rows = rows;
        }
    }

    /// Subtracts a share of the kept errors from slopes.
    pub fn less_kept(&self, which: usize, share: f64, slopes: &mut [Vector3]) {
        if !self.is_silent() {
            let at = self.kept(which);
            for (axis, slope) in slopes[at..at + 3].iter_mut().enumerate() {
                slope[axis] -= share;
            }
        }
    }

    fn kept(&self, which: usize) -> usize {
        self.lead + (2 * self.reach + 1) * self.inputs.len() + 3 * which
    }
}

impl Filter {
    /// Makes three components from `at` on what the others say: `y = slopes . x`.
    fn assign(&mut self, at: usize, slopes: &[Vector3], rows: &mut SparseRows) {
        rows.clear();
        for i in 0..self.size {
            match i.checked_sub(at).filter(|axis| *axis < 3) {
                Some(axis) => {
                    let elements = slopes.iter().enumerate().map(|(i, s)| (i, s[axis]));
                    rows.push(elements.filter(|(_, f)| *f != 0.0));
                }
                None => rows.push([(i, 1.0)]),
            }
        }
        self.map(rows);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_a_derived_rate_is_that_of_a_quartic() {
        let t = [0.0, 0.1, 0.25, 0.3, 0.5, 0.62, 0.7];
        let q = |t: f64| 1.0 + t * (2.0 - t * (3.0 + t * (1.0 - 4.0 * t)));
        let rate = |t: f64| 2.0 - 6.0 * t - 3.0 * t * t + 16.0 * t * t * t;
        for (k, at) in t.iter().enumerate() {
            let found: f64 = rate_weights(&t, k).iter().map(|(i, w)| w * q(t[*i])).sum();
            assert!((found - rate(*at)).abs() < 1.0e-11, "{k}");
        }
    }
}
