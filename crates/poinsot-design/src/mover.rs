//! One joint or wheel: its motion as a function of its free numbers, and the points at which limits are checked.

use poinsot::case::{Form, Moved};
use poinsot_dynamics::{Fourier, Jet, JointMotion, PiecewisePolynomial, Tree};
use poinsot_model::Model;
use std::f64::consts::{PI, TAU};

/// Points per harmonic of a Fourier series; this tightens its limits by 0.12 %.
const POINTS: usize = 64;
/// Pieces into which a cubic is divided for its Bezier hull.
const PARTS: usize = 2;
/// Share of a piece of a motion below which it is not divided.
const DIVIDED: f64 = 1.0e-12;
/// Relative excess of a limit that is round-off.
const ROUND_OFF: f64 = 1.0e-9;
/// Place of the largest acceleration of a rest-to-rest quintic: `s = (3 - sqrt 3) / 6`.
const QUINTIC_PEAK: f64 = 0.211_324_865_405_187_1;

/// What a mover drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Joint coordinate.
    Joint(usize),
    /// Wheel.
    Wheel(usize),
    /// Thruster.
    Thruster(usize),
}

impl Target {
    /// Name of the joint, wheel or thruster.
    pub fn name(self, model: &Model) -> String {
        let named = match self {
            Self::Joint(k) => &model.joints[Tree::new(model).coordinates[k]].name,
            Self::Wheel(k) => &model.wheels[k].name,
            Self::Thruster(k) => &model.thrusters[k].name,
        };
        named.clone()
    }
}

/// Derivative that a linear limit bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Joint position or wheel speed.
    Value,
    /// Joint rate.
    Rate,
    /// Joint acceleration.
    Acceleration,
}

/// One joint or wheel with its free numbers.
#[derive(Debug, Clone)]
pub struct Mover {
    /// Joint, wheel or thruster.
    pub target: Target,
    /// Form of the motion.
    pub form: Form,
    /// Whether it is a prismatic joint.
    pub slides: bool,
    /// Value at the start.
    pub start: f64,
    /// Value at the end, unless that is free.
    pub end: Option<f64>,
    /// What is flown first and next.
    around: [Vec<PiecewisePolynomial>; 2],
    /// Index of its first free number.
    pub first: usize,
    /// Scale of each free number, rad, m or rad/s.
    pub units: Vec<f64>,
    /// Lowest and highest value, largest rate and acceleration; infinite if unlimited.
    pub bounds: [(f64, f64); 3],
}

/// A commanded motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Harmonics.
    Fourier(Fourier),
    /// Nodes of a clamped cubic spline.
    Spline(Vec<f64>, Vec<f64>),
    /// Nodes of rest-to-rest quintics.
    Slews(Vec<f64>, Vec<f64>),
}

/// Centre of a range; the start if one end is infinite.
pub fn middle((low, high): (f64, f64), start: f64) -> f64 {
    match low.is_finite() && high.is_finite() {
        true => 0.5 * (low + high),
        false => start,
    }
}

impl Mover {
    pub fn new(
        target: Target,
        moved: &Moved,
        bounds: [(f64, f64); 3],
        first: usize,
        duration: f64,
    ) -> Result<Self, (Target, String)> {
        let around = [("first", &moved.before), ("next", &moved.after)];
        for (when, profiles) in around {
            if let Some(excess) = profiles.iter().find_map(|p| excess(p, bounds)) {
                return Err((target, format!("what is flown {when} {excess}")));
            }
        }
        let (low, high) = bounds[0];
        let room = match moved.form {
            // About its mean.
            Form::Fourier { .. } => f64::min(high - moved.start, moved.start - low),
            _ => 0.5 * (high - low),
        };
        if !(low <= moved.start && moved.start <= high && room > 0.0) {
            let why = format!(
                "it starts at {}, outside its limits {low} to {high}; give [[limits.joint]] or [[limits.wheel]] that include its initial position",
                moved.start
            );
            return Err((target, why));
        }
        let bound = |w: f64| room.min(bounds[1].1 / w).min(bounds[2].1 / (w * w));
        // Scale of nodes: the amplitude that one slow swing over the duration can reach.
        let swing = bound(4.0 / duration);
        let form = moved.form;
        let units = match form {
            Form::Fourier {
                harmonics, at_rest, ..
            } => {
                let f = base_frequency(&form, duration);
                let from = if at_rest { 2 } else { 1 };
                let one: Vec<f64> = (from..=harmonics)
                    .map(|k| bound(TAU * f * k as f64))
                    .collect();
                one.iter().chain(&one).copied().collect()
            }
            Form::Spline { nodes } => vec![swing; moved.free_nodes(nodes)],
            Form::Slews { slews } => vec![swing; moved.free_nodes(slews + 1)],
        };
        if units.iter().any(|u| !u.is_finite()) {
            let why = "no limit bounds it: the amplitude is unlimited; give [[limits.joint]] or [[limits.wheel]]".to_owned();
            return Err((target, why));
        }
        Ok(Self {
            target,
            form,
            slides: moved.slides,
            start: moved.start,
            end: moved.end,
            around: [moved.before.clone(), moved.after.clone()],
            first,
            units,
            bounds,
        })
    }

