//! Input errors in accelerometer samples, at several grid times together.

use super::{Filter, InputNoise, SparseRows};
use crate::motion::{BodyPoint, Input, Instant, Motion, State};
use crate::problem::Problem;
use crate::problem::segment::{Observations, SensorRecord};
use poinsot_dynamics::propagation::STATE;
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;

/// Where the noise of the inputs at instruments at points is only roughly right: samples between two of a wheel whose rounding
/// errors last have another error correlation than the filter assumes.
pub(crate) fn approximate(problem: &Problem) -> Option<String> {
    let mut segments = problem.segments.iter().map(|s| &s.observations);
    let rough = |o: &Observations| o.wheels.iter().any(|w| w.errors.lasts());
    let between = segments.any(|o| o.between_readings && o.reads_points() && rough(o));
    between.then(|| {
        "accelerometer or velocity-increment samples fall between rounded wheel samples, which are interpolated; their noise contribution is approximate. Samples at equal times are exact"
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

impl InputNoise {
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
        for (c, input) in self.inputs.iter().enumerate() {
            let here = self.place(c, 0);
            match input.of {
                Input::Step => {}
                Input::Wheel(j) => {
                    slopes[here] += around.input(Input::Wheel(j)) * input.share(k);
                    let acceleration = around.input(Input::WheelRate(j));
                    for (i, w) in around.wheel_weights(j) {
                        let after = i as isize - k as isize;
                        slopes[self.place(c, after)] += acceleration * (w * input.share(i));
                    }
                }
                of => slopes[here] += around.input(of),
            }
        }
        if let Some(at) = self.torque_at() {
            (0..3).for_each(|axis| slopes[at + axis] += around.outside_torque(axis));
        }
    }

    /// Direct effect of errors on joints: place in the filter's state, joint, change of its position and
    /// rate.
    pub fn at_once(&self) -> impl Iterator<Item = (usize, usize, f64, f64)> + '_ {
        let inputs = self.inputs.iter().enumerate();
        inputs.filter_map(|(c, input)| match input.of {
            Input::Position(j) => Some((self.place(c, 0), j, 1.0, 0.0)),
            Input::Rate(j) => Some((self.place(c, 0), j, 0.0, 1.0)),
            _ => None,
        })
    }

    /// Effect of errors on passive joints: place in the filter's state, joint, change of its position and rate.
    pub fn swings(&self, motion: &Motion) -> Vec<(usize, usize, f64, f64)> {
        let Some(now) = self.before.as_deref() else {
            return Vec::new();
        };
        let columns = self.columns.iter().enumerate();
        let each = columns.flat_map(|(at, x)| {
            let input = (0..self.inputs.len()).find(|c| self.place(*c, 0) == at);
            let driven = input.map(|c| &now.drive[c]);
            let own = motion.swings(now.modes.as_deref(), x);
            own.map(move |(joint, number, dq, drate)| {
                // What an input drives has its column in it.
                let drate = driven.map_or(drate, |d| d[STATE + number]);
                (at, joint, dq, drate)
            })
        });
        each.collect()
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
