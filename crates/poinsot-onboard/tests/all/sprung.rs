//! A rigid body with wheels and masses on springs that slide along lines of it: Newton and Euler with accelerations, exact at any
//! deflection, Runge-Kutta at a fiftieth of a second.

use crate::truth::{Motion, Truth};
use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};

use poinsot_onboard::{Configuration, Mode, WHEELS};
use std::f64::consts::TAU;

/// Longest step of the integration, s.
const STEP: f64 = 0.02;

/// A mass on a spring. That of the body includes it, without deflection.
#[derive(Clone, Copy)]
pub struct Sprung {
    pub mass: f64,
    /// Its place and direction in B.
    pub r: Vector3<f64>,
    pub u: Vector3<f64>,
    /// With the body held.
    pub frequency_Hz: f64,
    pub damping_ratio: f64,
    /// Deflection and its rate at the start, m and m/s.
    pub start: [f64; 2],
}

impl Sprung {
    fn spring(&self) -> [f64; 2] {
        let omega = TAU * self.frequency_Hz;
        let mass = self.mass;
        [
            mass * omega * omega,
            2.0 * self.damping_ratio * mass * omega,
        ]
    }

    /// As a mode of a body with its mass centre at `c`.
    pub fn mode(&self, c: &Vector3<f64>) -> Mode {
        let (root, rho, u) = (self.mass.sqrt(), self.r - c, self.u);
        let both = rho * u.transpose();
        Mode {
            body: 0,
            frequency_Hz: self.frequency_Hz,
            damping_ratio: self.damping_ratio,
            translation: u * root,
            rotation: self.r.cross(&u) * root,
            inertia_slope: (Matrix3::identity() * (2.0 * rho.dot(&u)) - both - both.transpose())
                * root,
        }
    }
}

#[derive(Clone)]
struct State {
    R: UnitQuaternion<f64>,
    /// Velocity of `Bo` in N, angular velocity in B.
    p: Vector3<f64>,
    v: Vector3<f64>,
    w: Vector3<f64>,
    speeds: [f64; WHEELS],
    swing: Vec<[f64; 2]>,
}

/// Acceleration of `Bo` in B, of the turn, of wheels and of the masses.
struct Accelerations {
    a: Vector3<f64>,
    alpha: Vector3<f64>,
    speeds: [f64; WHEELS],
    swing: Vec<f64>,
}

fn skew(x: &Vector3<f64>) -> Matrix3<f64> {
    x.cross_matrix()
}

/// The body without its sprung masses: mass, first moment and inertia about `Bo`.
fn rest(truth: &Truth) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let c = truth.c;
    let mut mass = truth.mass;
    let mut first = c * mass;
    let mut inertia = truth.I - skew(&c) * skew(&c) * mass;
    for sprung in &truth.sprung {
        mass -= sprung.mass;
        first -= sprung.r * sprung.mass;
        inertia += skew(&sprung.r) * skew(&sprung.r) * sprung.mass;
    }
    (mass, first, inertia)
}

fn accelerations(truth: &Truth, of: &Configuration, x: &State, k: usize) -> Accelerations {
    let n = truth.sprung.len();
    let (force, torque) = (truth.wrench)(k / truth.hold);
    let motors = (truth.motors)(k / truth.hold);
    let (mass, first, inertia) = rest(truth);
    let w = x.w;
    let mut M = DMatrix::<f64>::zeros(6 + n, 6 + n);
    let mut rhs = DVector::<f64>::zeros(6 + n);
    let mut add = |mass: f64, first: Vector3<f64>, inertia: Matrix3<f64>| {
        let S = skew(&first);
        for i in 0..3 {
            M[(i, i)] += mass;
            for j in 0..3 {
                M[(i, 3 + j)] -= S[(i, j)];
                M[(3 + i, j)] += S[(i, j)];
                M[(3 + i, 3 + j)] += inertia[(i, j)];
            }
        }
    };
    add(mass, first, inertia);
    let mut pull = force - w.cross(&w.cross(&first));
    let mut turn = torque - w.cross(&(inertia * w));
    for (sprung, [y, _]) in truth.sprung.iter().zip(&x.swing) {
        let rho = sprung.r + sprung.u * *y;
        add(
            sprung.mass,
            rho * sprung.mass,
            -skew(&rho) * skew(&rho) * sprung.mass,
        );
    }
    for (k, (sprung, [y, rate])) in truth.sprung.iter().zip(&x.swing).enumerate() {
        let (m, u) = (sprung.mass, sprung.u);
        let rho = sprung.r + u * *y;
        let carried = (w.cross(&w.cross(&rho)) + w.cross(&u) * (2.0 * rate)) * m;
        pull -= carried;
        turn -= rho.cross(&carried);
        let lever = rho.cross(&u) * m;
        for i in 0..3 {
            M[(i, 6 + k)] += m * u[i];
            M[(6 + k, i)] += m * u[i];
            M[(3 + i, 6 + k)] += lever[i];
            M[(6 + k, 3 + i)] += lever[i];
        }
        M[(6 + k, 6 + k)] = m;
        let [stiffness, damping] = sprung.spring();
        rhs[6 + k] = -stiffness * y - damping * rate - u.dot(&carried);
    }
    for (j, wheel) in of.wheels.iter().enumerate().take(of.wheel_count) {
        let a = Vector3::from(wheel.axis_B);
        turn -= w.cross(&(a * (wheel.spin_inertia * x.speeds[j]))) + a * motors[j];
        for i in 0..3 {
            for j in 0..3 {
                M[(3 + i, 3 + j)] -= wheel.spin_inertia * a[i] * a[j];
            }
        }
    }
    for i in 0..3 {
        (rhs[i], rhs[3 + i]) = (pull[i], turn[i]);
    }
    let found = M.lu().solve(&rhs).unwrap();
    let alpha = Vector3::new(found[3], found[4], found[5]);
    let mut speeds = [0.0; WHEELS];
    for (j, wheel) in of.wheels.iter().enumerate().take(of.wheel_count) {
        speeds[j] = motors[j] / wheel.spin_inertia - Vector3::from(wheel.axis_B).dot(&alpha);
    }
    Accelerations {
        a: Vector3::new(found[0], found[1], found[2]),
        alpha,
        speeds,
        swing: (0..n).map(|k| found[6 + k]).collect(),
    }
}

