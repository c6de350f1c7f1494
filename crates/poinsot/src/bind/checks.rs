//! What a record must hold and may not hold: sensors, attitude, plausible values.

use super::channels::Channels;
use super::sensors::{
    BaseSensors, REFERENCE, columns_of, covariance, named, parts_of, without_own,
};
use crate::channel_names::XYZ;
use crate::error::{Error, missing, no_noise, unsupported};
use poinsot_files::{Place, as_read, rounded};
use poinsot_identify::ErrorGroup;
use poinsot_model::{Model, MomentumKnowledge, Nuisance, Sensor, SensorKind};
use poinsot_telemetry::{Channel, Table, full_name, median_step};
use std::f64::consts::PI;

/// Reports unused sensors, columns without a sensor, and the sensors with which the fit starts.
///
/// # Errors
/// Columns without a sensor name that several sensors could have written; columns of a sensor without declared noise;
/// an unknown error of a sensor without columns.
pub(super) fn check_sensors(
    leading: &BaseSensors,
    tables: &[Table],
    repairs: &mut Vec<String>,
) -> Result<(), Error> {
    let model = leading.model;
    refuse_bias_of_frame(model)?;
    for table in tables {
        let label = super::file_label(table);
        refuse_without_reference(model, table, &label)?;
        for kind in SensorKind::with_axes() {
            refuse_ambiguous(model, table, kind)?;
        }
        unread(model, table, &label, repairs);
        ownerless(model, table, &label, repairs);
    }
    let all = model.sensors.iter().enumerate();
    let has_columns = |k: usize| tables.iter().any(|t| parts_of(model, t, k).is_some());
    let seen: Vec<&Sensor> = all.filter(|s| has_columns(s.0)).map(|s| s.1).collect();
    let read = |s: &Sensor| seen.iter().any(|other| std::ptr::eq(s, *other));
    refuse_links_alone(model, &read)?;
    for kind in SensorKind::with_axes() {
        let all: Vec<&Sensor> = model.sensors_of(kind).collect();
        let with_columns: Vec<&&Sensor> = all.iter().filter(|s| read(s)).collect();
        for sensor in &with_columns {
            refuse_noiseless(sensor, with_columns.len())?;
        }
        // A missing gyro is reported elsewhere.
        let needed = kind != SensorKind::Gyro || !with_columns.is_empty();
        if let Some(sensor) = all.iter().find(|s| needed && asks(s) && !read(s)) {
            return Err(unsupported(
                format!(
                    "sensor '{}': one of its errors is to be estimated, but no segment has its columns '{}'",
                    sensor.name,
                    kind.columns().join(" ")
                ),
                "add them, or take bias, scale, misalignment and lag out",
            ));
        }
        let base = with_columns.iter().filter(|s| s.body == 0).count();
        if base > 1
            && !kind.is_relative()
            && let Some(first) = leading.sensor(kind)
        {
            repairs.push(format!(
                "{base} sensors of type {} on the base: the linear start uses '{}', maximum likelihood uses all",
                kind.word(),
                first.name
            ));
        }
    }
    Ok(())
}

fn refuse_ambiguous(model: &Model, table: &Table, kind: SensorKind) -> Result<(), Error> {
    let nameless: Vec<&str> = without_own(model, table, kind)
        .map(|k| model.sensors[k].name.as_str())
        .collect();
    if nameless.len() < 2 || named(table, kind, "").is_none() {
        return Ok(());
    }
    let names = kind.columns();
    Err(unsupported(
        format!(
            "columns '{}' name no sensor, and {} sensors of type {} have no columns of their own ({})",
            names.join(" "),
            nameless.len(),
            kind.word(),
            nameless.join(", ")
        ),
        format!(
            "write '{}' and so on, or take a sensor out",
            full_name(nameless[0], names[0])
        ),
    ))
}

