//! Checks sensors: noise in the unit of the channel, and measured quantities.

use crate::check_name::unknown_name;
use crate::check_rest::check_nuisance;
use crate::check_rotation::check_rotation;
use crate::file::{ModelFile, NamesFile, NoiseFile, SensorFile};
use crate::finding::{Findings, Key};
use crate::vehicle::{ErrorKey, JointKind, Nuisance, Sensor, SensorKind};
use poinsot_files::list;
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use serde::Deserialize;
use std::collections::HashMap;
use toml::Value;

/// Parts that a sensor of joints, wheels or thrusters can measure, with units.
struct Readable<'a> {
    kind: SensorKind,
    /// Table of the file.
    table: &'static str,
    /// Index in the file, name, unit.
    items: Vec<(usize, &'a str, &'static str)>,
    by_name: HashMap<&'a str, (usize, &'static str)>,
}

impl<'a> Readable<'a> {
    fn of(
        kind: SensorKind,
        table: &'static str,
        items: Vec<(usize, &'a str, &'static str)>,
    ) -> Self {
        let by_name = items
            .iter()
            .map(|(k, name, unit)| (*name, (*k, *unit)))
            .collect();
        Self {
            kind,
            table,
            items,
            by_name,
        }
    }
}

pub(crate) fn check_sensors(
    file: &ModelFile,
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Vec<Sensor> {
    let readable = readables(file);
    let mut sensors = Vec::new();
    for (k, sensor) in file.sensor.as_deref().unwrap_or(&[]).iter().enumerate() {
        let key = Key::entry("sensor", k, sensor.name.as_deref());
        let body = match sensor.body.as_deref() {
            Some(name) => resolve(name),
            None => Some(0),
        };
        let Some(kind) = sensor.kind.map(|kind| kind.0) else {
            continue;
        };
        let from = check_seen_from(sensor, (kind, body), &key, resolve, findings);
        let kind = from.map_or(kind, |(relative, _)| relative);
        if let (Some(body), Some((_, seen_from)), Some(sensor)) = (
            body,
            from,
            check_sensor(sensor, kind, &key, &readable, findings),
        ) {
            sensors.push(Sensor {
                body,
                seen_from,
                ..sensor
            });
        }
    }
    sensors
}

/// The kind of a sensor, and the body from which it sees its own; 0 where it sees from none.
fn check_seen_from(
    file: &SensorFile,
    (kind, body): (SensorKind, Option<usize>),
    key: &Key,
    resolve: &impl Fn(&str) -> Option<usize>,
    findings: &mut Findings<'_, '_>,
) -> Option<(SensorKind, usize)> {
    let Some(name) = file.seen_from.as_deref() else {
        return Some((kind, 0));
    };
    let here = key.at("seen_from");
    let Some(relative) = kind.seen_from_a_body() else {
        findings.refuse(
            "E0118",
            &here,
            format!("a sensor of type \"{}\" sees no body", kind.word()),
            format!(
                "remove it; sensors of type {} can have it",
                can_see().join(", ")
            ),
        );
        return None;
    };
    let from = resolve(name)?;
    if body == Some(from) {
        findings.refuse(
            "E0118",
            &here,
            "the sensor would see its own body",
            "write the seen body as body, and the body that carries the camera as seen_from",
        );
        return None;
    }
    Some((relative, from))
}

/// Types with `seen_from`, in quotes.
fn can_see() -> Vec<String> {
    let all = SensorKind::declared().filter(|kind| kind.seen_from_a_body().is_some());
    all.map(|kind| format!("\"{}\"", kind.word())).collect()
}

fn readables(file: &ModelFile) -> [Readable<'_>; 4] {
    let joints = |revolute: &'static str, prismatic: &'static str| {
        let list = file.joint.as_deref().unwrap_or(&[]).iter().enumerate();
        list.filter_map(|(k, joint)| {
            let unit = match joint.kind? {
                JointKind::Revolute => revolute,
                JointKind::Prismatic => prismatic,
                JointKind::Fixed => return None,
            };
            Some((k, joint.name.as_deref()?, unit))
        })
        .collect()
    };
    let wheels = file.wheel.as_deref().unwrap_or(&[]).iter().enumerate();
    let wheels = wheels.filter_map(|(k, w)| Some((k, w.name.as_deref()?, "rad_s")));
    let thrusters = file.thruster.as_deref().unwrap_or(&[]).iter().enumerate();
    let thrusters = thrusters.filter_map(|(k, t)| Some((k, t.name.as_deref()?, "N")));
    [
        Readable::of(SensorKind::JointPosition, "joint", joints("rad", "m")),
        Readable::of(SensorKind::JointRate, "joint", joints("rad_s", "m_s")),
        Readable::of(SensorKind::WheelSpeed, "wheel", wheels.collect()),
        Readable::of(SensorKind::Thrust, "thruster", thrusters.collect()),
    ]
}

fn check_sensor(
    file: &SensorFile,
    kind: SensorKind,
    key: &Key,
    readable: &[Readable<'_>],
    findings: &mut Findings<'_, '_>,
) -> Option<Sensor> {
    let before = findings.count();
    let unit = check_unit(file, key, findings);
    let of = check_of(file, kind, unit, key, readable, findings);
    if kind.is_scalar() && of.is_empty() && findings.count() == before {
        findings.note(
            &key.at("type"),
            "the sensor has no effect: the model has nothing that it could measure; remove it, or add what it measures",
        );
    }
    // A joint sensor without declared noise has the unit of its joints.
    let unit = unit
        .or_else(|| {
            let readable = readable.iter().find(|r| r.kind == kind)?;
            let first = of.first()?;
            readable
                .items
                .iter()
                .find(|(k, _, _)| k == first)
                .map(|(_, _, unit)| *unit)
        })
        .or_else(|| kind.units().first().copied())?;
    let noise_covariance = check_noise(file, kind, unit, key, findings);
    let quantisation = file.sample_errors.get(&format!("quantisation_{unit}"));
    let rotation = check_rotation(
        file.rotation_xyzw.as_ref(),
        file.rotation_matrix.as_ref(),
        key,
        findings,
    );
    let reference_N = check_reference(file, key, findings);
    let mut nuisance = |error: ErrorKey, value, unit_key: &str| -> Nuisance {
        let here = key.at(error.word());
        let found = check_nuisance(value, &here, unit_key, findings);
        if found != Nuisance::Known && !kind.unknown_errors().contains(&error) {
            refuse_error(kind, (error, &here), findings);
        }
        found
    };
    let sensor = Sensor {
        kind,
        body: 0,
        seen_from: 0,
        noise_covariance,
        correlation_s: file.correlation_s.unwrap_or(0.0),
        quantisation: quantisation.and_then(Value::as_float).unwrap_or(0.0),
        bias: nuisance(ErrorKey::Bias, file.bias.as_ref(), &format!("sigma_{unit}")),
        scale: nuisance(ErrorKey::Scale, file.scale.as_ref(), "sigma"),
        misalignment: nuisance(
            ErrorKey::Misalignment,
            file.misalignment.as_ref(),
            "sigma_rad",
        ),
        nonorthogonality: nuisance(
            ErrorKey::Nonorthogonality,
            file.nonorthogonality.as_ref(),
            "sigma_rad",
        ),
        lag: nuisance(ErrorKey::Lag, file.lag.as_ref(), "sigma_s"),
        R_BS: rotation.unwrap_or_else(Matrix3::identity),
        p_BoS_B: Vector3::from(file.position_m.unwrap_or([0.0; 3])),
        reference_N,
        of,
        name: file.name.clone()?,
    };
    (findings.count() == before).then_some(sensor)
}

/// An error that no method estimates.
fn refuse_error(kind: SensorKind, (error, key): (ErrorKey, &Key), findings: &mut Findings<'_, '_>) {
    let (word, name) = (kind.word(), error.word());
    let problem = format!("the {name} of a sensor of type \"{word}\" cannot be estimated");
    let remedy = match (kind, error) {
        (SensorKind::JointRate, ErrorKey::Lag) => {
            "declare it on the joint_position sensor".to_owned()
        }
        // A wheel acts by spin inertia times speed alone.
        (SensorKind::WheelSpeed, ErrorKey::Scale) => {
            "write estimate = true on the [[wheel]]: its spin inertia stands for both".to_owned()
        }
        (SensorKind::Thrust, ErrorKey::Scale) => "write scale on the [[thruster]]".to_owned(),
        _ => match kind.unknown_errors() {
            [] => "remove it".to_owned(),
            list => {
                let words: Vec<&str> = list.iter().map(|error| error.word()).collect();
                format!("remove it; {} can be estimated", words.join(", "))
            }
        },
    };
    findings.refuse("E0118", key, problem, remedy);
}

/// The unit declared by the keys of this sensor.
fn check_unit(
    file: &SensorFile,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<&'static str> {
    let mut declared: Option<&'static str> = None;
    for unit in ["rad", "rad_s", "m", "m_s", "m_s2", "N"] {
        for name in ["noise", "quantisation"].map(|what| format!("{what}_{unit}")) {
            if !file.sample_errors.contains_key(&name) {
                continue;
            }
            if declared.is_some_and(|first| first != unit) {
                findings.refuse(
                    "E0118",
                    &key.at(&name),
                    "one sensor is declared in two units",
                    "write one [[sensor]] for revolute and one for prismatic joints",
                );
            } else {
                declared = Some(unit);
            }
        }
    }
    declared
}

/// The vector whose direction is measured, normalised.
fn check_reference(
    file: &SensorFile,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Vector3> {
    let given = file.reference_N?;
    let here = key.at("reference_N");
    let unit = Vector3::from(given).try_normalize(0.0);
    if unit.is_none_or(|v| !v.iter().all(|x| x.is_finite())) {
        let problem = "the vector has no direction".to_owned();
        findings.refuse(
            "E0118",
            &here,
            problem,
            "write a finite vector that is not zero",
        );
        return None;
    }
    unit
}

fn check_of(
    file: &SensorFile,
    kind: SensorKind,
    unit: Option<&str>,
    key: &Key,
    readable: &[Readable<'_>],
    findings: &mut Findings<'_, '_>,
) -> Vec<usize> {
    let here = key.at("of");
    let Some(readable) = readable.iter().find(|r| r.kind == kind) else {
        return Vec::new();
    };
    let Some(names) = &file.of else {
        let fits = readable
            .items
            .iter()
            .filter(|(_, _, u)| unit.is_none_or(|unit| unit == *u));
        return fits.map(|(k, _, _)| *k).collect();
    };
    let known: Vec<&str> = readable.items.iter().map(|(_, name, _)| *name).collect();
    let mut of: Vec<usize> = Vec::new();
    for (k, name) in names.as_slice().iter().enumerate() {
        let here = match names {
            NamesFile::One(_) => here.clone(),
            NamesFile::Many(_) => here.index(k),
        };
        match readable.by_name.get(name.as_str()) {
            None => unknown_name(&here, readable.table, name, &known, findings),
            Some((_, u)) if unit.is_some_and(|unit| unit != *u) => findings.refuse(
                "E0105",
                &here,
                format!(
                    "this joint is measured in {u}, but its noise is declared in {}",
                    unit.unwrap_or("")
                ),
                format!("write noise_{u} or quantisation_{u}"),
            ),
            Some((k, _)) => of.push(*k),
        }
    }
    of.sort_unstable();
    of.dedup();
    of
}

/// Covariance of one sample from one sigma, three sigmas, or the symmetric square root of the covariance.
fn check_noise(
    file: &SensorFile,
    kind: SensorKind,
    unit: &str,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Matrix3> {
    let here = key.at(&format!("noise_{unit}"));
    let noise = file.sample_errors.get(&format!("noise_{unit}"))?;
    let noise = NoiseFile::deserialize(noise.clone()).ok()?;
    if kind.is_scalar() && !matches!(noise, NoiseFile::Scalar(_)) {
        findings.refuse(
            "E0118",
            &here,
            format!("a sensor of type \"{}\" has no axes", kind.word()),
            "write one number",
        );
        return None;
    }
    if kind == SensorKind::Direction && !matches!(noise, NoiseFile::Scalar(_)) {
        findings.refuse(
            "E0118",
            &here,
            "the noise of a direction is an angle, alike in every sense across it",
            "write one number",
        );
        return None;
    }
    match noise {
        NoiseFile::Scalar(sigma) => Some(Matrix3::from_diagonal_element(sigma * sigma)),
        NoiseFile::Axes(sigmas) => {
            let variances = Vector3::from(sigmas.map(|sigma| sigma * sigma));
            Some(Matrix3::from_diagonal(&variances))
        }
        NoiseFile::Matrix(rows) => {
            let root = Matrix3::from_row_iterator(rows.iter().flatten().copied());
            let asymmetry = (root - root.transpose()).amax();
            let moments = MassProperties {
                mass: 1.0,
                p_BoBcm_B: Vector3::zeros(),
                I_BBcm_B: 0.5 * (root + root.transpose()),
            }
            .principal()
            .0;
            if asymmetry > 1e-9 * root.amax() || moments[0] <= 1e-12 * moments[2] {
                findings.refuse(
                    "E0118",
                    &here,
                    format!(
                        "the matrix is not symmetric and positive definite: eigenvalues {}",
                        list(&moments)
                    ),
                    "write the symmetric square root S of the covariance S S",
                );
                return None;
            }
            Some(root * root)
        }
    }
}
