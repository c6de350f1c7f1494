//! Checks wheels, thrusters, momentum, environment, and nuisance parameters common to these and to sensors.

use crate::check_rotation::check_axis;
use crate::check_tree::unknown_name;
use crate::file::{
    EnvironmentFile, Gravity, MomentumFile, MomentumVectorFile, MomentumWord, NuisanceFile,
    NuisanceWord, OrbitFile, RandomTorqueFile, ThrusterFile, WheelFile,
};
use crate::finding::{Findings, Key};
use crate::vehicle::{
    Body, Environment, Momentum, MomentumKnowledge, Nuisance, Orbit, Propellant, RandomTorque,
    Thruster, Wheel,
};
use poinsot_files::short;
use poinsot_spatial::Vector3;
use std::f64::consts::{PI, TAU};

/// A positive number; `None` if invalid.
pub(crate) fn positive(
    value: f64,
    key: &Key,
    code: &'static str,
    what: &str,
    findings: &mut Findings<'_, '_>,
) -> Option<f64> {
    if value > 0.0 {
        return Some(value);
    }
    findings.refuse(
        code,
        key,
        format!("{what} must be greater than zero"),
        "give a positive number",
    );
    None
}

/// A nuisance parameter with its prior in the unit of `unit_key`, for example `sigma_rad`.
pub(crate) fn check_nuisance(
    file: Option<&NuisanceFile>,
    key: &Key,
    unit_key: &str,
    findings: &mut Findings<'_, '_>,
) -> Nuisance {
    let sigma = match file {
        None | Some(NuisanceFile::Word(NuisanceWord::None)) => return Nuisance::Known,
        Some(NuisanceFile::Word(NuisanceWord::Estimate)) => return Nuisance::Estimate,
        Some(NuisanceFile::Sigma(sigma)) => sigma,
    };
    let mut known = None;
    for (name, value) in sigma.entries() {
        let Some(value) = value else { continue };
        if name == unit_key {
            known = positive(value, &key.at(name), "E0118", "one sigma", findings);
        } else {
            findings.refuse(
                "E0105",
                &key.at(name),
                "wrong unit".to_owned(),
                format!("write {unit_key} here"),
            );
        }
    }
    if sigma.entries().iter().all(|(_, value)| value.is_none()) && !findings.has_near(key) {
        findings.refuse(
            "E0118",
            key,
            "the table is empty".to_owned(),
            format!("write {{ {unit_key} = x }} or \"estimate\""),
        );
    }
    known.map_or(Nuisance::Known, Nuisance::Prior)
}

pub(crate) fn check_wheels(
    files: &[WheelFile],
    resolve: &impl Fn(&str) -> Option<usize>,
    body_names: &[&str],
    bodies: &[Body],
    findings: &mut Findings<'_, '_>,
) -> Vec<Wheel> {
    let mut wheels = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let key = Key::entry("wheel", k, file.name.as_deref());
        let body = check_host(file.body.as_deref(), &key, resolve, body_names, findings);
        let axis = file
            .axis
            .and_then(|axis| check_axis(&axis, &key.at("axis"), "axis", findings));
        let here = key.at("spin_inertia_kg_m2");
        let spin = file
            .spin_inertia_kg_m2
            .and_then(|spin| positive(spin, &here, "E0108", "the spin inertia", findings));
        let (Some(name), Some(body), Some(axis), Some(spin)) = (&file.name, body, axis, spin)
        else {
            continue;
        };
        if let Some(host) = bodies.get(body) {
            let along = axis.dot(&(host.nominal.I_BBcm_B * axis));
            if spin > along {
                findings.note(
                    &here,
                    format!(
                        "the rotor has more inertia than its body \"{}\" about this axis ({} kg m2), which should contain it; add it there",
                        host.name,
                        short(along)
                    ),
                );
            }
        }
        wheels.push(Wheel {
            name: name.clone(),
            body,
            axis_B: axis,
            spin_inertia: spin,
            estimate: file.estimate.unwrap_or(false),
            misalignment: check_nuisance(
                file.misalignment.as_ref(),
                &key.at("misalignment"),
                "sigma_rad",
                findings,
            ),
        });
    }
    wheels
}

