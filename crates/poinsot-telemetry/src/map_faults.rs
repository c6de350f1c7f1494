//! Checks of a map before any file is read.

use crate::clock::check_time;
use crate::error::map_of;
use crate::map::{AttitudeForm, mark};
use crate::unit::{list, nearest_unit};
use crate::{
    AttitudeMap, ChannelName, ColumnMap, Dimension, FileMap, Quantity, TelemetryMap, Unit,
    classify, parse_unit,
};
use poinsot_files::Faults;
use std::collections::HashMap;

/// A fault of a map, with its key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapFault {
    /// Code of the fault.
    pub code: &'static str,
    /// Index in [`TelemetryMap::files`]; `None` for the map of every file.
    pub file: Option<usize>,
    /// Key path below that entry.
    pub keys: Vec<String>,
    /// Index in a list.
    pub index: Option<usize>,
    /// Key of that entry; empty for the entry itself.
    pub key: &'static str,
    /// The mapped channel.
    pub channel: String,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub remedy: String,
}

impl From<MapFault> for Faults {
    fn from(fault: MapFault) -> Self {
        map_of(fault.code, &fault.channel, fault.problem, fault.remedy)
    }
}

/// Code, problem, remedy.
type Wrong = (&'static str, String, String);

/// All faults of a map.
///
/// ```
/// use poinsot_telemetry::{TelemetryMap, map_faults};
///
/// // A map without entries has no fault.
/// assert!(map_faults(&TelemetryMap::default()).is_empty());
/// ```
pub fn map_faults(map: &TelemetryMap) -> Vec<MapFault> {
    let mut faults = Vec::new();
    let all = &map.all;
    for (file, map) in map.maps() {
        let mut add = |keys: &[&str], entry: Option<(usize, _)>, channel: &str, wrong: Wrong| {
            let (code, problem, remedy) = wrong;
            faults.push(MapFault {
                code,
                file,
                keys: keys.iter().map(|k| (*k).to_owned()).collect(),
                index: entry.map(|e| e.0),
                key: entry.map_or("", |e| e.1),
                channel: channel.to_owned(),
                problem,
                remedy,
            });
        };
        let units_row = map.layout.units_row.or(all.layout.units_row) == Some(true);
        for (name, text) in [
            ("delimiter", &map.layout.delimiter),
            ("comment", &map.layout.comment),
        ] {
            if text.as_deref().is_some_and(|text| mark(text).is_none()) {
                let remedy = match name {
                    "comment" => "write for example \"#\"",
                    _ => "write \",\", \";\", \"|\", \"tab\" or \"space\"",
                };
                let problem = "the value must be one character that is in no number or name";
                add(
                    &[name],
                    None,
                    name,
                    ("E0107", problem.to_owned(), remedy.to_owned()),
                );
            }
        }
        for column in &map.columns {
            if let Err((key, wrong)) = resolve(column, units_row) {
                let keys = ["columns", &column.channel, key];
                let keys = if key.is_empty() { &keys[..2] } else { &keys };
                add(keys, None, &column.channel, wrong);
            }
        }
        if let Some(time) = &map.time
            && let Err((key, problem, remedy)) = check_time(time)
        {
            add(&["time", key], None, "time", ("E0212", problem, remedy));
        }
        for (k, attitude) in map.attitude.iter().enumerate() {
            if let Err((key, wrong)) = attitude_fault(attitude, units_row) {
                let name = crate::full_name(&attitude.sensor, "attitude");
                add(&["attitude"], Some((k, key)), &name, wrong);
            }
        }
        if let Some(orbit) = &map.orbit {
            for (key, unit, dimension) in [
                ("unit", &orbit.unit, Dimension::Length),
                ("velocity_unit", &orbit.velocity_unit, Dimension::Velocity),
            ] {
                if let Some(Err(wrong)) = unit.as_ref().map(|u| unit_of(u, dimension)) {
                    add(&["orbit", key], None, "orbit", wrong);
                }
            }
        }
        if let Some((keys, channel, wrong)) = column_twice(map) {
            let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
            add(&keys, None, &channel, wrong);
        }
    }
    faults
}

/// Finds a column used for two channels.
fn column_twice(map: &FileMap) -> Option<(Vec<String>, String, Wrong)> {
    let mut seen: HashMap<_, String> = HashMap::new();
    // Two channels may share a column if each has its own row filter, or one says by what factor or offset it differs.
    for own in map.named().into_iter().filter(|c| !c.is_changed()) {
        let (channel, column, rows) = (own.channel, own.column, own.rows);
        if let Some(first) = seen.insert((column.clone(), rows), channel.clone()) {
            let keys = match map.columns.iter().any(|c| c.channel == channel) {
                true => vec!["columns".to_owned(), channel.clone()],
                false => vec![channel.rsplit('.').next().unwrap_or_default().to_owned()],
            };
            let problem = format!("column '{column}' is mapped to '{first}' too");
            let remedy = "map each column once; a channel that is the same up to a factor or an offset says so by scale, sign or offset".to_owned();
            return Some((keys, channel, ("E0210", problem, remedy)));
        }
    }
    None
}

/// The unit, if it has this dimension.
fn unit_of(text: &str, dimension: Dimension) -> Result<Unit, Wrong> {
    let remedy = format!("use one of: {}", list(dimension));
    match parse_unit(text) {
        Ok(unit) if unit.dimension == dimension => Ok(unit),
        Ok(_) => {
            let problem = format!("unit '{text}' does not measure it");
            let remedy = format!(
                "give a unit that converts to {}: {}",
                dimension.si(),
                list(dimension)
            );
            Err(("E0212", problem, remedy))
        }
        Err(_) => {
            let near = nearest_unit(text, Some(dimension));
            let problem = format!("unit '{text}' is not known");
            Err((
                "E0211",
                problem,
                format!(
                    "did you mean '{near}'? {}{}",
                    remedy[..1].to_uppercase(),
                    &remedy[1..]
                ),
            ))
        }
    }
}

/// Standard name of a column, and its unit where it is its own.
type Resolved = (ChannelName, Option<Unit>);
/// A faulty key, and the fault.
type Refused = (&'static str, Wrong);

/// The standard name and unit of a column map; otherwise the faulty key and the fault. Without a unit it needs a units
/// row.
pub(crate) fn resolve(map: &ColumnMap, units_row: bool) -> Result<Resolved, Refused> {
    let fault =
        |key, problem: String, remedy: &str| Err((key, ("E0212", problem, remedy.to_owned())));
    let Some(name) = classify(&map.channel) else {
        let problem = "not a standard channel name".to_owned();
        return fault(
            "",
            problem,
            "write one, for example omega_x, joint1_rad, wheel1_rad_s or thr1_N",
        );
    };
    for (key, value) in [
        ("scale", map.scale),
        ("counts_per_revolution", map.counts_per_revolution),
        ("signed_range", map.signed_range),
        ("wraps_at", map.wraps_at),
    ] {
        if value == Some(0.0) || value.is_some_and(|x| key != "scale" && x < 0.0) {
            return fault(
                key,
                format!("the {} is not positive", key.replace('_', " ")),
                "correct the number; sign = -1 turns the sign",
            );
        }
    }
    if map.sign.is_some_and(|s| s.abs() != 1.0) {
        return fault(
            "sign",
            "the sign is neither 1 nor -1".to_owned(),
            "write 1 or -1; scale is for other factors",
        );
    }
    if let Some(wrong) = misplaced(map, &name) {
        return Err(wrong);
    }
    let time = name.quantity == Quantity::Time;
    let changed = map.is_changed();
    if time && (changed || map.counts_per_revolution.or(map.nominal_N).is_some()) {
        return fault(
            "",
            "a time has a unit alone".to_owned(),
            "remove the other keys, or write [telemetry] time",
        );
    }
    if map.nominal_N.is_some() {
        return flag(map, name, changed);
    }
    if map.counts_per_revolution.is_some() {
        return counts(map, name);
    }
    let Some(unit) = &map.unit else {
        if units_row {
            return Ok((name, None));
        }
        let remedy = format!(
            "write unit = \"...\", one of: {}; or units_row = true where the file has a row of units",
            list(name.dimension)
        );
        return fault("", "there is no unit".to_owned(), &remedy);
    };
    let measures = match map.increments {
        true => integral(name.dimension).unwrap_or(name.dimension),
        false => name.dimension,
    };
    match unit_of(unit, measures) {
        Ok(unit) => Ok((name, Some(unit))),
        Err(wrong) => Err(("unit", wrong)),
    }
}

/// Dimension of the increments of a rate.
fn integral(rate: Dimension) -> Option<Dimension> {
    match rate {
        Dimension::AngularVelocity => Some(Dimension::Angle),
        Dimension::AngularAcceleration => Some(Dimension::AngularVelocity),
        Dimension::Velocity => Some(Dimension::Length),
        Dimension::Acceleration => Some(Dimension::Velocity),
        _ => None,
    }
}

/// A key that the channel cannot have.
fn misplaced(map: &ColumnMap, name: &ChannelName) -> Option<Refused> {
    let fault = |key, problem: &str, remedy: &str| {
        Some((key, ("E0212", problem.to_owned(), remedy.to_owned())))
    };
    if map.increments && integral(name.dimension).is_none() {
        let problem = "only a rate has increments";
        return fault("increments", problem, "remove it, or map the rate");
    }
    if name.dimension == Dimension::Force {
        return None;
    }
    let (remedy, problem) = ("remove it", "only a thruster has a valve");
    if map.opens_late_s.is_some() {
        return fault("opens_late_s", problem, remedy);
    }
    if map.closes_late_s.is_some() {
        return fault("closes_late_s", problem, remedy);
    }
    match map.overlap {
        Some(_) => fault("overlap", problem, remedy),
        None => None,
    }
}

/// The same for a column that says whether a thruster fires: its unit is that of a duration.
fn flag(map: &ColumnMap, name: ChannelName, changed: bool) -> Result<Resolved, Refused> {
    let fault = |problem: &str, remedy: &str| {
        Err((
            "nominal_N",
            ("E0212", problem.to_owned(), remedy.to_owned()),
        ))
    };
    if name.dimension != Dimension::Force {
        return fault(
            "only a thruster has a nominal force",
            "map the column with its unit",
        );
    }
    if changed || map.counts_per_revolution.is_some() {
        return fault(
            "a flag has no sign, scale or offset",
            "remove them, or nominal_N",
        );
    }
    let duration = map.unit.as_ref().map(|u| unit_of(u, Dimension::Time));
    match duration.transpose() {
        Ok(unit) => Ok((name, unit)),
        Err(wrong) => Err(("unit", wrong)),
    }
}

/// The same for a column of counts.
fn counts(map: &ColumnMap, name: ChannelName) -> Result<Resolved, Refused> {
    let fault = |key, problem: &str, remedy: &str| {
        Err((key, ("E0212", problem.to_owned(), remedy.to_owned())))
    };
    let turns = matches!(
        name.dimension,
        Dimension::Angle | Dimension::AngularVelocity
    );
    if !turns {
        return fault(
            "counts_per_revolution",
            "only an angle or its rate has counts per revolution",
            "map the column with its unit",
        );
    }
    if map.unit.is_some() {
        return fault(
            "unit",
            "counts have no unit",
            "remove unit or counts_per_revolution",
        );
    }
    Ok((name, None))
}

fn attitude_fault(map: &AttitudeMap, units_row: bool) -> Result<(), Refused> {
    let refuse = |code, key, problem: &str, remedy: &str| {
        Err((key, (code, problem.to_owned(), remedy.to_owned())))
    };
    let given = map.given();
    let &[(name, _)] = given.as_slice() else {
        let remedy = "give one of quaternion, matrix, euler, mrp";
        return refuse("E0107", "", "an attitude has one form", remedy);
    };
    if map.order.is_some() && name != "quaternion" {
        let problem = "only a quaternion has an order";
        return refuse("E0107", "order", problem, "remove it");
    }
    if map.sequence.is_some() != (name == "euler") {
        let problem = "Euler angles and their sequence belong together";
        let remedy = "write for example sequence = \"ZYX\" for yaw, pitch, roll, or remove it";
        return refuse("E0107", "sequence", problem, remedy);
    }
    let Some(form) = map.form() else {
        let problem = "the sequence is not three of X, Y, Z";
        let remedy = "write for example \"ZYX\" for yaw, pitch, roll";
        return refuse("E0107", "sequence", problem, remedy);
    };
    let fault = |problem: &str, remedy: &str| refuse("E0212", "", problem, remedy);
    let (columns, wanted) = (map.columns(), form.width());
    if columns.len() != wanted {
        let named = columns.len();
        let problem = format!("{named} columns are named where the form has {wanted}");
        return fault(&problem, "name them in their order");
    }
    let euler = name == "euler";
    let odd = |c: &&ColumnMap| {
        let thrust = c.nominal_N.or(c.opens_late_s).or(c.closes_late_s).is_some();
        let unit = c.unit.is_some() || c.counts_per_revolution.is_some();
        thrust || c.overlap.is_some() || c.increments || (unit && !euler)
    };
    if let Some(ColumnMap { column, .. }) = columns.iter().find(odd) {
        let problem = format!("'{column}' has a key that no column of an attitude has");
        return fault(&problem, "remove it");
    }
    match form {
        AttitudeForm::Euler([a, b, c]) if a == b || b == c => {
            let problem = "two turns in a row are about one axis";
            return fault(problem, "correct the sequence, for example \"ZYX\"");
        }
        AttitudeForm::Euler(_) => {}
        _ if map.unit.is_some() => return fault("only Euler angles have a unit", "remove it"),
        _ => return Ok(()),
    }
    let units = columns
        .iter()
        .map(|c| c.unit.as_ref().or(map.unit.as_ref()));
    for unit in units {
        match unit {
            Some(unit) => unit_of(unit, Dimension::Angle).map_err(|wrong| ("", wrong))?,
            None if units_row => continue,
            None => {
                let remedy = "write unit = \"deg\" or another angle";
                return fault("the angles have no unit", remedy);
            }
        };
    }
    Ok(())
}