    /// The free numbers with every node in the middle of the range. A Fourier series stays about its start.
    pub fn towards_middle(&self) -> Vec<f64> {
        let far = match self.form {
            Form::Fourier { .. } => 0.0,
            _ => middle(self.bounds[0], self.start) - self.start,
        };
        self.units.iter().map(|unit| far / unit).collect()
    }

    /// The motion that the free numbers give.
    pub fn command(&self, x: &[f64], duration: f64) -> Command {
        let value: Vec<f64> = x.iter().zip(&self.units).map(|(x, u)| x * u).collect();
        let nodes = |count: usize, of: fn(Vec<f64>, Vec<f64>) -> Command| {
            let step = duration / (count - 1) as f64;
            let time = (0..count).map(|k| k as f64 * step).collect();
            let inner = value.iter().map(|v| self.start + v);
            let values = std::iter::once(self.start)
                .chain(inner)
                .chain(self.end)
                .collect();
            of(time, values)
        };
        match self.form {
            Form::Fourier { at_rest, .. } => {
                let (sine, cosine) = value.split_at(value.len() / 2);
                let (mut sine, mut cosine) = (sine.to_vec(), cosine.to_vec());
                let mut offset = self.start;
                if at_rest {
                    let order = |k: usize| (k + 2) as f64;
                    let a: f64 = sine.iter().enumerate().map(|(k, a)| order(k) * a).sum();
                    let b: f64 = cosine
                        .iter()
                        .enumerate()
                        .map(|(k, b)| order(k).powi(2) * b)
                        .sum();
                    sine.insert(0, -a);
                    cosine.insert(0, -b);
                    offset -= cosine.iter().sum::<f64>();
                }
                Command::Fourier(Fourier {
                    offset,
                    base_frequency_hz: base_frequency(&self.form, duration),
                    sine,
                    cosine,
                })
            }
            Form::Spline { nodes: n } => nodes(n, Command::Spline),
            Form::Slews { slews } => nodes(slews + 1, Command::Slews),
        }
    }

    /// Values whose limits bound the whole motion, with their order.
    pub fn points(&self, command: &Command) -> Vec<(Order, f64)> {
        let mut out = Vec::new();
        match command {
            Command::Fourier(f) => {
                let n = self.grid();
                for i in 0..n {
                    let jet = f.at(i as f64 / (n as f64 * f.base_frequency_hz));
                    push_jet(&mut out, &jet);
                }
            }
            Command::Spline(time, _) => {
                let Some(p) = command.profile() else {
                    return out;
                };
                for pair in time.windows(2) {
                    let h = (pair[1] - pair[0]) / PARTS as f64;
                    for part in 0..PARTS {
                        let t = pair[0] + h * part as f64;
                        let (from, to) = (p.at(t, t + 0.5 * h), p.at(t + h, t + 0.5 * h));
                        hull(&mut out, &from, &to, h);
                    }
                }
            }
            Command::Slews(time, values) => {
                let Some(p) = command.profile() else {
                    return out;
                };
                out.extend(values.iter().map(|v| (Order::Value, *v)));
                for pair in time.windows(2) {
                    let (t, h) = (pair[0], pair[1] - pair[0]);
                    let at = |s: f64| p.at(t + s * h, t + 0.5 * h);
                    out.push((Order::Rate, at(0.5).rate));
                    out.push((Order::Acceleration, at(QUINTIC_PEAK).acceleration));
                }
            }
        }
        out
    }

    fn grid(&self) -> usize {
        match self.form {
            Form::Fourier { harmonics, .. } => POINTS * harmonics,
            _ => 1,
        }
    }

