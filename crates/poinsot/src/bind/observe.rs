//! Every sensor and input at its own times, on the union of all times: for maximum likelihood.

use super::channels::{Channels, VectorChannels, WheelSpeed};
use super::cut::input_channels;
use super::driven_wheels::speed_at;
use super::input_errors::{between_readings, wheel_inputs};
use super::motion::{Inputs, Rates};
use super::orbit::orbit_at;
use super::sensors::{HALF_WIDTH, SAME, SensorColumns, own_values, sensor_columns, vectors};
use poinsot_files::each_once;
use poinsot_identify::{Firing, Observations, Samples};
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, differentiate, resample, resample_hermite};

/// Samples of all sensors between the first and the last aligned sample.
///
/// Joints and wheels are inputs: all their samples are on the grid, and they are interpolated to the other grid times.
/// Times without an input are dropped.
pub(super) fn observe(channels: &Channels, samples: &Samples, firings: &[Firing]) -> Observations {
    let model = channels.model;
    let sensors = sensor_columns(model, channels.table);
    let (Some(&from), Some(&to)) = (samples.time_s.first(), samples.time_s.last()) else {
        return Observations::default();
    };
    let wheels = channels.wheels();
    let mut driven = input_channels(channels);
    driven.extend(wheels.iter().flatten().map(|w| &*w.speed));
    let driven = clocks(&driven);
    let mut time_s: Vec<f64> = sensors
        .iter()
        .flat_map(|s| s.times())
        .chain(firings.iter().flat_map(|f| [f.start_s, f.end_s]))
        .chain(driven.into_iter().flatten().copied())
        .filter(|t| *t >= from && *t <= to)
        .collect();
    time_s.sort_by(f64::total_cmp);
    time_s.dedup_by(|a, b| *a - *b < SAME);
    let inputs = Inputs::at(channels, &wheels, &time_s, Rates::OfMotion);
    let orbit = orbit_at(channels, &time_s);
    let complete: Vec<usize> = (0..time_s.len())
        .filter(|&k| inputs.complete(k))
        .filter(|&k| orbit.get(k).is_none_or(Option::is_some))
        .collect();
    let orbit = complete
        .iter()
        .filter_map(|&k| orbit.get(k).copied().flatten())
        .collect();
    let time_s: Vec<f64> = complete.iter().map(|&k| time_s[k]).collect();
    let origin = match channels.vector(SensorKind::Position) {
        Some(position) => first_position(&position, samples),
        None => first_value(&sensors),
    };
    let joints = inputs.joints(channels, (&complete, &time_s));
    Observations {
        sensors: sensors
            .iter()
            .map(|s| s.record(model, &time_s, &origin))
            .collect(),
        orbit,
        joint_position: inputs.positions(&complete),
        joint_rate: inputs.rates(&complete),
        wheel_speed: inputs.wheel_speeds(&complete),
        smooth_wheel_speed: smooth_wheels(&wheels, &time_s),
        wheels: wheel_inputs(channels, &time_s),
        between_readings: between_readings(channels, &joints, &time_s),
        joints,
        expected_errors: Vec::new(),
        time_s,
    }
}

/// Distinct time bases of channels.
fn clocks<'a>(channels: &[&'a Channel]) -> Vec<&'a [f64]> {
    each_once(channels.iter().map(|c| &*c.time_s))
}

/// Position of the base origin at the first sample, from the position sensor.
fn first_position(r: &VectorChannels, samples: &Samples) -> Vector3 {
    let (Some(t), Some(R)) = (samples.time_s.first(), samples.R_NB.first()) else {
        return Vector3::zeros();
    };
    let at = vectors(&r.axes.map(|c| resample(c, &[*t], None)));
    let first = at.first().copied().flatten();
    first.map_or_else(Vector3::zeros, |p| p - R * r.p_BoS_B)
}

/// The first position measured by any sensor; an approximation if none is on the base.
fn first_value(sensors: &[SensorColumns]) -> Vector3 {
    let position = sensors.iter().find(|s| s.kind == SensorKind::Position);
    let at = |s: &SensorColumns, k: usize| s.parts[k].values.first().copied().unwrap_or(0.0);
    position.map_or_else(Vector3::zeros, |s| Vector3::from_fn(|k, _| at(s, k)))
}

/// Wheel speeds interpolated by cubic Hermite polynomials, but where the torque drives them; empty if all are sampled at
/// every grid time.
fn smooth_wheels(wheels: &[Option<WheelSpeed>], grid: &[f64]) -> Vec<f64> {
    let mut read = wheels.iter().flatten();
    if read.all(|w| own_values(w.tachometer, grid).iter().all(Option::is_some)) {
        return Vec::new();
    }
    let column = |w: &Option<WheelSpeed>| match w {
        None => vec![Some(0.0); grid.len()],
        Some(w) if w.driven => speed_at(&w.speed, w.tachometer, grid),
        Some(WheelSpeed { tachometer: c, .. }) => {
            resample_hermite(c, &differentiate(c, HALF_WIDTH), grid)
        }
    };
    let columns: Vec<Vec<Option<f64>>> = wheels.iter().map(column).collect();
    let row = |k: usize| columns.iter().map(move |c| c[k].unwrap_or(0.0));
    (0..grid.len()).flat_map(row).collect()
}

/// Firings of every thruster with a column, whose values hold until the next sample; others are off.
pub(super) fn firings(channels: &Channels, samples: &Samples) -> Vec<Firing> {
    let mut list = Vec::new();
    let last_s = samples.time_s.last().copied().unwrap_or(f64::NEG_INFINITY);
    for (thruster, item) in channels.model.thrusters.iter().enumerate() {
        let Some(channel) = channels.find(&format!("{}_N", item.name)) else {
            continue;
        };
        let mut rest = &*channel.time_s;
        // Consecutive equal values are one firing, up to the next value.
        for run in channel.values.chunk_by(|a, b| a == b) {
            let (own, next) = rest.split_at(run.len());
            rest = next;
            let end_s = last_s.max(own[own.len() - 1]);
            if run[0] != 0.0 {
                list.push(Firing {
                    thruster,
                    start_s: own[0],
                    end_s: next.first().copied().unwrap_or(end_s),
                    force: run[0],
                });
            }
        }
    }
    list.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    list
}
