//! All channels at the gyro's times: attitude, translation, joints, wheels.

use super::attitude_start::{attitudes, base_directions, carried, integrate_rate};
use super::channels::{BaseRates, Channels, JointColumns, VectorChannels, WheelSpeed};
use super::driven_wheels::speed_at;
use super::free_fall::ORBITAL;
use super::input_errors::joint_inputs;
use super::noise::scalar;
use super::sensors::{Column, HALF_WIDTH, own_values, rotation, rounding, scalar_sensor, vectors};
use crate::channel_names::{XYZ, axes};
use crate::error::Error;
use poinsot_dynamics::Kinematics;
use poinsot_files::{Place, rounded};
use poinsot_identify::{
    Accelerations, InputChannel, InputErrors, InputSample, JointMotion, Samples, Translation,
};
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_telemetry::{
    Channel, differentiate, median_step, resample, resample_attitude, resample_hermite,
};

/// Channels at the gyro's times; `None` without a sample.
pub(super) struct Aligned {
    time_s: Vec<f64>,
    rate: Vec<Option<Vector3>>,
    attitude: Vec<Option<UnitQuaternion>>,
    /// Position and velocity of the base origin in N.
    translation: Option<Positions>,
    inputs: Inputs,
}

pub(super) fn align(
    channels: &Channels,
    rates: &BaseRates,
    repairs: &mut Vec<String>,
) -> Result<Aligned, Error> {
    let times = rates.time_s();
    let inputs = Inputs::at(channels, &channels.wheels(), times, Rates::AsMeasured);
    let carrier = |kind| channels.leading.sensor(kind).map_or(0, |s| s.body);
    let of_attitude = Carrier::new(channels, &inputs, carrier(SensorKind::Attitude));
    let of_rates = match rates.are_measured() {
        true => Carrier::new(channels, &inputs, carrier(SensorKind::Gyro)),
        false => of_attitude.clone(),
    };
    let rate = vectors(&rates.axes.each_ref().map(|c| resample(c, times, None)));
    let rate = of_rates.of_base(rate, |w, R_BL, w_BL_B| R_BL * w - w_BL_B);
    let attitude = attitude(channels, rates, (&rate, &of_attitude), repairs);
    let translation = translation(channels, times, &rate, &attitude, repairs)?;
    for columns in channels.joints() {
        told(channels, &columns, repairs);
    }
    Ok(Aligned {
        time_s: times.to_vec(),
        rate,
        attitude,
        translation,
        inputs,
    })
}

impl Aligned {
    /// Whether every channel has a sample at time k.
    pub fn complete(&self, k: usize) -> bool {
        self.rate[k].is_some()
            && self.attitude[k].is_some()
            && self
                .translation
                .as_ref()
                .is_none_or(|(r, v)| r[k].is_some() && v[k].is_some())
            && self.inputs.complete(k)
    }

    /// The samples at these times; positions are relative to the first one.
    pub fn take(&self, picked: &[usize]) -> Samples {
        let translation = self.translation.as_ref().map(|(r, v)| {
            let mut p_NoBo_N = given(r, picked);
            if let Some(first) = p_NoBo_N.first().copied() {
                p_NoBo_N.iter_mut().for_each(|p| *p -= first);
            }
            Translation {
                v_NBo_N: given(v, picked),
                p_NoBo_N,
            }
        });
        Samples {
            time_s: picked.iter().map(|&k| self.time_s[k]).collect(),
            R_NB: given(&self.attitude, picked),
            w_NB_B: given(&self.rate, picked),
            translation,
            joint_position: self.inputs.positions(picked),
            joint_rate: self.inputs.rates(picked),
            wheel_speed: self.inputs.wheel_speeds(picked),
        }
    }
}

/// The body that carries a sensor, relative to the base: attitude, and angular velocity in base axes, at some times.
#[derive(Clone)]
struct Carrier {
    body: usize,
    motion: Vec<Option<(UnitQuaternion, Vector3)>>,
}

