//! Writes the `[telemetry]` table so that it reads back equal.

use crate::toml_text::{line, number, quoted, section};
use poinsot_telemetry::{
    AttitudeForm, AttitudeMap, ColumnMap, FileMap, Order, Sense, TelemetryMap, TimeFormat, TimeMap,
};

pub(crate) fn write_telemetry(out: &mut String, map: &TelemetryMap) {
    if map.all != FileMap::default() {
        section(out, "[telemetry]");
        write_file(out, &map.all);
    }
    for (name, own) in &map.files {
        section(out, "[[telemetry.file]]");
        line(out, "name", quoted(name));
        write_file(out, own);
    }
}

fn write_file(out: &mut String, map: &FileMap) {
    let character = |byte: u8| match byte {
        b'\t' => quoted("tab"),
        byte => quoted(&char::from(byte).to_string()),
    };
    let layout = map.layout;
    let mut given = |key: &str, value: Option<String>| {
        if let Some(value) = value {
            line(out, key, value);
        }
    };
    given("delimiter", layout.delimiter.map(character));
    given("comment", layout.comment.map(character));
    given("header_row", layout.header_row.map(|row| row.to_string()));
    given("units_row", layout.units_row.map(|on| on.to_string()));
    given("time", map.time.as_ref().map(time));
    let attitude: Vec<String> = map.attitude.iter().map(attitude).collect();
    given(
        "attitude",
        (!attitude.is_empty()).then(|| format!("[{}]", attitude.join(", "))),
    );
    given(
        "orbit",
        map.orbit.as_ref().map(|orbit| {
            let mut keys = vec![("position", names(&orbit.position))];
            keys.extend(orbit.unit.iter().map(|u| ("unit", quoted(u))));
            keys.extend(orbit.velocity.iter().map(|v| ("velocity", names(v))));
            let unit = orbit.velocity_unit.iter();
            keys.extend(unit.map(|u| ("velocity_unit", quoted(u))));
            keys.extend(orbit.earth_fixed.then(|| ("frame", quoted("earth_fixed"))));
            table(&keys)
        }),
    );
    let rows = map
        .row_filter
        .iter()
        .map(|(column, text)| (quoted(column), quoted(text)));
    rows.for_each(|(column, text)| line(out, &format!("where.{column}"), text));
    for column in &map.columns {
        line(
            out,
            &format!("columns.{}", quoted(&column.channel)),
            self::column(column),
        );
    }
}

fn table(keys: &[(&str, String)]) -> String {
    let keys: Vec<String> = keys
        .iter()
        .map(|(key, value)| format!("{key} = {value}"))
        .collect();
    format!("{{ {} }}", keys.join(", "))
}

fn names(columns: &[String]) -> String {
    let quoted: Vec<String> = columns.iter().map(|c| quoted(c)).collect();
    format!("[{}]", quoted.join(", "))
}

fn column(map: &ColumnMap) -> String {
    let mut keys = vec![("column", quoted(&map.column))];
    keys.extend(map.unit.iter().map(|u| ("unit", quoted(u))));
    let numbers = [
        ("sign", map.sign),
        ("scale", map.scale),
        ("offset", map.offset),
        ("counts_per_revolution", map.counts_per_revolution),
        ("nominal_N", map.nominal_N),
    ];
    keys.extend(
        numbers
            .into_iter()
            .filter_map(|(key, x)| Some((key, number(x?)))),
    );
    let rows = map.rows.iter();
    let rows: Vec<String> = rows
        .map(|(column, text)| format!("{} = {}", quoted(column), quoted(text)))
        .collect();
    keys.extend((!rows.is_empty()).then(|| ("where", format!("{{ {} }}", rows.join(", ")))));
    table(&keys)
}

fn time(map: &TimeMap) -> String {
    let format = match map.format {
        TimeFormat::Number => None,
        TimeFormat::Iso8601 => Some("iso8601"),
        TimeFormat::DayOfYear => Some("day_of_year"),
        TimeFormat::GpsWeek => Some("gps_week"),
    };
    let texts = [
        ("column", Some(map.column.as_str())),
        ("format", format),
        ("week", map.week.as_deref()),
        ("unit", map.unit.as_deref()),
        ("epoch", map.epoch.as_deref()),
        ("scale", map.scale.map(|scale| scale.name())),
    ];
    let keys: Vec<(&str, String)> = texts
        .into_iter()
        .filter_map(|(key, text)| Some((key, quoted(text?))))
        .collect();
    table(&keys)
}

fn attitude(map: &AttitudeMap) -> String {
    let mut keys = Vec::new();
    if !map.sensor.is_empty() {
        keys.push(("sensor", quoted(&map.sensor)));
    }
    let form = match map.form {
        AttitudeForm::Quaternion(_) => "quaternion",
        AttitudeForm::Matrix => "matrix",
        AttitudeForm::Euler(_) => "euler",
        AttitudeForm::Mrp => "mrp",
    };
    keys.push((form, names(&map.columns)));
    match map.form {
        AttitudeForm::Quaternion(Order::Wxyz) => keys.push(("order", quoted("wxyz"))),
        AttitudeForm::Euler(axes) => {
            let axes: String = axes.iter().filter_map(|a| "XYZ".chars().nth(*a)).collect();
            keys.push(("sequence", quoted(&axes)));
        }
        _ => {}
    }
    keys.extend(map.unit.iter().map(|u| ("unit", quoted(u))));
    if map.sense == Sense::InertialToBody {
        keys.push(("sense", quoted("inertial_to_body")));
    }
    if map.relative {
        keys.push(("relative", "true".to_owned()));
    }
    table(&keys)
}
