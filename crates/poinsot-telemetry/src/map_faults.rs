//! Checks of a map before any file is read.

use crate::clock::check_time;
use crate::error::{Refused, refuse, refuse_as};
use crate::map::{AttitudeForm, mark};
use crate::unit::{list, nearest_unit};
use crate::{
    AttitudeMap, ChannelName, ColumnMap, Dimension, FileMap, TelemetryMap, Unit, classify,
    parse_unit,
};
use std::collections::HashMap;

/// A fault of a map, with its key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MapFault {
    /// Index in [`TelemetryMap::files`]; `None` for the map of every file.
    pub file: Option<usize>,
    /// Path below that entry of what is refused.
    pub keys: Vec<String>,
    /// Its index, where the path leads to a list.
    pub index: Option<usize>,
    /// The mapped channel.
    pub channel: String,
    /// What is refused of it.
    pub refused: Refused,
}

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
        let units_row = map.layout.units_row.or(all.layout.units_row) == Some(true);
        let of_file = file_faults(map, units_row).into_iter();
        faults.extend(of_file.map(|fault| MapFault { file, ..fault }));
    }
    faults
}

/// Faults of the map of one kind of file.
fn file_faults(map: &FileMap, units_row: bool) -> Vec<MapFault> {
    let mut faults = Vec::new();
    let mut add = |keys: &[&str], index: Option<usize>, channel: &str, found: Option<Refused>| {
        faults.extend(found.map(|refused| MapFault {
            file: None,
            keys: keys.iter().copied().map(str::to_owned).collect(),
            index,
            channel: channel.to_owned(),
            refused,
        }));
    };
    let (delimiter, comment) = (&map.layout.delimiter, &map.layout.comment);
    let remedy = "write \",\", \";\", \"|\", \"tab\" or \"space\"";
    for (key, text, remedy) in [
        ("delimiter", delimiter, remedy),
        ("comment", comment, "write for example \"#\""),
    ] {
        if text.as_deref().is_some_and(|text| mark(text).is_none()) {
            let problem = "the value must be one character that is in no number or name";
            let found = refuse_as::<()>("E0107", key, problem, remedy).err();
            add(&[], None, key, found);
        }
    }
    for column in &map.columns {
        let channel = column.channel.as_str();
        let found = resolve(column, units_row).err();
        add(&["columns", channel], None, channel, found);
    }
    if let Some(time) = &map.time {
        add(&["time"], None, "time", check_time(time).err());
    }
    for (k, attitude) in map.attitude.iter().enumerate() {
        let name = crate::full_name(&attitude.sensor, "attitude");
        let found = check_attitude(attitude, units_row).err();
        add(&["attitude"], Some(k), &name, found);
    }
    if let Some(orbit) = &map.orbit {
        for (key, unit, dimension) in [
            ("unit", &orbit.unit, Dimension::Length),
            ("velocity_unit", &orbit.velocity_unit, Dimension::Velocity),
        ] {
            let found = unit.as_ref().and_then(|u| unit_of(key, u, dimension).err());
            add(&["orbit"], None, "orbit", found);
        }
    }
    if let Some((keys, channel, found)) = column_twice(map) {
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        add(&keys, None, &channel, Some(found));
    }
    faults
}

/// Finds a column used for two channels.
fn column_twice(map: &FileMap) -> Option<(Vec<String>, String, Refused)> {
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
            let remedy = "map each column once; a channel that is the same up to a factor or an offset says so by scale, sign or offset";
            let found = refuse_as::<()>("E0210", "", problem, remedy).err()?;
            return Some((keys, channel, found));
        }
    }
    None
}

/// The unit at a key, if it has this dimension.
fn unit_of(key: &'static str, text: &str, dimension: Dimension) -> Result<Unit, Refused> {
    let all = list(dimension);
    match parse_unit(text) {
        Ok(unit) if unit.dimension == dimension => Ok(unit),
        Ok(_) => {
            let problem = format!("unit '{text}' does not measure it");
            let si = dimension.si();
            let remedy = format!("give a unit that converts to {si}: {all}");
            refuse(key, problem, remedy)
        }
        Err(_) => {
            let near = nearest_unit(text, Some(dimension));
            let problem = format!("unit '{text}' is not known");
            let remedy = format!("did you mean '{near}'? Use one of: {all}");
            refuse_as("E0211", key, problem, remedy)
        }
    }
}