    /// Fraction of a limit allowed at the points, so that the motion between them holds it.
    pub fn shrink(&self) -> f64 {
        match self.form {
            Form::Fourier { harmonics, .. } => (PI * harmonics as f64 / self.grid() as f64).cos(),
            _ => 1.0,
        }
    }

    /// The command with what is flown before and after it; it begins at `from`.
    pub fn whole(&self, command: Command, from: f64) -> Option<JointMotion> {
        let [before, after] = &self.around;
        let command = match command.delayed(from).joint()? {
            JointMotion::Nodes(profile) => profile,
            series => return Some(series),
        };
        let parts = before.iter().chain([&command]).chain(after);
        let mut all = PiecewisePolynomial::default();
        for part in parts {
            all = all.then(part).ok()?;
        }
        Some(JointMotion::Nodes(all))
    }

    /// Free numbers that approximate a motion from `from` on best, by least squares over many times.
    pub fn fitted(&self, motion: &JointMotion, from: f64, duration: f64) -> Option<Vec<f64>> {
        const TIMES: usize = 400;
        let n = self.units.len();
        let sampled = |x: &[f64]| -> Option<nalgebra::DVector<f64>> {
            let own = self.command(x, duration).joint()?;
            Some(values_of(&own, (0.0, duration), TIMES))
        };
        let rest = sampled(&vec![0.0; n])?;
        let mut A = nalgebra::DMatrix::zeros(TIMES, n);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            A.set_column(j, &(sampled(&unit)? - &rest));
        }
        let y = values_of(motion, (from, duration), TIMES) - rest;
        let x = (A.transpose() * &A).cholesky()?.solve(&(A.transpose() * y));
        Some(x.iter().copied().collect())
    }
}

fn values_of(
    motion: &JointMotion,
    (from, duration): (f64, f64),
    count: usize,
) -> nalgebra::DVector<f64> {
    nalgebra::DVector::from_fn(count, |i, _| {
        let t = from + duration * (i as f64 + 0.5) / count as f64;
        motion.at(t, t).value
    })
}

/// Where a motion of the case exceeds a limit, in words.
fn excess(profile: &PiecewisePolynomial, bounds: [(f64, f64); 3]) -> Option<String> {
    for pair in profile.nodes().windows(2) {
        let h = pair[1] - pair[0];
        let at = |t: f64| profile.at(t, 0.5 * (pair[0] + pair[1]));
        let hulls = quintic(&at(pair[0]), &at(pair[1]), h);
        let orders = ["value", "rate", "acceleration"].into_iter().zip(bounds);
        for ((what, (low, high)), hull) in orders.zip(hulls) {
            let most = high.abs().max(low.abs());
            let slack = ROUND_OFF * if most.is_finite() { most } else { 0.0 };
            if let Some((share, value)) = left(hull, (low - slack, high + slack), (0.0, 1.0)) {
                let t = pair[0] + share * h;
                return Some(format!(
                    "exceeds its limit at {t:.3} s: {what} {value}, limits {low} to {high}"
                ));
            }
        }
    }
    None
}

/// Bezier points of a quintic given by its end states, and of its first two derivatives.
fn quintic(from: &Jet, to: &Jet, h: f64) -> [Vec<f64>; 3] {
    let near = |jet: &Jet, h: f64| {
        let second = jet.value + 0.4 * h * jet.rate + h * h / 20.0 * jet.acceleration;
        [jet.value, jet.value + 0.2 * h * jet.rate, second]
    };
    let (begin, end) = (near(from, h), near(to, -h));
    let value: Vec<f64> = begin.into_iter().chain(end.into_iter().rev()).collect();
    let derived = |points: &[f64]| -> Vec<f64> {
        let degree = (points.len() - 1) as f64;
        points
            .windows(2)
            .map(|p| degree / h * (p[1] - p[0]))
            .collect()
    };
    let rate = derived(&value);
    let acceleration = derived(&rate);
    [value, rate, acceleration]
}