impl Carrier {
    fn new(channels: &Channels, inputs: &Inputs, body: usize) -> Self {
        let tree = channels.tree;
        let mut kinematics = Kinematics::new(tree);
        // None for the base, and none without joints.
        let first = inputs.joints.first().filter(|_| body != 0);
        let times = first.map_or(0, |j| j.position.len());
        let motion = (0..times).map(|k| {
            let joints = inputs.joints.iter();
            let row = joints.map(|j| j.position[k].zip(j.rate[k]));
            let (q, rates): (Vec<f64>, Vec<f64>) =
                row.collect::<Option<Vec<_>>>()?.into_iter().unzip();
            kinematics.place(tree, &q);
            kinematics.set_velocities(tree, &Vector3::zeros(), &Vector3::zeros(), &rates);
            let R_BL = UnitQuaternion::from_matrix(&kinematics.R[body]);
            Some((R_BL, kinematics.w[body]))
        });
        Self {
            body,
            motion: motion.collect(),
        }
    }

    /// Readings of the base from those of this body, given how the body moves relative to the base.
    fn of_base<T>(
        &self,
        read: Vec<Option<T>>,
        of: impl Fn(T, UnitQuaternion, Vector3) -> T,
    ) -> Vec<Option<T>> {
        if self.body == 0 {
            return read;
        }
        let pairs = read.into_iter().zip(&self.motion);
        let all = pairs.map(|(x, motion)| {
            let (R_BL, w_BL_B) = (*motion)?;
            Some(of(x?, R_BL, w_BL_B))
        });
        all.collect()
    }
}

/// The values that are there, in a list without spare memory.
fn given<T: Copy>(column: &[Option<T>], picked: &[usize]) -> Vec<T> {
    let mut all = Vec::with_capacity(picked.len());
    all.extend(picked.iter().filter_map(|&k| column[k]));
    all
}

fn attitude(
    channels: &Channels,
    rates: &BaseRates,
    (rate, carrier): (&[Option<Vector3>], &Carrier),
    repairs: &mut Vec<String>,
) -> Vec<Option<UnitQuaternion>> {
    let (times, measured) = (rates.time_s(), channels.quaternion());
    if !rates.are_measured() {
        let from = if measured.is_some() {
            "the attitude"
        } else {
            "attitudes that fit the directions"
        };
        repairs.push(format!(
            "{}: no gyro: the fit starts from body rates differentiated from {from} (quartic through five samples)",
            channels.label
        ));
    }
    if let Some(parts) = measured.or_else(|| rates.attitude.as_ref().map(|a| a.each_ref())) {
        let axes = rates.axes.each_ref().map(|c| &**c);
        // The rates of another body are not the slopes of this attitude.
        let axes = (carrier.body == 0).then_some(axes);
        let measured = resample_attitude(parts, axes, times).into_iter();
        let measured = measured.map(|q| q.map(rotation)).collect();
        let measured = carrier.of_base(measured, |R, R_BL, _| R * R_BL.inverse());
        return carried(times, rate, measured);
    }
    let directions = base_directions(channels.model, channels.table).concat();
    let (start, found) = match directions.is_empty() {
        true => (
            "from the identity at its first sample",
            integrate_rate(times, rate),
        ),
        false => (
            "with the start and the bias that fit the directions best",
            attitudes(times, rate, &directions),
        ),
    };
    repairs.push(format!(
        "{}: no attitude channel: attitude integrated from the gyro, {start}",
        channels.label
    ));
    found
}

type Positions = (Vec<Option<Vector3>>, Vec<Option<Vector3>>);

