//! The free numbers of a manoeuvre: how they make motions of joints and wheels, and the linear limits on them.
//!
//! Every form is linear in its free numbers, so every limit of a commanded position, rate or acceleration is linear too.
//! Limits hold between points as well: a cubic lies in the hull of its Bezier points, a rest-to-rest quintic has its
//! peaks at known times, and a trigonometric polynomial of degree K is at most `1 / cos(pi K / N)` times its largest
//! value at N equidistant points (Ehlich and Zeller 1964).

use poinsot::case::{Design, Form, Limits, Moved, Scenario};
use poinsot_dynamics::{Fourier, Jet, JointMotion, PiecewisePolynomial, WheelMotion};
use poinsot_solve::{Polytope, Side};
use std::f64::consts::{PI, TAU};

/// Points of a Fourier series for each of its harmonics: its limits lose 0.12 %.
const POINTS: usize = 64;
/// Parts of a cubic piece whose hulls are taken.
const PARTS: usize = 2;
/// Where a rest-to-rest quintic has its largest acceleration: `s = (3 - sqrt 3) / 6`.
const QUINTIC_PEAK: f64 = 0.211_324_865_405_187_1;

/// What a mover moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Joint coordinate.
    Joint(usize),
    /// Wheel.
    Wheel(usize),
}

/// What a linear limit is of.
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
    /// What it moves.
    pub target: Target,
    /// How.
    pub form: Form,
    /// Whether it is a prismatic joint.
    pub slides: bool,
    /// Value at the start.
    pub start: f64,
    /// Index of its first free number.
    pub first: usize,
    /// What one of each free number is worth, rad, m or rad/s.
    pub units: Vec<f64>,
    /// Lowest and highest value, largest rate and acceleration; infinite without a limit.
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

/// Largest share of a linear limit that a manoeuvre uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Use {
    /// Index of the mover.
    pub mover: usize,
    /// Of what.
    pub order: Order,
    /// Value that comes closest to its limit.
    pub value: f64,
    /// That limit.
    pub limit: f64,
}

/// All free numbers of a manoeuvre of a duration.
#[derive(Debug, Clone)]
pub struct Space {
    /// Duration, s.
    pub duration: f64,
    /// Joints, then wheels.
    pub movers: Vec<Mover>,
    /// Limits on the free numbers.
    pub polytope: Polytope,
    /// What each side is of.
    of_side: Vec<SideOf>,
}

/// What a side of the polytope is of: the commanded value is `scale` times the side and `offset`.
#[derive(Debug, Clone, Copy)]
struct SideOf {
    mover: usize,
    order: Order,
    scale: f64,
    offset: f64,
}

impl Space {
    /// The free numbers of a design. A mover that no limit bounds, or that starts outside its limits, is an error in
    /// words.
    pub fn new(design: &Design, limits: &Limits, duration: f64) -> Result<Self, (Target, String)> {
        let mut movers = Vec::new();
        let mut first = 0;
        for moved in &design.joints {
            let l = &limits.joints[moved.index];
            let both = |x: f64| (-x, x);
            let bounds = [l.position, both(l.rate), both(l.acceleration)];
            let target = Target::Joint(moved.index);
            movers.push(Mover::new(target, moved, bounds, first, duration)?);
            first += movers.last().map_or(0, |m| m.units.len());
        }
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        for moved in &design.wheels {
            let speed = limits.wheels[moved.index].speed;
            let bounds = [(-speed, speed), free, free];
            let target = Target::Wheel(moved.index);
            movers.push(Mover::new(target, moved, bounds, first, duration)?);
            first += movers.last().map_or(0, |m| m.units.len());
        }
        let mut space = Self {
            duration,
            movers,
            polytope: Polytope::default(),
            of_side: Vec::new(),
        };
        for k in 0..space.movers.len() {
            space.add_sides(k);
        }
        Ok(space)
    }

    /// How many numbers are free.
    pub fn len(&self) -> usize {
        self.movers.iter().map(|m| m.units.len()).sum()
    }

    /// The commanded motion of every mover.
    pub fn commands(&self, x: &[f64]) -> Vec<Command> {
        let of = |m: &Mover| m.command(&x[m.first..m.first + m.units.len()], self.duration);
        self.movers.iter().map(of).collect()
    }

