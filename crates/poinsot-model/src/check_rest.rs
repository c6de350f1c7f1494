//! Checks wheels, thrusters, momentum, environment, and nuisance parameters common to these and to sensors.

use crate::check_rotation::check_axis;
use crate::file::{
    EnvironmentFile, Gravity, MomentumFile, MomentumVectorFile, MomentumWord, NuisanceFile,
    NuisanceWord, OrbitFile, ThrusterFile, WheelFile,
};
use crate::finding::{Findings, Key};
use crate::vehicle::{
    Body, Environment, Momentum, MomentumKnowledge, Nuisance, Orbit, Propellant, Thruster, Wheel,
};
use poinsot_files::short;
use poinsot_spatial::Vector3;

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
    for name in sigma.keys().filter(|name| *name != unit_key) {
        let remedy = format!("write {unit_key} here");
        findings.refuse("E0105", &key.at(name), "wrong unit", remedy);
    }
    if sigma.is_empty() && !findings.has_near(key) {
        let remedy = format!("write {{ {unit_key} = x }} or \"estimate\"");
        findings.refuse("E0118", key, "the table is empty", remedy);
    }
    let sigma = sigma.get(unit_key);
    sigma.map_or(Nuisance::Known, |sigma| Nuisance::Prior(*sigma))
}

pub(crate) fn check_wheels(
    files: &[WheelFile],
    resolve: &impl Fn(&str) -> Option<usize>,
    bodies: &[Body],
    findings: &mut Findings<'_, '_>,
) -> Vec<Wheel> {
    let mut wheels = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let key = Key::entry("wheel", k, file.name.as_deref());
        let body = file.body.as_deref().and_then(resolve);
        let axis = file
            .axis
            .and_then(|axis| check_axis(&axis, &key.at("axis"), "axis", findings));
        let here = key.at("spin_inertia_kg_m2");
        let (Some(name), Some(body), Some(axis), Some(spin)) =
            (&file.name, body, axis, file.spin_inertia_kg_m2)
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
            at_rest: file.at_rest.unwrap_or(false),
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
    bodies: &[Body],
    findings: &mut Findings<'_, '_>,
) -> Vec<Thruster> {
    let mut thrusters = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let key = Key::entry("thruster", k, file.name.as_deref());
        let body = file.body.as_deref().and_then(resolve);
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
            never_fires: file.never_fires.unwrap_or(false),
            scale,
            propellant: propellant(file, host),
        });
    }
    thrusters
}

/// What a thruster uses up, where a specific impulse is given.
fn propellant(file: &ThrusterFile, host: Option<&Body>) -> Option<Propellant> {
    let place = file.propellant_m.map(Vector3::from);
    Some(Propellant {
        specific_impulse: file.specific_impulse_s?,
        p_BoF_B: place.or(host.map(|b| b.nominal.p_BoBcm_B))?,
    })
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

fn orbit(file: &OrbitFile) -> Option<Orbit> {
    Some(Orbit {
        semi_major_axis: file.semi_major_axis_m?,
        eccentricity: file.eccentricity.unwrap_or(0.0),
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
    let mut nuisance = |file: &Option<NuisanceFile>, name: &str, unit_key: &str| {
        check_nuisance(file.as_ref(), &key.at(name), unit_key, findings)
    };
    Environment {
        point_mass_gm: match file.gravity {
            Some(Gravity::PointMass) => file.gm_m3_s2,
            _ => None,
        },
        gravity_gradient: file.gravity_gradient.unwrap_or(false),
        orbit: file.orbit.as_ref().and_then(orbit),
        disturbance_torque_inertial: nuisance(
            &file.disturbance_torque_inertial,
            "disturbance_torque_inertial",
            "sigma_N_m",
        ),
        disturbance_torque: nuisance(&file.disturbance_torque, "disturbance_torque", "sigma_N_m"),
        drag_torque: nuisance(&file.drag_torque, "drag_torque", "sigma_kg_m2"),
        random_torque: file.random_torque,
    }
}
