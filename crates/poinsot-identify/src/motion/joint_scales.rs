//! Scales of joint sensors and biases of joint rates: a sample is `(1 + scale) truth + bias`.
//!
//! The motion of a joint is linear in its samples: a part made of positions, and one made of rates where these are measured
//! for themselves. Each part has its own scale.

use crate::problem::parameters::{Parameters, UnknownKind};
use crate::problem::segment::{InputChannel, InputRate, Observations, RateParts};
use poinsot_spatial::Vector3;

/// Errors of one joint coordinate.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct JointScales {
    /// Index of the coordinate.
    pub joint: usize,
    /// Scale of the position, scale and bias of the rate: each with the index of its unknown and its value.
    errors: [Option<(usize, f64)>; 3],
}

/// Position, rate and acceleration without errors, and their slopes over the errors.
pub(super) struct Corrected {
    pub value: [f64; 3],
    pub slopes: [[f64; 3]; 3],
}

/// The joints with such errors.
pub(crate) fn joint_scales(parameters: &Parameters, x: &[f64]) -> Vec<JointScales> {
    let mut all: Vec<JointScales> = Vec::new();
    for (unknown, (of, value)) in parameters.unknowns.iter().zip(x).enumerate() {
        let (joint, which) = match of.kind {
            UnknownKind::JointScale(j) => (j, 0),
            UnknownKind::JointRateScale(j) => (j, 1),
            UnknownKind::JointRateBias(j) => (j, 2),
            _ => continue,
        };
        let at = all.iter().position(|own| own.joint == joint);
        let at = at.unwrap_or_else(|| {
            all.push(JointScales {
                joint,
                ..JointScales::default()
            });
            all.len() - 1
        });
        all[at].errors[which] = Some((unknown, *value));
    }
    all
}

impl JointScales {
    /// The unknowns, in the order of [`Corrected::slopes`].
    pub fn unknowns(&self) -> [Option<usize>; 3] {
        self.errors.map(|e| e.map(|(unknown, _)| unknown))
    }

    /// What the position is multiplied by.
    pub fn factor(&self) -> f64 {
        1.0 / (1.0 + self.value(0))
    }

    fn value(&self, which: usize) -> f64 {
        self.errors[which].map_or(0.0, |(_, value)| value)
    }

    /// The motion without errors: `whole` as measured, its part made of measured rates, and that part were all of them one.
    pub(super) fn corrected(&self, whole: [f64; 3], parts: &RateParts) -> Corrected {
        let RateParts {
            rates: of_rates,
            ones: of_ones,
        } = parts;
        let (by_position, by_rate) = (self.factor(), 1.0 / (1.0 + self.value(1)));
        let bias = self.value(2);
        let positions: [f64; 3] = std::array::from_fn(|i| whole[i] - of_rates[i]);
        let rates: [f64; 3] = std::array::from_fn(|i| of_rates[i] - bias * of_ones[i]);
        Corrected {
            value: std::array::from_fn(|i| by_position * positions[i] + by_rate * rates[i]),
            slopes: [
                positions.map(|x| -by_position * by_position * x),
                rates.map(|x| -by_rate * by_rate * x),
                of_ones.map(|x| -by_rate * x),
            ],
        }
    }
}

/// Position, rate and acceleration of a joint that its measured rates make, at a share of the interval after grid time k, and what they would
/// make were all of them one; zero where rates are derived from positions.
pub(super) fn rate_parts(
    o: &Observations,
    (dof, joint): (usize, usize),
    (k, at): (usize, f64),
) -> RateParts {
    let InputChannel { rate, of_rates, .. } = o.joint(joint);
    let ends = match rate {
        InputRate::Measured if of_rates.is_empty() => [k, k + 1].map(|k| {
            let rate = o.joint_rate.get(k * dof + joint).copied();
            RateParts {
                rates: [0.0, rate.unwrap_or(0.0), 0.0],
                ones: [0.0, 1.0, 0.0],
            }
        }),
        _ => [k, k + 1].map(|k| of_rates.get(k).copied().unwrap_or_default()),
    };
    let next = o.time_s.get(k + 1).copied().unwrap_or(o.time_s[k]);
    ends[0].to(&ends[1], next - o.time_s[k], at)
}

impl RateParts {
    /// Those at a share of an interval of length h: position and rate on the cubic with these ends, the acceleration between both.
    pub(super) fn to(&self, end: &Self, h: f64, at: f64) -> Self {
        let between = |a: [f64; 3], b: [f64; 3]| match at {
            0.0 => a,
            1.0 => b,
            _ => {
                let (so_far, rate) = cubic(b[0] - a[0], [a[1], b[1]], h, at);
                [a[0] + so_far, rate, a[2] + at * (b[2] - a[2])]
            }
        };
        Self {
            rates: between(self.rates, end.rates),
            ones: between(self.ones, end.ones),
        }
    }
}

/// The cubic with a change and the rates at both ends of an interval of length h: how far it is at a share of it, and its rate there.
pub(crate) fn cubic(change: f64, rates: [f64; 2], h: f64, at: f64) -> (f64, f64) {
    let [d0, d1] = rates.map(|rate| rate * h);
    let (c2, c3) = (3.0 * change - 2.0 * d0 - d1, d0 + d1 - 2.0 * change);
    let so_far = at * (d0 + at * (c2 + at * c3));
    (so_far, (d0 + at * (2.0 * c2 + at * 3.0 * c3)) / h)
}

/// How far such a cubic of each component is at a share of the interval.
pub(crate) fn cubic_between(change: &Vector3, rates: [&Vector3; 2], h: f64, at: f64) -> Vector3 {
    Vector3::from_fn(|i, _| cubic(change[i], rates.map(|rate| rate[i]), h, at).0)
}
