//! Checks wheels, thrusters, momentum, environment, and nuisance parameters common to these and to sensors.

use crate::check::Check;
use crate::file::{
    Gravity, MomentumVectorFile, MomentumWord, NuisanceFile, NuisanceWord, OrbitFile, ThrusterFile,
    WheelFile,
};
use crate::finding::Key;
use crate::vehicle::{
    Body, Environment, Momentum, MomentumKnowledge, Nuisance, Orbit, Propellant, Thruster, Wheel,
};
use poinsot_files::short;
use poinsot_spatial::Vector3;

impl Check<'_, '_> {
    /// A nuisance parameter with its prior in the unit of `unit_key`, for example `sigma_rad`.
    pub fn nuisance(&mut self, file: &Option<NuisanceFile>, key: &Key, unit_key: &str) -> Nuisance {
        let sigma = match file {
            None | Some(NuisanceFile::Word(NuisanceWord::None)) => return Nuisance::Known,
            Some(NuisanceFile::Word(NuisanceWord::Estimate)) => return Nuisance::Estimate,
            Some(NuisanceFile::Sigma(sigma)) => sigma,
        };
        let findings = &mut *self.findings;
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

    pub fn wheel(&mut self, k: usize, file: &WheelFile, bodies: &[Body]) -> Option<Wheel> {
        let key = Key::entry("wheel", k, file.name.as_deref());
        let axis_B = self.axis(&file.axis?, &key.at("axis"), "axis")?;
        let (name, spin_inertia) = (file.name.clone()?, file.spin_inertia_kg_m2?);
        let body = self.body_of(file.body.as_deref())?;
        if let Some(host) = bodies.get(body) {
            let along = axis_B.dot(&(host.nominal.I_BBcm_B * axis_B));
            if spin_inertia > along {
                let text = format!(
                    "the rotor has more inertia than its body \"{}\" about this axis ({} kg m2), which should contain it; add it there",
                    host.name,
                    short(along)
                );
                self.note(&key.at("spin_inertia_kg_m2"), text);
            }
        }
        let here = key.at("misalignment");
        Some(Wheel {
            name,
            body,
            axis_B,
            spin_inertia,
            at_rest: file.at_rest.unwrap_or(false),
            estimate: file.estimate.unwrap_or(false),
            misalignment: self.nuisance(&file.misalignment, &here, "sigma_rad"),
        })
    }

    pub fn thruster(&mut self, k: usize, file: &ThrusterFile, bodies: &[Body]) -> Option<Thruster> {
        let key = Key::entry("thruster", k, file.name.as_deref());
        let scale = self.nuisance(&file.scale, &key.at("scale"), "sigma");
        let here = key.at("force_direction");
        let direction_B = self.axis(&file.force_direction?, &here, "force direction")?;
        let body = self.body_of(file.body.as_deref())?;
        Some(Thruster {
            name: file.name.clone()?,
            body,
            p_BoT_B: Vector3::from(file.position_m?),
            direction_B,
            never_fires: file.never_fires.unwrap_or(false),
            scale,
            propellant: propellant(file, bodies.get(body)),
        })
    }

    pub fn momentum(&self) -> Momentum {
        let know = |file: Option<&MomentumVectorFile>| match file {
            None | Some(MomentumVectorFile::Word(MomentumWord::Estimate)) => {
                MomentumKnowledge::Estimate
            }
            Some(MomentumVectorFile::Word(MomentumWord::Zero)) => {
                MomentumKnowledge::Known(Vector3::zeros())
            }
            Some(MomentumVectorFile::Known(vector)) => {
                MomentumKnowledge::Known(Vector3::from(*vector))
            }
        };
        let file = self.file.momentum.as_ref();
        Momentum {
            linear: know(file.and_then(|f| f.linear_N_s.as_ref())),
            angular: know(file.and_then(|f| f.angular_N_m_s.as_ref())),
        }
    }

    pub fn environment(&mut self) -> Environment {
        let Some(file) = &self.file.environment else {
            return Environment::default();
        };
        let key = Key::top("environment");
        let mut nuisance = |file: &Option<NuisanceFile>, name: &str, unit_key: &str| {
            self.nuisance(file, &key.at(name), unit_key)
        };
        let (torque, inertial) = (&file.disturbance_torque, &file.disturbance_torque_inertial);
        Environment {
            point_mass_gm: match file.gravity {
                Some(Gravity::PointMass) => file.gm_m3_s2,
                _ => None,
            },
            gravity_gradient: file.gravity_gradient.unwrap_or(false),
            orbit: file.orbit.as_ref().and_then(orbit),
            disturbance_torque_inertial: nuisance(
                inertial,
                "disturbance_torque_inertial",
                "sigma_N_m",
            ),
            disturbance_torque: nuisance(torque, "disturbance_torque", "sigma_N_m"),
            drag_torque: nuisance(&file.drag_torque, "drag_torque", "sigma_kg_m2"),
            random_torque: file.random_torque,
        }
    }
}

/// What a thruster uses up, where a specific impulse is given.
fn propellant(file: &ThrusterFile, host: Option<&Body>) -> Option<Propellant> {
    let place = file.propellant_m.map(Vector3::from);
    Some(Propellant {
        specific_impulse: file.specific_impulse_s?,
        p_BoF_B: place.or(host.map(|b| b.nominal.p_BoBcm_B))?,
    })
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
