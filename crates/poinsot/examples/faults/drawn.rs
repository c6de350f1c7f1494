//! Faults of random size on three vehicles: whether each is detected and named correctly.
//!
//! The chi-square that a fault leaves in a fit to samples without noise is its squared effect on the predictions,
//! projected clear of all fitted numbers. The smallest size detectable at five sigma reaches the chance of five sigma in
//! half of the records, with the numbers of its hypothesis and the times at which it is tried: 25 for one number. A
//! trial draws its size between once and ten times that, each as likely.

use super::planted::{Said, diagnosed};
use nalgebra::{Quaternion, UnitQuaternion};
use poinsot::Error;
use poinsot::bind::bind;
use poinsot::case::{parse_case, read_case};
use poinsot::trials::Study;
use poinsot_dynamics::Tree;
use poinsot_identify::{Diagnostics, FaultKind, Suspect, maximum_likelihood};
use poinsot_model::{Model, Orbit, Propellant, read_model};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{STANDARD_GRAVITY, Table};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Chance of a deviation of five sigma, to either side.
const FIVE_SIGMA: f64 = 5.733e-7;
/// Chi-square from which the numbers of a hypothesis are sure to be printed.
const PLAIN: f64 = 400.0;
/// Largest size, relative to the smallest detectable one.
const LARGEST: f64 = 10.0;
/// Share of a record before an attitude jumps.
const JUMP: f64 = 0.46;
/// Gravitational parameter of the Earth, m3/s2.
const EARTH: f64 = 3.986_004_418e14;

/// Vehicle of a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Craft {
    /// One rigid body with three wheels and thrusters, 80 s.
    Satellite,
    /// A base with a two-link arm and three wheels, 80 s.
    Arm,
    /// Four wheels in a pyramid, 900 s.
    LowOrbit,
}

impl Craft {
    pub const ALL: [Self; 3] = [Self::Satellite, Self::Arm, Self::LowOrbit];

    pub fn words(self) -> &'static str {
        match self {
            Self::Satellite => "satellite",
            Self::Arm => "two-link arm",
            Self::LowOrbit => "low orbit",
        }
    }

    fn path(self) -> PathBuf {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        match self {
            Self::Satellite => root.join("../../data/cases/faults.toml"),
            Self::Arm => root.join("examples/faults/cases/two_link_arm.toml"),
            Self::LowOrbit => root.join("examples/faults/cases/low_orbit.toml"),
        }
    }

    /// The experiment with a modified true vehicle; `from` is replaced by `to` in the case.
    fn study(
        self,
        change: impl Fn(&mut Model),
        replace: Option<(&str, &str)>,
    ) -> Result<Study, Error> {
        let path = self.path();
        let mut case = read_case(&path).map_err(poinsot::simulate::SimulateError::from)?;
        if let Some((from, to)) = replace {
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            case = parse_case(&path, text.replace(from, to))
                .map_err(poinsot::simulate::SimulateError::from)?;
        }
        if self == Self::Satellite {
            case.rate_hz = RATE_HZ;
        }
        let nominal = read_model(&case.model)?;
        let mut truth = nominal.clone();
        change(&mut truth);
        let mut model = nominal;
        for body in model.bodies.iter_mut().filter(|b| b.estimate.any()) {
            body.nominal.I_BBcm_B *= 0.93;
            if body.estimate.mass {
                body.nominal.mass *= 1.05;
                body.nominal.p_BoBcm_B += Vector3::new(0.01, -0.01, 0.015);
            }
        }
        Study::of_case(&case, &truth, model)
    }
}

/// Rate of the satellite's record, 1/s.
const RATE_HZ: f64 = 10.0;

/// How a fault is introduced.
#[derive(Clone, Copy)]
pub enum Way {
    /// In the true vehicle.
    Vehicle(fn(&mut Model, f64)),
    /// In the ideal measurements.
    Exact(fn(&mut Table, f64)),
    /// In the noisy measurements.
    Read(fn(&mut Table, f64, &mut ChaCha8Rng)),
    /// The second half has the motion of another initial state.
    Joined,
    /// A wheel that stores momentum.
    Stored,
}

