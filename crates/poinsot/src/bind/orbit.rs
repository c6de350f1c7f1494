//! The reference orbit at the grid times: from telemetry, or from the elements in the model.

use super::channels::Channels;
use super::sensors::{HALF_WIDTH, vectors};
use crate::channel_names::axes;
use crate::error::{Error, unsupported};
use poinsot_dynamics::{Orbit, orbit_state};
use poinsot_files::{as_read, rounded};
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;
use poinsot_telemetry::{differentiate, resample, resample_hermite};

/// Position and velocity in N, m and m/s, at one time; `None` if telemetry has no value there.
type OrbitPoint = Option<(Vector3, Vector3)>;

/// Largest time between epoch and record, s: the node of a low orbit moves by 7 degrees a day.
const OLDEST_S: f64 = 30.0 * 86_400.0;

/// The orbit at every time of the grid; empty without gravity gradient.
pub(super) fn orbit_at(channels: &Channels, grid: &[f64]) -> Vec<OrbitPoint> {
    let around = &channels.model.environment;
    let Some(gm) = around.point_mass_gm.filter(|_| around.gravity_gradient) else {
        return Vec::new();
    };
    if let Some(axes) = axes(channels.table, "", "orbit") {
        let rates = axes.map(|c| differentiate(c, HALF_WIDTH));
        let smooth = [0, 1, 2].map(|k| resample_hermite(axes[k], &rates[k], grid));
        let positions = vectors(&smooth).into_iter();
        let velocities = vectors(&rates.each_ref().map(|c| resample(c, grid, None)));
        return positions.zip(velocities).map(|(p, v)| p.zip(v)).collect();
    }
    let orbit = in_record_time(channels);
    let at = |t: &f64| Some(orbit_state(gm, orbit.as_ref()?, *t));
    grid.iter().map(at).collect()
}

/// The elements with their epoch in the times of the record, which may begin to count at the first sample.
fn in_record_time(channels: &Channels) -> Option<Orbit> {
    let orbit = channels.model.environment.orbit?;
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
fn check_epoch(channels: &Channels) -> Result<(), Error> {
    let epoch = |orbit: Orbit| orbit.epoch;
    let own = channels.model.environment.orbit.and_then(epoch);
    let epoch = in_record_time(channels).and_then(epoch);
    let rates = channels.base_rates()?;
    let (Some((own, epoch)), Some(first), Some(last)) = (
        own.zip(epoch),
        rates.time_s().first(),
        rates.time_s().last(),
    ) else {
        return Ok(());
    };
    let apart = (first - epoch).max(epoch - last);
    if apart <= OLDEST_S {
        return Ok(());
    }
    let days = rounded(apart / 86_400.0, 3);
    let (own, first) = (as_read(own), as_read(own + (first - epoch)));
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
pub(super) fn check_orbit(channels: &Channels, repairs: &mut Vec<String>) -> Result<(), Error> {
    let model = channels.model;
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
    let read = axes(channels.table, "", "orbit").is_some();
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
        (false, true) => check_epoch(channels),
    }
}
