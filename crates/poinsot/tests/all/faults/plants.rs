//! What a fault does to a vehicle, its sensors or its measurements.

use nalgebra::{Quaternion, UnitQuaternion};
use poinsot::trials::Study;
use poinsot_model::{Model, Orbit, Propellant, Sensor, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, STANDARD_GRAVITY, Table};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;
use std::sync::Arc;

/// Noise of the satellite's gyro, rad/s.
pub const GYRO_RAD_S: f64 = 5.0e-5;
/// Gravitational parameter of the Earth, m3/s2.
const EARTH: f64 = 3.986_004_418e14;

fn group<'a>(table: &'a mut Table, prefix: &'a str) -> impl Iterator<Item = &'a mut Channel> {
    let all = table.channels.iter_mut();
    all.filter(move |c| c.name.starts_with(prefix))
}

/// Changes the values, given their times.
pub fn each(table: &mut Table, prefix: &str, mut change: impl FnMut(f64, &mut f64)) {
    for channel in group(table, prefix) {
        let samples = channel.time_s.iter().zip(&mut channel.values);
        samples.for_each(|(t, x)| change(*t, x));
    }
}

pub fn scale(table: &mut Table, prefix: &str, factor: f64) {
    each(table, prefix, |_, x| *x *= factor);
}

pub fn exchange(table: &mut Table, [a, b]: [&str; 2]) {
    for channel in &mut table.channels {
        if channel.name == a {
            channel.name = b.to_owned();
        } else if channel.name == b {
            channel.name = a.to_owned();
        }
    }
}

/// Delays every value by one sample.
pub fn delay(table: &mut Table, prefix: &str) {
    for channel in group(table, prefix) {
        let times: Vec<f64> = channel.time_s[1..].to_vec();
        channel.values.truncate(times.len());
        channel.time_s = times.into();
    }
}

/// Delays the times of a slow sensor.
pub fn late(table: &mut Table, prefix: &str, by_s: f64) {
    for channel in group(table, prefix) {
        channel.time_s = channel.time_s.iter().map(|t| t + by_s).collect();
    }
}

/// Multiplies the noise of these sensors.
pub fn noise(sensors: &mut [Sensor], kind: SensorKind, factor: f64) {
    for sensor in sensors.iter_mut().filter(|s| s.kind == kind) {
        let covariance = sensor.noise_covariance;
        sensor.noise_covariance = covariance.map(|c| c * (factor * factor));
    }
}

pub fn sharp_and_late(study: &mut Study, kind: SensorKind, prefix: &str, by_s: f64) {
    noise(&mut study.sensors, kind, 0.1);
    noise(&mut study.model.sensors, kind, 0.1);
    let tables = study.exact.iter_mut();
    tables.for_each(|t| late(t, prefix, by_s));
}

/// Adds an error in a random direction to three of a hundred gyro samples.
pub fn outliers(table: &mut Table, size: f64, rng: &mut ChaCha8Rng) {
    let samples = table.channel("omega_x").map_or(0, |c| c.values.len());
    for k in 0..samples {
        if rng.random::<f64>() >= 0.03 {
            continue;
        }
        let error = Vector3::from_fn(|_, _| 2.0 * rng.random::<f64>() - 1.0).normalize() * size;
        for (channel, e) in group(table, "omega_").zip(error.iter()) {
            channel.values[k] += e;
        }
    }
}

/// Rotates every attitude after a time, in body axes.
pub fn turn(table: &mut Table, from_s: f64, angle: f64) {
    let turned = UnitQuaternion::from_scaled_axis(Vector3::new(0.6, -0.5, 0.62) * angle);
    let at = ["q_w", "q_x", "q_y", "q_z"].map(|name| {
        let found = table.channels.iter().position(|c| c.name == name);
        found.unwrap()
    });
    let times = Arc::clone(&table.channels[at[0]].time_s);
    for k in (0..times.len()).filter(|k| times[*k] >= from_s) {
        let [w, x, y, z] = at.map(|c| table.channels[c].values[k]);
        let q = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)) * turned;
        for (c, v) in at.into_iter().zip([q.w, q.i, q.j, q.k]) {
            table.channels[c].values[k] = v;
        }
    }
}