pub struct Fault {
    pub words: &'static str,
    pub craft: Craft,
    /// Correct names; empty if no alarm is wanted.
    pub names: &'static [FaultKind],
    /// Text required in the sentence.
    pub culprit: &'static str,
    /// A small size, with its unit; random unless `fixed`.
    pub size: (f64, &'static str),
    pub fixed: bool,
    pub way: Way,
}

/// Result of the trials of one fault.
pub struct Tally {
    /// Smallest size detectable at five sigma.
    pub noticeable: f64,
    pub trials: u64,
    pub noticed: usize,
    /// Named correctly, alone or with causes that the data cannot distinguish; then, alone.
    pub named: usize,
    pub alone: usize,
    /// Another cause was named.
    pub wrong: usize,
    /// The same counts for at least twice the smallest size.
    pub large: (usize, usize),
    pub firsts: BTreeMap<String, usize>,
    /// Largest and mean CPU time of a fit with its diagnosis, s; exact with one thread.
    pub seconds: (f64, f64),
}

/// CPU time of this thread, s; zero if unknown.
fn processor_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.unwrap_or(0.0) * 1.0e-9
}

/// CPU time of a fit without its diagnosis, and with it, s.
pub fn times(craft: Craft) -> Result<[f64; 2], Error> {
    let study = craft.study(|_| {}, None)?;
    let (tables, biases) = study.draw(0);
    let truth = study.true_numbers(&biases);
    let timed = |diagnose: bool| -> Result<f64, Error> {
        let start = processor_s();
        study.answer(&tables, &truth, &study.question, diagnose)?;
        Ok(processor_s() - start)
    };
    Ok([timed(false)?, timed(true)?])
}

/// Trials of one fault, in parallel.
pub fn tally(fault: &Fault, trials: u64) -> Result<Tally, Error> {
    let noticeable = noticeable(fault)?;
    let clean = study_at(fault, 0.0)?;
    let run = |trial: u64| -> Result<(f64, Vec<Said>, f64), Error> {
        let mut rng = ChaCha8Rng::seed_from_u64(0x000d_4a31);
        rng.set_stream(trial);
        let factor = 1.0 + (LARGEST - 1.0) * rng.random::<f64>();
        let size = match fault.fixed || !noticeable.is_finite() {
            true => fault.size.0,
            false => noticeable * factor,
        };
        let study = match fault.way {
            Way::Read(_) => clean.clone(),
            _ => study_at(fault, size)?,
        };
        let (mut tables, _) = study.draw(trial);
        if let Way::Read(plant) = fault.way {
            tables.iter_mut().for_each(|t| plant(t, size, &mut rng));
        }
        let start = processor_s();
        let said = diagnosed(&study, &tables);
        let said = said.map_or_else(|e| vec![Said::error(e)], |s| s.0);
        Ok((factor, said, processor_s() - start))
    };
    let all: Vec<Result<_, Error>> = (0..trials).into_par_iter().map(run).collect();
    let mut out = Tally {
        noticeable,
        trials,
        noticed: 0,
        named: 0,
        alone: 0,
        wrong: 0,
        large: (0, 0),
        firsts: BTreeMap::new(),
        seconds: (0.0, 0.0),
    };
    for one in all {
        let (factor, said, seconds) = one?;
        out.seconds.0 = out.seconds.0.max(seconds);
        out.seconds.1 += seconds / trials as f64;
        let large = fault.fixed || factor >= 2.0;
        out.large.1 += usize::from(large);
        let Some(first) = said.first() else {
            continue;
        };
        out.noticed += 1;
        *out.firsts.entry(first.names.join("|")).or_insert(0) += 1;
        let is = |name: &String| fault.names.iter().any(|f| f.name() == name);
        let right = first.names.iter().any(is) && first.text.contains(fault.culprit);
        out.named += usize::from(right);
        out.alone += usize::from(right && first.names.iter().all(is));
        out.large.0 += usize::from(right && large);
        out.wrong += usize::from(!right);
    }
    Ok(out)
}

/// The smallest size detectable at five sigma.
fn noticeable(fault: &Fault) -> Result<f64, Error> {
    let (small, _) = fault.size;
    if matches!(fault.way, Way::Read(_)) || fault.names.is_empty() {
        return Ok(f64::NAN);
    }
    let left = |size: f64| -> Result<Diagnostics, Error> {
        let study = study_at(fault, size)?;
        let tree = Tree::new(&study.model);
        let bound = bind(&study.model, &tree, &study.exact)?;
        let estimate = maximum_likelihood(&bound.problem(&study.model, &tree))?;
        Ok(estimate.diagnostics.unwrap_or_default())
    };
    let chi2 = left(small)?.chi2;
    let plain = left(small * (PLAIN / chi2).sqrt())?;
    let is = |s: &&Suspect| fault.names.contains(&s.fault) && s.name.contains(fault.culprit);
    let own = plain.suspects.iter().find(is);
    let (numbers, times) = own.map_or((1, 1), |s| (s.numbers, s.times));
    Ok(small * (detectable(numbers, times) / chi2).sqrt())
}

