//! Checks a file and converts it to a [`Model`]. Every table has its own check, which reports all findings and drops
//! invalid entries.

use crate::check_body::{check_bodies, check_massless, check_together};
use crate::check_joint::check_joints;
use crate::check_known::known;
use crate::check_mode::{check_carried, check_modes};
use crate::check_name::check_names;
use crate::check_rest::{check_environment, check_momentum, check_thrusters, check_wheels};
use crate::check_sensor::check_sensors;
use crate::check_telemetry::check_telemetry;
use crate::check_tree::{Tree, check_tree};
use crate::file::{BodyFile, ModelFile};
use crate::finding::{Findings, Key};
use crate::knowledge::Knowledge;
use crate::vehicle::Model;
use std::collections::HashMap;
use toml::Table;

/// Largest number of bodies.
pub(crate) const MOST_BODIES: usize = 10_000;

/// Checks the file. The result is valid only without findings.
pub(crate) fn check_model(
    file: &ModelFile,
    clean: &Table,
    findings: &mut Findings<'_, '_>,
) -> Option<Model> {
    let bodies = file.body.as_deref().unwrap_or(&[]);
    if !check_count(file, findings) {
        return None;
    }
    check_names(file, findings);
    let joint_files = file.joint.as_deref().unwrap_or(&[]);
    let Tree { order, carried_by } = check_tree(bodies, joint_files, findings);

    let places = places(bodies, &order);
    let resolve = |name: &str| places.get(name).copied();
    let in_file_order = check_bodies(bodies, findings);
    let mut model_bodies = Vec::with_capacity(order.len());
    for k in &order {
        let Some(body) = in_file_order.get(*k) else {
            continue;
        };
        let mut body = body.clone();
        body.joint = carried_by.get(*k).copied().flatten();
        model_bodies.push(body);
    }
    let joints = check_joints(joint_files, &resolve, findings);
    let wheels = check_wheels(
        file.wheel.as_deref().unwrap_or(&[]),
        &resolve,
        &model_bodies,
        findings,
    );
    let thrusters = check_thrusters(
        file.thruster.as_deref().unwrap_or(&[]),
        &resolve,
        &model_bodies,
        findings,
    );
    let modes = check_modes(file, &resolve, findings);
    let sensors = check_sensors(file, &resolve, findings);
    let mut model = Model {
        name: file.name.clone().unwrap_or_else(|| "vehicle".to_owned()),
        bodies: model_bodies,
        joints,
        wheels,
        thrusters,
        modes,
        sensors,
        momentum: check_momentum(file.momentum.as_ref()),
        environment: check_environment(file.environment.as_ref(), findings),
        telemetry: check_telemetry(file.telemetry.clone(), Some(file), findings),
        knowledge: Knowledge::default(),
        notes: Vec::new(),
    };
    if model.bodies.len() == bodies.len() && model.joints.len() == joint_files.len() {
        for k in model.seat_sensors() {
            let name = model.sensors.get(k).map(|s| s.name.as_str());
            findings.note(
                &Key::entry("sensor", k, name).at("body"),
                "the body is fixed to the base, and the sensor is taken as one of the base",
            );
        }
    }
    model.knowledge = known(clean, &order, &model, findings);
    // These checks need the whole tree, so every body and joint must be valid.
    if model.bodies.len() == bodies.len() && model.joints.len() == joint_files.len() {
        check_massless(&model, &order, findings);
        check_together(&model, &order, findings);
    }
    if findings.count() == 0 {
        check_carried(&mut model, file, findings);
    }
    Some(model)
}

/// Whether the number of bodies is allowed.
fn check_count(file: &ModelFile, findings: &mut Findings<'_, '_>) -> bool {
    let top = Key::top("body");
    match file.body.as_deref() {
        None => {}
        Some([]) => findings.refuse(
            "E0106",
            &top,
            "there is no body",
            "add [[body]]; the first one is the base",
        ),
        Some(bodies) if bodies.len() > MOST_BODIES => findings.refuse(
            "E0119",
            &top.index(MOST_BODIES),
            format!("the file has {} bodies", bodies.len()),
            format!("keep to {MOST_BODIES} bodies"),
        ),
        Some(_) => return true,
    }
    false
}

/// Index of each named body in model order, in which parents come before children. A body without parent, reported
/// elsewhere, has an index beyond all.
fn places<'f>(bodies: &'f [BodyFile], order: &[usize]) -> HashMap<&'f str, usize> {
    let mut place = vec![usize::MAX; bodies.len()];
    for (k, body) in order.iter().enumerate() {
        if let Some(place) = place.get_mut(*body) {
            *place = k;
        }
    }
    let all = bodies.iter().zip(place).rev();
    all.filter_map(|(b, place)| Some((b.name.as_deref()?, place)))
        .collect()
}
