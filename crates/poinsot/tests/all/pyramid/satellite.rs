//! A satellite with four wheels in a pyramid, whose torque commands change every half second.
//!
//! Between commands the torque on each wheel is constant, so its axial momentum `Js (Omega + a . w)` is linear in time
//! and exact. The body is integrated by Runge-Kutta with steps of at most 20 ms.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use poinsot_model::{Model, parse_model};
use poinsot_telemetry::{Channel, Table};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// True central inertia, kg m2.
pub const TRUTH: [f64; 6] = [61.2, 1.3, 74.5, -2.1, 0.8, 88.9];
const SPIN: f64 = 0.05;
/// Time between commands, s.
const COMMAND: f64 = 0.5;
const STEP: f64 = 0.02;
const GYRO: f64 = 1.0e-5;
const TRACKER: f64 = 2.0e-5;
pub const TACHOMETER: f64 = 0.05;

/// Measurements and wheel commands.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Tachometer samples per second.
    pub tachometer_hz: f64,
    /// Error of each tachometer time, relative to the step.
    pub jitter: f64,
    /// Six rest-to-rest slews, or sums of sines.
    pub slews: bool,
    /// Step of rounded tachometers, rad/s; zero for white noise.
    pub rounding: f64,
    /// First and last second of a gap in the first wheel's column.
    pub gap: Option<(f64, f64)>,
    pub duration_s: f64,
    pub torque: Torque,
    /// Measurements without noise, of the model's own body.
    pub exact: bool,
}

/// Columns of the motor torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Torque {
    Absent,
    /// Commands with their times.
    Commanded,
    /// Measured at a clock of its own, so often a second.
    Measured(u32),
}

/// Error of the torque's scale, its offset in N m, and its noise in N m where it is measured.
const SCALE: f64 = 1.03;
const OFFSET: f64 = 2.0e-3;
const TORQUE: f64 = 2.0e-4;

pub const PLAIN: Case = Case {
    tachometer_hz: 2.0,
    jitter: 0.1,
    slews: false,
    rounding: 0.0,
    gap: None,
    duration_s: 200.0,
    torque: Torque::Absent,
    exact: false,
};

/// Axes of the wheels, one per column.
fn axes() -> [Vector3<f64>; 4] {
    let (c, s) = (0.8, 0.6);
    let all = [(c, 0.0), (0.0, c), (-c, 0.0), (0.0, -c)];
    all.map(|(x, y)| Vector3::new(x, y, s))
}

