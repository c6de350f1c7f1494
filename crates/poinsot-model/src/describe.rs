//! Describes a vehicle as text and tables, for `poinsot check`.

use crate::file::{JointFile, ModeFile, ThrusterFile, WheelFile};
use crate::vehicle::{Body, Model, MomentumKnowledge, Sensor, printed_unit};
use crate::words::{entry, lines};
use crate::write::file_of;
use poinsot_dynamics::{Kinematics, Vehicle, composite};
use poinsot_files::{list, short};
use poinsot_spatial::MassProperties;
use poinsot_telemetry::TelemetryMap;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::fmt;

/// A summary of a [`Model`], for people (`Display`) and programs (`Serialize`).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Description {
    /// Name of the vehicle.
    pub name: String,
    /// Mass of all bodies, kg.
    pub mass_kg: f64,
    /// Whole vehicle with every joint at its locked position.
    pub system: SystemDescription,
    /// Bodies, the base first.
    pub bodies: Vec<BodyDescription>,
    /// The tree, one line per body.
    pub tree: Vec<String>,
    /// Joints, as in the model file.
    pub joints: Vec<JointFile>,
    /// Wheels, as in the model file.
    pub wheels: Vec<WheelFile>,
    /// Thrusters, as in the model file.
    pub thrusters: Vec<ThrusterFile>,
    /// Flexible modes, as in the model file.
    pub modes: Vec<ModeFile>,
    /// Sensors.
    pub sensors: Vec<SensorDescription>,
    /// Forces and torques of the surroundings, in words.
    pub environment: Vec<String>,
    /// What the map of the telemetry says, in words.
    pub telemetry: Vec<String>,
    /// What is unknown, in words.
    pub unknown: Vec<String>,
    /// Notes of the reader.
    pub notes: Vec<String>,
}

/// Mass centre and inertia of the whole vehicle.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SystemDescription {
    /// Mass centre from the base frame's origin, in base axes, m.
    pub com_m: [f64; 3],
    /// Principal moments about it, ascending, kg m2.
    pub principal_kg_m2: [f64; 3],
}

/// One body.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BodyDescription {
    /// Name.
    pub name: String,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Mass centre in the body's frame, m.
    pub com_m: [f64; 3],
    /// Principal moments about the mass centre, ascending, kg m2.
    pub principal_kg_m2: [f64; 3],
    /// What is unknown: some of "mass", "com", "inertia".
    pub unknown: Vec<&'static str>,
}

/// One sensor.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SensorDescription {
    /// Name.
    pub name: String,
    /// Type as in the file.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Body it sits on.
    pub body: String,
    /// Body from which the sensor sees `body`; absent for a sensor without `seen_from`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seen_from: Option<String>,
    /// Unit of its samples.
    pub unit: &'static str,
    /// One sigma per axis in that unit; null where no noise is declared.
    pub noise: Option<[f64; 3]>,
    /// Least significant bit in that unit; zero where not quantised.
    pub quantisation: f64,
    /// Joints, wheels or thrusters it reads.
    pub of: Vec<String>,
}

/// Summarises a vehicle.
///
/// ```
#[doc = include_str!("../doc/box.txt")]
/// let summary = describe(&model);
/// assert_eq!((summary.mass_kg, summary.bodies.len()), (10.0, 1));
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn describe(model: &Model) -> Description {
    let (mass_kg, system) = whole(model);
    let file = file_of(model);
    let around = file.environment.as_ref();
    let environment = around.map_or_else(|| vec!["free fall".to_owned()], lines);
    Description {
        name: model.name.clone(),
        mass_kg,
        system,
        bodies: model.bodies.iter().map(describe_body).collect(),
        tree: tree(model),
        joints: file.joint.unwrap_or_default(),
        wheels: file.wheel.unwrap_or_default(),
        thrusters: file.thruster.unwrap_or_default(),
        modes: file.mode.unwrap_or_default(),
        sensors: model
            .sensors
            .iter()
            .map(|s| describe_sensor(model, s))
            .collect(),
        environment,
        telemetry: describe_map(&model.telemetry),
        unknown: unknown(model),
        notes: model.notes.clone(),
    }
}

