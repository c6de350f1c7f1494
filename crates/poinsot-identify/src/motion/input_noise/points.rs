//! Input errors in accelerometer samples, at several grid times together.

use super::{Filter, Input, InputNoise};
use crate::motion::slope_weights;
use crate::motion::{BodyPoint, Instant, Motion, State};
use crate::problem::Problem;
use crate::problem::segment::{InputErrors, Observations, SensorRecord};
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
    let rough = |o: &Observations| noisy || o.wheel_errors.iter().any(InputErrors::lasts);
    let between = segments.any(|o| o.between_readings && o.reads_points() && rough(o));
    between.then(|| {
        "accelerometer or velocity-increment samples fall between joint or rounded wheel samples, which are interpolated; their noise contribution is approximate. Samples at equal times are exact"
            .to_owned()
    })
}

/// Sensors whose readings are changes of velocity.
pub(super) fn increments(sensors: &[SensorRecord]) -> usize {
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
fn rate_weights(t: &[f64], k: usize) -> Vec<(usize, f64)> {
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
    (first..first + width).map(|i| (i, weight(i))).collect()
}

impl InputNoise {
    /// Moves the window one grid time on, to k: `upper` holds the rows of `s`.
    pub(super) fn shift(&mut self, upper: &[f64], k: usize) {
        let (size, inputs) = (self.filter.size, self.inputs.len());
        let sparse = |row: &[f64]| -> Vec<(usize, f64)> {
            let pairs = row.iter().copied().enumerate();
            pairs.filter(|(_, f)| *f != 0.0).collect()
        };
        let mut rows: Vec<Vec<(usize, f64)>> = upper.chunks_exact(size).map(sparse).collect();
        let errors = 2 * self.reach * inputs;
        rows.extend((0..errors).map(|_| Vec::new()));
        let from = self.lead;
        for (i, row) in rows.iter_mut().enumerate().skip(from) {
            row.push((i + inputs, 1.0));
        }
        let reach = self.reach as isize;
        let last = k - 1 + self.reach;
        for c in 0..inputs {
            rows.push(vec![(self.place(c, reach), self.memory[c].memory(last))]);
        }
        // The errors at the beginning of an increment stay.
        rows.extend((rows.len()..size).map(|i| vec![(i, 1.0)]));
        self.filter.map(&rows);
        for c in 0..inputs {
            let a = self.memory[c].memory(last);
            let at = self.place(c, reach);
            self.filter.covariance[at * size + at] += self.inputs[c].1 * (1.0 - a * a);
        }
    }

    /// Joints whose rate is made of positions: what it errs by, as change of the twist.
    pub(super) fn add_derived_rates(&mut self, k: usize) {
        for (at, weight, joint) in self.derived_errors(k, k) {
            let gain = self.rate_gain[joint];
            self.twists[at] += gain * weight;
        }
    }

    /// Errors of positions in the derived rates at grid time `of`, seen from grid time k: place in the state, weight
    /// and joint.
    fn derived_errors(&self, k: usize, of: usize) -> Vec<(usize, f64, usize)> {
        let mut list = Vec::new();
        for (c, (input, _)) in self.inputs.iter().enumerate() {
            let Input::Joint(joint) = input else { continue };
            if self.derived.get(*joint) == Some(&true) {
                let weights = rate_weights(&self.time_s, of).into_iter();
                list.extend(weights.map(|(i, w)| {
                    let after = i as isize - k as isize;
                    (self.place(c, after), w, *joint)
                }));
            }
        }
        list
    }

    /// Change of the specific force at a point, in its body, with every error in the filter's state.
    pub fn force_slopes(
        &self,
        motion: &mut Motion,
        (state, k): (&State, usize),
        instant: &Instant,
        point: &BodyPoint,
    ) -> Vec<Vector3> {
        if self.is_silent() {
            return Vec::new();
        }
        let around = motion.force_around((state, k), instant, point);
        let pairs = self.columns.iter().zip(&self.twists);
        let mut slopes: Vec<Vector3> = pairs.map(|(x, twist)| around.state(x, twist)).collect();
        for (c, (input, _)) in self.inputs.iter().enumerate() {
            let here = self.place(c, 0);
            match *input {
                Input::Joint(j) => slopes[here] += around.joint_position(j),
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
        if self.derived.contains(&true) {
            let of = |joint: usize| match self.derived[joint] {
                true => (around.joint_rate(joint), around.joint_acceleration(joint)),
                false => (Vector3::zeros(), Vector3::zeros()),
            };
            let joints: Vec<(Vector3, Vector3)> = (0..self.derived.len()).map(of).collect();
            for (at, weight, joint) in self.derived_errors(k, k) {
                slopes[at] += joints[joint].0 * weight;
            }
            for (i, share) in slope_weights(&self.time_s, k) {
                for (at, weight, joint) in self.derived_errors(k, i) {
                    slopes[at] += joints[joint].1 * (weight * share);
                }
            }
        }
        slopes
    }

    /// Direct effect of errors on joints at grid time k: place in the filter's state, joint, change of its position and
    /// rate.
    pub fn at_once(&self, k: usize) -> Vec<(usize, usize, f64, f64)> {
        let inputs = self.inputs.iter().enumerate();
        let mut all: Vec<_> = inputs
            .filter_map(|(c, (input, _))| match *input {
                Input::Joint(j) => Some((self.place(c, 0), j, 1.0, 0.0)),
                Input::Rate(j) => Some((self.place(c, 0), j, 0.0, 1.0)),
                Input::Wheel(_) => None,
            })
            .collect();
        let derived = self.derived_errors(k, k).into_iter();
        all.extend(derived.map(|(at, weight, j)| (at, j, 0.0, weight)));
        all
    }

    /// Keeps the velocity error at the beginning of an increment until its end: in slot `which`.
    pub fn keep(&mut self, which: usize, slopes: &[Vector3]) {
        if !self.is_silent() {
            let at = self.kept(which);
            self.filter.assign(at, slopes);
        }
    }

    /// Subtracts the kept slopes from those of the velocity at the end.
    pub fn less_kept(&self, which: usize, mut slopes: Vec<Vector3>) -> Vec<Vector3> {
        if !self.is_silent() {
            let at = self.kept(which);
            for (axis, slope) in slopes[at..at + 3].iter_mut().enumerate() {
                slope[axis] -= 1.0;
            }
        }
        slopes
    }

    fn kept(&self, which: usize) -> usize {
        self.lead + (2 * self.reach + 1) * self.inputs.len() + 3 * which
    }
}

impl Filter {
    /// Makes three components from `at` on what the others say: `y = slopes . x`.
    fn assign(&mut self, at: usize, slopes: &[Vector3]) {
        let mut rows: Vec<Vec<(usize, f64)>> = (0..self.size).map(|i| vec![(i, 1.0)]).collect();
        for (axis, row) in rows[at..at + 3].iter_mut().enumerate() {
            let elements = slopes.iter().enumerate().map(|(i, s)| (i, s[axis]));
            *row = elements.filter(|(_, f)| *f != 0.0).collect();
        }
        self.map(&rows);
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