/// A direction needs its reference vector in N.
fn refuse_without_reference(model: &Model, table: &Table, label: &str) -> Result<(), Error> {
    for (k, sensor) in model.sensors.iter().enumerate() {
        if sensor.kind != SensorKind::Direction || sensor.reference_N.is_some() {
            continue;
        }
        if columns_of(model, table, k).is_some_and(|c| c.reference.is_none()) {
            let own = |axis| full_name(&sensor.name, &format!("{REFERENCE}_{axis}"));
            let purpose = format!(
                "the direction '{}' needs its reference vector in inertial axes",
                sensor.name
            );
            let advice = "add the columns, or write reference_N = [x, y, z] in its [[sensor]]";
            return Err(missing(label, &XYZ.map(own).join(" "), &purpose, advice));
        }
    }
    Ok(())
}

/// The initial position and velocity must be measured on the base, where any are used.
fn refuse_links_alone(model: &Model, read: &impl Fn(&Sensor) -> bool) -> Result<(), Error> {
    let moves = |s: &&Sensor| matches!(s.kind, SensorKind::Velocity | SensorKind::Position);
    let own = || model.sensors.iter().filter(moves).filter(|s| read(s));
    if let (Some(sensor), false) = (own().next(), own().any(|s| s.body == 0)) {
        let problem = format!(
            "sensor '{}' is on body '{}', but the fit needs a velocity or position on the base '{}' for its initial state",
            sensor.name, model.bodies[sensor.body].name, model.bodies[0].name
        );
        return Err(unsupported(problem, "add one there, or remove this sensor"));
    }
    Ok(())
}

/// A declared sensor without columns is not used.
fn unread(model: &Model, table: &Table, label: &str, repairs: &mut Vec<String>) {
    for (k, sensor) in model.sensors.iter().enumerate() {
        if !sensor.kind.is_scalar() && parts_of(model, table, k).is_none() {
            repairs.push(format!(
                "{label}: no columns '{}' of the {} '{}': the sensor is not used",
                sensor.kind.columns().join(" "),
                sensor.kind.word().replace('_', " "),
                sensor.name
            ));
        }
    }
}

/// Columns of an undeclared sensor are not used, nor columns without a sensor name if every sensor has its own.
fn ownerless(model: &Model, table: &Table, label: &str, repairs: &mut Vec<String>) {
    for kind in SensorKind::with_axes() {
        let first = kind.columns()[0];
        for channel in table.channels.iter().filter(|c| c.name == first) {
            let declared = model.sensors_of(kind).any(|s| s.name == channel.sensor);
            let shared = channel.sensor.is_empty()
                && (without_own(model, table, kind).next().is_some()
                    || kind == SensorKind::Attitude && model.sensors_of(kind).next().is_none());
            if !declared && !shared {
                repairs.push(format!(
                    "{label}: column '{}' and its companions match no {} of the model and are not used; declare [[sensor]] type = \"{}\", name = \"{}\"{}",
                    channel.full(),
                    kind.word().replace('_', " "),
                    kind.declared_as().word(),
                    channel.sensor,
                    if kind.is_relative() { ", seen_from = \"BODY\"" } else { "" }
                ));
            }
        }
    }
}

/// Some kinds may be exact if there is only one sensor; other sensors need declared noise.
fn refuse_noiseless(sensor: &Sensor, of_its_kind: usize) -> Result<(), Error> {
    if covariance(sensor).is_some() {
        return Ok(());
    }
    let kind = sensor.kind;
    if kind.needs_noise() {
        return Err(no_noise(kind));
    }
    if of_its_kind < 2 {
        return Ok(());
    }
    let problem = format!(
        "sensor '{}' declares no noise, and is one of {of_its_kind} of type {}: their weights are undetermined",
        sensor.name,
        kind.word()
    );
    Err(unsupported(problem, "declare its noise"))
}

/// Whether any error of a sensor is declared unknown.
fn asks(sensor: &Sensor) -> bool {
    let mut groups = ErrorGroup::of(sensor.kind);
    groups.any(|g| g.key.declared(sensor) != Nuisance::Known)
}

/// # Errors
/// A bias of the only sensor of translation.
fn refuse_bias_of_frame(model: &Model) -> Result<(), Error> {
    for sensor in &model.sensors {
        let kind = sensor.kind;
        let moves = matches!(kind, SensorKind::Position | SensorKind::Velocity);
        let biased = sensor.bias != Nuisance::Known;
        if moves && biased && model.sensors_of(kind).nth(1).is_none() {
            let problem = format!(
                "sensor '{}': a bias of the only sensor of type {} is not identifiable: it equals an offset and drift of N",
                sensor.name,
                kind.word()
            );
            return Err(unsupported(problem, "take it out"));
        }
    }
    Ok(())
}

