//! Declared noise of the sensors, and the fraction of it observed in the data.

use super::sensors::{BaseSensors, covariance, scalar_sensor};
use crate::channel_names::joint_channels;
use crate::error::{Error, no_noise};
use poinsot_dynamics::Tree;
use poinsot_identify::Noise;
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::Matrix3;
use poinsot_telemetry::{Channel, Table, median_step, noise_level};

/// Sigma of a derivative by the quartic through five samples, relative to the sample sigma over the time step.
const DIFFERENCE: f64 = 0.95;

/// Noise of every measurement in the momentum equations, from the sensors of the model.
///
/// # Errors
/// The gyro or a measured velocity has no declared noise.
pub(super) fn declared_noise(
    tree: &Tree,
    tables: &[Table],
    leading: &BaseSensors,
    repairs: &mut Vec<String>,
) -> Result<Noise, Error> {
    let model = leading.model;
    let columns = |kind| -> Vec<Vec<&Channel>> {
        let own = tables.iter().filter_map(|t| leading.columns(t, kind));
        own.collect()
    };
    let has = |kind| !columns(kind).is_empty();
    let vector = |kind| {
        let sensor = leading.sensor(kind)?;
        Some(sensor.R_BS * covariance(sensor)? * sensor.R_BS.transpose())
    };
    let declared = |kind| vector(kind).ok_or(no_noise(kind));
    // Of what is measured, or of the derivative of the first of the others that is.
    let measured_or = |own, measured: bool, others: &[SensorKind]| -> Result<_, Error> {
        if measured {
            return declared(own).map(Some);
        }
        let read = others.iter().find(|kind| has(**kind));
        let derived = read.map(|kind| Ok(derivative(declared(*kind)?, &columns(*kind))));
        derived.transpose()
    };
    let gyros = has(SensorKind::Gyro) || model.sensors_of(SensorKind::Gyro).next().is_some();
    let turned = [SensorKind::Attitude, SensorKind::Direction];
    let gyro = measured_or(SensorKind::Gyro, gyros, &turned)?;
    let gyro = gyro.ok_or(no_noise(SensorKind::Gyro))?;
    let moves = has(SensorKind::Velocity);
    let velocity = measured_or(SensorKind::Velocity, moves, &[SensorKind::Position])?;
    let mut exact = |value: Option<Matrix3>, kind: SensorKind| {
        if value.is_none() && has(kind) {
            let what = kind.word();
            repairs.push(format!(
                "assumed: {what} exact, because no sensor declares its noise"
            ));
        }
        value.unwrap_or_else(Matrix3::zeros)
    };
    let attitude = exact(vector(SensorKind::Attitude), SensorKind::Attitude);
    let position = exact(vector(SensorKind::Position), SensorKind::Position);
    let of_joints = |kind: SensorKind| -> Vec<f64> {
        let joints = tree.coordinates.iter();
        joints.map(|&at| scalar(model, kind, at)).collect()
    };
    let mut noise = Noise {
        gyro_sensor: leading.index(SensorKind::Gyro),
        gyro,
        attitude,
        velocity: velocity.unwrap_or_else(Matrix3::identity),
        position,
        joint_position: of_joints(SensorKind::JointPosition),
        joint_rate: of_joints(SensorKind::JointRate),
        wheel_speed: (0..model.wheels.len())
            .map(|k| scalar(model, SensorKind::WheelSpeed, k))
            .collect(),
        ..Noise::default()
    };
    silence_given(model, tables, &mut noise);
    noise.seen_gyro = seen(axes(columns(SensorKind::Gyro), &gyro));
    noise.seen_velocity = seen(axes(columns(SensorKind::Velocity), &noise.velocity));
    let rates = model.moving_joints().zip(&noise.joint_rate);
    let rates = rates.filter(|(_, variance)| **variance > 0.0);
    let rates = rates.flat_map(|(joint, variance)| {
        let [_, rate, ..] = joint_channels(joint);
        let read = tables.iter().filter_map(move |t| t.channel(&rate));
        read.map(|channel| (channel, *variance))
    });
    noise.seen_joint_rate = seen(rates);
    Ok(noise)
}

/// Declared variance of a sensor of one number, zero without.
pub(crate) fn scalar(model: &Model, kind: SensorKind, of: usize) -> f64 {
    scalar_sensor(model, kind, of)
        .and_then(covariance)
        .map_or(0.0, |c| c[(0, 0)])
}

/// Covariance of a derivative by the quartic through five samples.
fn derivative(of: Matrix3, columns: &[Vec<&Channel>]) -> Matrix3 {
    let steps = columns.iter().filter_map(|c| median_step(&c[0].time_s));
    let step = steps.fold(f64::INFINITY, f64::min);
    of * (DIFFERENCE / step).powi(2)
}

/// A joint or wheel without a column is given, so without noise. With positions only, the noise of the rate of a joint is that of
/// differences.
fn silence_given(model: &Model, tables: &[Table], noise: &mut Noise) {
    for (k, joint) in model.moving_joints().enumerate() {
        let [position, rate, ..] = joint_channels(joint);
        let channels = |name: &str| tables.iter().filter_map(|t| t.channel(name)).next();
        match (channels(&position), channels(&rate)) {
            (None, _) => {
                noise.joint_position[k] = 0.0;
                noise.joint_rate[k] = 0.0;
            }
            (Some(q), None) => {
                let step = median_step(&q.time_s).unwrap_or(f64::INFINITY);
                noise.joint_rate[k] = noise.joint_position[k] * (DIFFERENCE / step).powi(2);
            }
            _ => {}
        }
    }
    for (wheel, variance) in model.wheels.iter().zip(&mut noise.wheel_speed) {
        let column = super::driven_wheels::speed_column(&wheel.name);
        if tables.iter().all(|t| t.channel(&column).is_none()) {
            *variance = 0.0;
        }
    }
}

/// Observed over declared variance, at most one: the largest over channels with their declared variances.
fn seen<'t>(all: impl Iterator<Item = (&'t Channel, f64)>) -> f64 {
    let share = |(channel, variance): (&Channel, f64)| {
        let level = noise_level(channel)?;
        Some(level.sigma.powi(2) / variance)
    };
    all.filter_map(share).fold(0.0, f64::max).min(1.0)
}

/// The columns of a sensor with the variances of its axes.
fn axes<'t>(
    columns: Vec<Vec<&'t Channel>>,
    declared: &Matrix3,
) -> impl Iterator<Item = (&'t Channel, f64)> {
    let axes = columns.into_iter().flat_map(|c| c.into_iter().enumerate());
    axes.map(|(axis, channel)| (channel, declared[(axis, axis)]))
}