pub(crate) fn check_thrusters(
    files: &[ThrusterFile],
    resolve: &impl Fn(&str) -> Option<usize>,
    body_names: &[&str],
    bodies: &[Body],
    findings: &mut Findings<'_, '_>,
) -> Vec<Thruster> {
    let mut thrusters = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let key = Key::entry("thruster", k, file.name.as_deref());
        let body = check_host(file.body.as_deref(), &key, resolve, body_names, findings);
        let direction = file.force_direction.and_then(|direction| {
            check_axis(
                &direction,
                &key.at("force_direction"),
                "force direction",
                findings,
            )
        });
        let scale = check_nuisance(file.scale.as_ref(), &key.at("scale"), "sigma", findings);
        let host = body.and_then(|body| bodies.get(body));
        let propellant = check_propellant(file, &key, host, findings);
        let (Some(name), Some(body), Some(position), Some(direction)) =
            (&file.name, body, file.position_m, direction)
        else {
            continue;
        };
        thrusters.push(Thruster {
            name: name.clone(),
            body,
            p_BoT_B: Vector3::from(position),
            direction_B: direction,
            scale,
            propellant,
        });
    }
    thrusters
}

/// What a thruster uses up, where a specific impulse is given.
fn check_propellant(
    file: &ThrusterFile,
    key: &Key,
    host: Option<&Body>,
    findings: &mut Findings<'_, '_>,
) -> Option<Propellant> {
    let place = file.propellant_m.map(Vector3::from);
    let Some(specific) = file.specific_impulse_s else {
        let sigmas = file.uncertainty.clone().unwrap_or_default();
        let beside = [
            ("propellant_m", place.is_some()),
            (
                "uncertainty.specific_impulse",
                sigmas.specific_impulse.is_some(),
            ),
            ("uncertainty.propellant_m", sigmas.propellant_m.is_some()),
        ];
        if let Some((other, _)) = beside.iter().find(|(_, given)| *given) {
            findings.refuse(
                "E0106",
                &key.at("specific_impulse_s"),
                format!("required key missing beside {other}"),
                "give the specific impulse in s",
            );
        }
        return None;
    };
    let here = key.at("specific_impulse_s");
    let specific = positive(specific, &here, "E0108", "the specific impulse", findings)?;
    Some(Propellant {
        specific_impulse: specific,
        p_BoF_B: place.or(host.map(|b| b.nominal.p_BoBcm_B))?,
    })
}

/// Index of the host body.
pub(crate) fn check_host(
    name: Option<&str>,
    key: &Key,
    resolve: &impl Fn(&str) -> Option<usize>,
    body_names: &[&str],
    findings: &mut Findings<'_, '_>,
) -> Option<usize> {
    let name = name?;
    let found = resolve(name);
    if found.is_none() {
        unknown_name(&key.at("body"), "body", name, body_names, findings);
    }
    found
}

pub(crate) fn check_momentum(file: Option<&MomentumFile>) -> Momentum {
    let know = |file: Option<&MomentumVectorFile>| match file {
        None | Some(MomentumVectorFile::Word(MomentumWord::Estimate)) => {
            MomentumKnowledge::Estimate
        }
        Some(MomentumVectorFile::Word(MomentumWord::Zero)) => {
            MomentumKnowledge::Known(Vector3::zeros())
        }
        Some(MomentumVectorFile::Known(vector)) => MomentumKnowledge::Known(Vector3::from(*vector)),
    };
    Momentum {
        linear: know(file.and_then(|f| f.linear_N_s.as_ref())),
        angular: know(file.and_then(|f| f.angular_N_m_s.as_ref())),
    }
}