/// # Errors
/// Momentum, velocity or position are given in N, but no attitude is measured.
pub(super) fn needs_attitude(channels: &Channels) -> Result<(), Error> {
    let seen = [SensorKind::Attitude, SensorKind::Direction];
    if seen.iter().any(|kind| channels.leading(*kind).is_some()) {
        return Ok(());
    }
    let momentum = &channels.model.momentum;
    let fault = |what: String, advice| {
        let problem = format!(
            "no attitude channel (q_x q_y q_z q_w), but {what} in the axes of N, whose orientation is unknown without it"
        );
        let advice = format!("add the attitude, or {advice}");
        Error::one("E0307", Place::label(channels.label), problem, advice)
    };
    for (key, known) in [
        ("linear_N_s", momentum.linear),
        ("angular_N_m_s", momentum.angular),
    ] {
        if let MomentumKnowledge::Known(p) = known
            && p.norm() > 0.0
        {
            let what = format!("[momentum] {key} = [{}, {}, {}]", p.x, p.y, p.z);
            return Err(fault(what, "write \"estimate\""));
        }
    }
    for (kind, prefix) in [(SensorKind::Velocity, "v"), (SensorKind::Position, "r")] {
        if channels.vector(kind).is_some() {
            let what = format!("{prefix}_x {prefix}_y {prefix}_z");
            return Err(fault(what, "take the sensor out of the model"));
        }
    }
    Ok(())
}

/// Largest plausible values, by suffix of the channel name.
const LARGEST: [(&str, f64, &str); 6] = [
    ("_rad_s", 1.0e5, "rad/s"),
    ("_m_s", 1.0e4, "m/s"),
    ("_rad", 1.0e6, "rad"),
    ("_m", 1.0e6, "m"),
    ("_Nm", 1.0e6, "N m"),
    ("_N", 1.0e8, "N"),
];

/// Returns an error for samples beyond plausible limits.
///
/// # Errors
/// The first such sample, with channel and time.
pub(super) fn check_plausible(channels: &Channels) -> Result<(), Error> {
    for channel in &channels.table.channels {
        let fault = match channel.name.as_str() {
            "omega_x" | "omega_y" | "omega_z" => turns_too_far(channel),
            "v_x" | "v_y" | "v_z" | "dv_x" | "dv_y" | "dv_z" => beyond(channel, 1.0e6, "m/s"),
            "acc_x" | "acc_y" | "acc_z" => beyond(channel, 1.0e6, "m/s2"),
            "domega_x" | "domega_y" | "domega_z" => beyond(channel, 1.0e6, "rad/s2"),
            name => LARGEST
                .iter()
                .find(|(end, ..)| name.ends_with(end))
                .and_then(|(_, most, unit)| beyond(channel, *most, unit)),
        };
        if let Some((at, why)) = fault {
            let name = channel.full();
            let value = as_read(channel.values.get(at).copied().unwrap_or_default());
            let time_s = channel.time_s.get(at).copied().unwrap_or_default();
            let place = Place::label(channels.label).key(&format!("channel '{name}'"));
            let problem = format!("{value} at t = {time_s} s: {why}");
            let advice = "correct the unit, or leave the cell empty where there is no sample";
            return Err(Error::one("E0306", place, problem, advice));
        }
    }
    Ok(())
}

fn beyond(channel: &Channel, most: f64, unit: &str) -> Option<(usize, String)> {
    let at = channel.values.iter().position(|x| x.abs() > most)?;
    Some((at, format!("beyond {most:e} {unit}")))
}

/// Between two samples a vehicle must rotate by less than half a turn; otherwise the rotation is ambiguous.
fn turns_too_far(channel: &Channel) -> Option<(usize, String)> {
    let step = median_step(&channel.time_s)?;
    let at = channel.values.iter().position(|x| x.abs() * step > PI)?;
    let turns = channel.values.get(at)?.abs() * step / (2.0 * PI);
    Some((
        at,
        format!(
            "{} turns between samples {} s apart",
            rounded(turns, 4),
            rounded(step, 4)
        ),
    ))
}
