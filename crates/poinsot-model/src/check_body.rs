//! Mass properties: physical, and sufficient to determine every motion.

use crate::file::{BodyFile, EstimateFile, InertiaFile, Parameter};
use crate::finding::{Findings, Key};
use crate::vehicle::{Body, EstimateSet, JointKind, Model, Prior};
use poinsot_files::{list, short};
use poinsot_spatial::{MassProperties, Matrix3, Unphysical, Vector3};

/// Tolerance of the triangle inequality, relative to the largest principal moment: covers rounding to seven digits.
pub(crate) const PHYSICAL_TOLERANCE: f64 = 1e-6;

/// Smallest mass accepted, kg: a nanogram.
pub(crate) const SMALLEST_MASS: f64 = 1e-12;

/// Checks the bodies in file order; an invalid one is replaced by a default.
pub(crate) fn check_bodies(bodies: &[BodyFile], findings: &mut Findings<'_, '_>) -> Vec<Body> {
    bodies
        .iter()
        .enumerate()
        .map(|(k, body)| check_body(k, body, findings))
        .collect()
}

fn check_body(k: usize, file: &BodyFile, findings: &mut Findings<'_, '_>) -> Body {
    let key = Key::entry("body", k, file.name.as_deref());
    let estimate = estimate_set(file.estimate.as_ref());
    let before = findings.count();
    let nominal = check_mass_properties(file, &key, findings);
    if let Some(nominal) = &nominal {
        check_estimate(&estimate, nominal, &key, findings);
    }
    note_idle_prior(file.prior, &estimate, &key, findings);
    Body {
        name: file.name.clone().unwrap_or_default(),
        // An invalid body counts as massive, to avoid errors about joints that move it.
        nominal: match nominal {
            Some(nominal) if findings.count() == before => nominal,
            _ => MassProperties {
                mass: 1.0,
                ..MassProperties::ZERO
            },
        },
        estimate,
        prior: file.prior,
        joint: None,
    }
}

fn estimate_set(file: Option<&EstimateFile>) -> EstimateSet {
    match file {
        None | Some(EstimateFile::All(false)) => EstimateSet::default(),
        Some(EstimateFile::All(true)) => EstimateSet::ALL,
        Some(EstimateFile::Some(list)) => EstimateSet {
            mass: list.contains(&Parameter::Mass),
            com: list.contains(&Parameter::Com),
            inertia: list.contains(&Parameter::Inertia),
        },
    }
}

