//! Checks sensors: noise in the unit of the channel, and measured quantities.

use crate::check::Check;
use crate::check_name::unknown_name;
use crate::file::{ModelFile, NamesFile, NoiseFile, NuisanceFile, SensorFile};
use crate::finding::{Key, each};
use crate::shape::quoted;
use crate::vehicle::{ErrorKey, JointKind, Nuisance, Sensor, SensorKind, SlowError};
use poinsot_files::list;
use poinsot_spatial::{Matrix3, Vector3, principal_axes};
use serde::Deserialize;
use std::collections::HashMap;
use toml::Value;

/// Parts that a sensor of joints, wheels or thrusters can measure.
struct Readable<'a> {
    kind: SensorKind,
    /// Table of the file.
    table: &'static str,
    /// Index in the file, name, unit.
    items: Vec<(usize, &'a str, &'static str)>,
}

/// A sensor of the file.
struct Declared<'f> {
    file: &'f SensorFile,
    /// With the meaning of `seen_from`.
    kind: SensorKind,
    key: Key,
}

fn readables(file: &ModelFile) -> [Readable<'_>; 4] {
    let joints = |kind, revolute, prismatic| {
        let items = each(&file.joint, |k, joint| {
            let unit = match joint.kind? {
                JointKind::Revolute => revolute,
                JointKind::Prismatic => prismatic,
                JointKind::Fixed => return None,
            };
            Some((k, joint.name.as_deref()?, unit))
        });
        Readable {
            kind,
            table: "joint",
            items,
        }
    };
    [
        joints(SensorKind::JointPosition, "rad", "m"),
        joints(SensorKind::JointRate, "rad_s", "m_s"),
        Readable {
            kind: SensorKind::WheelSpeed,
            table: "wheel",
            items: each(&file.wheel, |k, w| Some((k, w.name.as_deref()?, "rad_s"))),
        },
        Readable {
            kind: SensorKind::Thrust,
            table: "thruster",
            items: each(&file.thruster, |k, t| Some((k, t.name.as_deref()?, "N"))),
        },
    ]
}

/// Types with `seen_from`, in quotes.
fn can_see() -> String {
    let all = SensorKind::declared().filter(|kind| kind.seen_from_a_body().is_some());
    quoted(&all.map(SensorKind::word).collect::<Vec<_>>())
}

impl Check<'_, '_> {
    pub fn sensors(&mut self) -> Vec<Sensor> {
        let readable = readables(self.file);
        each(&self.file.sensor, |k, file| {
            self.sensor_on_body(k, file, &readable)
        })
    }