/// Chi-square without noise of a fault that reaches the chance of five sigma in half of the records.
fn detectable(numbers: usize, times: usize) -> f64 {
    let numbers = numbers as f64;
    let chi2 = ChiSquared::new(numbers).map(|c| c.inverse_cdf(1.0 - FIVE_SIGMA / times as f64));
    // Noise adds the degrees of freedom less one to the median, nearly.
    chi2.map_or(f64::NAN, |chi2| chi2 - (numbers - 1.0))
}

/// The experiment with a fault of this size in the vehicle or in the ideal measurements.
fn study_at(fault: &Fault, size: f64) -> Result<Study, Error> {
    let plain = |_: &mut Model| {};
    match fault.way {
        Way::Vehicle(change) if size != 0.0 => fault.craft.study(|m| change(m, size), None),
        Way::Exact(change) if size != 0.0 => {
            let mut study = fault.craft.study(plain, None)?;
            study.exact.iter_mut().for_each(|t| change(t, size));
            Ok(study)
        }
        Way::Stored => {
            let fast = "speed_rad_s = [500.0, 380.0, 560.0, 640.0, 500.0]";
            let slow = "speed_rad_s = [0.0, -120.0, 60.0, 140.0, 0.0]";
            fault.craft.study(plain, Some((slow, fast)))
        }
        Way::Joined => {
            let mut study = fault.craft.study(plain, None)?;
            let start = format!("omega_rad_s = [{}, -0.015, 0.02]", 0.01 + size);
            let other = Some(("omega_rad_s = [0.01, -0.015, 0.02]", start.as_str()));
            let second = fault.craft.study(plain, other)?;
            for (table, second) in study.exact.iter_mut().zip(&second.exact) {
                for (channel, new) in table.channels.iter_mut().zip(&second.channels) {
                    let half = channel.values.len() / 2;
                    channel.values[half..].copy_from_slice(&new.values[half..]);
                }
            }
            Ok(study)
        }
        _ => fault.craft.study(plain, None),
    }
}

fn each(table: &mut Table, prefix: &str, mut change: impl FnMut(f64, &mut f64)) {
    let own = table
        .channels
        .iter_mut()
        .filter(|c| c.name.starts_with(prefix));
    for channel in own {
        let times = Arc::clone(&channel.time_s);
        for (t, x) in times.iter().zip(&mut channel.values) {
            change(*t, x);
        }
    }
}

/// Rotates every attitude after a time, in body axes.
fn turn(table: &mut Table, from_s: f64, angle: Vector3) {
    let at = |name: &str| table.channels.iter().position(|c| c.name == name);
    let (Some(x), Some(y), Some(z), Some(w)) = (at("q_x"), at("q_y"), at("q_z"), at("q_w")) else {
        return;
    };
    for k in 0..table.channels[x].values.len() {
        if table.channels[x].time_s[k] < from_s {
            continue;
        }
        let value = |c: usize| table.channels[c].values[k];
        let q = UnitQuaternion::from_quaternion(Quaternion::new(
            value(w),
            value(x),
            value(y),
            value(z),
        ));
        let q = q * UnitQuaternion::from_scaled_axis(angle);
        for (c, v) in [(x, q.i), (y, q.j), (z, q.k), (w, q.w)] {
            table.channels[c].values[k] = v;
        }
    }
}

/// Adds the acceleration of a tide of this strength, 1/s2, to positions and velocities.
fn tide(table: &mut Table, strength: f64) {
    for (axis, factor) in [("x", 2.0), ("y", -1.0), ("z", -1.0)] {
        let name = format!("r_{axis}");
        let Some(r) = table.channels.iter().find(|c| c.name == name) else {
            continue;
        };
        let (t, p) = (Arc::clone(&r.time_s), r.values.clone());
        let (mut moved, mut speed) = (vec![0.0; t.len()], vec![0.0; t.len()]);
        for k in 1..t.len() {
            let h = t[k] - t[k - 1];
            let a = strength * factor * (p[k - 1] + moved[k - 1]);
            speed[k] = speed[k - 1] + a * h;
            moved[k] = moved[k - 1] + speed[k - 1] * h + 0.5 * a * h * h;
        }
        for (prefix, change) in [("r_", &moved), ("v_", &speed)] {
            let name = format!("{prefix}{axis}");
            let own = table.channels.iter_mut().filter(|c| c.name == name);
            for channel in own {
                channel
                    .values
                    .iter_mut()
                    .zip(change)
                    .for_each(|(x, d)| *x += d);
            }
        }
    }
}