/// Position and velocity of the base origin in N, corrected for the sensor positions.
fn translation(
    channels: &Channels,
    times: &[f64],
    rate: &[Option<Vector3>],
    attitude: &[Option<UnitQuaternion>],
    repairs: &mut Vec<String>,
) -> Result<Option<Positions>, Error> {
    let velocity = channels.vector(SensorKind::Velocity);
    let position = channels.vector(SensorKind::Position);
    let label = channels.label;
    if let Some(r) = &position {
        refuse_orbital(label, r)?;
    }
    let corrected = |list: Vec<Option<Vector3>>, arm: Vector3, moving: bool| {
        list.into_iter()
            .zip(rate.iter().zip(attitude))
            .map(|(x, (w, R))| {
                let (x, w, R) = (x?, (*w)?, (*R)?);
                Some(x - R * if moving { w.cross(&arm) } else { arm })
            })
            .collect::<Vec<_>>()
    };
    let at_times = |c: &[&Channel; 3]| vectors(&c.map(|c| resample(c, times, None)));
    Ok(match (velocity, position) {
        (None, None) => None,
        (Some(v), Some(r)) => {
            let smooth = [0, 1, 2].map(|k| resample_hermite(r.axes[k], v.axes[k], times));
            Some((
                corrected(vectors(&smooth), r.p_BoS_B, false),
                corrected(at_times(&v.axes), v.p_BoS_B, true),
            ))
        }
        (Some(v), None) => {
            repairs.push(format!(
                "{label}: no position channel: position integrated from velocity"
            ));
            let velocity = corrected(at_times(&v.axes), v.p_BoS_B, true);
            Some((integrate_velocity(times, &velocity), velocity))
        }
        (None, Some(r)) => {
            repairs.push(format!(
                "{label}: no velocity channel: velocity differentiated from position (quartic through five samples)"
            ));
            let rates = r.axes.map(|c| differentiate(c, HALF_WIDTH));
            let v = vectors(&[0, 1, 2].map(|k| resample(&rates[k], times, None)));
            Some((
                corrected(at_times(&r.axes), r.p_BoS_B, false),
                corrected(v, r.p_BoS_B, true),
            ))
        }
    })
}

fn refuse_orbital(label: &str, r: &VectorChannels) -> Result<(), Error> {
    let [x, y, z] = r.axes.map(|c| c.values.first().copied().unwrap_or(0.0));
    let distance = Vector3::new(x, y, z).norm();
    if distance > ORBITAL {
        let time = r.axes[0].time_s.first().copied().unwrap_or(0.0);
        let distance = rounded(distance, 4);
        let place = Place::label(label).key("channel 'r'");
        let problem = format!(
            "|r| = {distance} m at t = {time} s: absolute orbital coordinates are too large for this precision"
        );
        let advice = "write [environment] gravity = \"point_mass\" with gm_m3_s2 to use them relative to free fall";
        return Err(Error::one("E0304", place, problem, advice));
    }
    Ok(())
}

/// Position from velocity by the trapezoid rule with end correction from central slopes.
fn integrate_velocity(times: &[f64], velocity: &[Option<Vector3>]) -> Vec<Option<Vector3>> {
    let known: Vec<usize> = (0..times.len())
        .filter(|&k| velocity[k].is_some())
        .collect();
    let v = |i: usize| velocity[known[i]].unwrap_or_default();
    let t = |i: usize| times[known[i]];
    let slope = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(known.len() - 1));
        if b > a {
            (v(b) - v(a)) / (t(b) - t(a))
        } else {
            Vector3::zeros()
        }
    };
    let mut out = vec![None; times.len()];
    let mut p = Vector3::zeros();
    for i in 0..known.len() {
        if i > 0 {
            let h = t(i) - t(i - 1);
            p += (v(i - 1) + v(i)) * (0.5 * h) + (slope(i - 1) - slope(i)) * (h * h / 12.0);
        }
        out[known[i]] = Some(p);
    }
    out
}

/// What is assumed of a joint whose rate is not measured, or that is locked (see [`super::held`]).
fn told(channels: &Channels, columns: &JointColumns, repairs: &mut Vec<String>) {
    let (label, name) = (channels.label, &channels.model.joints[columns.at].name);
    let (position_name, rate_name) = (&columns.position_name, &columns.rate_name);
    let turns = |rate: &Channel| rate.values.iter().any(|x| *x != 0.0);
    if columns.locked && columns.rate.is_some_and(turns) {
        repairs.push(format!(
            "{label}: {name} has one constant position: assumed locked, its '{rate_name}' assumed zero"
        ));
    }
    if columns.moving().is_some() && columns.rate.is_none() {
        let noise = scalar(channels.model, SensorKind::JointPosition, columns.at);
        let how = match noise > 0.0 {
            true => format!("position and rate of {name} smoothed from '{position_name}'"),
            false => format!(
                "rate of {name} differentiated from '{position_name}' (quartic through five samples)"
            ),
        };
        repairs.push(format!("{label}: no channel '{rate_name}': {how}"));
    }
}

