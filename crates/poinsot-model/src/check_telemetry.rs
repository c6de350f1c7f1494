//! Which column holds which channel.

use crate::file::{JointType, ModelFile, TelemetryFile};
use crate::finding::{Findings, Key};
use crate::suggest;
use crate::vehicle::{ColumnSource, TelemetryMap};
use poinsot_files::excerpt;
use std::collections::HashSet;

/// Channels that every vehicle may have.
const CHANNELS: [&str; 23] = [
    "time_s", "q_x", "q_y", "q_z", "q_w", "omega_x", "omega_y", "omega_z", "domega_x", "domega_y",
    "domega_z", "r_x", "r_y", "r_z", "v_x", "v_y", "v_z", "dv_x", "dv_y", "dv_z", "acc_x", "acc_y",
    "acc_z",
];

/// Checks the map; the channel names only where the vehicle is known.
pub(crate) fn check_telemetry(
    file: Option<&TelemetryFile>,
    model: Option<&ModelFile>,
    findings: &mut Findings<'_, '_>,
) -> TelemetryMap {
    let Some(file) = file else {
        return TelemetryMap::default();
    };
    let key = Key::top("telemetry");
    let mut columns = Vec::new();
    if let Some(map) = &file.columns {
        let known = model.map(channels);
        for (channel, source) in map {
            let mut here = key.at("columns");
            here.path = here.path.key(channel);
            if let Some(known) = &known {
                check_channel(channel, known, &here, findings);
            }
            let (Some(column), Some(unit)) = (&source.column, &source.unit) else {
                continue;
            };
            if column.is_empty() {
                findings.refuse(
                    "E0109",
                    &here.at("column"),
                    "the name is empty".to_owned(),
                    "name a column of the telemetry file",
                );
            }
            columns.push(ColumnSource {
                channel: channel.clone(),
                column: column.clone(),
                unit: unit.clone(),
            });
        }
    }
    let rows = file.rows.iter().flatten();
    TelemetryMap {
        columns,
        row_filter: rows
            .map(|(column, text)| (column.clone(), text.clone()))
            .collect(),
    }
}

/// Every channel this vehicle can have.
fn channels(model: &ModelFile) -> HashSet<String> {
    let mut known: HashSet<String> = CHANNELS
        .iter()
        .filter(|c| !c.is_empty())
        .map(|c| (*c).to_owned())
        .collect();
    let mut add = |name: Option<&str>, ends: &[&str]| {
        if let Some(name) = name {
            known.extend(ends.iter().map(|end| format!("{name}_{end}")));
        }
    };
    for joint in model.joint.iter().flatten() {
        match joint.kind {
            Some(JointType::Revolute) => {
                add(joint.name.as_deref(), &["rad", "rad_s", "rad_s2", "Nm"]);
            }
            Some(JointType::Prismatic) => {
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
    // Names of sensors are checked by prefix; a marker keeps them apart from channels.
    known.extend(sensors.iter().map(|name| format!("{name}.")));
    known
}

fn check_channel(
    channel: &str,
    known: &HashSet<String>,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) {
    if known.contains(channel) && !channel.ends_with('.') {
        return;
    }
    let split = channel
        .match_indices('.')
        .map(|(at, _)| channel.split_at(at + 1))
        .find(|(sensor, rest)| known.contains(*sensor) && known.contains(*rest));
    if split.is_some() {
        return;
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
}
