//! Converts orbital positions and velocities (from receivers and ephemerides) to values relative to free fall.
//!
//! N falls freely with the vehicle: its origin is `G(t)` with `G'' = g(r(t))`, the gravity at the vehicle. Then
//! `m (r - G)'' = F` holds with the vehicle's own forces, including tides, on any orbit and for any time. Noise of `r`
//! enters `G` multiplied by the gravity gradient, 1e-6 1/s2 in low orbit, and is negligible.

use super::sensors::HALF_WIDTH;
use crate::channel_names::{XYZ, axes};
use crate::error::{Error, unsupported};
use poinsot_files::rounded;
use poinsot_model::{Model, MomentumKnowledge, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table, differentiate, resample_hermite};
use std::borrow::Cow;
use std::sync::Arc;

/// Distance above which positions are orbital, m.
pub(super) const ORBITAL: f64 = 1.0e5;
/// Gravitational parameter of the Earth, m3/s2, its equatorial radius, m, and its oblateness (Petit and Luzum 2010,
/// IERS Conventions, table 1.1).
const EARTH_GM: f64 = 3.986_004_418e14;
const EARTH_RADIUS: f64 = 6_378_136.6;
const EARTH_J2: f64 = 1.082_635_9e-3;
/// Relative tolerance for a gravitational parameter of the Earth.
const SAME_BODY: f64 = 1.0e-3;
/// Gravity of the neglected harmonics above J2 in low orbit, m/s2: four times J3 times 9 m/s2.
const NEGLECTED: f64 = 1.0e-4;

/// Converts orbital positions and velocities of the tables to values relative to free fall.
///
/// # Errors
/// The linear momentum is given, which is not defined in freely falling axes.
pub(super) fn relative<'t>(
    model: &Model,
    tables: &'t [Table],
    repairs: &mut Vec<String>,
) -> Result<Cow<'t, [Table]>, Error> {
    let Some(gm) = model.environment.point_mass_gm else {
        return Ok(Cow::Borrowed(tables));
    };
    let mut out = Cow::Borrowed(tables);
    for (k, table) in tables.iter().enumerate() {
        let Some(fall) = FreeFall::of(model, table, gm) else {
            continue;
        };
        if matches!(model.momentum.linear, MomentumKnowledge::Known(_)) {
            let what = "[momentum] linear_N_s is given, but it has no meaning for positions relative to free fall";
            return Err(unsupported(what, "write linear_N_s = \"estimate\""));
        }
        repairs.push(format!("{}: {}", super::file_label(table), fall.words()));
        fall.apply(model, &mut out.to_mut()[k]);
    }
    Ok(out)
}

struct FreeFall {
    /// Measured position relative to the attracting body, in N.
    position: [Channel; 3],
    /// Position and velocity of the origin of N at the times of the position samples.
    origin: [Channel; 3],
    velocity: [Channel; 3],
    oblate: bool,
}

/// Three channels of one name, of any sensor.
fn three(table: &Table, prefix: &str) -> Option<[Channel; 3]> {
    let first = table.channel(&format!("{prefix}_x"))?;
    Some(axes(table, &first.sensor, prefix)?.map(Clone::clone))
}

fn at(channels: &[Channel; 3], k: usize) -> Option<Vector3> {
    let [x, y, z] = channels.each_ref().map(|c| c.values.get(k).copied());
    Some(Vector3::new(x?, y?, z?))
}

/// Gravity at a position relative to the attracting body, m/s2; with J2 of the Earth about axis z of N.
fn gravity(gm: f64, oblate: bool, r: &Vector3) -> Vector3 {
    let d = r.norm();
    let point = -r * (gm / d.powi(3));
    if !oblate {
        return point;
    }
    let ratio = 1.5 * EARTH_J2 * gm * EARTH_RADIUS.powi(2) / d.powi(5);
    let s = 5.0 * (r.z / d).powi(2);
    point + Vector3::new(r.x * (s - 1.0), r.y * (s - 1.0), r.z * (s - 3.0)) * ratio
}

impl FreeFall {
    fn of(model: &Model, table: &Table, gm: f64) -> Option<Self> {
        model.sensors_of(SensorKind::Position).next()?;
        let far = |c: &[Channel; 3]| at(c, 0).is_some_and(|r| r.norm() > ORBITAL);
        let position = three(table, "r").or_else(|| three(table, "orbit"));
        let position = position.filter(far)?;
        let oblate = (gm / EARTH_GM - 1.0).abs() < SAME_BODY;
        let times = position[0].time_s.clone();
        let points: Option<Vec<Vector3>> = (0..times.len()).map(|k| at(&position, k)).collect();
        let points = points?;
        let pulls: Vec<Vector3> = points.iter().map(|r| gravity(gm, oblate, r)).collect();
        let channel = |k: usize, values: Vec<f64>| Channel {
            values,
            ..position[k].clone()
        };
        let axis = |k: usize| fall_of(&channel(k, pulls.iter().map(|g| g[k]).collect()));
        let [(x, u), (y, v), (z, w)] = [axis(0), axis(1), axis(2)];
        let mut fall = Self {
            origin: [channel(0, x), channel(1, y), channel(2, z)],
            velocity: [channel(0, u), channel(1, v), channel(2, w)],
            position,
            oblate,
        };
        for k in 0..3 {
            fall.start(k, &times);
        }
        Some(fall)
    }