    fn sensor_on_body(
        &mut self,
        k: usize,
        file: &SensorFile,
        readable: &[Readable<'_>],
    ) -> Option<Sensor> {
        let key = Key::entry("sensor", k, file.name.as_deref());
        let name = file.body.as_deref();
        let body = name.map_or(Some(0), |name| self.body_of(Some(name)));
        let kind = file.kind?.0;
        let from = self.seen_from(file, (kind, body), &key);
        let kind = from.map_or(kind, |(relative, _)| relative);
        let readable = readable.iter().find(|r| r.kind == kind);
        let sensor = self.sensor(&Declared { file, kind, key }, readable);
        Some(Sensor {
            body: body?,
            seen_from: from?.1,
            ..sensor?
        })
    }

    /// The kind of a sensor, and the body from which it sees its own; 0 where it sees from none.
    fn seen_from(
        &mut self,
        file: &SensorFile,
        (kind, body): (SensorKind, Option<usize>),
        key: &Key,
    ) -> Option<(SensorKind, usize)> {
        let Some(name) = file.seen_from.as_deref() else {
            return Some((kind, 0));
        };
        let here = key.at("seen_from");
        let Some(relative) = kind.seen_from_a_body() else {
            let problem = format!("a sensor of type \"{}\" observes no body", kind.word());
            let remedy = format!("remove it; sensors of type {} can have it", can_see());
            return self.findings.refused("E0118", &here, problem, remedy);
        };
        let from = self.body_of(Some(name))?;
        if body == Some(from) {
            let problem = "the sensor would observe its own body";
            let remedy = "write the observed body as body, and the body that carries the camera as seen_from";
            return self.findings.refused("E0118", &here, problem, remedy);
        }
        Some((relative, from))
    }

    fn sensor(&mut self, own: &Declared, readable: Option<&Readable<'_>>) -> Option<Sensor> {
        let Declared { file, kind, key } = own;
        let before = self.findings.count();
        let unit = self.unit(own);
        let of = readable.map_or_else(Vec::new, |r| self.measured(own, unit, r));
        if kind.is_scalar() && of.is_empty() && self.findings.count() == before {
            let text = "the sensor has no effect: the model has nothing that it could measure; remove it, or add what it measures";
            self.note(&key.at("type"), text);
        }
        // A joint sensor without declared noise has the unit of its joints.
        let first = of.first().zip(readable);
        let first = first.and_then(|(first, r)| r.items.iter().find(|item| item.0 == *first));
        let unit = unit.or(first.map(|item| item.2));
        let unit = unit.or(kind.units().first().copied())?;
        let noise_covariance = self.noise(own, &format!("noise_{unit}"));
        let (noise_covariance, slow) = self.slow(own, unit, noise_covariance);
        let quantisation = file.sample_errors.get(&format!("quantisation_{unit}"));
        let rotation = self.rotation(file.rotation_xyzw, file.rotation_matrix, key);
        let reference_N = self.reference(own);
        let mut nuisance = |error: ErrorKey, value: &Option<NuisanceFile>, unit_key: &str| {
            let here = key.at(error.word());
            let found = self.nuisance(value, &here, unit_key);
            if found != Nuisance::Known && !kind.unknown_errors().contains(&error) {
                self.refuse_error(*kind, error, &here);
            }
            found
        };
        let skew = &file.nonorthogonality;
        let sensor = Sensor {
            kind: *kind,
            body: 0,
            seen_from: 0,
            noise_covariance,
            slow,
            quantisation: quantisation.and_then(Value::as_float).unwrap_or(0.0),
            bias: nuisance(ErrorKey::Bias, &file.bias, &format!("sigma_{unit}")),
            scale: nuisance(ErrorKey::Scale, &file.scale, "sigma"),
            misalignment: nuisance(ErrorKey::Misalignment, &file.misalignment, "sigma_rad"),
            nonorthogonality: nuisance(ErrorKey::Nonorthogonality, skew, "sigma_rad"),
            lag: nuisance(ErrorKey::Lag, &file.lag, "sigma_s"),
            R_BS: rotation.unwrap_or_else(Matrix3::identity),
            p_BoS_B: Vector3::from(file.position_m.unwrap_or([0.0; 3])),
            reference_N,
            of,
            name: file.name.clone()?,
        };
        (self.findings.count() == before).then_some(sensor)
    }

    /// An error that no method estimates.
    fn refuse_error(&mut self, kind: SensorKind, error: ErrorKey, key: &Key) {
        let (word, name) = (kind.word(), error.word());
        let problem = format!("the {name} of a sensor of type \"{word}\" cannot be estimated");
        let can: Vec<&str> = kind.unknown_errors().iter().map(|e| e.word()).collect();
        let remedy = match (kind, error) {
            (SensorKind::JointRate, ErrorKey::Lag) => "declare it on the joint_position sensor",
            // A wheel acts by spin inertia times speed alone.
            (SensorKind::WheelSpeed, ErrorKey::Scale) => {
                "write estimate = true on the [[wheel]]: its spin inertia stands for both"
            }
            (SensorKind::Thrust, ErrorKey::Scale) => "write scale on the [[thruster]]",
            _ if can.is_empty() => "remove it",
            _ => &format!("remove it; {} can be estimated", can.join(", ")),
        };
        self.findings.refuse("E0118", key, problem, remedy);
    }

    /// The unit declared by the keys of this sensor.
    fn unit(&mut self, own: &Declared) -> Option<&'static str> {
        let mut declared: Option<&'static str> = None;
        for unit in ["rad", "rad_s", "m", "m_s", "m_s2", "N"] {
            let keys = ["noise", "slow", "quantisation"].map(|what| format!("{what}_{unit}"));
            let walk = format!("walk_{unit}_s05");
            for name in keys
                .iter()
                .chain([&walk])
                .filter(|name| own.file.sample_errors.contains_key(*name))
            {
                if *declared.get_or_insert(unit) != unit {
                    let problem = "one sensor is declared in two units";
                    let remedy = "write one [[sensor]] for revolute and one for prismatic joints";
                    self.findings
                        .refuse("E0118", &own.key.at(name), problem, remedy);
                }
            }
        }
        declared
    }

    /// The vector whose direction is measured, normalised.
    fn reference(&mut self, own: &Declared) -> Option<Vector3> {
        let unit = Vector3::from(own.file.reference_N?).try_normalize(0.0);
        let unit = unit.filter(|v| v.iter().all(|x| x.is_finite()));
        if unit.is_none() {
            let (here, problem) = (own.key.at("reference_N"), "the vector has no direction");
            let remedy = "write a finite vector that is not zero";
            self.findings.refuse("E0118", &here, problem, remedy);
        }
        unit
    }

