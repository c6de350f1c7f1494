//! Every sensor and input at its own times, on the union of them: for maximum likelihood.

use super::channels::{Channels, VectorChannels, joint_columns};
use super::cut::input_channels;
use super::input_errors::{between_readings, derived_rates, is_locked, joint_errors, wheel_errors};
use super::orbit::orbit_at;
use super::points::point_channels;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use poinsot_dynamics::Tree;
use poinsot_identify::{Firing, Observations, Samples};
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::{Channel, resample, resample_hermite};

/// Times closer than this are one time, s.
pub(super) const SAME: f64 = 1.0e-9;

/// Readings of all sensors between the first and the last aligned sample.
///
/// Joints and wheels are inputs: every reading of theirs is on the grid, and they are interpolated to its other times.
/// A time at which an input is missing is left out.
pub(super) fn observe(
    model: &Model,
    tree: &Tree,
    channels: &Channels,
    samples: &Samples,
    firings: &[Firing],
) -> Observations {
    let gyro = channels.vector(model, SensorKind::Gyro, "omega");
    let velocity = channels.vector(model, SensorKind::Velocity, "v");
    let position = channels.vector(model, SensorKind::Position, "r");
    let attitude = attitude_channels(model, channels);
    let points = point_channels(model, channels);
    let (from, to) = match (samples.time_s.first(), samples.time_s.last()) {
        (Some(a), Some(b)) => (*a, *b),
        _ => return Observations::default(),
    };
    let driven = clocks(&input_channels(model, tree, channels));
    let mut time_s: Vec<f64> = [&gyro, &velocity, &position]
        .into_iter()
        .flatten()
        .flat_map(|c| c.time_s().iter().copied())
        .chain(attitude.iter().flat_map(|a| a[0].time_s.iter().copied()))
        .chain(points.iter().flat_map(|p| p.times()))
        .chain(firings.iter().flat_map(|f| [f.start_s, f.end_s]))
        .chain(driven.into_iter().flatten().copied())
        .filter(|t| *t >= from && *t <= to)
        .collect();
    time_s.sort_by(f64::total_cmp);
    time_s.dedup_by(|a, b| *a - *b < SAME);
    let inputs = inputs(model, tree, channels, &time_s);
    let orbit = orbit_at(model, channels, &time_s);
    let complete: Vec<usize> = (0..time_s.len())
        .filter(|&k| inputs.iter().all(|c| c[k].is_some()))
        .filter(|&k| orbit.get(k).is_none_or(Option::is_some))
        .collect();
    let orbit = complete
        .iter()
        .filter_map(|&k| orbit.get(k).copied().flatten())
        .collect();
    let time_s: Vec<f64> = complete.iter().map(|&k| time_s[k]).collect();
    let rows = |from: usize, to: usize| -> Vec<f64> {
        complete
            .iter()
            .flat_map(|&k| inputs[from..to].iter().map(move |c| c[k].unwrap_or(0.0)))
            .collect()
    };
    let dof = tree.dof();
    let origin = first_position(&position, samples);
    Observations {
        rate: gyro
            .as_ref()
            .map(|g| own(&g.axes, &time_s))
            .unwrap_or_else(|| vec![None; time_s.len()]),
        attitude: attitude
            .map(|a| attitudes(&a, &time_s))
            .unwrap_or_else(|| vec![None; time_s.len()]),
        velocity: velocity
            .as_ref()
            .map(|v| own(&v.axes, &time_s))
            .unwrap_or_else(|| vec![None; time_s.len()]),
        position: position
            .as_ref()
            .map(|r| {
                own(&r.axes, &time_s)
                    .into_iter()
                    .map(|p| p.map(|p| p - origin))
                    .collect()
            })
            .unwrap_or_else(|| vec![None; time_s.len()]),
        velocity_arm_B: velocity.as_ref().map_or_else(Vector3::zeros, |v| v.p_BoS_B),
        position_arm_B: position.as_ref().map_or_else(Vector3::zeros, |r| r.p_BoS_B),
        orbit,
        points: points.iter().map(|p| p.readings(model, &time_s)).collect(),
        joint_position: rows(0, dof),
        joint_rate: rows(dof, 2 * dof),
        wheel_speed: rows(2 * dof, inputs.len()),
        joint_errors: joint_errors(model, tree, channels, &time_s),
        wheel_errors: wheel_errors(model, channels, &time_s),
        derived_rates: derived_rates(model, tree, channels, &time_s),
        between_readings: between_readings(model, tree, channels, &time_s),
        time_s,
    }
}