/// Where a polynomial leaves a range, and its value there, by the hull of its Bezier points: it is divided where the hull leaves the
/// range and its ends do not (de Casteljau).
fn left(hull: Vec<f64>, (low, high): (f64, f64), (begin, end): (f64, f64)) -> Option<(f64, f64)> {
    let is_beyond = |x: &f64| !(low..=high).contains(x);
    let ends = [(begin, hull.first()), (end, hull.last())];
    let beyond = ends
        .into_iter()
        .find_map(|(at, x)| Some((at, *x.filter(|x| is_beyond(x))?)));
    if beyond.is_some() || !hull.iter().any(is_beyond) || end - begin < DIVIDED {
        return beyond;
    }
    let (mut first, mut second, mut rest) = (Vec::new(), Vec::new(), hull);
    while let (Some(a), Some(b)) = (rest.first(), rest.last()) {
        first.push(*a);
        second.push(*b);
        rest = rest.windows(2).map(|p| 0.5 * (p[0] + p[1])).collect();
    }
    second.reverse();
    let middle = 0.5 * (begin + end);
    left(first, (low, high), (begin, middle)).or_else(|| left(second, (low, high), (middle, end)))
}

fn base_frequency(form: &Form, duration: f64) -> f64 {
    match form {
        Form::Fourier {
            base_frequency_hz: Some(f),
            ..
        } => *f,
        _ => 1.0 / duration,
    }
}

fn push_jet(out: &mut Vec<(Order, f64)>, jet: &Jet) {
    out.push((Order::Value, jet.value));
    out.push((Order::Rate, jet.rate));
    out.push((Order::Acceleration, jet.acceleration));
}

/// Bezier points of a cubic given by its end states, and of its first two derivatives.
fn hull(out: &mut Vec<(Order, f64)>, from: &Jet, to: &Jet, h: f64) {
    push_jet(out, from);
    push_jet(out, to);
    out.push((Order::Value, from.value + h / 3.0 * from.rate));
    out.push((Order::Value, to.value - h / 3.0 * to.rate));
    out.push((Order::Rate, from.rate + 0.5 * h * from.acceleration));
}

impl Command {
    /// The same command, later. A Fourier series fills its record.
    pub fn delayed(self, by: f64) -> Self {
        let later = |time: Vec<f64>| time.into_iter().map(|t| t + by).collect();
        match self {
            Self::Fourier(f) => Self::Fourier(f),
            Self::Spline(time, values) => Self::Spline(later(time), values),
            Self::Slews(time, values) => Self::Slews(later(time), values),
        }
    }

    /// The command as motion of a joint.
    pub fn joint(&self) -> Option<JointMotion> {
        match self {
            Self::Fourier(f) => Some(JointMotion::Fourier(f.clone())),
            _ => self.profile().map(JointMotion::Nodes),
        }
    }

    /// The command as polynomials; `None` for a Fourier series.
    pub fn profile(&self) -> Option<PiecewisePolynomial> {
        match self {
            Self::Fourier(_) => None,
            Self::Spline(t, v) => PiecewisePolynomial::cubic_clamped(t, v).ok(),
            Self::Slews(t, v) => PiecewisePolynomial::quintic_rest(t, v).ok(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// Splines and slews with random nodes, limits just above and just below their largest values by 100,000 points.
    #[test]
    fn prop_the_motion_of_a_case_is_refused_where_it_exceeds_a_limit_at_any_time() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        for trial in 0..20 {
            let times = [0.0, 7.0, 11.0, 20.0];
            let values = times.map(|_| rng.random_range(-1.0..1.0));
            let profile = match trial % 2 {
                0 => PiecewisePolynomial::cubic_clamped(&times, &values).unwrap(),
                _ => PiecewisePolynomial::quintic_rest(&times, &values).unwrap(),
            };
            let mut largest = [0.0_f64; 3];
            for i in 0..100_000 {
                let t = 20.0 * (f64::from(i) + 0.5) / 100_000.0;
                let jet = profile.at(t, t);
                for (own, x) in largest
                    .iter_mut()
                    .zip([jet.value, jet.rate, jet.acceleration])
                {
                    *own = own.max(x.abs());
                }
            }
            for order in 0..3 {
                let bounded = |factor: f64| {
                    let mut bounds = [free; 3];
                    bounds[order] = (-factor * largest[order], factor * largest[order]);
                    excess(&profile, bounds)
                };
                // The points miss a peak by at most 1e-8 of it, and the largest acceleration of a spline, at a node, by 2e-4.
                let above = if order == 2 { 1.0002 } else { 1.0 + 1.0e-7 };
                assert_eq!(bounded(above), None, "{trial} {order}");
                assert!(bounded(1.0 - 1.0e-6).is_some(), "{trial} {order}");
            }
        }
    }
}
