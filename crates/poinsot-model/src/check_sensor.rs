//! Checks sensors: noise in the unit of the channel, and measured quantities.

use crate::check_rest::{check_host, check_nuisance, positive};
use crate::check_rotation::check_rotation;
use crate::check_tree::unknown_name;
use crate::file::{JointType, ModelFile, NamesFile, NoiseFile, SensorFile};
use crate::finding::{Findings, Key};
use crate::vehicle::{ErrorKey, Nuisance, Sensor, SensorKind};
use poinsot_files::list;
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use std::collections::HashMap;

/// Valid units of a channel, as key suffixes.
const UNITS: [&str; 6] = ["rad", "rad_s", "m", "m_s", "m_s2", "N"];

/// Whether a key is valid for a sensor type; keys without a unit always are.
pub(crate) fn key_fits(word: &str, key: &str) -> bool {
    let unit = key
        .strip_prefix("noise_")
        .or_else(|| key.strip_prefix("quantisation_"));
    let kind = SensorKind::ALL.iter().find(|kind| kind.word() == word);
    match (unit, kind) {
        (Some(unit), Some(kind)) => kind.units().contains(&unit),
        _ => true,
    }
}

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
    body_names: &[&str],
    findings: &mut Findings<'_, '_>,
) -> Vec<Sensor> {
    let readable = readables(file);
    let mut sensors = Vec::new();
    for (k, sensor) in file.sensor.as_deref().unwrap_or(&[]).iter().enumerate() {
        let key = Key::entry("sensor", k, sensor.name.as_deref());
        let body = match sensor.body.as_deref() {
            Some(name) => check_host(Some(name), &key, resolve, body_names, findings),
            None => Some(0),
        };
        let Some(kind) = sensor.kind.map(|kind| kind.0) else {
            continue;
        };
        let from = check_seen_from(sensor, (kind, body), &key, resolve, body_names, findings);
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
    body_names: &[&str],
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
    let Some(from) = resolve(name) else {
        unknown_name(&here, "body", name, body_names, findings);
        return None;
    };
    if body == Some(from) {
        findings.refuse(
            "E0118",
            &here,
            "the sensor would see its own body".to_owned(),
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

/// Smallest noise accepted.
const SMALLEST_NOISE: f64 = 1e-100;

fn readables(file: &ModelFile) -> [Readable<'_>; 4] {
    let joints = |revolute: &'static str, prismatic: &'static str| {
        let list = file.joint.as_deref().unwrap_or(&[]).iter().enumerate();
        list.filter_map(|(k, joint)| {
            let unit = match joint.kind? {
                JointType::Revolute => revolute,
                JointType::Prismatic => prismatic,
                JointType::Fixed => return None,
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
    let unit = check_unit(file, kind, key, findings);
    if kind.is_scalar() {
        refuse_axes(file, kind, key, findings);
    }
    let of = check_of(file, kind, unit, key, readable, findings);
    if kind.is_scalar() && of.is_empty() && findings.count() == before {
        findings.note(
            &key.at("type"),
            "the sensor has no effect: the model has nothing that it could measure; remove it, or add what it measures".to_owned(),
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
    let quantisation = check_quantisation(file, unit, key, findings);
    let correlation_s = check_correlation(file, kind, key, findings);
    let rotation = check_rotation(
        file.rotation_xyzw.as_ref(),
        file.rotation_matrix.as_ref(),
        key,
        findings,
    );
    let reference_N = check_reference(file, kind, key, findings);
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
        correlation_s: correlation_s.unwrap_or(0.0),
        quantisation: quantisation.unwrap_or(0.0),
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

fn noise_of<'f>(file: &'f SensorFile, unit: &str) -> Option<&'f NoiseFile> {
    match unit {
        "rad" => file.noise_rad.as_ref(),
        "rad_s" => file.noise_rad_s.as_ref(),
        "m" => file.noise_m.as_ref(),
        "m_s" => file.noise_m_s.as_ref(),
        "m_s2" => file.noise_m_s2.as_ref(),
        _ => file.noise_N.as_ref(),
    }
}

fn quantisation_of(file: &SensorFile, unit: &str) -> Option<f64> {
    match unit {
        "rad" => file.quantisation_rad,
        "rad_s" => file.quantisation_rad_s,
        "m" => file.quantisation_m,
        "m_s" => file.quantisation_m_s,
        "m_s2" => file.quantisation_m_s2,
        _ => file.quantisation_N,
    }
}

/// The unit declared by the keys of this sensor; units not allowed for its type are rejected.
fn check_unit(
    file: &SensorFile,
    kind: SensorKind,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<&'static str> {
    let allowed = kind.units();
    let mut declared: Option<&'static str> = None;
    for unit in UNITS {
        for (what, given) in [
            ("noise", noise_of(file, unit).is_some()),
            ("quantisation", quantisation_of(file, unit).is_some()),
        ] {
            if !given {
                continue;
            }
            let here = key.at(&format!("{what}_{unit}"));
            if !allowed.contains(&unit) {
                let keys: Vec<String> = allowed.iter().map(|u| format!("{what}_{u}")).collect();
                findings.refuse(
                    "E0105",
                    &here,
                    format!("wrong unit for a sensor of type \"{}\"", kind.word()),
                    format!("write {}", keys.join(" or ")),
                );
            } else if declared.is_some_and(|first| first != unit) {
                findings.refuse(
                    "E0118",
                    &here,
                    "one sensor is declared in two units".to_owned(),
                    "write one [[sensor]] for revolute and one for prismatic joints",
                );
            } else {
                declared = Some(unit);
            }
        }
    }
    declared
}

/// Sensors of joints, wheels and thrusters have no axes and no position.
fn refuse_axes(file: &SensorFile, kind: SensorKind, key: &Key, findings: &mut Findings<'_, '_>) {
    for (name, given) in [
        ("rotation_xyzw", file.rotation_xyzw.is_some()),
        ("rotation_matrix", file.rotation_matrix.is_some()),
        ("position_m", file.position_m.is_some()),
    ] {
        if given {
            findings.refuse(
                "E0118",
                &key.at(name),
                format!(
                    "a sensor of type \"{}\" has no axes and no place",
                    kind.word()
                ),
                "remove it",
            );
        }
    }
}

fn check_quantisation(
    file: &SensorFile,
    unit: &str,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<f64> {
    let lsb = quantisation_of(file, unit)?;
    let here = key.at(&format!("quantisation_{unit}"));
    if lsb > 0.0 && lsb < SMALLEST_NOISE {
        let problem = "the quantisation is below 1e-100".to_owned();
        findings.refuse("E0118", &here, problem, "give that of a real instrument");
        return None;
    }
    positive(lsb, &here, "E0118", "the quantisation", findings)
}

fn check_correlation(
    file: &SensorFile,
    kind: SensorKind,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<f64> {
    let time = file.correlation_s?;
    let here = key.at("correlation_s");
    if kind.is_scalar() {
        let problem = format!("a {} has no coloured noise", kind.word());
        let remedy = "leave it out; sensors of three axes can have it";
        findings.refuse("E0106", &here, problem, remedy);
        return None;
    }
    positive(time, &here, "E0118", "a correlation time", findings)
}

/// The vector whose direction is measured, normalised.
fn check_reference(
    file: &SensorFile,
    kind: SensorKind,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Vector3> {
    let given = file.reference_N?;
    let here = key.at("reference_N");
    if kind != SensorKind::Direction {
        let problem = format!("a sensor of type \"{}\" has no reference", kind.word());
        findings.refuse("E0118", &here, problem, "remove it");
        return None;
    }
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
        if file.of.is_some() {
            findings.refuse(
                "E0118",
                &here,
                format!(
                    "a sensor of type \"{}\" measures no joint, wheel or thruster",
                    kind.word()
                ),
                "remove it",
            );
        }
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
    let noise = noise_of(file, unit)?;
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
            "the noise of a direction is an angle, alike in every sense across it".to_owned(),
            "write one number",
        );
        return None;
    }
    match noise {
        NoiseFile::Scalar(sigma) => {
            let sigma = noise_sigma(*sigma, &here, findings)?;
            Some(Matrix3::from_diagonal_element(sigma * sigma))
        }
        NoiseFile::Axes(sigmas) => {
            for (k, sigma) in sigmas.iter().enumerate() {
                noise_sigma(*sigma, &here.index(k), findings)?;
            }
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

/// A positive sigma whose square does not underflow to zero.
fn noise_sigma(sigma: f64, key: &Key, findings: &mut Findings<'_, '_>) -> Option<f64> {
    let sigma = positive(sigma, key, "E0118", "the noise", findings)?;
    if sigma >= SMALLEST_NOISE {
        return Some(sigma);
    }
    findings.refuse(
        "E0118",
        key,
        format!("the noise is below {SMALLEST_NOISE:e}"),
        "give the noise of a real instrument",
    );
    None
}
