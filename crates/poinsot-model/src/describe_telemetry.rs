//! Describes environment and telemetry map as text.

use crate::vehicle::{Environment, Orbit};
use poinsot_files::short;
use poinsot_telemetry::{
    AttitudeForm, AttitudeMap, ColumnMap, FileMap, Order, Sense, TelemetryMap, TimeFormat, TimeMap,
};

/// One line per active force or torque of the environment.
pub(crate) fn environment(around: &Environment) -> Vec<String> {
    let Some(gm) = around.point_mass_gm else {
        return vec!["free fall: no gravity gradient".to_owned()];
    };
    let body = match (gm - EARTH).abs() < 1e-6 * EARTH {
        true => " (the Earth)",
        false => "",
    };
    let mut lines = vec![format!("gravity of a point mass of {gm:e} m3/s2{body}")];
    if around.gravity_gradient {
        lines.push("gravity-gradient torque: included".to_owned());
        lines.push(match &around.orbit {
            Some(orbit) => orbit_words(orbit, gm),
            None => {
                "orbit: from telemetry (orbit_x orbit_y orbit_z, or [telemetry] orbit)".to_owned()
            }
        });
    }
    lines
}

/// Gravitational parameter of the Earth, m3/s2.
const EARTH: f64 = 3.986_004_418e14;

fn orbit_words(orbit: &Orbit, gm: f64) -> String {
    let period_min = std::f64::consts::TAU * (orbit.semi_major_axis.powi(3) / gm).sqrt() / 60.0;
    format!(
        "orbit: semi-major axis {} km, eccentricity {}, inclination {} deg, node {} deg, periapsis {} deg, true anomaly {} deg at {}; one orbit in {} min",
        short(orbit.semi_major_axis / 1e3),
        short(orbit.eccentricity),
        short(orbit.inclination.to_degrees()),
        short(orbit.raan.to_degrees()),
        short(orbit.argument_of_periapsis.to_degrees()),
        short(orbit.true_anomaly.to_degrees()),
        orbit.epoch.map_or(
            "the start of the record's times".to_owned(),
            |epoch| format!("{} s", short(epoch))
        ),
        short(period_min)
    )
}

/// One line per entry of the map.
///
/// ```
/// use poinsot_model::{describe_map, parse_telemetry_map};
///
/// let map = parse_telemetry_map(
///     r#"
/// [telemetry.columns]
/// omega_x = { column = "GYR_X", unit = "deg/s" }
/// "#,
///     "map.toml",
/// )?;
/// let lines = describe_map(&map);
/// assert!(lines.iter().any(|line| line.contains("omega_x") && line.contains("GYR_X")));
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn telemetry(map: &TelemetryMap) -> Vec<String> {
    let mut lines = file("", &map.all);
    for (name, own) in &map.files {
        lines.extend(file(&format!("{name}: "), own));
    }
    lines
}

fn file(head: &str, map: &FileMap) -> Vec<String> {
    let mut lines = Vec::new();
    let mut say = |text: String| lines.push(format!("{head}{text}"));
    let layout = map.layout;
    let delimiter = layout
        .delimiter
        .map(|d| format!("fields separated by {:?}", char::from(d)));
    let comment = layout
        .comment
        .map(|c| format!("lines that begin with {:?} are comments", char::from(c)));
    let header = layout.header_row.map(|row| format!("header in line {row}"));
    let units = layout.units_row.map(|on| match on {
        true => "units in the row below the header".to_owned(),
        false => "no row of units".to_owned(),
    });
    let layout: Vec<String> = [delimiter, comment, header, units]
        .into_iter()
        .flatten()
        .collect();
    if !layout.is_empty() {
        say(layout.join(", "));
    }
    if let Some(time) = &map.time {
        say(time_words(time));
    }
    for map in &map.columns {
        let rows = map.rows.iter();
        let rows = rows.map(|(c, text)| format!(", where '{c}' is '{text}'"));
        say(column(map) + &rows.collect::<String>());
    }
    map.attitude.iter().for_each(|a| say(attitude(a)));
    if let Some(orbit) = &map.orbit {
        let unit = orbit.unit.as_deref().unwrap_or("from the units row");
        let frame = match orbit.earth_fixed {
            true => "axes that turn with the Earth (turned back by the Earth rotation angle)",
            false => "inertial axes",
        };
        say(format!(
            "orbit: position from {}, {unit}, in {frame}",
            orbit.position.join(" ")
        ));
        if let Some(velocity) = &orbit.velocity {
            let unit = orbit.velocity_unit.as_deref();
            let unit = unit.unwrap_or("from the units row");
            say(format!(
                "orbit: velocity from {}, {unit}",
                velocity.join(" ")
            ));
        }
    }
    for (column, text) in &map.row_filter {
        say(format!("rows: those with '{text}' in '{column}'"));
    }
    lines
}