fn tensor(file: &InertiaFile) -> Option<Matrix3> {
    let (xx, yy, zz) = (file.xx?, file.yy?, file.zz?);
    let [xy, xz, yz] = [file.xy, file.xz, file.yz].map(|x| x.unwrap_or(0.0));
    Some(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

fn check_mass_properties(
    file: &BodyFile,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) -> Option<MassProperties> {
    let mass = file.mass_kg.filter(|mass| *mass >= 0.0)?;
    if mass > 0.0 && mass < SMALLEST_MASS {
        findings.refuse(
            "E0108",
            &key.at("mass_kg"),
            format!("the mass is below {SMALLEST_MASS:e} kg"),
            "correct it; 0 means a body without mass",
        );
        return None;
    }
    if mass > 0.0 {
        for (name, missing) in [
            ("com_m", file.com_m.is_none()),
            ("inertia_kg_m2", file.inertia_kg_m2.is_none()),
        ] {
            if missing && !findings.has_near(&key.at(name)) {
                findings.missing(
                    &key.at(name),
                    "the key is missing on a body that has mass",
                    "give it, if need be as a rough guess with estimate = true",
                );
            }
        }
        if file.com_m.is_none() || file.inertia_kg_m2.is_none() {
            return None;
        }
    }
    let inertia = match &file.inertia_kg_m2 {
        Some(inertia) => tensor(inertia)?,
        None => Matrix3::zeros(),
    };
    let nominal = MassProperties {
        mass,
        p_BoBcm_B: Vector3::from(file.com_m.unwrap_or([0.0; 3])),
        I_BBcm_B: inertia,
    };
    if let Err(fault) = nominal.check_physical(PHYSICAL_TOLERANCE) {
        refuse_unphysical(fault, key, findings);
        return None;
    }
    let gyration = nominal.radius_of_gyration();
    if gyration > 5.0 || (gyration > 0.0 && gyration < 1e-3) {
        findings.note(
            &key.at("inertia_kg_m2"),
            format!(
                "the radius of gyration is {} m; are mass in kg and inertia in kg m2?",
                short(gyration)
            ),
        );
    }
    if inertia == Matrix3::identity() {
        findings.note(
            &key.at("inertia_kg_m2"),
            "the inertia is 1 kg m2 about every axis; is it a placeholder?",
        );
    }
    Some(nominal)
}

fn refuse_unphysical(fault: Unphysical, key: &Key, findings: &mut Findings<'_, '_>) {
    let inertia = key.at("inertia_kg_m2");
    let remedy = "correct the numbers; they are tensor elements (xy = -integral x y dm) about the mass centre";
    match fault {
        Unphysical::NotFinite | Unphysical::NegativeMass(_) => {
            let problem = "the mass properties are not finite".to_owned();
            findings.refuse("E0108", key, problem, "write finite numbers");
        }
        Unphysical::MasslessWithInertia => findings.refuse(
            "E0116",
            &inertia,
            "the body has inertia but no mass",
            "give it a mass, or zero inertia",
        ),
        Unphysical::Indefinite(moments) => findings.refuse(
            "E0115",
            &inertia,
            format!(
                "the smallest principal moment is negative: {} kg m2",
                list(&moments)
            ),
            remedy,
        ),
        Unphysical::Triangle(moments) => findings.refuse(
            "E0115",
            &inertia,
            format!(
                "these principal moments are not physical: {} kg m2, the largest exceeds the sum of the other two",
                list(&moments)
            ),
            remedy,
        ),
    }
}

fn check_estimate(
    estimate: &EstimateSet,
    nominal: &MassProperties,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) {
    if !estimate.any() {
        return;
    }
    if nominal.mass == 0.0 {
        findings.refuse(
            "E0117",
            &key.at("estimate"),
            "the body is to be estimated but its nominal mass is zero",
            "give a rough positive mass_kg, com_m and inertia_kg_m2, or remove estimate",
        );
        return;
    }
    let (moments, _) = nominal.principal();
    if moments[2] <= 0.0 {
        findings.refuse(
            "E0117",
            &key.at("estimate"),
            "the body is to be estimated but its nominal inertia is zero",
            "give a rough positive inertia_kg_m2: it sets the scale of the estimate",
        );
    } else if moments[0] + moments[1] - moments[2] <= PHYSICAL_TOLERANCE * moments[2] {
        findings.note(
            &key.at("inertia_kg_m2"),
            "the nominal body is flat or thin to rounding: it is at the limit of physical mass properties",
        );
    }
}

/// Notes priors of numbers that are not estimated.
fn note_idle_prior(
    prior: Option<Prior>,
    estimate: &EstimateSet,
    key: &Key,
    findings: &mut Findings<'_, '_>,
) {
    let given = prior.map_or([None; 3], |p| [p.mass, p.com, p.inertia]);
    let asked = [estimate.mass, estimate.com, estimate.inertia];
    for (k, name) in ["mass_kg", "com_m", "inertia_kg_m2"]
        .into_iter()
        .enumerate()
    {
        if given[k].is_some() && !asked[k] {
            findings.note(
                &key.at("prior").at(name),
                "the prior has no effect: the number is not estimated; remove it, or estimate the number",
            );
        }
    }
}

/// Mass of the subtree of each body, including the body.
fn carried_mass(model: &Model) -> Vec<f64> {
    let mut carried: Vec<f64> = model.bodies.iter().map(|b| b.nominal.mass).collect();
    for (k, body) in model.bodies.iter().enumerate().rev() {
        let parent = body
            .joint
            .and_then(|j| model.joints.get(j))
            .map(|j| j.parent);
        let own = carried.get(k).copied().unwrap_or(0.0);
        if let Some(sum) = parent.and_then(|p| carried.get_mut(p)) {
            *sum += own;
        }
    }
    carried
}

/// Reports joints that move no mass: momentum does not depend on their rate.
pub(crate) fn check_massless(model: &Model, order: &[usize], findings: &mut Findings<'_, '_>) {
    let carried = carried_mass(model);
    let key = |k: usize| {
        let name = model.bodies.get(k).map(|b| b.name.as_str());
        Key::entry("body", order.get(k).copied().unwrap_or(k), name).at("mass_kg")
    };
    if carried.first() == Some(&0.0) {
        findings.refuse(
            "E0116",
            &key(0),
            "no body of the vehicle has mass",
            "give the base a mass",
        );
        return;
    }
    for (k, body) in model.bodies.iter().enumerate() {
        let Some(joint) = body.joint.and_then(|j| model.joints.get(j)) else {
            continue;
        };
        let weightless = carried.get(k) == Some(&0.0);
        // For a massless chain only the joint next to a massive body is reported.
        let held = carried.get(joint.parent).is_some_and(|m| *m > 0.0);
        let moves = joint.kind != JointKind::Fixed || moving_part(model, &carried, k);
        if weightless && held && moves {
            findings.refuse(
                "E0116",
                &key(k),
                format!(
                    "the body moves on joint \"{}\", but neither it nor its outboard bodies have mass",
                    joint.name
                ),
                "give it a mass, make its joint fixed, or remove it",
            );
        }
    }
}

/// Whether the massless part fixed to body `root` contains a moving joint.
fn moving_part(model: &Model, carried: &[f64], root: usize) -> bool {
    if carried.get(root) != Some(&0.0) {
        return false;
    }
    let mut inside = vec![false; model.bodies.len()];
    if let Some(mark) = inside.get_mut(root) {
        *mark = true;
    }
    for (k, body) in model.bodies.iter().enumerate().skip(root + 1) {
        let Some(joint) = body.joint.and_then(|j| model.joints.get(j)) else {
            continue;
        };
        if inside.get(joint.parent) == Some(&true) {
            if joint.kind != JointKind::Fixed {
                return true;
            }
            if let Some(mark) = inside.get_mut(k) {
                *mark = true;
            }
        }
    }
    false
}

/// Adds a note for rigidly connected unknown bodies: only their sum is identifiable.
pub(crate) fn check_together(model: &Model, order: &[usize], findings: &mut Findings<'_, '_>) {
    for (k, body) in model.bodies.iter().enumerate() {
        let Some(joint) = body.joint.and_then(|j| model.joints.get(j)) else {
            continue;
        };
        let parent = model.bodies.get(joint.parent);
        let both = body.estimate.any() && parent.is_some_and(|p| p.estimate.any());
        if joint.kind == JointKind::Fixed && both {
            let at = order.get(k).copied().unwrap_or(k);
            findings.note(
                &Key::entry("body", at, Some(&body.name)).at("estimate"),
                format!(
                    "the body is fixed to \"{}\", which is unknown too: only their sum is identifiable; fix one of them",
                    parent.map_or("", |p| p.name.as_str())
                ),
            );
        }
    }
}
