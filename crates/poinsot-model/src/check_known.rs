//! Uncertainty of the known numbers: declared per number, by source, or exact.

use crate::file::{ModelFile, SourceFile};
use crate::finding::{Findings, Key};
use crate::knowledge::{Knowledge, KnownNumber, Origin, Uncertain};
use crate::vehicle::Model;

/// Uncertainty declared in one table.
#[derive(Default)]
struct Declared {
    exact: Option<bool>,
    source: Option<SourceFile>,
    /// Uncertainty keys of the table, with values.
    sigmas: Vec<(&'static str, Option<f64>)>,
}

/// Uncertainties of all numbers of a checked model.
pub(crate) fn check_known(
    file: &ModelFile,
    model: &Model,
    findings: &mut Findings<'_, '_>,
) -> Knowledge {
    let mut out = Knowledge::default();
    let whole = (file.exact, file.source);
    for number in model.known_numbers() {
        let Some((key, declared)) = declared(file, model, number) else {
            continue;
        };
        let slot = slot_of(number);
        let given = declared.sigmas.get(slot).copied();
        if let Some((name, Some(sigma))) = given {
            if !(0.0..1.0).contains(&sigma) {
                findings.refuse(
                    "E0118",
                    &key.at("uncertainty").at(name),
                    "one sigma must be at least 0 and below 1".to_owned(),
                    "give a share (0.01 for 1 %), metres or radians as the key says",
                );
                continue;
            }
            if !number.is_known(model) {
                findings.note(
                    &key.at("uncertainty").at(name),
                    "the uncertainty has no effect: the number is estimated, or it defines the axes of its body; remove it"
                        .to_owned(),
                );
            }
            out.uncertain.push(Uncertain { number, sigma });
            continue;
        }
        // A table's own declaration precedes that of the model.
        let own = declared.exact.is_some() || declared.source.is_some();
        let (exact, source) = match own {
            true => (declared.exact, declared.source),
            false => whole,
        };
        if exact == Some(true) {
            continue;
        }
        out.assumed |= source.is_none() && exact.is_none() && number.is_known(model);
        let origin = match source {
            Some(SourceFile::Measured) => Origin::Measured,
            Some(SourceFile::Cad) | None => Origin::Cad,
        };
        out.uncertain.push(Uncertain {
            number,
            sigma: number.usual_sigma(origin),
        });
    }
    out.uncertain.retain(|u| u.sigma > 0.0);
    out.nominal_within = file.nominal_within.filter(|factor| {
        let right = *factor > 1.0;
        if !right {
            findings.refuse(
                "E0108",
                &Key::top("nominal_within"),
                "the factor must be greater than 1".to_owned(),
                "give 3 for a third to three times the nominal numbers",
            );
        }
        right
    });
    out
}

/// Index of a number among the uncertainties of its table.
fn slot_of(number: KnownNumber) -> usize {
    match number {
        KnownNumber::MassCentre(_)
        | KnownNumber::JointAxis(_)
        | KnownNumber::WheelAxis(_)
        | KnownNumber::ForceDirection(_) => 1,
        KnownNumber::Inertia(_) | KnownNumber::ForcePosition(_) => 2,
        KnownNumber::SpecificImpulse(_) => 3,
        KnownNumber::PropellantPlace(_) => 4,
        _ => 0,
    }
}

/// The table of a number in the file, by its name, and its declaration.
fn declared(file: &ModelFile, model: &Model, number: KnownNumber) -> Option<(Key, Declared)> {
    match number {
        KnownNumber::Mass(k) | KnownNumber::MassCentre(k) | KnownNumber::Inertia(k) => {
            let name = model.bodies.get(k)?.name.as_str();
            let at = place(file.body.as_deref()?, name, |t| t.name.as_deref())?;
            let t = file.body.as_deref()?.get(at)?;
            let u = t.uncertainty.clone().unwrap_or_default();
            let sigmas = vec![("mass", u.mass), ("com_m", u.com_m), ("inertia", u.inertia)];
            Some(entry("body", at, name, t.exact, t.source, sigmas))
        }
        KnownNumber::JointOrigin(k) | KnownNumber::JointAxis(k) => {
            let name = model.joints.get(k)?.name.as_str();
            let at = place(file.joint.as_deref()?, name, |t| t.name.as_deref())?;
            let t = file.joint.as_deref()?.get(at)?;
            let u = t.uncertainty.clone().unwrap_or_default();
            let sigmas = vec![("origin_m", u.origin_m), ("axis_rad", u.axis_rad)];
            Some(entry("joint", at, name, t.exact, t.source, sigmas))
        }
        KnownNumber::SpinInertia(k) | KnownNumber::WheelAxis(k) => {
            let name = model.wheels.get(k)?.name.as_str();
            let at = place(file.wheel.as_deref()?, name, |t| t.name.as_deref())?;
            let t = file.wheel.as_deref()?.get(at)?;
            let u = t.uncertainty.clone().unwrap_or_default();
            let sigmas = vec![("spin_inertia", u.spin_inertia), ("axis_rad", u.axis_rad)];
            Some(entry("wheel", at, name, t.exact, t.source, sigmas))
        }
        KnownNumber::Force(k)
        | KnownNumber::ForceDirection(k)
        | KnownNumber::ForcePosition(k)
        | KnownNumber::SpecificImpulse(k)
        | KnownNumber::PropellantPlace(k) => {
            let name = model.thrusters.get(k)?.name.as_str();
            let at = place(file.thruster.as_deref()?, name, |t| t.name.as_deref())?;
            let t = file.thruster.as_deref()?.get(at)?;
            let u = t.uncertainty.clone().unwrap_or_default();
            let sigmas = vec![
                ("force", u.force),
                ("direction_rad", u.direction_rad),
                ("position_m", u.position_m),
                ("specific_impulse", u.specific_impulse),
                ("propellant_m", u.propellant_m),
            ];
            Some(entry("thruster", at, name, t.exact, t.source, sigmas))
        }
        KnownNumber::Mounting(k) => {
            let sensor = model.sensors.get(k)?;
            let list = file.sensor.as_deref()?;
            // Names of sensors are unique only within a type.
            let at = list.iter().position(|t| {
                t.name.as_deref() == Some(sensor.name.as_str())
                    && t.kind
                        .is_some_and(|kind| kind.0 == sensor.kind.declared_as())
            })?;
            let t = list.get(at)?;
            let u = t.uncertainty.clone().unwrap_or_default();
            let sigmas = vec![("mounting_rad", u.mounting_rad)];
            Some(entry("sensor", at, &sensor.name, t.exact, t.source, sigmas))
        }
    }
}

fn place<T>(list: &[T], name: &str, of: impl Fn(&T) -> Option<&str>) -> Option<usize> {
    list.iter().position(|t| of(t) == Some(name))
}

fn entry(
    table: &str,
    at: usize,
    name: &str,
    exact: Option<bool>,
    source: Option<SourceFile>,
    sigmas: Vec<(&'static str, Option<f64>)>,
) -> (Key, Declared) {
    let declared = Declared {
        exact,
        source,
        sigmas,
    };
    (Key::entry(table, at, Some(name)), declared)
}
