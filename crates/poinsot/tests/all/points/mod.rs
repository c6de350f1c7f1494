//! Sensors at points of bodies: their samples and their position in a model.

use crate::vehicle::{Flight, sensor};
use poinsot_dynamics::{MotionSample, Tolerance, vector_reading};
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Channel, Table};
use std::sync::Arc;

/// Adds the samples of a sensor at a point of a body; increments start at the second time.
pub fn add_point(
    table: &mut Table,
    model: &Model,
    flight: &Flight,
    (kind, body, place): (SensorKind, usize, Vector3),
) {
    let times = table.channels[0].time_s.clone();
    let mut readings: Vec<Vector3> = Vec::new();
    let read = |s: &MotionSample| readings.push(vector_reading(kind, s, body, &place));
    poinsot_dynamics::Flight::new(model, &flight.plan, Tolerance::default())
        .unwrap()
        .run(&flight.start, &*times, read)
        .unwrap();
    let (prefix, from) = match kind {
        SensorKind::Accelerometer => ("acc", 0),
        _ => ("dv", 1),
    };
    if from == 1 {
        let before = readings.clone();
        for (k, x) in readings.iter_mut().enumerate().skip(1) {
            *x -= before[k - 1];
        }
    }
    push(table, prefix, times[from..].into(), &readings[from..]);
}

pub fn push(table: &mut Table, prefix: &str, time_s: Arc<[f64]>, readings: &[Vector3]) {
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        table.channels.push(Channel {
            name: format!("{prefix}_{axis}"),
            time_s: time_s.clone(),
            values: readings.iter().map(|x| x[k]).collect(),
            ..Channel::default()
        });
    }
}

pub fn with_point(
    mut model: Model,
    (kind, body, place): (SensorKind, usize, Vector3),
    sigma: f64,
) -> Model {
    let mut one = sensor(kind, sigma);
    one.body = body;
    one.p_BoS_B = place;
    model.sensors.push(one);
    model
}