fn time_words(time: &TimeMap) -> String {
    let scale = time.scale.map_or("UTC", |scale| scale.name());
    let unit = time.unit.as_deref().unwrap_or("s");
    let column = &time.column;
    match time.format {
        TimeFormat::Number => {
            let since = match time.epoch.as_deref() {
                None => "an unknown epoch".to_owned(),
                Some("unix") => "1970-01-01 UTC (Unix)".to_owned(),
                Some("gps") => "1980-01-06 GPS".to_owned(),
                Some(date) => format!("{date} {scale}"),
            };
            format!("time: '{column}', {unit} since {since}")
        }
        TimeFormat::Iso8601 => {
            format!("time: '{column}', date and time, {scale} where it has no zone")
        }
        TimeFormat::DayOfYear => {
            format!("time: '{column}', year, day of the year and time, {scale}")
        }
        TimeFormat::GpsWeek => {
            let week = time.week.as_deref().unwrap_or_default();
            format!("time: GPS week '{week}' and seconds of the week '{column}', {unit}")
        }
    }
}

fn column(map: &ColumnMap) -> String {
    let (channel, column) = (&map.channel, &map.column);
    if let Some(force) = map.nominal_N {
        let force = short(force);
        return match &map.unit {
            None => format!("{channel}: flag '{column}', {force} N where it is on"),
            Some(unit) => format!("{channel}: pulses of {force} N, as long as '{column}', {unit}"),
        };
    }
    let mut value = match map.scale {
        Some(scale) => format!("{} '{column}'", short(scale)),
        None => format!("'{column}'"),
    };
    if let Some(offset) = map.offset {
        value = format!("({value} + {})", short(offset));
    }
    if map.sign == Some(-1.0) {
        value = format!("-{value}");
    }
    match (map.counts_per_revolution, map.unit.as_deref()) {
        (Some(counts), _) => format!(
            "{channel}: {value}, {} counts per revolution",
            short(counts)
        ),
        (None, Some(unit)) => format!("{channel}: {value}, {unit}"),
        (None, None) => format!("{channel}: {value}, unit from the units row"),
    }
}

fn attitude(map: &AttitudeMap) -> String {
    let of = match map.sensor.as_str() {
        "" => String::new(),
        sensor => format!(" of {sensor}"),
    };
    let form = match map.form {
        AttitudeForm::Quaternion(Order::Xyzw) => "quaternion, scalar last".to_owned(),
        AttitudeForm::Quaternion(Order::Wxyz) => "quaternion, scalar first".to_owned(),
        AttitudeForm::Matrix => "rotation matrix, row by row".to_owned(),
        AttitudeForm::Mrp => "modified Rodrigues parameters".to_owned(),
        AttitudeForm::Euler(axes) => {
            let axes: Vec<&str> = axes
                .iter()
                .filter_map(|a| ["x", "y", "z"].get(*a).copied())
                .collect();
            let unit = map.unit.as_deref().unwrap_or("unit from the units row");
            format!("Euler angles about {}, {unit}", axes.join(", "))
        }
    };
    let sense = match (map.sense, map.relative) {
        (Sense::BodyToInertial, false) => "body to inertial",
        (Sense::InertialToBody, false) => "inertial to body",
        (Sense::BodyToInertial, true) => "seen body to the body from which it is seen",
        (Sense::InertialToBody, true) => "body from which it is seen to the seen body",
    };
    format!(
        "attitude{of}: {form}, {sense}, from {}",
        map.columns.join(" ")
    )
}
