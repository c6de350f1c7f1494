//! Checks the map from columns to channels.

use crate::file::{
    AttitudeColumnFile, AttitudeFile, ColumnFile, DecimalFile, FrameFile, InvalidFile, ModelFile,
    OrbitColumnsFile, PartFile, TelemetryFile,
};
use crate::finding::{Findings, Key};
use crate::suggest;
use crate::vehicle::JointKind;
use poinsot_files::excerpt;
use poinsot_telemetry::{
    AttitudeForm, AttitudeMap, ColumnMap, FileMap, Layout, OrbitMap, OrbitalMap, Order, Sense,
    TelemetryMap, map_faults, vector_channels,
};
use std::collections::{BTreeMap, HashSet};

/// Longest text of a fault, which may contain names of the file.
const LONGEST: usize = 400;

/// Largest header row number.
const MOST_LINES: f64 = 1e6;

/// Checks the map; channel names are checked only if the vehicle is known.
pub(crate) fn check_telemetry(
    file: Option<&TelemetryFile>,
    model: Option<&ModelFile>,
    findings: &mut Findings<'_, '_>,
) -> TelemetryMap {
    let Some(file) = file else {
        return TelemetryMap::default();
    };
    let known = model.map(channels);
    let key = Key::top("telemetry");
    let mut check = |part: &PartFile, key: &Key| checked(part, key, known.as_ref(), findings);
    let all = check(&file.all, &key);
    let mut files = Vec::new();
    for (k, own) in file.file.iter().flatten().enumerate() {
        let map = check(&own.part, &key.at("file").index(k));
        files.push((own.name.clone().unwrap_or_default(), map));
    }
    let orbital = file.orbital_frame.as_ref().and_then(|frame| {
        Some(OrbitalMap {
            rate_rad_s: frame.rate_rad_s?,
            rates: frame.rates.unwrap_or(false),
        })
    });
    let map = TelemetryMap {
        all: FileMap { orbital, ..all },
        files,
    };
    for fault in map_faults(&map) {
        let mut here = match fault.file {
            None => key.clone(),
            Some(k) => key.at("file").index(k),
        };
        for name in &fault.keys {
            here.path = here.path.key(name);
        }
        if let Some(index) = fault.index {
            here = here.index(index);
        }
        let problem = excerpt(&fault.problem, LONGEST);
        findings.refuse(fault.code, &here, problem, excerpt(&fault.remedy, LONGEST));
    }
    map
}

fn checked(
    part: &PartFile,
    key: &Key,
    known: Option<&HashSet<String>>,
    findings: &mut Findings<'_, '_>,
) -> FileMap {
    let mut columns = Vec::new();
    for (channel, source) in part.columns.iter().flatten() {
        let mut here = key.at("columns");
        here.path = here.path.key(channel);
        if let Some(known) = known
            && !check_channel(channel, known, &here, findings)
        {
            continue;
        }
        let Some(column) = &source.column else {
            continue;
        };
        columns.push(column_map(channel, column, source));
    }
    let attitude = part.attitude.iter().flatten().enumerate();
    let attitude =
        attitude.filter_map(|(k, a)| check_attitude(a, &key.at("attitude").index(k), findings));
    FileMap {
        attitude: attitude.collect(),
        layout: check_layout(part, key, findings),
        time: part.time.clone(),
        columns,
        orbit: part.orbit.as_ref().and_then(orbit_map),
        orbital: None,
        row_filter: chosen(&part.rows),
    }
}

fn column_map(channel: &str, column: &str, source: &ColumnFile) -> ColumnMap {
    ColumnMap {
        channel: channel.to_owned(),
        column: column.to_owned(),
        unit: source.unit.clone(),
        scale: source.scale,
        offset: source.offset,
        sign: source.sign,
        counts_per_revolution: source.counts_per_revolution,
        nominal_N: source.nominal_N,
        rows: chosen(&source.rows),
        invalid: texts(&source.invalid),
        signed_range: source.signed_range,
        wraps_at: source.wraps_at,
        increments: source.increments.unwrap_or(false),
        opens_late_s: source.opens_late_s,
        closes_late_s: source.closes_late_s,
        overlap: source.overlap,
    }
}

