//! Checks the map from columns to channels.

use crate::file::ModelFile;
use crate::finding::{Findings, Key};
use crate::vehicle::JointKind;
use poinsot_files::excerpt;
use poinsot_telemetry::{FileMap, TelemetryMap, map_faults, vector_channels};
use std::collections::HashSet;

/// Longest text of a fault, which may contain names of the file.
const LONGEST: usize = 400;

/// Checks the map; channel names are checked only if the vehicle is known.
pub(crate) fn check_telemetry(
    file: Option<TelemetryMap>,
    model: Option<&ModelFile>,
    findings: &mut Findings<'_>,
) -> TelemetryMap {
    let mut map = file.unwrap_or_default();
    let key = Key::top("telemetry");
    let of_file = |k: Option<usize>| k.map_or_else(|| key.clone(), |k| key.at("file").index(k));
    if let Some(known) = model.map(channels) {
        let wheels = model.iter().flat_map(|m| m.wheel.iter().flatten());
        let spins = wheels.filter(|wheel| wheel.estimate != Some(true));
        let spins: Vec<&str> = spins.filter_map(|w| w.name.as_deref()).collect();
        let mut check = |part: &mut FileMap, key: &Key| {
            part.columns.retain(|column| {
                let here = key.at("columns").named(&column.channel);
                let is_known = check_channel(&column.channel, &known, &here, findings);
                let wheel = column.channel.strip_suffix("_rad_s").unwrap_or_default();
                if is_known && column.is_momentum() && !spins.contains(&wheel) {
                    let problem = "the speed is this momentum over a spin inertia, and no wheel has a known one";
                    let remedy = "remove estimate = true of the wheel, or map a column of the speed";
                    findings.refuse("E0212", &here.at("unit"), problem, remedy);
                }
                is_known
            });
        };
        check(&mut map.all, &key);
        for (k, own) in map.files.iter_mut().enumerate() {
            check(&mut own.map, &of_file(Some(k)));
        }
    }
    for fault in map_faults(&map) {
        let step = |key: Key, name: &String| key.named(name);
        let mut here = fault.keys.iter().fold(of_file(fault.file), step);
        if let Some(index) = fault.index {
            here = here.index(index);
        }
        let refused = fault.refused;
        if !refused.key.is_empty() {
            here = here.at(refused.key);
        }
        let [problem, remedy] = [&refused.problem, &refused.remedy].map(|s| excerpt(s, LONGEST));
        findings.refuse(refused.code, &here, problem, remedy);
    }
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
    let sensors = model.sensor.iter().flatten();
    // Sensor names are checked by prefix; the suffix distinguishes them from channels.
    let sensors = sensors.filter_map(|s| s.name.as_ref());
    known.extend(sensors.map(|name| format!("{name}.")));
    known
}

/// Checks that the vehicle can have this channel.
fn check_channel(
    channel: &str,
    known: &HashSet<String>,
    key: &Key,
    findings: &mut Findings<'_>,
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
        poinsot_files::nearest(channel, &names)
    } else {
        None
    };
    let remedy = match near {
        Some(near) => format!("did you mean {}?", excerpt(near, 60)),
        None => {
            "name a standard channel, for example omega_x, joint1_rad or gyro.omega_x".to_owned()
        }
    };
    let problem = "this vehicle has no channel of this name";
    findings.refuse("E0111", key, problem, remedy);
    false
}