/// Samples at times with an error relative to the interval.
fn jitter(table: &mut Table, share: f64, rng: &mut ChaCha8Rng) {
    let channels = table.channels.iter_mut();
    let gyro: Vec<_> = channels.filter(|c| c.name.starts_with("omega_")).collect();
    let samples = gyro.first().map_or(0, |c| c.values.len());
    let late: Vec<f64> = (0..samples)
        .map(|_| share * 3.0_f64.sqrt() * (2.0 * rng.random::<f64>() - 1.0))
        .collect();
    for channel in gyro {
        let old = channel.values.clone();
        for k in 1..samples.saturating_sub(1) {
            let slope = 0.5 * (old[k + 1] - old[k - 1]);
            channel.values[k] += slope * late[k];
        }
    }
}

/// Moves the link behind its drive by half the backlash.
fn backlash(table: &mut Table, play: f64) {
    let rate = table
        .channels
        .iter()
        .find(|c| c.name.starts_with("elbow") && c.unit == "rad/s");
    let Some(rates) = rate.map(|c| c.values.clone()) else {
        return;
    };
    let own = table.channels.iter_mut();
    for channel in own.filter(|c| c.name.starts_with("elbow") && c.unit == "rad") {
        let pairs = channel.values.iter_mut().zip(&rates);
        pairs.for_each(|(x, rate)| *x += 0.5 * play * rate.signum());
    }
}

/// Every fault on every applicable vehicle.
pub fn faults() -> Vec<Fault> {
    const DRAWN: bool = false;
    const FIXED: bool = true;
    use Craft::{Arm, LowOrbit, Satellite};
    use FaultKind as F;
    use Way::{Exact, Joined, Read, Vehicle};
    let row = |(words, names, culprit, size, fixed, way), craft| Fault {
        words,
        craft,
        names,
        culprit,
        size,
        fixed,
        way,
    };
    #[rustfmt::skip]
    let everywhere: [Row; 8] = [
        ("wheel tilt", &[F::WheelTilt], "wheel2", (1.0e-4, "rad"), DRAWN, Vehicle(tilt)),
        ("spin inertia", &[F::WheelScale, F::KnownNumber], "wheel2", (1.0e-4, "1"), DRAWN, Vehicle(spin)),
        ("tracker misalignment", &[F::TrackerMisalignment], "attitude", (1.0e-4, "rad"), DRAWN, Exact(|t, e| turn(t, f64::NEG_INFINITY, turned(e)))),
        ("gyro bias drift", &[F::BiasDrift], "gyro", (1.0e-7, "rad/s2"), DRAWN, Exact(|t, e| each(t, "omega_y", |s, x| *x += e * s))),
        ("gyro scale", &[F::GyroScale], "gyro", (1.0e-4, "1"), DRAWN, Exact(|t, e| each(t, "omega_", |_, x| *x *= 1.0 + e))),
        ("attitude jump", &[F::AttitudeJump], "attitude", (1.0e-5, "rad"), DRAWN, Exact(|t, e| turn(t, halfway(t), turned(e)))),
        ("time jitter 20 %", &[F::TimeJitter], "gyro", (0.2, "of an interval"), FIXED, Read(jitter)),
        ("rounded gyro", &[F::Quantisation], "gyro", (3.0e-4, "rad/s"), FIXED, Read(|t, e, _| each(t, "omega_", |_, x| *x = (*x / e).round() * e))),
    ];
    #[rustfmt::skip]
    let some: [(Row, Craft); 12] = [
        (("early attitude jump", &[F::AttitudeJump], "attitude", (1.0e-5, "rad"), DRAWN, Exact(|t, e| turn(t, 37.0, turned(e)))), LowOrbit),
        (("propellant use", &[F::PropellantUse], "bus", (1.0e-4, "kg/(N s)"), DRAWN, Vehicle(propellant)), Satellite),
        (("joined record", &[F::JoinedRecord], "", (1.0e-5, "rad/s"), DRAWN, Joined), Satellite),
        (("joined record", &[F::JoinedRecord], "", (1.0e-5, "rad/s"), DRAWN, Joined), Arm),
        (("tide", &[F::Tide], "", (1.0e-6, "1/s2"), DRAWN, Exact(tide)), Satellite),
        (("firing missing from telemetry", &[F::Firing], "", (1.0, "firing"), FIXED, Exact(|t, _| thrust(t, 0.0..20.0, 0.0))), Satellite),
        (("firing that did not happen", &[F::Firing], "thr2 at", (1.0, "firing"), FIXED, Exact(|t, _| thrust(t, 40.0..41.0, 5.0))), Satellite),
        (("backlash", &[F::Backlash], "elbow", (1.0e-4, "rad"), DRAWN, Exact(backlash)), Arm),
        (("link mass", &[F::KnownNumber], "upper.mass", (1.0e-3, "1"), DRAWN, Vehicle(|m, e| m.bodies[1].nominal.mass *= 1.0 + e)), Arm),
        (("joint origin", &[F::KnownNumber], "shoulder.origin", (1.0e-4, "m"), DRAWN, Vehicle(|m, e| m.joints[0].p_PoCo_P += Vector3::new(0.3, 0.8, -0.5) * e)), Arm),
        (("gravity gradient", &[F::GravityGradient], "", (1.0, "of 600 km"), FIXED, Vehicle(gravity_gradient)), LowOrbit),
        (("reversed wheel", &[F::WheelSign], "wheel2", (1.0, "sign"), FIXED, Exact(|t, _| each(t, "wheel2_rad_s", |_, x| *x = -*x))), LowOrbit),
    ];
    let on = |craft| everywhere.map(|fault| row(fault, craft));
    let all = Craft::ALL.into_iter().flat_map(on);
    all.chain(some.map(|(fault, craft)| row(fault, craft)))
        .collect()
}