fn texts(invalid: &Option<Vec<InvalidFile>>) -> Vec<String> {
    let text = |one: &InvalidFile| match one {
        InvalidFile::Number(x) => x.to_string(),
        InvalidFile::Text(text) => text.clone(),
    };
    invalid.iter().flatten().map(text).collect()
}

/// Columns and texts of row filters.
fn chosen(rows: &Option<BTreeMap<String, String>>) -> Vec<(String, String)> {
    let rows = rows.iter().flatten();
    rows.map(|(c, t)| (c.clone(), t.clone())).collect()
}

fn orbit_map(orbit: &OrbitColumnsFile) -> Option<OrbitMap> {
    Some(OrbitMap {
        position: orbit.position.clone()?,
        unit: orbit.unit.clone(),
        velocity: orbit.velocity.clone(),
        velocity_unit: orbit.velocity_unit.clone(),
        earth_fixed: orbit.frame == Some(FrameFile::EarthFixed),
    })
}

fn check_layout(part: &PartFile, key: &Key, findings: &mut Findings<'_, '_>) -> Layout {
    let mut one = |text: &Option<String>, name: &str| -> Option<u8> {
        let text = text.as_deref()?;
        let byte = match text {
            "tab" => b'\t',
            "space" => b' ',
            _ => match text.as_bytes() {
                [byte]
                    if !byte.is_ascii_alphanumeric()
                        && !matches!(byte, b'"' | b'.' | b'-' | b'+' | b'\n' | b'\r') =>
                {
                    *byte
                }
                _ => {
                    let problem =
                        "the value must be one character that is in no number or name".to_owned();
                    let remedy = match name {
                        "comment" => "write for example \"#\"",
                        _ => "write \",\", \";\", \"|\", \"tab\" or \"space\"",
                    };
                    findings.refuse("E0107", &key.at(name), problem, remedy);
                    return None;
                }
            },
        };
        Some(byte)
    };
    let delimiter = one(&part.delimiter, "delimiter");
    let comment = one(&part.comment, "comment");
    let header_row = part.header_row.and_then(|row| {
        if row >= 0.0 && row.fract() == 0.0 && row <= MOST_LINES {
            return Some(row as u64);
        }
        let problem = "the line of the header is a whole number from 0 to 1e6".to_owned();
        findings.refuse(
            "E0108",
            &key.at("header_row"),
            problem,
            "count lines from 1; 0 means that there is no header",
        );
        None
    });
    Layout {
        delimiter,
        comment,
        header_row,
        units_row: part.units_row,
        decimal_comma: part.decimal.map(|sign| sign == DecimalFile::Comma),
    }
}

