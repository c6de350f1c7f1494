//! Checks a file and converts it to a [`Model`]. Every table has its own check, which reports all findings and drops
//! invalid entries.

use crate::check_known::known;
use crate::check_name::{columns_unique, sensors_unique};
use crate::check_telemetry::check_telemetry;
use crate::check_tree::{Tree, check_tree};
use crate::file::{BodyFile, ModelFile};
use crate::finding::{Findings, Key, all, each};
use crate::vehicle::Model;
use std::collections::HashMap;
use std::fmt;
use toml::Table;

/// Largest number of bodies.
pub(crate) const MOST_BODIES: usize = 10_000;

/// The checks of the tables of a file.
pub(crate) struct Check<'a, 'd> {
    pub file: &'a ModelFile,
    /// Index of each named body in model order. A body without parent, reported elsewhere, has an index beyond all.
    pub places: HashMap<&'a str, usize>,
    pub findings: &'a mut Findings<'d>,
}

impl Check<'_, '_> {
    /// Index of the body with this name.
    pub fn body_of(&self, name: Option<&str>) -> Option<usize> {
        self.places.get(name?).copied()
    }

    /// Adds a note that is not an error.
    pub fn note(&mut self, key: &Key, text: impl fmt::Display) {
        self.findings.note(key, text);
    }
}

/// Checks the file. The result is valid only without findings.
pub(crate) fn check_model(
    file: &ModelFile,
    clean: &Table,
    findings: &mut Findings<'_>,
) -> Option<Model> {
    if !check_count(file, findings) {
        return None;
    }
    sensors_unique(file, findings);
    columns_unique(file, findings);
    let (bodies, joints) = (all(&file.body), all(&file.joint));
    let Tree { order, carried_by } = check_tree(bodies, joints, findings);
    let mut check = Check {
        file,
        places: places(bodies, &order),
        findings,
    };
    let mut in_file_order = each(&file.body, |k, body| Some(check.body(k, body)));
    for (body, joint) in in_file_order.iter_mut().zip(carried_by) {
        body.joint = joint;
    }
    let bodies_in_order = order.iter().filter_map(|k| in_file_order.get(*k).cloned());
    let mut model = Model {
        name: file.name.clone().unwrap_or_else(|| "vehicle".to_owned()),
        bodies: bodies_in_order.collect(),
        joints: each(&file.joint, |k, joint| check.joint(k, joint)),
        momentum: check.momentum(),
        environment: check.environment(),
        ..Model::default()
    };
    model.wheels = each(&file.wheel, |k, w| check.wheel(k, w, &model.bodies));
    model.thrusters = each(&file.thruster, |k, t| check.thruster(k, t, &model.bodies));
    model.modes = check.modes();
    model.sensors = check.sensors();
    model.telemetry = check_telemetry(file.telemetry.clone(), Some(file), check.findings);
    // These checks need the whole tree, so every body and joint must be valid.
    let whole = model.bodies.len() == bodies.len() && model.joints.len() == joints.len();
    for k in model.seat_sensors().into_iter().filter(|_| whole) {
        let name = model.sensors.get(k).map(|s| s.name.as_str());
        let text = "the body is fixed to the base, and the sensor is taken as one of the base";
        check.note(&Key::entry("sensor", k, name).at("body"), text);
    }
    model.knowledge = known(clean, &order, &model, check.findings);
    if whole {
        check.massless(&model, &order);
        check.together(&model, &order);
    }
    if check.findings.count() == 0 {
        check.carried(&mut model);
    }
    Some(model)
}

/// Whether the number of bodies is allowed.
fn check_count(file: &ModelFile, findings: &mut Findings<'_>) -> bool {
    let top = Key::top("body");
    match file.body.as_deref() {
        None => {}
        Some([]) => {
            let remedy = "add [[body]]; the first one is the base";
            findings.refuse("E0106", &top, "there is no body", remedy);
        }
        Some(bodies) if bodies.len() > MOST_BODIES => {
            let problem = format!("the file has {} bodies", bodies.len());
            let remedy = format!("keep to {MOST_BODIES} bodies");
            findings.refuse("E0119", &top.index(MOST_BODIES), problem, remedy);
        }
        Some(_) => return true,
    }
    false
}

/// Index of each named body in model order, in which parents come before children.
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