/// What is prescribed at some times: position and rate of every joint, speed of every wheel, one column each; `None` without a
/// sample.
pub(super) struct Inputs {
    joints: Vec<JointColumn>,
    wheel_speed: Vec<Column>,
}

/// Motion of a joint at some times, as in [`Inputs`].
struct JointColumn {
    position: Column,
    rate: Column,
    /// Of a joint with noisy samples, at the same times.
    motion: Option<JointMotion>,
}

/// What measured rates of joints are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Rates {
    /// Values that rows of the linear equations take, with their noise.
    AsMeasured,
    /// Samples of a motion, as positions are.
    OfMotion,
}

impl Inputs {
    pub fn at(
        channels: &Channels,
        wheels: &[Option<WheelSpeed>],
        times: &[f64],
        rates: Rates,
    ) -> Self {
        let joints = channels.joints();
        let joints = joints.map(|columns| joint_at(channels.model, &columns, (times, rates)));
        let wheel = |wheel: &Option<WheelSpeed>| match wheel {
            Some(w) => speed_at(&w.speed, w.tachometer, times),
            None => vec![Some(0.0); times.len()],
        };
        Self {
            joints: joints.collect(),
            wheel_speed: wheels.iter().map(wheel).collect(),
        }
    }

    /// What is known of every joint on the grid of these times.
    pub fn joints(
        &self,
        channels: &Channels,
        (picked, grid): (&[usize], &[f64]),
    ) -> Vec<InputChannel> {
        let all = joint_inputs(channels, grid).into_iter();
        all.zip(&self.joints)
            .map(|(plain, joint)| match &joint.motion {
                Some(motion) => {
                    let motion = motion.at_times(picked);
                    InputChannel {
                        errors: InputErrors::Process(motion.errors),
                        acceleration: motion.acceleration,
                        of_rates: motion.of_rates,
                        ..plain
                    }
                }
                None => plain,
            })
            .collect()
    }

    /// Whether every column has a sample at time k.
    pub fn complete(&self, k: usize) -> bool {
        let mut joints = self.joints.iter().flat_map(|j| [&j.position, &j.rate]);
        joints.all(|c| c[k].is_some()) && self.wheel_speed.iter().all(|c| c[k].is_some())
    }

    /// Positions of the joints at these times, row by row.
    pub fn positions(&self, picked: &[usize]) -> Vec<f64> {
        by_row(self.joints.iter().map(|j| &j.position), picked)
    }

    /// Their rates.
    pub fn rates(&self, picked: &[usize]) -> Vec<f64> {
        by_row(self.joints.iter().map(|j| &j.rate), picked)
    }

    /// Speeds of the wheels.
    pub fn wheel_speeds(&self, picked: &[usize]) -> Vec<f64> {
        by_row(self.wheel_speed.iter(), picked)
    }
}

/// The values of columns at these times, row by row; zero without a sample.
fn by_row<'c>(columns: impl Iterator<Item = &'c Column>, picked: &[usize]) -> Vec<f64> {
    let columns: Vec<&Column> = columns.collect();
    let row = |&k: &usize| columns.iter().map(move |c| c[k].unwrap_or(0.0));
    let mut all = Vec::with_capacity(picked.len() * columns.len());
    all.extend(picked.iter().flat_map(row));
    all
}

/// Motion of a joint at some times: cubic between exact samples, smoothed where these are noisy; at rest without a
/// column, or where it is locked.
fn joint_at(model: &Model, columns: &JointColumns, (times, rates): (&[f64], Rates)) -> JointColumn {
    let Some(q) = columns.moving() else {
        let still = || vec![Some(model.joints[columns.at].standing_at()); times.len()];
        let position = columns.position.map(|q| resample(q, times, None));
        return JointColumn {
            position: position.unwrap_or_else(still),
            rate: vec![Some(0.0); times.len()],
            motion: None,
        };
    };
    let derived = columns.rate.is_none();
    if (derived || rates == Rates::OfMotion)
        && let Some(smoothed) = smoothed(model, columns, times)
    {
        return smoothed;
    }
    let derived = derived.then(|| differentiate(q, HALF_WIDTH));
    let rate = derived.as_ref().or(columns.rate).unwrap_or(q);
    JointColumn {
        position: resample_hermite(q, rate, times),
        rate: resample(rate, times, None),
        motion: None,
    }
}