    /// Puts the motions into a scenario.
    pub fn place(&self, x: &[f64], scenario: &mut Scenario) -> Option<()> {
        for (mover, command) in self.movers.iter().zip(self.commands(x)) {
            match mover.target {
                Target::Joint(k) => *scenario.plan.joints.get_mut(k)? = command.joint()?,
                Target::Wheel(k) => {
                    *scenario.plan.wheels.get_mut(k)? = WheelMotion::Speed(command.profile()?);
                }
            }
        }
        Some(())
    }

    /// The uses of all linear limits, the largest of each mover and order.
    pub fn uses(&self, x: &[f64]) -> Vec<Use> {
        let mut all: Vec<Use> = Vec::new();
        for (side, of) in self.polytope.sides.iter().zip(&self.of_side) {
            let (low, high) = self.movers[of.mover].bounds[of.order as usize];
            let value = side.at(x) * of.scale + of.offset;
            let limit = if high - value <= value - low {
                high
            } else {
                low
            };
            let one = Use {
                mover: of.mover,
                order: of.order,
                value,
                limit,
            };
            let gap = |u: &Use| (u.limit - u.value).abs();
            let same = |u: &&mut Use| u.mover == of.mover && u.order == of.order;
            match all.iter_mut().find(same) {
                Some(u) if gap(u) <= gap(&one) => {}
                Some(u) => *u = one,
                None => all.push(one),
            }
        }
        all
    }

    /// The free numbers whose commands come closest to given motions, and drawn towards rest until they are within
    /// the limits.
    pub fn nearest(&self, scenario: &Scenario) -> Vec<f64> {
        let mut x = vec![0.0; self.len()];
        for mover in &self.movers {
            let own = match mover.target {
                Target::Joint(k) => scenario.plan.joints.get(k).cloned(),
                Target::Wheel(k) => match scenario.plan.wheels.get(k) {
                    Some(WheelMotion::Speed(p)) => Some(JointMotion::Nodes(p.clone())),
                    _ => None,
                },
            };
            if let Some(fitted) = own.and_then(|motion| mover.fitted(&motion, self.duration)) {
                x[mover.first..mover.first + fitted.len()].copy_from_slice(&fitted);
            }
        }
        self.drawn_inside(x)
    }

    /// The point itself, or the part of the way from rest to it that lies within the limits; each mover for itself.
    pub fn drawn_inside(&self, mut x: Vec<f64>) -> Vec<f64> {
        let rest = vec![0.0; x.len()];
        for mover in &self.movers {
            let range = mover.first..mover.first + mover.units.len();
            let mut own = rest.clone();
            own[range.clone()].copy_from_slice(&x[range.clone()]);
            let reach = self.polytope.reach(&rest, &own).min(1.0);
            x[range].iter_mut().for_each(|x| *x *= reach);
        }
        x
    }

    /// The direction stretched until each mover, by itself, uses `share` of its limits.
    pub fn stretched(&self, direction: &[f64], share: f64) -> Vec<f64> {
        let rest = vec![0.0; direction.len()];
        let mut x = direction.to_vec();
        for mover in &self.movers {
            let range = mover.first..mover.first + mover.units.len();
            let mut own = rest.clone();
            own[range.clone()].copy_from_slice(&direction[range.clone()]);
            let reach = self.polytope.reach(&rest, &own);
            x[range].iter_mut().for_each(|x| *x *= share * reach);
        }
        x
    }