fn check_attitude(
    file: &AttitudeFile,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<AttitudeMap> {
    let forms = [&file.quaternion, &file.matrix, &file.euler, &file.mrp];
    let given: Vec<usize> = (0..forms.len())
        .filter(|k| forms.get(*k).is_some_and(|f| f.is_some()))
        .collect();
    let mut fault = |name: &str, problem: &str, remedy: &str| {
        let here = if name.is_empty() {
            key.clone()
        } else {
            key.at(name)
        };
        findings.refuse("E0107", &here, problem.to_owned(), remedy);
        None
    };
    let &[form] = given.as_slice() else {
        return fault(
            "",
            "an attitude has one form",
            "give one of quaternion, matrix, euler, mrp",
        );
    };
    if file.order.is_some() && form != 0 {
        return fault("order", "only a quaternion has an order", "remove it");
    }
    if file.sequence.is_some() != (form == 2) {
        return fault(
            "sequence",
            "Euler angles and their sequence belong together",
            "write for example sequence = \"ZYX\" for yaw, pitch, roll, or remove it",
        );
    }
    let columns: Vec<ColumnMap> = forms
        .get(form)
        .copied()
        .into_iter()
        .flatten()
        .flatten()
        .map(|column| attitude_column(column, file))
        .collect();
    let form_of = || match form {
        0 if columns.len() == 3 => Some(AttitudeForm::VectorPart),
        0 => Some(AttitudeForm::Quaternion(file.order.unwrap_or(Order::Xyzw))),
        1 => Some(AttitudeForm::Matrix),
        3 => Some(AttitudeForm::Mrp),
        _ => {
            let axis = |c: char| "XYZ".find(c.to_ascii_uppercase());
            let axes: Option<Vec<usize>> = file.sequence.as_deref()?.chars().map(axis).collect();
            axes?.try_into().ok().map(AttitudeForm::Euler)
        }
    };
    let Some(kind) = form_of() else {
        return fault(
            "sequence",
            "the sequence is not three of X, Y, Z",
            "write for example \"ZYX\" for yaw, pitch, roll",
        );
    };
    Some(AttitudeMap {
        sensor: file.sensor.clone().unwrap_or_default(),
        form: kind,
        columns,
        sense: file.sense.unwrap_or(Sense::BodyToInertial),
        unit: file.unit.clone(),
        relative: file.relative.unwrap_or(false),
    })
}

/// A column of an attitude, with what holds for all of them.
fn attitude_column(column: &AttitudeColumnFile, file: &AttitudeFile) -> ColumnMap {
    let mut map = match column {
        AttitudeColumnFile::Name(column) => ColumnMap::part(column),
        AttitudeColumnFile::Column(own) => {
            column_map("", own.column.as_deref().unwrap_or_default(), own)
        }
    };
    map.rows.extend(chosen(&file.rows));
    map.invalid.extend(texts(&file.invalid));
    map
}

/// All possible channels of this vehicle.
fn channels(model: &ModelFile) -> HashSet<String> {
    let mut known: HashSet<String> = vector_channels().into_iter().collect();
    let mut add = |name: Option<&str>, ends: &[&str]| {
        if let Some(name) = name {
            known.extend(ends.iter().map(|end| format!("{name}_{end}")));
        }
    };
    for joint in model.joint.iter().flatten() {
        match joint.kind {
            Some(JointKind::Revolute) => {
                add(joint.name.as_deref(), &["rad", "rad_s", "rad_s2", "Nm"]);
            }
            Some(JointKind::Prismatic) => {
                add(joint.name.as_deref(), &["m", "m_s", "m_s2", "N"]);
            }
            _ => {}
        }
    }
    for wheel in model.wheel.iter().flatten() {
        add(wheel.name.as_deref(), &["rad_s", "Nm"]);
    }
    for thruster in model.thruster.iter().flatten() {
        add(thruster.name.as_deref(), &["N"]);
    }
    let sensors: Vec<&str> = model
        .sensor
        .iter()
        .flatten()
        .filter_map(|s| s.name.as_deref())
        .collect();
    // Sensor names are checked by prefix; the suffix distinguishes them from channels.
    known.extend(sensors.iter().map(|name| format!("{name}.")));
    known
}

/// Checks that the vehicle can have this channel.
fn check_channel(
    channel: &str,
    known: &HashSet<String>,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> bool {
    if known.contains(channel) && !channel.ends_with('.') {
        return true;
    }
    let split = channel
        .match_indices('.')
        .map(|(at, _)| channel.split_at(at + 1))
        .find(|(sensor, rest)| known.contains(*sensor) && known.contains(*rest));
    if split.is_some() {
        return true;
    }
    let near = if findings.count() < 50 {
        let mut names: Vec<&str> = known.iter().map(String::as_str).collect();
        names.sort_unstable();
        suggest::nearest(channel, &names)
    } else {
        None
    };
    let remedy = match near {
        Some(near) => format!("did you mean {}?", excerpt(near, 60)),
        None => {
            "name a standard channel, for example omega_x, joint1_rad or gyro.omega_x".to_owned()
        }
    };
    findings.refuse(
        "E0111",
        key,
        "this vehicle has no channel of this name".to_owned(),
        remedy,
    );
    false
}