/// Share of an error that stands for none beside one that is declared.
const EXACT: f64 = 1.0e-6;

/// Motion of a joint from its positions and rates, where these are noisy.
fn smoothed(model: &Model, columns: &JointColumns, times: &[f64]) -> Option<JointColumn> {
    let q = columns.moving()?;
    let step = median_step(&q.time_s)?;
    let kinds = [SensorKind::JointPosition, SensorKind::JointRate];
    let [of_position, of_rate] = kinds.map(|kind| scalar(model, kind, columns.at));
    let of_rate = columns.rate.map_or(0.0, |_| of_rate);
    if of_position + of_rate == 0.0 {
        return None;
    }
    let tolerance = 1.0e-6 * step;
    let rates = columns.rate.into_iter().flat_map(|rate| &*rate.time_s);
    let mut grid: Vec<f64> = times
        .iter()
        .chain(&*q.time_s)
        .chain(rates)
        .copied()
        .collect();
    grid.sort_by(f64::total_cmp);
    grid.dedup_by(|a, b| *a - *b <= tolerance);
    let place = |t: &f64| grid.partition_point(|x| *x < t - tolerance);
    let read = |channel: &Channel, of: fn(usize, f64, f64) -> InputSample, variance: f64| {
        let pairs = channel.time_s.iter().zip(&channel.values);
        let mut samples: Vec<InputSample> =
            pairs.map(|(t, x)| of(place(t), *x, variance)).collect();
        samples.dedup_by_key(|sample| sample.at);
        samples
    };
    let positions = read(
        q,
        InputSample::white,
        of_position.max(EXACT * of_rate * step * step),
    );
    let slope = of_rate.max(EXACT * of_position / (step * step));
    let rates = columns
        .rate
        .map_or_else(Vec::new, |rate| read(rate, InputSample::slope, slope));
    let sensor = scalar_sensor(model, SensorKind::JointPosition, columns.at);
    let rounds = sensor.and_then(rounding).is_some();
    let motion = JointMotion::new(&grid, (&positions, &rates), rounds)?;
    let picked: Vec<usize> = times.iter().map(place).collect();
    let motion = motion.at_times(&picked);
    // Gaps stay gaps.
    let known = resample(q, times, None);
    let column = |of: &[f64]| -> Column {
        let pairs = known.iter().zip(of);
        pairs.map(|(known, x)| known.map(|_| *x)).collect()
    };
    Some(JointColumn {
        position: column(&motion.position),
        rate: column(&motion.rate),
        motion: Some(motion),
    })
}

/// Channels of accelerations: `domega` and those of the accelerometer.
///
/// ```
/// use poinsot::bind::acceleration_channels;
///
/// assert!(acceleration_channels().any(|name| name == "domega_x"));
/// ```
pub fn acceleration_channels() -> impl Iterator<Item = String> {
    ["domega", "acc"]
        .into_iter()
        .flat_map(|name| XYZ.map(|k| format!("{name}_{k}")))
}

/// Angular acceleration at every sample, and specific force if the accelerometer has a value at every sample.
///
/// Nothing is interpolated: thrust switches between samples.
pub(super) fn accelerations(channels: &Channels, samples: &Samples) -> Option<Accelerations> {
    let angular = axes(channels.table, "", "domega")?;
    let dw_NB_B = at_samples(&angular, &samples.time_s)?;
    let linear = channels.vector(SensorKind::Accelerometer);
    let p_BoS_B = linear.as_ref().map_or_else(Vector3::zeros, |a| a.p_BoS_B);
    Some(Accelerations {
        dw_NB_B,
        a_NS_B: linear.and_then(|a| at_samples(&a.axes, &samples.time_s)),
        p_BoS_B,
    })
}

fn at_samples(axes: &[&Channel; 3], times: &[f64]) -> Option<Vec<Vector3>> {
    let all = vectors(&axes.map(|channel| own_values(channel, times)));
    all.into_iter().collect()
}