pub fn model(case: &Case) -> Model {
    let mut text = format!(
        r#"schema = "poinsot.model/1"
exact = true
name = "pyramid"
[[body]]
name = "bus"
mass_kg = 312.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = {{ xx = 58.0, yy = 78.0, zz = 86.0 }}
estimate = ["inertia"]
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = {GYRO}
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = {TRACKER}
[[sensor]]
name = "tachometers"
type = "wheel_speed"
"#
    );
    match case.rounding > 0.0 {
        true => text.push_str(&format!("quantisation_rad_s = {}\n", case.rounding)),
        false => text.push_str(&format!("noise_rad_s = {TACHOMETER}\n")),
    }
    for (k, a) in axes().iter().enumerate() {
        text.push_str(&format!(
            "[[wheel]]\nname = \"wheel{}\"\nbody = \"bus\"\naxis = [{}, {}, {}]\nspin_inertia_kg_m2 = {SPIN}\n",
            k + 1, a.x, a.y, a.z
        ));
    }
    if case.exact {
        let [xx, xy, yy, xz, yz, zz] = TRUTH;
        let own = format!("{{ xx = {xx}, yy = {yy}, zz = {zz}, xy = {xy}, xz = {xz}, yz = {yz} }}");
        text = text.replace("{ xx = 58.0, yy = 78.0, zz = 86.0 }", &own);
    }
    parse_model(&text, "pyramid.toml").unwrap()
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

/// Torque on the wheels in each command interval.
fn commands(case: &Case, random: &mut ChaCha8Rng, count: usize) -> Vec<[f64; 4]> {
    let uniform = |random: &mut ChaCha8Rng, a: f64, b: f64| random.random_range(a..b);
    let jitter = 1.0e-3;
    if case.slews {
        let span = case.duration_s / 6.0;
        let slews: Vec<Vector3<f64>> = (0..6)
            .map(|_| {
                Vector3::from_fn(|_, _| normal(random)).normalize() * uniform(random, 0.06, 0.1)
            })
            .collect();
        return (0..count)
            .map(|i| {
                let t = i as f64 * COMMAND;
                let at = ((t / span) as usize).min(5);
                let share = (t - at as f64 * span) / span;
                // Forward, coast, back, rest.
                let level = match share {
                    x if x < 0.25 => 1.0,
                    x if x < 0.4 => 0.0,
                    x if x < 0.65 => -1.0,
                    _ => 0.0,
                };
                let wanted = slews[at] * level;
                std::array::from_fn(|w| {
                    let own = axes()[w].dot(&wanted) * 0.5;
                    own + 0.1 * jitter * normal(random)
                })
            })
            .collect();
    }
    let tones: Vec<Vec<[f64; 3]>> = (0..4)
        .map(|_| {
            (0..3)
                .map(|_| {
                    [
                        uniform(random, 0.01, 0.04),
                        uniform(random, 0.05, 0.4),
                        // The published seeds were drawn with these digits.
                        uniform(random, 0.0, 628.0 / 100.0),
                    ]
                })
                .collect()
        })
        .collect();
    (0..count)
        .map(|i| {
            let t = i as f64 * COMMAND;
            std::array::from_fn(|w| {
                let sum = tones[w]
                    .iter()
                    .map(|[a, f, p]| a * (f * t + p).sin())
                    .sum::<f64>();
                sum + jitter * normal(random)
            })
        })
        .collect()
}

struct Body {
    inertia: Matrix3<f64>,
    /// Momentum of the vehicle, in N.
    momentum: Vector3<f64>,
    inverse: Matrix3<f64>,
}

impl Body {
    /// Rate from attitude and axial speeds `Omega + a . w`.
    fn rate(&self, R: &UnitQuaternion<f64>, speeds: &[f64; 4]) -> Vector3<f64> {
        let wheels = axes()
            .iter()
            .zip(speeds)
            .map(|(a, s)| a * (SPIN * s))
            .sum::<Vector3<f64>>();
        self.inverse * (R.inverse() * self.momentum - wheels)
    }
}

/// Telemetry of one seed.
pub fn table(case: &Case, seed: u64) -> Table {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let phase = random.random_range(0.0..COMMAND);
    let count = (case.duration_s / COMMAND) as usize + 3;
    let torques = commands(case, &mut random, count);
    // Axial speeds at the command times.
    let mut nodes = vec![[0.0; 4]];
    for (w, speed) in nodes[0].iter_mut().enumerate() {
        *speed = 100.0 + 20.0 * w as f64 + 10.0 * normal(&mut random);
    }
    for torque in &torques {
        let last = nodes[nodes.len() - 1];
        nodes.push(std::array::from_fn(|w| {
            last[w] + torque[w] / SPIN * COMMAND
        }));
    }
    let speeds = |t: f64| -> [f64; 4] {
        let at = (t + phase) / COMMAND;
        let i = at as usize;
        std::array::from_fn(|w| nodes[i][w] + (at - i as f64) * (nodes[i + 1][w] - nodes[i][w]))
    };
    let I = Matrix3::new(
        TRUTH[0], TRUTH[1], TRUTH[3], TRUTH[1], TRUTH[2], TRUTH[4], TRUTH[3], TRUTH[4], TRUTH[5],
    );
    let rotors: Matrix3<f64> = axes().iter().map(|a| a * a.transpose() * SPIN).sum();
    let mut body = Body {
        inertia: I - rotors,
        momentum: Vector3::zeros(),
        inverse: Matrix3::identity(),
    };
    body.inverse = body.inertia.try_inverse().unwrap();
    let mut R = UnitQuaternion::identity();
    let wheels: Vector3<f64> = axes()
        .iter()
        .zip(speeds(0.0))
        .map(|(a, s)| a * (SPIN * s))
        .sum();
    let tumble = if case.slews { 0.0 } else { 1.0e-2 };
    body.momentum = wheels + body.inertia * Vector3::new(tumble, -tumble, 0.5 * tumble);

    let noise = if case.exact { 0.0 } else { 1.0 };
    let range = |step: f64, from: f64| -> Vec<f64> {
        let n = ((case.duration_s - from) / step) as usize;
        (0..=n).map(|k| from + k as f64 * step).collect()
    };
    let gyro = range(0.5, 0.0);
    let tracker = range(1.0, 0.3);
    let h = 1.0 / case.tachometer_hz;
    let first = -h * random.random_range(0.05..0.95);
    let tachometer: Vec<f64> = (0..)
        .map(|k| first + k as f64 * h)
        .take_while(|t| *t < case.duration_s + h)
        .map(|t| t + h * case.jitter * random.random_range(-0.5..0.5))
        .collect();
    let mut events: Vec<f64> = gyro
        .iter()
        .chain(&tracker)
        .chain(&tachometer)
        .copied()
        .collect();
    let knots = (0..count).map(|k| k as f64 * COMMAND - phase);
    events.extend(knots);
    events.retain(|t| (0.0..=case.duration_s).contains(t));
    events.sort_by(f64::total_cmp);
    let (mut omega, mut q) = (vec![Vec::new(); 3], vec![Vec::new(); 4]);
    let mut rates: Vec<(f64, Vector3<f64>)> = Vec::new();
    let mut now = 0.0;
    for t in events {
        let steps = ((t - now) / STEP).ceil().max(1.0);
        let dt = (t - now) / steps;
        for k in 0..steps as usize {
            let at = now + k as f64 * dt;
            R = stepped(&body, &R, &speeds, at, dt);
        }
        now = t;
        let w = body.rate(&R, &speeds(t));
        rates.push((t, w));
        if gyro.contains(&t) {
            for k in 0..3 {
                omega[k].push(w[k] + noise * GYRO * normal(&mut random));
            }
        }
        if tracker.contains(&t) {
            let off = Vector3::from_fn(|_, _| noise * TRACKER * normal(&mut random));
            let measured = R * UnitQuaternion::from_scaled_axis(off);
            for (column, value) in q.iter_mut().zip(measured.coords.iter()) {
                column.push(*value);
            }
        }
    }
    let rate_at = |t: f64| {
        let i = rates.partition_point(|r| r.0 < t).min(rates.len() - 1);
        rates[i].1
    };
    let mut channels = Vec::new();
    for (axis, values) in ["x", "y", "z"].iter().zip(omega) {
        add(&mut channels, format!("omega_{axis}"), &gyro, values);
    }
    for (axis, values) in ["x", "y", "z", "w"].iter().zip(q) {
        add(&mut channels, format!("q_{axis}"), &tracker, values);
    }
    for w in 0..4 {
        let kept: Vec<f64> = tachometer
            .iter()
            .copied()
            .filter(|t| (0.0..=case.duration_s).contains(t))
            .filter(|t| w > 0 || !case.gap.is_some_and(|g| *t > g.0 && *t < g.1))
            .collect();
        let read = |t: &f64| {
            let own = speeds(*t)[w] - axes()[w].dot(&rate_at(*t));
            match case.rounding > 0.0 {
                true => (own / case.rounding).round() * case.rounding,
                false => own + noise * TACHOMETER * normal(&mut random),
            }
        };
        let values = kept.iter().map(read).collect();
        add(
            &mut channels,
            format!("wheel{}_rad_s", w + 1),
            &kept,
            values,
        );
    }
    let (start, step) = match case.torque {
        Torque::Absent => (0.0, f64::INFINITY),
        Torque::Commanded => (COMMAND - phase, COMMAND),
        Torque::Measured(hz) => {
            let step = 1.0 / f64::from(hz);
            (step * random.random_range(0.0..1.0), step)
        }
    };
    let read: Vec<f64> = (0..)
        .map(|k| start + f64::from(k) * step)
        .take_while(|t| *t <= case.duration_s)
        .collect();
    let noise = match case.torque {
        Torque::Measured(_) => TORQUE,
        _ => 0.0,
    };
    let wheels = if case.torque == Torque::Absent { 0 } else { 4 };
    for w in 0..wheels {
        let value = |t: &f64| {
            // At its own time a command is the new one.
            let now = torques[((t + phase) / COMMAND + 1.0e-9) as usize];
            SCALE * now[w] + OFFSET + noise * normal(&mut random)
        };
        let values = read.iter().map(value).collect();
        add(&mut channels, format!("wheel{}_Nm", w + 1), &read, values);
    }
    Table {
        channels,
        ..Table::default()
    }
}

fn add(channels: &mut Vec<Channel>, name: String, time_s: &[f64], values: Vec<f64>) {
    channels.push(Channel {
        name,
        time_s: time_s.into(),
        values,
        ..Channel::default()
    });
}

fn stepped(
    body: &Body,
    R: &UnitQuaternion<f64>,
    speeds: &impl Fn(f64) -> [f64; 4],
    t: f64,
    dt: f64,
) -> UnitQuaternion<f64> {
    // An event at a command time belongs to the end of the previous interval.
    let [a, m, b] = [0.0, 0.5, 1.0].map(|s| speeds(t + s * dt));
    let turned = |w: &Vector3<f64>, dt: f64| R * UnitQuaternion::from_scaled_axis(w * dt);
    let k1 = body.rate(R, &a);
    let k2 = body.rate(&turned(&k1, 0.5 * dt), &m);
    let k3 = body.rate(&turned(&k2, 0.5 * dt), &m);
    let k4 = body.rate(&turned(&k3, dt), &b);
    // Commutators over 20 ms are below 1e-9 rad.
    turned(&((k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0), dt)
}
