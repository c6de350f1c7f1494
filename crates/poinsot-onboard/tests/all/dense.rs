//! The bound of Cramer and Rao of a record: all errors of wheel speeds and joints and the whole motion as unknowns of one least squares problem,
//! derivatives by differences. The motion is predicted from the measured inputs as in the filter, by code of its own.

use crate::arm::{Arm, points};
use crate::setups::Setup;
use crate::truth::Motion;
use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};
use poinsot_onboard::{JOINTS, WHEELS, Wheel};

/// Steps of the integration between two samples.
const STEPS: usize = 4;

#[derive(Clone, Copy)]
struct State {
    R: UnitQuaternion<f64>,
    h: Vector3<f64>,
    p: Vector3<f64>,
    P: Vector3<f64>,
}

#[derive(Clone, Copy)]
struct Body {
    mass: f64,
    c: Vector3<f64>,
    I: Matrix3<f64>,
}

fn body(p: &[f64; 10]) -> Body {
    let c = Vector3::new(p[1], p[2], p[3]) / p[0];
    let about_Bo = Matrix3::new(p[4], p[5], p[7], p[5], p[6], p[8], p[7], p[8], p[9]);
    let shift = (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * p[0];
    Body {
        mass: p[0],
        c,
        I: about_Bo - shift,
    }
}

/// Inputs of a sample: wheel speeds, positions and rates of joints.
#[derive(Clone, Copy)]
struct Inputs {
    speeds: [f64; WHEELS],
    q: [f64; JOINTS],
    rate: [f64; JOINTS],
}

impl Inputs {
    fn of(m: &Motion) -> Self {
        Self {
            speeds: m.speeds,
            q: m.q,
            rate: m.rate,
        }
    }

    fn nth(&mut self, k: usize) -> &mut f64 {
        match k.checked_sub(WHEELS) {
            None => &mut self.speeds[k],
            Some(j) if j < JOINTS => &mut self.q[j],
            Some(j) => &mut self.rate[j - JOINTS],
        }
    }

    /// Between two samples: straight, and the cubic through positions and rates.
    fn between([a, b]: [&Self; 2], share: f64, dt: f64) -> Self {
        let (x, y) = (share, 1.0 - share);
        let bend = |j: usize| {
            let rise = (b.q[j] - a.q[j]) / dt;
            (a.rate[j] - rise, b.rate[j] - rise, rise)
        };
        Self {
            speeds: std::array::from_fn(|j| a.speeds[j] + x * (b.speeds[j] - a.speeds[j])),
            q: std::array::from_fn(|j| {
                let (first, last, _) = bend(j);
                y * a.q[j] + x * b.q[j] + x * y * (y * first - x * last) * dt
            }),
            rate: std::array::from_fn(|j| {
                let (first, last, rise) = bend(j);
                rise + y * (y - 2.0 * x) * first + x * (x - 2.0 * y) * last
            }),
        }
    }
}

struct Predictor<'a> {
    setup: &'a Setup,
    body: Body,
    /// The arm with that body.
    arm: Option<Arm>,
}

impl<'a> Predictor<'a> {
    fn new(setup: &'a Setup, numbers: &[f64; 10]) -> Self {
        let body = body(numbers);
        let mut arm = setup.truth.arm.clone();
        if let Some(last) = arm.as_mut().and_then(|arm| arm.links.last_mut()) {
            let own = points(body.mass, body.c, body.I);
            let first = last.points.len() - own.len();
            last.points[first..].copy_from_slice(&own);
        }
        Self { setup, body, arm }
    }

    fn wheels(&self) -> &[Wheel] {
        let configuration = &self.setup.configuration;
        &configuration.wheels[..configuration.wheel_count]
    }

    fn rate(&self, state: &State, inputs: &Inputs) -> Vector3<f64> {
        let mut h = state.R.inverse() * state.h;
        if let Some(arm) = &self.arm {
            return arm.turn(&inputs.q, &inputs.rate, &h);
        }
        for (wheel, speed) in self.wheels().iter().zip(&inputs.speeds) {
            h -= Vector3::from(wheel.axis_B) * (wheel.spin_inertia * speed);
        }
        self.body.I.try_inverse().unwrap() * h
    }