/// Times of channels, those that are read together once.
fn clocks<'a>(channels: &[&'a Channel]) -> Vec<&'a [f64]> {
    let mut all: Vec<&[f64]> = Vec::new();
    for channel in channels {
        if !all.contains(&&*channel.time_s) {
            all.push(&channel.time_s);
        }
    }
    all
}

/// Place of the base origin at the first sample, as the position sensor saw it.
fn first_position(position: &Option<VectorChannels>, samples: &Samples) -> Vector3<f64> {
    let (Some(r), Some(t), Some(R)) = (position, samples.time_s.first(), samples.R_NB.first())
    else {
        return Vector3::zeros();
    };
    own_or_between(&r.axes, *t).map_or_else(Vector3::zeros, |p| p - R * r.p_BoS_B)
}

fn own_or_between(axes: &[&Channel; 3], t: f64) -> Option<Vector3<f64>> {
    let at = |c: &Channel| resample(c, &[t], None).first().copied().flatten();
    Some(Vector3::new(at(axes[0])?, at(axes[1])?, at(axes[2])?))
}

/// The samples of a channel that fall on grid times; `None` elsewhere.
fn own_values(channel: &Channel, grid: &[f64]) -> Vec<Option<f64>> {
    let mut at = 0;
    grid.iter()
        .map(|t| {
            while channel.time_s.get(at).is_some_and(|x| *x < t - SAME) {
                at += 1;
            }
            match channel.time_s.get(at) {
                Some(x) if (x - t).abs() <= SAME => channel.values.get(at).copied(),
                _ => None,
            }
        })
        .collect()
}

fn own(axes: &[&Channel; 3], grid: &[f64]) -> Vec<Option<Vector3<f64>>> {
    let [x, y, z] = axes.map(|c| own_values(c, grid));
    x.into_iter()
        .zip(y)
        .zip(z)
        .map(|((x, y), z)| Some(Vector3::new(x?, y?, z?)))
        .collect()
}

fn attitude_channels<'a>(model: &Model, channels: &Channels<'a>) -> Option<[&'a Channel; 4]> {
    let name = super::base_sensor(model, SensorKind::Attitude).map(|s| s.name.as_str());
    let part = |k: &str| channels.find(name, &format!("q_{k}"));
    Some([part("x")?, part("y")?, part("z")?, part("w")?])
}

fn attitudes(parts: &[&Channel; 4], grid: &[f64]) -> Vec<Option<UnitQuaternion<f64>>> {
    let [x, y, z, w] = parts.map(|c| own_values(c, grid));
    (0..grid.len())
        .map(|k| {
            let q = Quaternion::new(w[k]?, x[k]?, y[k]?, z[k]?);
            Some(UnitQuaternion::from_quaternion(q))
        })
        .collect()
}

/// Joint positions, joint rates, wheel speeds at the grid's times, one column each.
fn inputs(model: &Model, tree: &Tree, channels: &Channels, grid: &[f64]) -> Vec<Vec<Option<f64>>> {
    let mut positions = Vec::new();
    let mut rates = Vec::new();
    for &at in &tree.coordinates {
        let joint = &model.joints[at];
        let (position_name, rate_name) = joint_columns(&joint.name, joint.kind);
        match channels.find(None, &position_name) {
            None => {
                positions.push(vec![Some(joint.locked_at); grid.len()]);
                rates.push(vec![Some(0.0); grid.len()]);
            }
            Some(q) => {
                let derived;
                let rate = match channels.find(None, &rate_name) {
                    Some(rate) => rate,
                    None => {
                        derived = super::motion::derived_rate(q);
                        &derived
                    }
                };
                if is_locked(model, at, q) {
                    positions.push(resample(q, grid, None));
                    rates.push(vec![Some(0.0); grid.len()]);
                } else {
                    positions.push(resample_hermite(q, rate, grid, None));
                    rates.push(resample(rate, grid, None));
                }
            }
        }
    }
    let wheels = model.wheels.iter().map(|w| {
        channels
            .find(None, &format!("{}_rad_s", w.name))
            .map_or_else(|| vec![None; grid.len()], |c| resample(c, grid, None))
    });
    positions.into_iter().chain(rates).chain(wheels).collect()
}
