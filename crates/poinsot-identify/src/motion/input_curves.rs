//! Smooth curves through the samples of joints and wheels of a segment: along them a lag shifts the readings in time.

use crate::problem::parameters::Parameters;
use crate::problem::segment::{InputErrors, Noise, Observations, Segment};
use poinsot_solve::smooth_curve::{Reading, SmoothCurve};
use poinsot_spatial::Vector3;

/// Share of a record that a lag may lie beyond its readings. Measured: at 1 % the answer is right, at 2 % of a slewing vehicle
/// chi-square is 1.06 and the inertia 2 sigma off.
const BEYOND: f64 = 0.015;

/// Input motion that the largest lag needs beyond the samples.
pub(crate) struct Extrapolation<'a> {
    /// Name of the lag.
    name: &'a str,
    lag_s: f64,
    /// The lag relative to the shortest record.
    pub share: f64,
}

impl Extrapolation<'_> {
    /// Whether it lies so far beyond the samples that the extrapolation matters.
    pub fn is_large(&self) -> bool {
        self.share > BEYOND
    }

    pub fn message(&self) -> String {
        format!(
            "{} is {:.1} % of the shortest record, so inputs beyond their samples are extrapolated: the covariance is not trustworthy; shift the columns by {:.3} s and identify again",
            self.name,
            100.0 * self.share,
            self.lag_s
        )
    }
}

/// The largest lag of joint or wheel motion; `None` without one.
pub(crate) fn extrapolated_inputs<'a>(
    segments: &[Segment],
    parameters: &'a Parameters,
    x: &[f64],
) -> Option<Extrapolation<'a>> {
    let span = |s: &Segment| {
        let t = &s.observations.time_s;
        t.last().zip(t.first()).map(|(last, first)| last - first)
    };
    let shortest = segments.iter().filter_map(span).reduce(f64::min)?;
    let lags = parameters
        .unknowns
        .iter()
        .zip(x)
        .filter(|(u, _)| u.kind.delays_inputs());
    let (unknown, lag) = lags.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(Extrapolation {
        name: &unknown.name,
        lag_s: *lag,
        share: lag.abs() / shortest,
    })
}

/// One curve for each joint and wheel that moves.
#[derive(Debug, Clone, Default)]
pub(crate) struct InputCurves {
    joints: Vec<Option<SmoothCurve>>,
    wheels: Vec<Option<SmoothCurve>>,
    /// Wheels whose readings are declared free of noise.
    exact: Vec<bool>,
}

impl InputCurves {
    pub fn new(o: &Observations, noise: &Noise) -> Self {
        let count = |all: &[f64]| all.len() / o.time_s.len().max(1);
        let joints = (0..count(&o.joint_position)).map(|j| of_joint(o, j));
        let wheels = (0..count(&o.wheel_speed)).map(|w| of_wheel(o, w, count(&o.wheel_speed)));
        Self {
            joints: joints.collect(),
            wheels: wheels.collect(),
            exact: noise.wheel_speed.iter().map(|v| *v == 0.0).collect(),
        }
    }

    /// Motion of a joint between two times: changes of position and rate, and its rate and acceleration at the later
    /// one.
    pub fn joint(&self, j: usize, t: f64, lag_s: f64) -> ([f64; 2], [f64; 2]) {
        let (change, there) = between(self.joints.get(j), t, lag_s);
        ([change[0], change[1]], [there[1], there[2]])
    }

    /// Whether a wheel runs straight from reading to reading, also with a lag: there is no noise to smooth, and a
    /// torque step is not smooth.
    pub fn runs_straight(&self, w: usize, wheels_smooth: bool) -> bool {
        !wheels_smooth && self.exact.get(w) == Some(&true)
    }

    /// The same for a wheel's speed, and its acceleration at the later time.
    pub fn wheel(&self, w: usize, t: f64, lag_s: f64) -> (f64, f64) {
        // The curve is that of the wheel's angle.
        let (change, there) = between(self.wheels.get(w), t, lag_s);
        (change[1], there[2])
    }
}

/// Change of a curve from t to `t + lag_s`, and the curve there; zero without motion.
fn between(curve: Option<&Option<SmoothCurve>>, t: f64, lag_s: f64) -> (Vector3, Vector3) {
    let Some(Some(curve)) = curve else {
        return (Vector3::zeros(), Vector3::zeros());
    };
    let there = curve.at(t + lag_s);
    let change = match lag_s == 0.0 {
        true => Vector3::zeros(),
        false => there - curve.at(t),
    };
    (change, there)
}

fn of_joint(o: &Observations, j: usize) -> Option<SmoothCurve> {
    let dof = o.joint_position.len() / o.time_s.len().max(1);
    let picked = readings(o, &o.joint(j).errors);
    let h = typical_step(o, &picked)?;
    let reading = |&k: &usize| Reading {
        time_s: o.time_s[k],
        value: Some((o.joint_position[k * dof + j], 1.0)),
        slope: Some((o.joint_rate[k * dof + j], 1.0 / (h * h))),
    };
    SmoothCurve::new(&picked.iter().map(reading).collect::<Vec<_>>())
}

fn of_wheel(o: &Observations, w: usize, wheels: usize) -> Option<SmoothCurve> {
    let reading = |&k: &usize| Reading {
        time_s: o.time_s[k],
        value: None,
        slope: Some((o.wheel_speed[k * wheels + w], 1.0)),
    };
    let picked = readings(o, &o.wheel(w).errors);
    SmoothCurve::new(&picked.iter().map(reading).collect::<Vec<_>>())
}

fn typical_step(o: &Observations, picked: &[usize]) -> Option<f64> {
    let (first, last) = (picked.first()?, picked.last()?);
    let step = (o.time_s[*last] - o.time_s[*first]) / (picked.len() - 1).max(1) as f64;
    (step > 0.0).then_some(step)
}

/// Grid times about as far apart as the readings: values interpolated between those tell nothing of their noise. None of an input
/// without errors.
fn readings(o: &Observations, errors: &InputErrors) -> Vec<usize> {
    if matches!(errors, InputErrors::Locked | InputErrors::None) {
        return Vec::new();
    }
    let t = &o.time_s;
    let all = 0..t.len();
    if let InputErrors::Interpolated(places) = errors {
        let read = |k: &usize| places.get(*k).is_some_and(|p| p.share == 0.0);
        return all.filter(read).collect();
    }
    if !o.between_readings || !errors.lasts() {
        return all.collect();
    }
    let memory = (0..t.len()).map(|k| errors.memory(k));
    // A grid of step h between readings H apart has the memory (H - h) / (H + h).
    let mut apart: Vec<f64> = t
        .windows(2)
        .zip(memory)
        .filter(|(_, a)| *a < 1.0)
        .map(|(w, a)| (w[1] - w[0]) * (1.0 + a) / (1.0 - a))
        .collect();
    apart.sort_by(f64::total_cmp);
    let Some(apart) = apart.get(apart.len() / 2) else {
        return all.collect();
    };
    let mut next = f64::NEG_INFINITY;
    all.filter(|&k| {
        let due = t[k] >= next;
        if due {
            next = t[k] + 0.999 * apart;
        }
        due
    })
    .collect()
}