/// The standard name of a column map, and its unit where it is its own; otherwise the fault. Without a unit it needs a units row.
pub(crate) fn resolve(
    map: &ColumnMap,
    units_row: bool,
) -> Result<(ChannelName, Option<Unit>), Refused> {
    let Some(name) = classify(&map.channel) else {
        let problem = "not a standard channel name";
        let remedy = "write one, for example omega_x, joint1_rad, wheel1_rad_s or thr1_N";
        return refuse("", problem, remedy);
    };
    check_numbers(map)?;
    check_place(map, name.dimension)?;
    let counts = map.counts_per_revolution.is_some();
    let changed = map.is_changed();
    let unit = match &map.unit {
        // Whether a thruster fires, or how long.
        unit if map.nominal_N.is_some() => {
            if name.dimension != Dimension::Force {
                let problem = "only a thruster has a nominal force";
                return refuse("nominal_N", problem, "map the column with its unit");
            }
            if changed || counts {
                let problem = "a flag has no sign, scale or offset";
                return refuse("nominal_N", problem, "remove them, or nominal_N");
            }
            let duration = unit.as_ref().map(|u| unit_of("unit", u, Dimension::Time));
            duration.transpose()?
        }
        unit if counts => {
            let key = "counts_per_revolution";
            if ![Dimension::Angle, Dimension::AngularVelocity].contains(&name.dimension) {
                let problem = "only an angle or its rate has counts per revolution";
                return refuse(key, problem, "map the column with its unit");
            }
            if unit.is_some() {
                let remedy = "remove unit or counts_per_revolution";
                return refuse("unit", "counts have no unit", remedy);
            }
            None
        }
        None if units_row => None,
        None => {
            let all = list(name.dimension);
            let remedy = format!(
                "write unit = \"...\", one of: {all}; or units_row = true where the file has a row of units"
            );
            return refuse("", "there is no unit", remedy);
        }
        Some(unit) => {
            let of_wheel = !name.subject.is_empty() && map.is_momentum();
            let own = match (name.dimension, map.increments) {
                (Dimension::AngularVelocity, false) if of_wheel => Dimension::AngularMomentum,
                (rate, true) => integral(rate).unwrap_or(rate),
                (usual, false) => usual,
            };
            Some(unit_of("unit", unit, own)?)
        }
    };
    Ok((name, unit))
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

/// Signs of the numbers.
fn check_numbers(map: &ColumnMap) -> Result<(), Refused> {
    for (key, value) in [
        ("scale", map.scale),
        ("counts_per_revolution", map.counts_per_revolution),
        ("signed_range", map.signed_range),
        ("wraps_at", map.wraps_at),
    ] {
        if value == Some(0.0) || value.is_some_and(|x| key != "scale" && x < 0.0) {
            let problem = format!("the {} is not positive", key.replace('_', " "));
            let remedy = "correct the number; sign = -1 turns the sign";
            return refuse(key, problem, remedy);
        }
    }
    if map.sign.is_some_and(|s| s.abs() != 1.0) {
        let remedy = "write 1 or -1; scale is for other factors";
        return refuse("sign", "the sign is neither 1 nor -1", remedy);
    }
    Ok(())
}

/// Keys that the channel cannot have.
fn check_place(map: &ColumnMap, dimension: Dimension) -> Result<(), Refused> {
    for (key, given) in [
        ("sign", map.sign.is_some()),
        ("scale", map.scale.is_some()),
        ("offset", map.offset.is_some()),
        ("counts_per_revolution", map.counts_per_revolution.is_some()),
        ("nominal_N", map.nominal_N.is_some()),
        ("where", !map.rows.is_empty()),
        ("invalid", !map.invalid.is_empty()),
        ("signed_range", map.signed_range.is_some()),
        ("wraps_at", map.wraps_at.is_some()),
        ("late_s", map.late_s.is_some()),
    ] {
        if given && dimension == Dimension::Time {
            let problem = "a time has a unit alone";
            return refuse(key, problem, "remove it, or write [telemetry] time");
        }
    }
    if map.increments && integral(dimension).is_none() {
        let problem = "only a rate has increments";
        return refuse("increments", problem, "remove it, or map the rate");
    }
    for (key, given) in [
        ("opens_late_s", map.opens_late_s.is_some()),
        ("closes_late_s", map.closes_late_s.is_some()),
        ("overlap", map.overlap.is_some()),
    ] {
        if given && dimension != Dimension::Force {
            return refuse(key, "only a thruster has a valve", "remove it");
        }
    }
    Ok(())
}

fn check_attitude(map: &AttitudeMap, units_row: bool) -> Result<(), Refused> {
    let given = map.given();
    let &[(name, _)] = given.as_slice() else {
        let remedy = "give one of quaternion, matrix, euler, mrp";
        return refuse_as("E0107", "", "an attitude has one form", remedy);
    };
    if map.order.is_some() && name != "quaternion" {
        let problem = "only a quaternion has an order";
        return refuse_as("E0107", "order", problem, "remove it");
    }
    let euler = name == "euler";
    if map.sequence.is_some() != euler {
        let problem = "Euler angles and their sequence belong together";
        let remedy = "write for example sequence = \"ZYX\" for yaw, pitch, roll, or remove it";
        return refuse_as("E0107", "sequence", problem, remedy);
    }
    let Some(form) = map.form() else {
        let problem = "the sequence is not three of X, Y, Z";
        let remedy = "write for example \"ZYX\" for yaw, pitch, roll";
        return refuse_as("E0107", "sequence", problem, remedy);
    };
    let (columns, wanted) = (map.columns(), form.width());
    if columns.len() != wanted {
        let named = columns.len();
        let problem = format!("{named} columns are named where the form has {wanted}");
        return refuse("", problem, "name them in their order");
    }
    let odd = |c: &&ColumnMap| {
        let thrust = c.nominal_N.or(c.opens_late_s).or(c.closes_late_s).is_some();
        let unit = c.unit.is_some() || c.counts_per_revolution.is_some();
        thrust || c.overlap.is_some() || c.increments || (unit && !euler)
    };
    if let Some(ColumnMap { column, .. }) = columns.iter().find(odd) {
        let problem = format!("'{column}' has a key that no column of an attitude has");
        return refuse("", problem, "remove it");
    }
    match form {
        AttitudeForm::Euler([a, b, c]) if a == b || b == c => {
            let problem = "two turns in a row are about one axis";
            return refuse("", problem, "correct the sequence, for example \"ZYX\"");
        }
        AttitudeForm::Euler(_) => {}
        _ if map.unit.is_some() => return refuse("", "only Euler angles have a unit", "remove it"),
        _ => return Ok(()),
    }
    for column in &columns {
        match column.unit.as_ref().or(map.unit.as_ref()) {
            Some(unit) => unit_of("", unit, Dimension::Angle)?,
            None if units_row => continue,
            None => {
                let remedy = "write unit = \"deg\" or another angle";
                return refuse("", "the angles have no unit", remedy);
            }
        };
    }
    Ok(())
}