    /// Indices of what the sensor measures.
    fn measured(
        &mut self,
        own: &Declared,
        unit: Option<&str>,
        readable: &Readable<'_>,
    ) -> Vec<usize> {
        let (here, items) = (own.key.at("of"), readable.items.iter());
        let Some(names) = &own.file.of else {
            let fits = items.filter(|item| unit.is_none_or(|unit| unit == item.2));
            return fits.map(|item| item.0).collect();
        };
        let by_name: HashMap<&str, _> = items.clone().map(|item| (item.1, item)).collect();
        let known: Vec<&str> = items.map(|item| item.1).collect();
        let mut of: Vec<usize> = Vec::new();
        for (k, name) in names.as_slice().iter().enumerate() {
            let here = match names {
                NamesFile::One(_) => here.clone(),
                NamesFile::Many(_) => here.index(k),
            };
            match (by_name.get(name.as_str()), unit) {
                (None, _) => unknown_name(&here, readable.table, name, &known, self.findings),
                (Some((_, _, own)), Some(unit)) if unit != *own => {
                    let problem = format!(
                        "this joint is measured in {own}, but its noise is declared in {unit}"
                    );
                    let remedy = format!("write noise_{own} or quantisation_{own}");
                    self.findings.refuse("E0105", &here, problem, remedy);
                }
                (Some(item), _) => of.push(item.0),
            }
        }
        of.sort_unstable();
        of.dedup();
        of
    }

    /// The white noise and what lasts over samples; with a correlation time alone, all noise does.
    fn slow(
        &mut self,
        own: &Declared,
        unit: &str,
        white: Option<Matrix3>,
    ) -> (Option<Matrix3>, Vec<SlowError>) {
        let [slow, walk] = [format!("slow_{unit}"), format!("walk_{unit}_s05")];
        let lasting = self.noise(own, &slow);
        let walk = self.noise(own, &walk).zip(Some(f64::INFINITY));
        let (white, process) = match (lasting, own.file.correlation_s) {
            (Some(_), None) => {
                let problem = "how long the slow error lasts is missing";
                let remedy = "write correlation_s, the time after which it has fallen to 1/e, s";
                self.findings
                    .refuse("E0118", &own.key.at(&slow), problem, remedy);
                (white, None)
            }
            (None, Some(time)) => (None, white.zip(Some(time))),
            (lasting, time) => (white, lasting.zip(time)),
        };
        let slow = process.into_iter().chain(walk);
        let slow = slow.map(|(covariance, correlation_s)| SlowError {
            covariance,
            correlation_s,
        });
        (white, slow.collect())
    }

    /// Covariance of one sample from one sigma, three sigmas, or the symmetric square root of the covariance.
    fn noise(&mut self, own: &Declared, name: &str) -> Option<Matrix3> {
        let (here, noise) = (own.key.at(name), own.file.sample_errors.get(name)?);
        let problem = match NoiseFile::deserialize(noise.clone()).ok()? {
            NoiseFile::Scalar(sigma) => {
                return Some(Matrix3::from_diagonal_element(sigma * sigma));
            }
            _ if own.kind.is_scalar() => {
                format!("a sensor of type \"{}\" has no axes", own.kind.word())
            }
            _ if own.kind == SensorKind::Direction => {
                "the noise of a direction is an angle, alike in every sense across it".to_owned()
            }
            NoiseFile::Axes(sigmas) => {
                let variances = Vector3::from(sigmas.map(|sigma| sigma * sigma));
                return Some(Matrix3::from_diagonal(&variances));
            }
            NoiseFile::Matrix(rows) => {
                let root = Matrix3::from(rows).transpose();
                let (moments, _) = principal_axes(&(0.5 * (root + root.transpose())));
                let asymmetry = root - root.transpose();
                if asymmetry.amax() <= 1e-9 * root.amax() && moments[0] > 1e-12 * moments[2] {
                    return Some(root * root);
                }
                let problem = format!(
                    "the matrix is not symmetric and positive definite: eigenvalues {}",
                    list(&moments)
                );
                let remedy = "write the symmetric square root S of the covariance S S";
                return self.findings.refused("E0118", &here, problem, remedy);
            }
        };
        self.findings
            .refused("E0118", &here, problem, "write one number")
    }
}