/// One line per entry of the map.
///
/// ```
/// use poinsot_model::{describe_map, parse_telemetry_map};
///
/// let map = parse_telemetry_map(
///     r#"
/// [telemetry.columns]
/// omega_x = { column = "GYR_X", unit = "deg/s" }
/// "#,
///     "map.toml",
/// )?;
/// assert_eq!(describe_map(&map), ["omega_x: column GYR_X, unit deg/s"]);
/// # Ok::<(), poinsot_files::Faults>(())
/// ```
pub fn describe_map(map: &TelemetryMap) -> Vec<String> {
    lines(map)
}

fn describe_body(body: &Body) -> BodyDescription {
    BodyDescription {
        name: body.name.clone(),
        mass_kg: body.nominal.mass,
        com_m: body.nominal.p_BoBcm_B.into(),
        principal_kg_m2: body.nominal.principal().0,
        unknown: body.estimate.words(),
    }
}

fn describe_sensor(model: &Model, s: &Sensor) -> SensorDescription {
    let body_name = |k: usize| model.bodies.get(k).map(|b| b.name.clone());
    let names = s.of.iter().filter_map(|k| model.measured(s, *k));
    SensorDescription {
        name: s.name.clone(),
        kind: s.kind.declared_as().word(),
        body: body_name(s.body).unwrap_or_default(),
        seen_from: body_name(s.seen_from).filter(|_| s.kind.is_relative()),
        unit: printed_unit(model.unit_of(s)),
        noise: s.covariance().map(|c| c.diagonal().map(f64::sqrt).into()),
        quantisation: s.quantisation,
        of: names.map(str::to_owned).collect(),
    }
}

/// Mass, mass centre and principal moments of the whole vehicle, joints at their locked positions.
fn whole(model: &Model) -> (f64, SystemDescription) {
    let vehicle = Vehicle::from(model);
    let kinematics = Kinematics::at(&vehicle.tree, &vehicle.locked_at);
    let whole = composite(&vehicle.bodies, &kinematics);
    let properties = whole.mass_properties().unwrap_or(MassProperties::ZERO);
    let system = SystemDescription {
        com_m: properties.p_BoBcm_B.into(),
        principal_kg_m2: properties.principal().0,
    };
    (whole.mass, system)
}

/// One line per body, without recursion: a chain may have thousands of links.
fn tree(model: &Model) -> Vec<String> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); model.bodies.len()];
    for (k, body) in model.bodies.iter().enumerate() {
        let parent = model.joint_of(body).map(|j| j.parent);
        if let Some(list) = parent.and_then(|p| children.get_mut(p)) {
            list.push(k);
        }
    }
    let mut lines = Vec::new();
    let mut open = vec![(0_usize, 0_usize)];
    while let Some((k, depth)) = open.pop() {
        let Some(body) = model.bodies.get(k) else {
            continue;
        };
        let by = model.joint_of(body).map_or_else(String::new, |j| {
            format!("  ({}, {})", j.name, j.kind.word())
        });
        // Deep chains are not indented; their depth is printed instead.
        let indent = match depth {
            0 => String::new(),
            1..=20 => format!("{}+- ", "   ".repeat(depth - 1)),
            _ => format!("{}+- [{depth}] ", "   ".repeat(20)),
        };
        lines.push(format!("{indent}{}{by}", body.name));
        if let Some(list) = children.get(k) {
            open.extend(list.iter().rev().map(|child| (*child, depth + 1)));
        }
    }
    lines
}

