//! The reference orbit at the grid times: from telemetry, or from the elements in the model.

use super::channels::Channels;
use crate::error::{Error, unsupported};
use nalgebra::Vector3;
use poinsot_dynamics::{Orbit, orbit_state};
use poinsot_files::{as_read, rounded};
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::{differentiate, resample, resample_hermite};

/// Position and velocity in N, m and m/s, at one time; `None` if telemetry has no value there.
type OrbitPoint = Option<(Vector3<f64>, Vector3<f64>)>;

/// Largest time between epoch and record, s: the node of a low orbit moves by 7 degrees a day.
const OLDEST_S: f64 = 30.0 * 86_400.0;

/// Half-width of the polynomial that differentiates positions, in samples.
const HALF_WIDTH: usize = 2;

/// The orbit at every time of the grid; empty without gravity gradient.
pub(super) fn orbit_at(model: &Model, channels: &Channels, grid: &[f64]) -> Vec<OrbitPoint> {
    let around = &model.environment;
    let Some(gm) = around.point_mass_gm.filter(|_| around.gravity_gradient) else {
        return Vec::new();
    };
    let axis = |k: &str| channels.find(None, &format!("orbit_{k}"));
    if let (Some(x), Some(y), Some(z)) = (axis("x"), axis("y"), axis("z")) {
        let columns = [x, y, z].map(|c| {
            let rate = differentiate(c, HALF_WIDTH, None);
            (
                resample_hermite(c, &rate, grid, None),
                resample(&rate, grid, None),
            )
        });
        let at = |k: usize| -> OrbitPoint {
            let [x, y, z] = &columns;
            Some((
                Vector3::new(x.0[k]?, y.0[k]?, z.0[k]?),
                Vector3::new(x.1[k]?, y.1[k]?, z.1[k]?),
            ))
        };
        return (0..grid.len()).map(at).collect();
    }
    let Some(orbit) = in_record_time(model, channels) else {
        return vec![None; grid.len()];
    };
    grid.iter()
        .map(|t| Some(orbit_state(gm, &orbit, *t)))
        .collect()
}

/// The elements with their epoch in the times of the record, which may begin to count at the first sample.
fn in_record_time(model: &Model, channels: &Channels) -> Option<Orbit> {
    let orbit = model.environment.orbit?;
    let since = |own_s| {
        let origin = channels.table.origin;
        origin.map_or(own_s, |origin| origin.since_origin_s(own_s))
    };
    Some(Orbit {
        epoch: orbit.epoch.map(since),
        ..orbit
    })
}

/// # Errors
/// The epoch is so far from the record that elements without perturbations do not give the orbit.
fn check_epoch(model: &Model, channels: &Channels) -> Result<(), Error> {
    let epoch = in_record_time(model, channels).and_then(|orbit| orbit.epoch);
    let rates = channels.base_rates(model)?;
    let (Some(epoch), Some(first), Some(last)) =
        (epoch, rates.time_s().first(), rates.time_s().last())
    else {
        return Ok(());
    };
    let apart = (first - epoch).max(epoch - last);
    if apart <= OLDEST_S {
        return Ok(());
    }
    let own = model.environment.orbit.and_then(|orbit| orbit.epoch);
    let first_own = own.map_or(*first, |own| own + (first - epoch));
    let (own, days) = (as_read(own.unwrap_or(epoch)), rounded(apart / 86_400.0, 3));
    let first = as_read(first_own);
    Err(unsupported(
        format!(
            "[environment] orbit.epoch_s = {own}: the record begins at {first} s of its own count, {days} days away, and elements without perturbations do not hold that long"
        ),
        "write the epoch in the count of the time column, or leave it out where the elements are those of the first sample",
    ))
}

/// Reports the source of the orbit; a gravity gradient needs one.
///
/// # Errors
/// Neither columns nor elements are given.
pub(super) fn check_orbit(
    model: &Model,
    channels: &Channels,
    repairs: &mut Vec<String>,
) -> Result<(), Error> {
    let around = &model.environment;
    let positions = model.sensors_of(SensorKind::Position).next().is_some();
    if around.point_mass_gm.is_some() && !around.gravity_gradient && !positions {
        return Err(unsupported(
            "[environment] gravity = \"point_mass\" alone has no effect: N is in free fall with the vehicle",
            "add gravity_gradient = true, or remove it",
        ));
    }
    if !around.gravity_gradient {
        return Ok(());
    }
    let read = ["orbit_x", "orbit_y", "orbit_z"]
        .iter()
        .all(|name| channels.find(None, name).is_some());
    match (read, around.orbit.is_some()) {
        (false, false) => Err(channels.missing(
            "orbit_x orbit_y orbit_z",
            "the gravity gradient needs the orbit",
            "add its positions from the attracting body in inertial axes, m, or its elements as [environment] orbit",
        )),
        (true, true) => {
            repairs.push(format!(
                "{}: orbit from its columns, not from the elements of the model",
                channels.label
            ));
            Ok(())
        }
        (true, false) => Ok(()),
        (false, true) => check_epoch(model, channels),
    }
}