    /// From sample k to the next.
    fn follow(&self, start: &State, k: usize, ends: [&Inputs; 2]) -> State {
        let (force, torque) = (self.setup.truth.wrench)(k);
        let dt = self.setup.truth.dt / STEPS as f64;
        let slope = |s: &State, share: f64| {
            (
                self.rate(s, &Inputs::between(ends, share, self.setup.truth.dt)),
                s.R * (torque - self.body.c.cross(&force)),
                s.R * force,
            )
        };
        let mut now = *start;
        for step in 0..STEPS {
            let share = |x: f64| (step as f64 + x) / STEPS as f64;
            // Two points of Gauss, a commutator for the turn.
            let (a, b) = (0.5 - 3.0_f64.sqrt() / 6.0, 0.5 + 3.0_f64.sqrt() / 6.0);
            let mut points = [slope(&now, share(a)), slope(&now, share(b))];
            for _ in 0..4 {
                let at = |x: f64| {
                    let (first, last) = (points[0].0, points[1].0);
                    let slope = (last - first) / (b - a);
                    let turn = (first - slope * a) * x + slope * (0.5 * x * x);
                    State {
                        R: now.R * UnitQuaternion::from_scaled_axis(turn * dt),
                        h: now.h + points[0].1 * (x * dt),
                        ..now
                    }
                };
                points = [slope(&at(a), share(a)), slope(&at(b), share(b))];
            }
            let [first, last] = points;
            let turn = (first.0 + last.0) * (0.5 * dt)
                + first.0.cross(&last.0) * (3.0_f64.sqrt() / 12.0 * dt * dt);
            now = State {
                R: now.R * UnitQuaternion::from_scaled_axis(turn),
                h: now.h + (first.1 + last.1) * (0.5 * dt),
                p: now.p
                    + now.P * (dt / self.body.mass)
                    + (first.2 + last.2) * (0.25 * dt * dt / self.body.mass),
                P: now.P + (first.2 + last.2) * (0.5 * dt),
            };
        }
        now
    }
}

/// Unknowns of the problem and their steps.
#[derive(Clone, Copy)]
enum Unknown {
    Turn(usize),
    Momentum(usize),
    Position(usize),
    Push(usize),
    Bias,
    Parameter(usize),
    Input(usize, usize),
}