    fn add_sides(&mut self, k: usize) {
        let mover = &self.movers[k];
        let n = mover.units.len();
        let at = |x: &[f64]| mover.points(&mover.command(x, self.duration));
        let rest = at(&vec![0.0; n]);
        let columns: Vec<Vec<(Order, f64)>> = (0..n)
            .map(|j| {
                let mut unit = vec![0.0; n];
                unit[j] = 1.0;
                at(&unit)
            })
            .collect();
        let shrink = mover.shrink();
        for (i, &(order, offset)) in rest.iter().enumerate() {
            let (low, high) = mover.bounds[order as usize];
            if low.is_infinite() && high.is_infinite() {
                continue;
            }
            let middle =
                middle((low, high), mover.start) * f64::from(u8::from(order == Order::Value));
            let scale = match high.is_finite() {
                true => high - middle,
                false => middle - low,
            };
            let a: Vec<(usize, f64)> = (0..n)
                .map(|j| (mover.first + j, (columns[j][i].1 - offset) / scale))
                .filter(|(_, a)| a.abs() > 1.0e-14)
                .collect();
            if a.is_empty() {
                continue;
            }
            let end = |bound: f64| (middle + shrink * (bound - middle) - offset) / scale;
            self.polytope.sides.push(Side {
                a,
                low: end(low),
                high: end(high),
            });
            self.of_side.push(SideOf {
                mover: k,
                order,
                scale,
                offset,
            });
        }
    }
}

/// Centre of a range; the start where it has only one end.
fn middle((low, high): (f64, f64), start: f64) -> f64 {
    match low.is_finite() && high.is_finite() {
        true => 0.5 * (low + high),
        false => start,
    }
}

impl Mover {
    fn new(
        target: Target,
        moved: &Moved,
        bounds: [(f64, f64); 3],
        first: usize,
        duration: f64,
    ) -> Result<Self, (Target, String)> {
        let (low, high) = bounds[0];
        if !(low < moved.start && moved.start < high) {
            let why = format!(
                "it starts at {}, outside its limits {low} to {high}",
                moved.start
            );
            return Err((target, why));
        }
        let room = f64::min(high - moved.start, moved.start - low);
        let bound = |w: f64| room.min(bounds[1].1 / w).min(bounds[2].1 / (w * w));
        // Free numbers of nodes are worth what a slow swing over the duration may reach.
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
            Form::Spline { nodes, returns } => vec![swing; nodes - 1 - usize::from(returns)],
            Form::Slews { slews, returns } => vec![swing; slews - usize::from(returns)],
        };
        if units.iter().any(|u| !u.is_finite()) {
            let why = "no limit bounds it: the amplitude is unlimited".to_owned();
            return Err((target, why));
        }
        Ok(Self {
            target,
            form,
            slides: moved.slides,
            start: moved.start,
            first,
            units,
            bounds,
        })
    }

    /// The motion of free numbers of this mover.
    fn command(&self, x: &[f64], duration: f64) -> Command {
        let value: Vec<f64> = x.iter().zip(&self.units).map(|(x, u)| x * u).collect();
        let nodes = |count: usize, returns: bool| {
            let step = duration / (count - 1) as f64;
            let time = (0..count).map(|k| k as f64 * step).collect();
            let inner = value.iter().map(|v| self.start + v);
            let last = returns.then_some(self.start);
            let values = std::iter::once(self.start)
                .chain(inner)
                .chain(last)
                .collect();
            (time, values)
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
            Form::Spline { nodes: n, returns } => {
                let (time, values) = nodes(n, returns);
                Command::Spline(time, values)
            }
            Form::Slews { slews, returns } => {
                let (time, values) = nodes(slews + 1, returns);
                Command::Slews(time, values)
            }
        }
    }

    /// Values whose limits bound the whole motion.
    fn points(&self, command: &Command) -> Vec<(Order, f64)> {
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
                        hull(
                            &mut out,
                            &p.at(t, t + 0.5 * h),
                            &p.at(t + h, t + 0.5 * h),
                            h,
                        );
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

    /// Share of a limit that the points may use so that the motion between them holds it.
    fn shrink(&self) -> f64 {
        match self.form {
            Form::Fourier { harmonics, .. } => (PI * harmonics as f64 / self.grid() as f64).cos(),
            _ => 1.0,
        }
    }

    /// Free numbers nearest to a motion, by least squares at many times.
    fn fitted(&self, motion: &JointMotion, duration: f64) -> Option<Vec<f64>> {
        const TIMES: usize = 400;
        let n = self.units.len();
        let sampled = |x: &[f64]| -> Option<nalgebra::DVector<f64>> {
            let own = self.command(x, duration).joint()?;
            Some(values_of(&own, duration, TIMES))
        };
        let rest = sampled(&vec![0.0; n])?;
        let mut A = nalgebra::DMatrix::zeros(TIMES, n);
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            A.set_column(j, &(sampled(&unit)? - &rest));
        }
        let y = values_of(motion, duration, TIMES) - rest;
        let x = (A.transpose() * &A).cholesky()?.solve(&(A.transpose() * y));
        Some(x.iter().copied().collect())
    }
}