    /// Chooses the initial position and velocity of the origin that minimise the relative position on one axis.
    fn start(&mut self, k: usize, times: &[f64]) {
        let n = times.len() as f64;
        let rest = self.rest(k);
        let mean = |x: &[f64]| x.iter().sum::<f64>() / n;
        let (middle, level) = (mean(times), mean(&rest));
        let spread: f64 = times.iter().map(|t| (t - middle).powi(2)).sum();
        let pairs = times.iter().zip(&rest);
        let slope: f64 = pairs.map(|(t, x)| (t - middle) * (x - level)).sum();
        let slope = if spread > 0.0 { slope / spread } else { 0.0 };
        let moved = self.origin[k].values.iter_mut().zip(times);
        moved.for_each(|(g, t)| *g += level + slope * (t - middle));
        self.velocity[k].values.iter_mut().for_each(|v| *v += slope);
    }

    /// The relative position on one axis.
    fn rest(&self, k: usize) -> Vec<f64> {
        let pairs = self.position[k].values.iter().zip(&self.origin[k].values);
        pairs.map(|(r, g)| r - g).collect()
    }

    fn words(&self) -> String {
        let times = &self.position[0].time_s;
        let span = times.last().unwrap_or(&0.0) - times.first().unwrap_or(&0.0);
        let field = match self.oblate {
            // Displacement by a constant acceleration, minus the straight line fitted by the initial state.
            true => format!(
                "a point mass and J2 of the Earth; higher harmonics are neglected, {NEGLECTED:e} m/s2, {} m over the record",
                rounded(NEGLECTED * span * span / 12.0, 2)
            ),
            false => "a point mass; all else is neglected".to_owned(),
        };
        format!("positions are relative to free fall in the gravity of {field}")
    }

    /// Replaces positions and velocities; the orbit is kept for the gravity gradient.
    fn apply(&self, model: &Model, table: &mut Table) {
        if three(table, "orbit").is_none() {
            for (axis, channel) in XYZ.iter().zip(&self.position) {
                table.channels.push(Channel {
                    name: format!("orbit_{axis}"),
                    sensor: String::new(),
                    ..channel.clone()
                });
            }
        }
        for (k, axis) in XYZ.iter().enumerate() {
            let rest = Channel {
                name: format!("r_{axis}"),
                values: self.rest(k),
                ..self.position[k].clone()
            };
            match table.channels.iter_mut().find(|c| c.name == rest.name) {
                Some(channel) => *channel = rest,
                None => table.channels.push(rest),
            }
        }
        let measured = model.sensors_of(SensorKind::Velocity).next().is_some();
        if let (true, Some(velocity)) = (measured, three(table, "v")) {
            for (k, own) in velocity.into_iter().enumerate() {
                let acceleration = differentiate(&self.velocity[k], HALF_WIDTH);
                let fall = resample_hermite(&self.velocity[k], &acceleration, &own.time_s);
                let kept = own.time_s.iter().zip(&own.values).zip(fall);
                let kept = kept.filter_map(|((t, v), fall)| Some((*t, v - fall?)));
                let (times, values): (Vec<f64>, Vec<f64>) = kept.unzip();
                let same = |c: &&mut Channel| c.name == own.name && c.sensor == own.sensor;
                if let Some(channel) = table.channels.iter_mut().find(same) {
                    (channel.time_s, channel.values) = (Arc::from(times), values);
                }
            }
        }
    }
}

/// Position and velocity from rest under this acceleration: cubic between samples, with slopes from five samples.
fn fall_of(pull: &Channel) -> (Vec<f64>, Vec<f64>) {
    let jerk = differentiate(pull, HALF_WIDTH);
    let jerks = resample_hermite(&jerk, &jerk, &pull.time_s);
    let slope = |k: usize| jerks.get(k).copied().flatten().unwrap_or(0.0);
    let (mut x, mut v) = (0.0, 0.0);
    let (mut places, mut speeds) = (vec![0.0], vec![0.0]);
    let steps = pull.time_s.windows(2).zip(pull.values.windows(2));
    for (k, (t, g)) in steps.enumerate() {
        let ([t0, t1], [a, b]) = (t, g) else { continue };
        let (h, c, d) = (t1 - t0, slope(k), slope(k + 1));
        x += v * h + h * h * ((7.0 * a + 3.0 * b) / 20.0 + h * (3.0 * c - 2.0 * d) / 60.0);
        v += h * ((a + b) / 2.0 + h * (c - d) / 12.0);
        places.push(x);
        speeds.push(v);
    }
    (places, speeds)
}