/// Rates of a state, and the acceleration of `Bo` in N.
struct Rates {
    turn: Vector3<f64>,
    v: Vector3<f64>,
    a: Vector3<f64>,
    alpha: Vector3<f64>,
    speeds: [f64; WHEELS],
    swing: Vec<[f64; 2]>,
}

fn rates(truth: &Truth, of: &Configuration, x: &State, k: usize) -> Rates {
    let found = accelerations(truth, of, x, k);
    let swing = x.swing.iter().zip(&found.swing);
    Rates {
        turn: x.w,
        v: x.v,
        a: x.R * found.a,
        alpha: found.alpha,
        speeds: found.speeds,
        swing: swing.map(|([_, rate], a)| [*rate, *a]).collect(),
    }
}

fn after(x: &State, r: &Rates, dt: f64) -> State {
    let swing = x.swing.iter().zip(&r.swing);
    State {
        R: x.R * UnitQuaternion::from_scaled_axis(r.turn * dt),
        p: x.p + r.v * dt,
        v: x.v + r.a * dt,
        w: x.w + r.alpha * dt,
        speeds: std::array::from_fn(|j| x.speeds[j] + r.speeds[j] * dt),
        swing: swing
            .map(|([y, rate], [dy, a])| [y + dy * dt, rate + a * dt])
            .collect(),
    }
}

/// Runge-Kutta; the turn by the mean rate of Simpson's rule and its commutator (Magnus, fourth order).
fn step(truth: &Truth, of: &Configuration, x: &State, k: usize, dt: f64) -> State {
    let a = rates(truth, of, x, k);
    let b = rates(truth, of, &after(x, &a, 0.5 * dt), k);
    let c = rates(truth, of, &after(x, &b, 0.5 * dt), k);
    let d = rates(truth, of, &after(x, &c, dt), k);
    let vector = |f: fn(&Rates) -> Vector3<f64>| (f(&a) + (f(&b) + f(&c)) * 2.0 + f(&d)) / 6.0;
    let number = |f: &dyn Fn(&Rates) -> f64| (f(&a) + 2.0 * (f(&b) + f(&c)) + f(&d)) / 6.0;
    let mean = Rates {
        turn: vector(|r| r.turn) + a.turn.cross(&d.turn) * (dt / 12.0),
        v: vector(|r| r.v),
        a: vector(|r| r.a),
        alpha: vector(|r| r.alpha),
        speeds: std::array::from_fn(|j| number(&|r| r.speeds[j])),
        swing: (0..x.swing.len())
            .map(|k| [0, 1].map(|i| number(&|r| r.swing[k][i])))
            .collect(),
    };
    after(x, &mean, dt)
}

/// The motion at all samples.
pub fn motions(truth: &Truth, configuration: &Configuration) -> Vec<Motion> {
    let steps = (truth.dt / STEP).ceil() as usize;
    let start = &truth.start;
    let mut x = State {
        R: start.R,
        p: start.p - start.R * truth.c,
        v: start.v - start.R * start.w.cross(&truth.c),
        w: start.w,
        speeds: start.speeds,
        swing: truth.sprung.iter().map(|s| s.start).collect(),
    };
    let seen = |x: &State| Motion {
        R: x.R,
        w: x.w,
        speeds: x.speeds,
        p: x.p + x.R * truth.c,
        ..*start
    };
    let mut out = vec![seen(&x)];
    for k in 1..truth.samples {
        for _ in 0..steps {
            x = step(truth, configuration, &x, k - 1, truth.dt / steps as f64);
        }
        out.push(seen(&x));
    }
    out
}
