//! Checks names: printable, unique, and no two parts with the same telemetry column.

use crate::file::{ModelFile, NuisanceFile, NuisanceWord, SensorFile};
use crate::finding::{Findings, Key};
use crate::suggest;
use crate::vehicle::JointKind;
use poinsot_files::{excerpt, is_unprintable};
use std::collections::HashMap;

/// Longest name, bytes.
const LONGEST: usize = 200;

/// Checks that no two parts have the same column or the same unknown error.
pub(crate) fn check_names(file: &ModelFile, findings: &mut Findings<'_, '_>) {
    sensors_unique(file, findings);
    columns_unique(file, findings);
}

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

fn duplicate(table: &str, index: usize, problem: &str, findings: &mut Findings<'_, '_>) {
    let key = Key::entry(table, index, None).at("name");
    findings.refuse("E0110", &key, problem.to_owned(), "rename one of them");
}

/// Sensors of different kinds may share a name (as gyro and accelerometer of one unit do), unless unknown errors of
/// both get the same address (`imu.scale.x`).
fn sensors_unique(file: &ModelFile, findings: &mut Findings<'_, '_>) {
    let mut seen: HashMap<&str, Vec<usize>> = HashMap::new();
    let all = file.sensor.as_deref().unwrap_or(&[]);
    for (index, sensor) in all.iter().enumerate() {
        let Some(name) = sensor.name.as_deref() else {
            continue;
        };
        let earlier = seen.entry(name).or_default();
        for first in earlier.iter() {
            let other = all.get(*first).filter(|other| other.kind != sensor.kind);
            if let Some(error) = other.and_then(|other| shared_error(other, sensor)) {
                let problem = format!(
                    "sensor[{first}] has the same name, and the unknown {error} of both would be {name}.{error}"
                );
                duplicate("sensor", index, &problem, findings);
            }
        }
        earlier.push(index);
    }
}

/// An error unknown in both sensors, with the same unit.
fn shared_error(one: &SensorFile, other: &SensorFile) -> Option<&'static str> {
    let declared = |error: &Option<NuisanceFile>| {
        !matches!(error, None | Some(NuisanceFile::Word(NuisanceWord::None)))
    };
    // Joint offsets are named after the joints.
    let vector = |s: &SensorFile| s.kind.map(|kind| kind.0).filter(|k| !k.is_scalar());
    let units = [one, other].map(|s| vector(s).map(|k| k.units()));
    let same_bias = units[0].is_some() && units[0] == units[1];
    let pairs = [
        ("bias", &one.bias, &other.bias, same_bias),
        ("scale", &one.scale, &other.scale, true),
        (
            "misalignment_rad",
            &one.misalignment,
            &other.misalignment,
            true,
        ),
        (
            "nonorthogonality_rad",
            &one.nonorthogonality,
            &other.nonorthogonality,
            true,
        ),
        ("lag_s", &one.lag, &other.lag, true),
    ];
    let mut pairs = pairs.into_iter();
    pairs
        .find(|(_, a, b, same)| *same && declared(a) && declared(b))
        .map(|(error, ..)| error)
}

/// A wheel and a revolute joint with equal names share `<name>_rad_s`; a thruster and a prismatic joint share
/// `<name>_N`.
fn columns_unique(file: &ModelFile, findings: &mut Findings<'_, '_>) {
    let mut joints: HashMap<(&str, &str), usize> = HashMap::new();
    for (index, joint) in file.joint.as_deref().unwrap_or(&[]).iter().enumerate() {
        let column = match joint.kind {
            Some(JointKind::Revolute) => "rad_s",
            Some(JointKind::Prismatic) => "N",
            _ => continue,
        };
        if let Some(name) = joint.name.as_deref() {
            joints.insert((name, column), index);
        }
    }
    let wheels = file.wheel.as_deref().unwrap_or(&[]).iter();
    let thrusters = file.thruster.as_deref().unwrap_or(&[]).iter();
    let others = wheels
        .enumerate()
        .map(|(k, w)| ("wheel", k, w.name.as_deref(), "rad_s"))
        .chain(
            thrusters
                .enumerate()
                .map(|(k, t)| ("thruster", k, t.name.as_deref(), "N")),
        );
    let mut clashes = Vec::new();
    for (table, index, name, column) in others {
        let Some(name) = name else { continue };
        if let Some(joint) = joints.get(&(name, column)) {
            clashes.push((table, index, format!("joint[{joint}] has the same name, and both would have the column {name}_{column}")));
        }
    }
    for (table, index, problem) in clashes {
        duplicate(table, index, &problem, findings);
    }
}

/// Reports a reference to an unknown name.
pub(crate) fn unknown_name(
    key: &Key,
    kind: &str,
    name: &str,
    names: &[&str],
    findings: &mut Findings<'_, '_>,
) {
    // In a file with many faults no similar name is searched.
    let near = if findings.count() < 50 {
        suggest::nearest(name, names)
    } else {
        None
    };
    let remedy = match near {
        Some(near) => format!("did you mean \"{}\"?", excerpt(near, 60)),
        None => format!("name one that a [[{kind}]] has"),
    };
    findings.refuse(
        "E0111",
        key,
        format!("there is no {kind} of this name"),
        remedy,
    );
}