fn values_of(motion: &JointMotion, duration: f64, count: usize) -> nalgebra::DVector<f64> {
    nalgebra::DVector::from_fn(count, |i, _| {
        let t = duration * (i as f64 + 0.5) / count as f64;
        motion.at(t, t).value
    })
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

/// Bezier points of a cubic with these ends, of its rate and of its acceleration.
fn hull(out: &mut Vec<(Order, f64)>, from: &Jet, to: &Jet, h: f64) {
    push_jet(out, from);
    push_jet(out, to);
    out.push((Order::Value, from.value + h / 3.0 * from.rate));
    out.push((Order::Value, to.value - h / 3.0 * to.rate));
    out.push((Order::Rate, from.rate + 0.5 * h * from.acceleration));
}

impl Command {
    /// As motion of a joint.
    pub fn joint(&self) -> Option<JointMotion> {
        match self {
            Self::Fourier(f) => Some(JointMotion::Fourier(f.clone())),
            _ => self.profile().map(JointMotion::Nodes),
        }
    }

    /// As polynomials; `None` for a Fourier series.
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
    use rand::RngExt;
    use rand::SeedableRng;

    fn mover(form: Form, bounds: [(f64, f64); 3]) -> Space {
        let moved = Moved {
            index: 0,
            slides: false,
            form,
            start: 0.2,
        };
        let mover = Mover::new(Target::Joint(0), &moved, bounds, 0, 40.0).unwrap();
        let mut space = Space {
            duration: 40.0,
            movers: vec![mover],
            polytope: Polytope::default(),
            of_side: Vec::new(),
        };
        space.add_sides(0);
        space
    }

    /// Motions stretched to their limits, sampled a hundred times as densely: no limit is broken anywhere, and the
    /// hull gives away little.
    #[test]
    fn prop_limits_hold_between_the_points_for_every_form() {
        let both = |x: f64| (-x, x);
        let bounds = [(-0.5, 1.1), both(0.11), both(0.03)];
        let fourier = |at_rest| Form::Fourier {
            harmonics: 3,
            base_frequency_hz: None,
            at_rest,
        };
        let returns = true;
        let forms = [
            fourier(false),
            fourier(true),
            Form::Spline { nodes: 8, returns },
            Form::Slews { slews: 4, returns },
        ];
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(22);
        for form in forms {
            let space = mover(form, bounds);
            let mut closest = 0.0_f64;
            for _ in 0..50 {
                let d: Vec<f64> = (0..space.len())
                    .map(|_| rng.random_range(-1.0..1.0))
                    .collect();
                let x = space.stretched(&d, 1.0);
                let motion = space.commands(&x)[0].joint().unwrap();
                let mut share = 0.0_f64;
                for i in 0..20_000 {
                    let t = 40.0 * (f64::from(i) + 0.5) / 20_000.0;
                    let jet = motion.at(t, t);
                    share = share
                        .max((jet.value - 0.3).abs() / 0.8)
                        .max(jet.rate.abs() / 0.11)
                        .max(jet.acceleration.abs() / 0.03);
                }
                assert!(share <= 1.0 + 1.0e-9, "{form:?} {share}");
                closest = closest.max(share);
            }
            assert!(closest > 0.995, "{form:?} {closest}");
        }
    }

    #[test]
    fn exact_a_manoeuvre_of_the_same_form_is_found_again() {
        let both = |x: f64| (-x, x);
        let form = Form::Spline {
            nodes: 7,
            returns: true,
        };
        let space = mover(form, [both(2.0), both(1.0), both(1.0)]);
        let x = space.stretched(&[0.4, -0.3, 0.2, 0.5, -0.1], 0.7);
        let motion = space.commands(&x)[0].joint().unwrap();
        let found = space.movers[0].fitted(&motion, 40.0).unwrap();
        for (a, b) in x.iter().zip(found) {
            assert!((a - b).abs() < 1.0e-9);
        }
    }
}
