//! Mass properties: physical, and sufficient to determine every motion.

use crate::check::Check;
use crate::file::{BodyFile, InertiaFile, Parameter, Which};
use crate::finding::Key;
use crate::vehicle::{Body, EstimateSet, JointKind, Model};
use poinsot_files::{list, short};
use poinsot_spatial::{MassProperties, Matrix3, Unphysical, Vector3, tensor};

/// Tolerance of the triangle inequality, relative to the largest principal moment: covers rounding to seven digits.
pub(crate) const PHYSICAL_TOLERANCE: f64 = 1e-6;

/// Share by which a guessed tensor may be off the nearest physical one before it is taken for a mistake. A rule of thumb.
const GUESS: f64 = 0.05;

/// Smallest mass accepted, kg: a nanogram.
pub(crate) const SMALLEST_MASS: f64 = 1e-12;

fn estimate_set(file: Option<&Which<Parameter>>) -> EstimateSet {
    let asks = |what| Which::asks(file, &what);
    EstimateSet {
        mass: asks(Parameter::Mass),
        com: asks(Parameter::Com),
        inertia: asks(Parameter::Inertia),
    }
}

impl InertiaFile {
    /// The tensor, if its moments are given.
    pub(crate) fn tensor(&self) -> Option<Matrix3> {
        let [xy, xz, yz] = [self.xy, self.xz, self.yz].map(|x| x.unwrap_or(0.0));
        Some(tensor([self.xx?, xy, self.yy?, xz, yz, self.zz?]))
    }
}

impl Check<'_, '_> {
    /// One body; an invalid one is replaced by a default.
    pub fn body(&mut self, k: usize, file: &BodyFile) -> Body {
        let key = Key::entry("body", k, file.name.as_deref());
        let estimate = estimate_set(file.estimate.as_ref());
        let before = self.findings.count();
        let given = self.mass_properties(file, &key);
        let nominal = given.and_then(|given| self.physical(given, estimate, &key));
        if let Some(nominal) = nominal.as_ref().filter(|_| estimate.any()) {
            self.estimate(nominal, &key);
        }
        let priors = file.prior.map_or([None; 3], |p| [p.mass, p.com, p.inertia]);
        let asked = [estimate.mass, estimate.com, estimate.inertia];
        let names = ["mass_kg", "com_m", "inertia_kg_m2"].into_iter();
        for ((name, prior), asked) in names.zip(priors).zip(asked) {
            if prior.is_some() && !asked {
                let text = "the prior has no effect: the number is not estimated; remove it, or estimate the number";
                self.note(&key.at("prior").at(name), text);
            }
        }
        // An invalid body counts as massive, to avoid errors about joints that move it.
        let massive = MassProperties {
            mass: 1.0,
            ..MassProperties::ZERO
        };
        let valid = nominal.filter(|_| self.findings.count() == before);
        Body {
            name: file.name.clone().unwrap_or_default(),
            nominal: valid.unwrap_or(massive),
            given: given.filter(|given| valid.is_some_and(|valid| valid != *given)),
            estimate,
            prior: file.prior,
            joint: None,
        }
    }