/// Description, names, required text, size, whether it is fixed, way.
type Row = (
    &'static str,
    &'static [FaultKind],
    &'static str,
    (f64, &'static str),
    bool,
    Way,
);

fn tilt(m: &mut Model, angle: f64) {
    let a = m.wheels[1].axis_B;
    let across = Vector3::new(0.8, 0.1, 0.6).cross(&a).normalize();
    m.wheels[1].axis_B = (a + across * angle).normalize();
}

/// Mass that the thrusters use per impulse, from a tank beside the mass centre.
fn propellant(m: &mut Model, used: f64) {
    for thruster in &mut m.thrusters {
        let c = m.bodies[thruster.body].nominal.p_BoBcm_B;
        thruster.propellant = Some(Propellant {
            specific_impulse: 1.0 / (STANDARD_GRAVITY * used),
            p_BoF_B: c + Vector3::new(0.1, -0.2, 0.05),
        });
    }
}

/// Somewhat before half of a record, s.
fn halfway(table: &Table) -> f64 {
    let ends = table.channels.iter().filter_map(|c| c.time_s.last());
    JUMP * ends.copied().fold(0.0, f64::max)
}

fn spin(m: &mut Model, share: f64) {
    m.wheels[1].spin_inertia *= 1.0 + share;
}

fn turned(angle: f64) -> Vector3 {
    Vector3::new(0.6, -0.5, 0.62) * angle
}

/// Sets the measured thrust within a time range, N.
fn thrust(table: &mut Table, within_s: Range<f64>, force: f64) {
    each(table, "thr2_N", |s, x| {
        if within_s.contains(&s) {
            *x = force;
        }
    });
}

fn gravity_gradient(m: &mut Model, share: f64) {
    m.environment.point_mass_gm = Some(EARTH * share);
    m.environment.gravity_gradient = true;
    m.environment.orbit = Some(Orbit {
        semi_major_axis: 6.978e6,
        eccentricity: 0.0,
        inclination: 0.9,
        raan: 0.4,
        argument_of_periapsis: 0.2,
        true_anomaly: -0.3,
        epoch: 0.0,
    });
}

/// Vehicles without a fault; the last satellite has stored momentum.
pub fn clean() -> Vec<Fault> {
    let fault = |words, craft, way| Fault {
        words,
        craft,
        names: &[],
        culprit: "",
        size: (1.0, ""),
        fixed: true,
        way,
    };
    let none: fn(&mut Table, f64) = |_, _| {};
    let mut list: Vec<Fault> = Craft::ALL
        .map(|craft| fault("none", craft, Way::Exact(none)))
        .into();
    list.push(fault("stored momentum", Craft::Satellite, Way::Stored));
    list
}
