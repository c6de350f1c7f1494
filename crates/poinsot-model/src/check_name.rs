//! Checks names: printable, unique, and no two parts with the same telemetry column.

use crate::file::{ModelFile, NuisanceFile, NuisanceWord, SensorFile};
use crate::finding::{Findings, Key, all};
use crate::vehicle::JointKind;
use poinsot_files::{excerpt, is_unprintable};
use std::collections::HashMap;

/// Longest name, bytes.
const LONGEST: usize = 200;

/// Fault in the spelling of a name in a model file or URDF.
pub(crate) fn misspelt(name: &str) -> Option<&'static str> {
    if name.trim().is_empty() {
        Some("the name is empty")
    } else if name.trim() != name {
        Some("the name begins or ends with a blank")
    } else if name.len() > LONGEST {
        Some("the name is longer than 200 bytes")
    } else if name.chars().any(is_unprintable) {
        Some("the name has an unprintable character")
    } else {
        None
    }
}

fn duplicate(table: &str, index: usize, problem: String, findings: &mut Findings<'_>) {
    let key = Key::entry(table, index, None).at("name");
    findings.refuse("E0110", &key, problem, "rename one of them");
}

/// Sensors of different kinds may share a name (as gyro and accelerometer of one unit do), unless unknown errors of
/// both get the same address (`imu.scale.x`).
pub(crate) fn sensors_unique(file: &ModelFile, findings: &mut Findings<'_>) {
    let mut seen: HashMap<&str, Vec<usize>> = HashMap::new();
    let sensors = all(&file.sensor);
    for (index, sensor) in sensors.iter().enumerate() {
        let Some(name) = sensor.name.as_deref() else {
            continue;
        };
        let earlier = seen.entry(name).or_default();
        for first in earlier.iter() {
            let other = sensors
                .get(*first)
                .filter(|other| other.kind != sensor.kind);
            if let Some(error) = other.and_then(|other| shared_error(other, sensor)) {
                let problem = format!(
                    "sensor[{first}] has the same name, and the unknown {error} of both would be {name}.{error}"
                );
                duplicate("sensor", index, problem, findings);
            }
        }
        earlier.push(index);
    }
}

/// An error unknown in both sensors, with the same unit.
fn shared_error(one: &SensorFile, other: &SensorFile) -> Option<&'static str> {
    // Joint offsets are named after the joints.
    let vector = |s: &SensorFile| s.kind.map(|kind| kind.0).filter(|k| !k.is_scalar());
    let units = [one, other].map(|s| vector(s).map(|k| k.units()));
    let same_bias = units[0].is_some() && units[0] == units[1];
    let mut both = unknown_errors(one).into_iter().zip(unknown_errors(other));
    let shared = both.find(|(a, b)| a.is_some() && a == b && (same_bias || *a != Some("bias")));
    shared?.0
}

/// What the addresses of a sensor's unknown errors end with.
fn unknown_errors(s: &SensorFile) -> [Option<&'static str>; 5] {
    let errors = [
        ("bias", &s.bias),
        ("scale", &s.scale),
        ("misalignment_rad", &s.misalignment),
        ("nonorthogonality_rad", &s.nonorthogonality),
        ("lag_s", &s.lag),
    ];
    errors.map(|(end, error)| match error {
        None | Some(NuisanceFile::Word(NuisanceWord::None)) => None,
        Some(_) => Some(end),
    })
}

/// A wheel and a revolute joint with equal names share `<name>_rad_s`; a thruster and a prismatic joint share
/// `<name>_N`.
pub(crate) fn columns_unique(file: &ModelFile, findings: &mut Findings<'_>) {
    let mut joints: HashMap<(&str, &str), usize> = HashMap::new();
    for (index, joint) in all(&file.joint).iter().enumerate() {
        let column = match joint.kind {
            Some(JointKind::Revolute) => "rad_s",
            Some(JointKind::Prismatic) => "N",
            _ => continue,
        };
        if let Some(name) = joint.name.as_deref() {
            joints.insert((name, column), index);
        }
    }
    let wheels = all(&file.wheel).iter().enumerate();
    let wheels = wheels.map(|(k, w)| ("wheel", k, &w.name, "rad_s"));
    let thrusters = all(&file.thruster).iter().enumerate();
    let thrusters = thrusters.map(|(k, t)| ("thruster", k, &t.name, "N"));
    for (table, index, name, column) in wheels.chain(thrusters) {
        let Some(name) = name else { continue };
        if let Some(joint) = joints.get(&(name.as_str(), column)) {
            let problem = format!(
                "joint[{joint}] has the same name, and both would have the column {name}_{column}"
            );
            duplicate(table, index, problem, findings);
        }
    }
}

/// Reports a reference to an unknown name.
pub(crate) fn unknown_name(
    key: &Key,
    kind: &str,
    name: &str,
    names: &[&str],
    findings: &mut Findings<'_>,
) {
    // In a file with many faults no similar name is searched.
    let few = findings.count() < 50;
    let near = few.then(|| poinsot_files::nearest(name, names)).flatten();
    let remedy = match near {
        Some(near) => format!("did you mean \"{}\"?", excerpt(near, 60)),
        None => format!("name one that a [[{kind}]] has"),
    };
    let problem = format!("there is no {kind} of this name");
    findings.refuse("E0111", key, problem, remedy);
}