    fn mass_properties(&mut self, file: &BodyFile, key: &Key) -> Option<MassProperties> {
        let mass = file.mass_kg.filter(|mass| *mass >= 0.0)?;
        if mass > 0.0 && mass < SMALLEST_MASS {
            let problem = format!("the mass is below {SMALLEST_MASS:e} kg");
            let remedy = "correct it; 0 means a body without mass";
            return self
                .findings
                .refused("E0108", &key.at("mass_kg"), problem, remedy);
        }
        let absent = [
            ("com_m", file.com_m.is_none()),
            ("inertia_kg_m2", file.inertia_kg_m2.is_none()),
        ];
        let absent = absent
            .into_iter()
            .filter(|(_, absent)| mass > 0.0 && *absent);
        for here in absent.clone().map(|(name, _)| key.at(name)) {
            if !self.findings.has_near(&here) {
                let problem = "the key is missing on a body that has mass";
                let remedy = "give it, if need be as a rough guess with estimate = true";
                self.findings.refuse("E0106", &here, problem, remedy);
            }
        }
        if absent.count() > 0 {
            return None;
        }
        let inertia = match &file.inertia_kg_m2 {
            Some(inertia) => inertia.tensor()?,
            None => Matrix3::zeros(),
        };
        let nominal = MassProperties {
            mass,
            p_BoBcm_B: Vector3::from(file.com_m.unwrap_or([0.0; 3])),
            I_BBcm_B: inertia,
        };
        let (here, gyration) = (key.at("inertia_kg_m2"), nominal.radius_of_gyration());
        if gyration > 5.0 || (gyration > 0.0 && gyration < 1e-3) {
            let gyration = short(gyration);
            let text = format!(
                "the radius of gyration is {gyration} m; are mass in kg and inertia in kg m2?"
            );
            self.note(&here, text);
        }
        if inertia == Matrix3::identity() {
            let text = "the inertia is 1 kg m2 about every axis; is it a placeholder?";
            self.note(&here, text);
        }
        Some(nominal)
    }

    /// The body, or the nearest that is physical where its tensor is unknown and no farther off than a guess may be.
    fn physical(
        &mut self,
        given: MassProperties,
        estimate: EstimateSet,
        key: &Key,
    ) -> Option<MassProperties> {
        let Err(fault) = given.check_physical(PHYSICAL_TOLERANCE) else {
            return Some(given);
        };
        let tensor = matches!(fault, Unphysical::Triangle(_) | Unphysical::Indefinite(_));
        if tensor && estimate.inertia {
            let near = given.nearest_physical();
            let off = (near.I_BBcm_B - given.I_BBcm_B).norm();
            if off <= GUESS * given.I_BBcm_B.norm() {
                let here = key.at("inertia_kg_m2");
                let moments = list(&given.principal().0);
                let text = format!(
                    "these principal moments are not physical: {moments} kg m2, the largest exceeds the sum of the other two; a fit starts from the nearest tensor that is"
                );
                self.note(&here, text);
                return Some(near);
            }
        }
        self.refuse_unphysical(fault, key);
        None
    }

    fn refuse_unphysical(&mut self, fault: Unphysical, key: &Key) {
        let inertia = key.at("inertia_kg_m2");
        let correct = "correct the numbers; they are tensor elements (xy = -integral x y dm) about the mass centre";
        let (code, key, problem, remedy) = match fault {
            Unphysical::NotFinite | Unphysical::NegativeMass(_) => {
                let problem = "the mass properties are not finite".to_owned();
                ("E0108", key, problem, "write finite numbers")
            }
            Unphysical::MasslessWithInertia => {
                let problem = "the body has inertia but no mass".to_owned();
                (
                    "E0116",
                    &inertia,
                    problem,
                    "give it a mass, or zero inertia",
                )
            }
            Unphysical::Indefinite(moments) => {
                let moments = list(&moments);
                let problem = format!("the smallest principal moment is negative: {moments} kg m2");
                ("E0115", &inertia, problem, correct)
            }
            Unphysical::Triangle(moments) => {
                let problem = format!(
                    "these principal moments are not physical: {} kg m2, the largest exceeds the sum of the other two",
                    list(&moments)
                );
                ("E0115", &inertia, problem, correct)
            }
        };
        self.findings.refuse(code, key, problem, remedy);
    }