fn unknown(model: &Model) -> Vec<String> {
    let mut out = Vec::new();
    for body in &model.bodies {
        let words = body.estimate.words();
        if !words.is_empty() {
            let prior = body.prior.map_or("", |_| " (with prior)");
            out.push(format!("{}: {}{prior}", body.name, words.join(", ")));
        }
    }
    let file = serde_json::to_value(file_of(model)).unwrap_or_default();
    for list in ["thruster", "wheel", "sensor"] {
        for table in file[list].as_array().into_iter().flatten() {
            unknown_of(table["name"].as_str().unwrap_or_default(), table, &mut out);
        }
    }
    unknown_of("environment", &file["environment"], &mut out);
    for wheel in model.wheels.iter().filter(|w| w.estimate) {
        out.push(format!("{}: spin inertia", wheel.name));
    }
    let modes = model.modes.iter().map(|m| (&m.name, m.estimate.words()));
    for (name, words) in modes.filter(|(_, words)| !words.is_empty()) {
        out.push(format!("{name}: {}", words.join(", ")));
    }
    for joint in model.joints.iter().filter(|j| !j.spring_unknown.is_empty()) {
        let words: Vec<_> = joint.spring_unknown.iter().map(|n| n.name()).collect();
        let words = words.join(", ");
        out.push(format!("{}: {words} of its spring", joint.name));
    }
    for (what, value) in [
        ("linear momentum", model.momentum.linear),
        ("angular momentum", model.momentum.angular),
    ] {
        if value == MomentumKnowledge::Estimate {
            out.push(format!("{what} of each segment"));
        }
    }
    out
}

/// Keys of a table that are to be estimated, or have a prior.
fn unknown_of(name: &str, table: &Value, out: &mut Vec<String>) {
    let keys = table.as_object().into_iter().flatten();
    for (key, value) in keys.filter(|(key, _)| *key != "uncertainty") {
        let what = key.replace('_', " ");
        let one = value.as_object().filter(|keys| keys.len() == 1);
        let sigma = one.and_then(|keys| keys.values().next()?.as_f64());
        match (value.as_str(), sigma) {
            (Some("estimate"), _) => out.push(format!("{name}: {what}")),
            (_, Some(sigma)) => {
                out.push(format!("{name}: {what} (prior sigma {})", short(sigma)));
            }
            _ => {}
        }
    }
}

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} kg", self.name, short(self.mass_kg))?;
        writeln!(
            f,
            "mass centre ({}) m, principal moments {} kg m2, joints as locked",
            list(&self.system.com_m),
            list(&self.system.principal_kg_m2)
        )?;
        writeln!(f, "\nTree")?;
        for line in &self.tree {
            writeln!(f, "  {line}")?;
        }
        writeln!(f, "\nBodies")?;
        for b in &self.bodies {
            let unknown = match b.unknown.as_slice() {
                [] => "known".to_owned(),
                words => format!("unknown: {}", words.join(", ")),
            };
            writeln!(
                f,
                "  {}: {} kg, mass centre ({}) m, principal moments {} kg m2; {unknown}",
                b.name,
                short(b.mass_kg),
                list(&b.com_m),
                list(&b.principal_kg_m2)
            )?;
        }
        section(f, "Joints", &entries(&self.joints))?;
        section(f, "Wheels", &entries(&self.wheels))?;
        section(f, "Thrusters", &entries(&self.thrusters))?;
        section(f, "Modes", &entries(&self.modes))?;
        section(f, "Sensors", &entries(&self.sensors))?;
        section(f, "Environment", &self.environment)?;
        section(f, "Telemetry", &self.telemetry)?;
        section(f, "Unknown", &self.unknown)?;
        section(f, "Notes", &self.notes)
    }
}

fn entries<T: Serialize>(all: &[T]) -> Vec<String> {
    all.iter().map(entry).collect()
}

fn section(f: &mut fmt::Formatter<'_>, title: &str, lines: &[String]) -> fmt::Result {
    if lines.is_empty() {
        return Ok(());
    }
    writeln!(f, "\n{title}")?;
    for line in lines {
        writeln!(f, "  {line}")?;
    }
    Ok(())
}