/// Sigma of the unknown parameters after the first `count` samples of a motion.
pub fn bound(setup: &Setup, motions: &[Motion], count: usize) -> Vec<f64> {
    let noise = setup.configuration.noise;
    let truth = setup.truth.parameters();
    let translates = noise.position > 0.0;
    let noise_of = |input: usize| {
        let c = &setup.configuration;
        let joint = |j: usize| c.joints[j % JOINTS];
        match input.checked_sub(WHEELS) {
            None => c.wheels[input].noise,
            Some(j) if j < JOINTS => joint(j).position_noise,
            Some(j) => joint(j).rate_noise,
        }
    };
    let noisy: Vec<usize> = (0..WHEELS + 2 * JOINTS)
        .filter(|k| noise_of(*k) > 0.0)
        .collect();
    let parameters: Vec<usize> = (0..10).filter(|k| setup.sigma[*k] > 0.0).collect();
    let mut unknowns: Vec<Unknown> = parameters.iter().map(|k| Unknown::Parameter(*k)).collect();
    for axis in 0..3 {
        unknowns.extend([Unknown::Turn(axis), Unknown::Momentum(axis)]);
        if translates {
            unknowns.extend([Unknown::Position(axis), Unknown::Push(axis)]);
        }
    }
    let moving = unknowns.len();
    unknowns.extend([Unknown::Bias; 3]);
    let of_wheels = unknowns.len();
    let inputs = (0..count).flat_map(|k| noisy.iter().map(move |j| Unknown::Input(k, *j)));
    unknowns.extend(inputs);

    let rows = if translates { 9 } else { 6 };
    let mut J = DMatrix::<f64>::zeros(rows * count, unknowns.len());
    let first = Predictor::new(setup, &truth);
    let start = {
        let m = &motions[0];
        let mut h = first.body.I * m.w;
        for (wheel, speed) in first.wheels().iter().zip(&m.speeds) {
            h += Vector3::from(wheel.axis_B) * (wheel.spin_inertia * speed);
        }
        let arm = setup.truth.arm.as_ref();
        State {
            R: m.R,
            h: arm.map_or(m.R * h, |arm| arm.momentum(m)),
            p: m.p,
            P: m.v * first.body.mass,
        }
    };
    let mut path = vec![start];
    for k in 1..count {
        let ends = [k - 1, k].map(|k| Inputs::of(&motions[k]));
        path.push(first.follow(&path[k - 1], k - 1, ends.each_ref()));
    }
    for (column, unknown) in unknowns.iter().enumerate() {
        let (step, from) = match unknown {
            Unknown::Bias => continue,
            Unknown::Input(k, j) => (noise_of(*j), *k),
            Unknown::Parameter(k) => (1.0e-4 * setup.sigma[*k], 0),
            _ => (1.0e-5, 0),
        };
        let side = |sign: f64| {
            let (mut state, mut numbers) = (path[from.saturating_sub(1)], truth);
            let mut off = None;
            match unknown {
                Unknown::Turn(axis) => {
                    let turn = Vector3::ith(*axis, sign * step);
                    state.R *= UnitQuaternion::from_scaled_axis(turn);
                }
                Unknown::Momentum(axis) => state.h[*axis] += sign * step,
                Unknown::Position(axis) => state.p[*axis] += sign * step,
                Unknown::Push(axis) => state.P[*axis] += sign * step,
                Unknown::Parameter(k) => numbers[*k] += sign * step,
                Unknown::Input(k, j) => off = Some((*k, *j)),
                Unknown::Bias => {}
            }
            let predictor = Predictor::new(setup, &numbers);
            let of = |k: usize| {
                let mut inputs = Inputs::of(&motions[k]);
                if let Some((_, j)) = off.filter(|(at, _)| *at == k) {
                    *inputs.nth(j) += sign * step;
                }
                inputs
            };
            let mut out: Vec<f64> = Vec::new();
            for k in from.saturating_sub(1)..count {
                if k > from.saturating_sub(1) {
                    state = predictor.follow(&state, k - 1, [&of(k - 1), &of(k)]);
                }
                let w = predictor.rate(&state, &of(k)) / noise.gyro;
                let turn = (path[k].R.inverse() * state.R).scaled_axis() / noise.attitude;
                out.extend(w.iter().chain(turn.iter()));
                if translates {
                    let p = (state.p - state.R * predictor.body.c) / noise.position;
                    out.extend(p.iter());
                }
            }
            out
        };
        let (up, down) = (side(1.0), side(-1.0));
        let at = rows * from.saturating_sub(1);
        for (i, (up, down)) in up.iter().zip(&down).enumerate() {
            J[(at + i, column)] = (up - down) / (2.0 * step);
        }
    }
    for axis in 0..3 {
        for k in 0..count {
            J[(rows * k + axis, moving + axis)] = 1.0 / noise.gyro;
        }
    }
    // Scaled to unit priors of wheels and parameters.
    let mut scale = vec![1.0; unknowns.len()];
    for (column, unknown) in unknowns.iter().enumerate() {
        let (size, prior) = match unknown {
            Unknown::Input(_, j) => (noise_of(*j), 1.0),
            Unknown::Parameter(k) => (setup.sigma[*k], 1.0),
            Unknown::Bias => (noise.bias, 1.0),
            _ => (1.0e-4, 0.0),
        };
        scale[column] = prior;
        J.column_mut(column).scale_mut(size);
    }
    let mut information = J.tr_mul(&J);
    for (k, prior) in scale.iter().enumerate() {
        information[(k, k)] += prior;
    }
    // The errors of the inputs are eliminated.
    let n = of_wheels;
    let rest = unknowns.len() - n;
    let mut small = information.view((0, 0), (n, n)).into_owned();
    if rest > 0 {
        let coupled = information.view((n, 0), (rest, n)).into_owned();
        let own = information.view((n, n), (rest, rest)).into_owned();
        small -= coupled.tr_mul(&own.cholesky().unwrap().solve(&coupled));
    }
    let covariance = small.cholesky().unwrap().inverse();
    let sizes = parameters.iter().enumerate();
    sizes
        .map(|(j, k)| covariance[(j, j)].sqrt() * setup.sigma[*k])
        .collect()
}