/// Elements of the reference orbit; `None` if invalid.
fn check_orbit(
    file: &OrbitFile,
    gradient: bool,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<Orbit> {
    if !gradient {
        findings.refuse(
            "E0106",
            key,
            "an orbit without effect".to_owned(),
            "add gravity_gradient = true with gravity = \"point_mass\", or remove it",
        );
        return None;
    }
    let axis_key = key.at("semi_major_axis_m");
    let semi_major_axis = positive(
        file.semi_major_axis_m?,
        &axis_key,
        "E0108",
        "the semi-major axis",
        findings,
    )?;
    let eccentricity = file.eccentricity.unwrap_or(0.0);
    if !(0.0..1.0).contains(&eccentricity) {
        findings.refuse(
            "E0108",
            &key.at("eccentricity"),
            "the eccentricity must be at least 0 and below 1".to_owned(),
            "give an ellipse, or the positions as columns orbit_x orbit_y orbit_z",
        );
        return None;
    }
    let angles = [
        ("inclination_rad", file.inclination_rad, PI),
        ("raan_rad", file.raan_rad, TAU),
        (
            "argument_of_periapsis_rad",
            file.argument_of_periapsis_rad,
            TAU,
        ),
        ("true_anomaly_rad", file.true_anomaly_rad, TAU),
    ];
    let before = findings.count();
    for (name, angle, most) in angles {
        if let Some(angle) = angle.filter(|a| a.abs() > most) {
            findings.refuse(
                "E0108",
                &key.at(name),
                format!("the angle is beyond {} rad", short(most)),
                format!(
                    "write radians; {} deg are {} rad",
                    short(angle),
                    short(angle.to_radians())
                ),
            );
        }
    }
    if findings.count() > before {
        return None;
    }
    Some(Orbit {
        semi_major_axis,
        eccentricity,
        inclination: file.inclination_rad.unwrap_or(0.0),
        raan: file.raan_rad.unwrap_or(0.0),
        argument_of_periapsis: file.argument_of_periapsis_rad.unwrap_or(0.0),
        true_anomaly: file.true_anomaly_rad.unwrap_or(0.0),
        epoch: file.epoch_s,
    })
}

pub(crate) fn check_environment(
    file: Option<&EnvironmentFile>,
    findings: &mut Findings<'_, '_>,
) -> Environment {
    let Some(file) = file else {
        return Environment::default();
    };
    let key = Key::top("environment");
    let point_mass = file.gravity == Some(Gravity::PointMass);
    let gm_key = key.at("gm_m3_s2");
    let gm = file.gm_m3_s2.and_then(|gm| {
        positive(
            gm,
            &gm_key,
            "E0108",
            "the gravitational parameter",
            findings,
        )
    });
    if point_mass && file.gm_m3_s2.is_none() && !findings.has_near(&gm_key) {
        findings.missing(
            &gm_key,
            "the key is missing with gravity = \"point_mass\"",
            "add it: 3.986004418e14 for the Earth",
        );
    }
    if file.gm_m3_s2.is_some() && !point_mass {
        findings.refuse(
            "E0106",
            &gm_key,
            "a gravitational parameter without gravity".to_owned(),
            "add gravity = \"point_mass\", or remove it",
        );
    }
    let gradient = file.gravity_gradient.unwrap_or(false);
    if gradient && !point_mass {
        findings.refuse(
            "E0106",
            &key.at("gravity_gradient"),
            "a gravity gradient without gravity".to_owned(),
            "add gravity = \"point_mass\" and gm_m3_s2, or remove it",
        );
    }
    let orbit = file
        .orbit
        .as_ref()
        .and_then(|orbit| check_orbit(orbit, gradient, &key.at("orbit"), findings));
    let mut nuisance = |file: &Option<NuisanceFile>, name: &str, unit_key: &str| {
        check_nuisance(file.as_ref(), &key.at(name), unit_key, findings)
    };
    Environment {
        point_mass_gm: if point_mass { gm } else { None },
        gravity_gradient: gradient,
        orbit,
        disturbance_torque_inertial: nuisance(
            &file.disturbance_torque_inertial,
            "disturbance_torque_inertial",
            "sigma_N_m",
        ),
        disturbance_torque: nuisance(&file.disturbance_torque, "disturbance_torque", "sigma_N_m"),
        drag_torque: nuisance(&file.drag_torque, "drag_torque", "sigma_kg_m2"),
        random_torque: random_torque(file.random_torque.as_ref(), &key, findings),
    }
}

fn random_torque(
    file: Option<&RandomTorqueFile>,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<RandomTorque> {
    let file = file?;
    let key = key.at("random_torque");
    let mut number = |value: f64, name: &str, what: &str| {
        positive(value, &key.at(name), "E0118", what, findings)
    };
    let sigma_N_m = number(file.sigma_N_m, "sigma_N_m", "one sigma");
    let correlation_s = number(file.correlation_s, "correlation_s", "a correlation time");
    Some(RandomTorque {
        sigma_N_m: sigma_N_m?,
        correlation_s: correlation_s?,
    })
}