/// Adds the acceleration of a tide of this strength, 1/s2, to positions and velocities.
pub fn tide(table: &mut Table, strength: f64) {
    for (axis, factor) in [("x", 2.0), ("y", -1.0), ("z", -1.0)] {
        let r = table.channel(&format!("r_{axis}")).unwrap();
        let (t, p) = (Arc::clone(&r.time_s), r.values.clone());
        let (mut moved, mut speed) = (vec![0.0; t.len()], vec![0.0; t.len()]);
        for k in 1..t.len() {
            let h = t[k] - t[k - 1];
            let a = strength * factor * (p[k - 1] + moved[k - 1]);
            speed[k] = speed[k - 1] + a * h;
            moved[k] = moved[k - 1] + speed[k - 1] * h + 0.5 * a * h * h;
        }
        for (prefix, change) in [("r_", &moved), ("v_", &speed)] {
            let mut change = change.iter();
            let name = format!("{prefix}{axis}");
            each(table, &name, |_, x| *x += change.next().unwrap_or(&0.0));
        }
    }
}

/// Samples at times with an error relative to the interval.
pub fn jitter(table: &mut Table, share: f64, rng: &mut ChaCha8Rng) {
    let samples = table.channel("omega_x").map_or(0, |c| c.values.len());
    let late: Vec<f64> = (0..samples)
        .map(|_| share * 3.0_f64.sqrt() * (2.0 * rng.random::<f64>() - 1.0))
        .collect();
    for channel in group(table, "omega_") {
        let old = channel.values.clone();
        for k in 1..samples.saturating_sub(1) {
            channel.values[k] += 0.5 * (old[k + 1] - old[k - 1]) * late[k];
        }
    }
}

/// Moves the link behind its drive by half the backlash.
pub fn backlash(table: &mut Table, play: f64) {
    let of = |c: &Channel, unit| c.name.starts_with("elbow") && c.unit == unit;
    let rate = table.channels.iter().find(|c| of(c, "rad/s"));
    let rates = rate.unwrap().values.clone();
    for channel in table.channels.iter_mut().filter(|c| of(c, "rad")) {
        let pairs = channel.values.iter_mut().zip(&rates);
        pairs.for_each(|(x, rate)| *x += 0.5 * play * rate.signum());
    }
}

/// Sets the measured thrust within a time range, N.
pub fn thrust(table: &mut Table, within_s: Range<f64>, force: f64) {
    each(table, "thr2_N", |s, x| {
        if within_s.contains(&s) {
            *x = force;
        }
    });
}

/// Time of the last sample, s.
pub fn duration_s(table: &Table) -> f64 {
    let ends = table.channels.iter().filter_map(|c| c.time_s.last());
    ends.copied().fold(0.0, f64::max)
}

pub fn tilt(m: &mut Model, angle: f64) {
    let a = m.wheels[1].axis_B;
    let across = Vector3::new(0.8, 0.1, 0.6).cross(&a).normalize();
    m.wheels[1].axis_B = (a + across * angle).normalize();
}

/// Mass that the thrusters use per impulse, from a tank beside the mass centre.
pub fn propellant(m: &mut Model, used: f64) {
    for thruster in &mut m.thrusters {
        let c = m.bodies[thruster.body].nominal.p_BoBcm_B;
        thruster.propellant = Some(Propellant {
            specific_impulse: 1.0 / (STANDARD_GRAVITY * used),
            p_BoF_B: c + Vector3::new(0.1, -0.2, 0.05),
        });
    }
}

pub fn gravity_gradient(m: &mut Model, share: f64) {
    m.environment.point_mass_gm = Some(EARTH * share);
    m.environment.gravity_gradient = true;
    m.environment.orbit = Some(Orbit {
        semi_major_axis: 6.978e6,
        eccentricity: 0.0,
        inclination: 0.9,
        raan: 0.4,
        argument_of_periapsis: 0.2,
        true_anomaly: -0.3,
        epoch: None,
    });
}