    /// Nominal numbers set the scale of an estimate.
    fn estimate(&mut self, nominal: &MassProperties, key: &Key) {
        let here = key.at("estimate");
        let (moments, _) = nominal.principal();
        let (problem, remedy) = if nominal.mass == 0.0 {
            (
                "the body is to be estimated but its nominal mass is zero",
                "give a rough positive mass_kg, com_m and inertia_kg_m2, or remove estimate",
            )
        } else if moments[2] <= 0.0 {
            (
                "the body is to be estimated but its nominal inertia is zero",
                "give a rough positive inertia_kg_m2: it sets the scale of the estimate",
            )
        } else {
            if moments[0] + moments[1] - moments[2] <= PHYSICAL_TOLERANCE * moments[2] {
                let text = "the nominal body is flat or thin to rounding: it is at the limit of physical mass properties";
                self.note(&key.at("inertia_kg_m2"), text);
            }
            return;
        };
        self.findings.refuse("E0117", &here, problem, remedy);
    }

    /// Reports joints that move no mass: momentum does not depend on their rate.
    pub fn massless(&mut self, model: &Model, order: &[usize]) {
        let carried = carried_mass(model);
        let key = |k: usize| {
            let name = model.bodies.get(k).map(|b| b.name.as_str());
            Key::entry("body", order.get(k).copied().unwrap_or(k), name).at("mass_kg")
        };
        if carried.first() == Some(&0.0) {
            let problem = "no body of the vehicle has mass";
            self.findings
                .refuse("E0116", &key(0), problem, "give the base a mass");
            return;
        }
        for (k, body) in model.bodies.iter().enumerate() {
            let Some(joint) = model.joint_of(body) else {
                continue;
            };
            let weightless = carried.get(k) == Some(&0.0);
            // For a massless chain only the joint next to a massive body is reported.
            let held = carried.get(joint.parent).is_some_and(|m| *m > 0.0);
            let moves = || joint.kind != JointKind::Fixed || moving_part(model, k);
            if weightless && held && moves() {
                let problem = format!(
                    "the body moves on joint \"{}\", but neither it nor its outboard bodies have mass",
                    joint.name
                );
                let remedy = "give it a mass, make its joint fixed, or remove it";
                self.findings.refuse("E0116", &key(k), problem, remedy);
            }
        }
    }

    /// Adds a note for rigidly connected unknown bodies: only their sum is identifiable.
    pub fn together(&mut self, model: &Model, order: &[usize]) {
        for (k, body) in model
            .bodies
            .iter()
            .enumerate()
            .filter(|b| b.1.estimate.any())
        {
            let fixed = model.joint_of(body).filter(|j| j.kind == JointKind::Fixed);
            let parent = fixed.and_then(|joint| model.bodies.get(joint.parent));
            if let Some(parent) = parent.filter(|parent| parent.estimate.any()) {
                let at = order.get(k).copied().unwrap_or(k);
                let text = format!(
                    "the body is fixed to \"{}\", which is unknown too: only their sum is identifiable; fix one of them",
                    parent.name
                );
                let key = Key::entry("body", at, Some(&body.name)).at("estimate");
                self.note(&key, text);
            }
        }
    }
}

/// Mass of the subtree of each body, including the body.
fn carried_mass(model: &Model) -> Vec<f64> {
    let mut carried: Vec<f64> = model.bodies.iter().map(|b| b.nominal.mass).collect();
    for (k, body) in model.bodies.iter().enumerate().rev() {
        let own = carried.get(k).copied().unwrap_or(0.0);
        let parent = model.joint_of(body).map(|joint| joint.parent);
        if let Some(sum) = parent.and_then(|p| carried.get_mut(p)) {
            *sum += own;
        }
    }
    carried
}

/// Whether what a massless body carries by fixed joints contains a moving joint.
fn moving_part(model: &Model, root: usize) -> bool {
    let mut inside = vec![root];
    for (k, body) in model.bodies.iter().enumerate().skip(root + 1) {
        let joint = model
            .joint_of(body)
            .filter(|joint| inside.contains(&joint.parent));
        match joint.map(|joint| joint.kind) {
            Some(JointKind::Fixed) => inside.push(k),
            Some(_) => return true,
            None => {}
        }
    }
    false
}
