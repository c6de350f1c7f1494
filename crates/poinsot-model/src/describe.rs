//! Describes a vehicle as text and tables, for `poinsot check`.

use crate::vehicle::{JointKind, Model, MomentumKnowledge, Nuisance, SensorKind, printed_unit};
use poinsot_files::{list, short};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use schemars::JsonSchema;
use serde::Serialize;
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
    /// Joints.
    pub joints: Vec<JointDescription>,
    /// Wheels.
    pub wheels: Vec<WheelDescription>,
    /// Thrusters.
    pub thrusters: Vec<ThrusterDescription>,
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

/// One joint.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct JointDescription {
    /// Name.
    pub name: String,
    /// "revolute", "prismatic" or "fixed".
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Parent body.
    pub parent: String,
    /// Child body.
    pub child: String,
    /// Origin in the parent's frame, m.
    pub origin_m: [f64; 3],
    /// Unit axis in the child's frame; zero for a fixed joint.
    pub axis: [f64; 3],
    /// Spring and damper in words; null where the joint has none.
    pub spring_damper: Option<String>,
}

/// One wheel.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WheelDescription {
    /// Name.
    pub name: String,
    /// Host body.
    pub body: String,
    /// Unit axis in the host's axes.
    pub axis: [f64; 3],
    /// Spin inertia, kg m2.
    pub spin_inertia_kg_m2: f64,
}

/// One thruster.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ThrusterDescription {
    /// Name.
    pub name: String,
    /// Host body.
    pub body: String,
    /// Position in the host's frame, m.
    pub position_m: [f64; 3],
    /// Unit direction of the force on the body.
    pub force_direction: [f64; 3],
    /// Specific impulse, s; null: no propellant is used up.
    pub specific_impulse_s: Option<f64>,
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
    let body_name = |k: usize| {
        model
            .bodies
            .get(k)
            .map_or_else(String::new, |b| b.name.clone())
    };
    Description {
        name: model.name.clone(),
        mass_kg,
        system,
        bodies: model.bodies.iter().map(describe_body).collect(),
        tree: tree(model),
        joints: model
            .joints
            .iter()
            .map(|j| JointDescription {
                name: j.name.clone(),
                kind: joint_word(j.kind),
                parent: body_name(j.parent),
                child: body_name(j.child),
                origin_m: j.p_PoCo_P.into(),
                axis: j.axis_C.into(),
                spring_damper: j.spring_damper.map(|s| spring_words(&s, j.kind)),
            })
            .collect(),
        wheels: model
            .wheels
            .iter()
            .map(|w| WheelDescription {
                name: w.name.clone(),
                body: body_name(w.body),
                axis: w.axis_B.into(),
                spin_inertia_kg_m2: w.spin_inertia,
            })
            .collect(),
        thrusters: model
            .thrusters
            .iter()
            .map(|t| ThrusterDescription {
                name: t.name.clone(),
                body: body_name(t.body),
                position_m: t.p_BoT_B.into(),
                force_direction: t.direction_B.into(),
                specific_impulse_s: t.propellant.map(|p| p.specific_impulse),
            })
            .collect(),
        sensors: describe_sensors(model),
        environment: crate::describe_telemetry::environment(&model.environment),
        telemetry: crate::describe_telemetry::telemetry(&model.telemetry),
        unknown: unknown(model),
        notes: model.notes.clone(),
    }
}

fn joint_word(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Revolute => "revolute",
        JointKind::Prismatic => "prismatic",
        JointKind::Fixed => "fixed",
    }
}

fn spring_words(spring: &crate::SpringDamper, kind: JointKind) -> String {
    let [stiffness, damping, unit] = match kind {
        JointKind::Prismatic => ["N/m", "N s/m", "m"],
        _ => ["N m/rad", "N m s/rad", "rad"],
    };
    format!(
        "spring {} {stiffness} about {} {unit}, damper {} {damping}",
        short(spring.stiffness),
        short(spring.rest),
        short(spring.damping)
    )
}

fn describe_body(body: &crate::Body) -> BodyDescription {
    let e = body.estimate;
    let words = [("mass", e.mass), ("com", e.com), ("inertia", e.inertia)];
    BodyDescription {
        name: body.name.clone(),
        mass_kg: body.nominal.mass,
        com_m: body.nominal.p_BoBcm_B.into(),
        principal_kg_m2: body.nominal.principal().0,
        unknown: words
            .iter()
            .filter(|(_, on)| *on)
            .map(|(w, _)| *w)
            .collect(),
    }
}

fn describe_sensors(model: &Model) -> Vec<SensorDescription> {
    let body_name = |k: usize| model.bodies.get(k).map(|b| b.name.clone());
    let describe = |s: &crate::Sensor| {
        let names = s.of.iter().filter_map(|k| match s.kind {
            SensorKind::WheelSpeed => model.wheels.get(*k).map(|w| w.name.clone()),
            SensorKind::Thrust => model.thrusters.get(*k).map(|t| t.name.clone()),
            _ => model.joints.get(*k).map(|j| j.name.clone()),
        });
        SensorDescription {
            name: s.name.clone(),
            kind: s.kind.declared_as().word(),
            body: body_name(s.body).unwrap_or_default(),
            seen_from: body_name(s.seen_from).filter(|_| s.kind.is_relative()),
            unit: printed_unit(model.unit_of(s)),
            noise: s
                .noise_covariance
                .map(|c| c.diagonal().map(f64::sqrt).into()),
            quantisation: s.quantisation,
            of: names.collect(),
        }
    };
    model.sensors.iter().map(describe).collect()
}

/// Mass, mass centre and principal moments of the whole vehicle, joints at their locked positions.
fn whole(model: &Model) -> (f64, SystemDescription) {
    let mut poses: Vec<(Matrix3, Vector3)> = Vec::with_capacity(model.bodies.len());
    let mut sum = poinsot_spatial::InertialParameters::ZERO;
    for body in &model.bodies {
        let joint = body.joint.and_then(|j| model.joints.get(j));
        let (R_BaseB, p_BaseB) = match joint {
            None => (Matrix3::identity(), Vector3::zeros()),
            Some(joint) => {
                let (R_P, p_P) = poses
                    .get(joint.parent)
                    .copied()
                    .unwrap_or((Matrix3::identity(), Vector3::zeros()));
                let R_C = R_P * joint.R_PC_zero;
                let p_C = p_P + R_P * joint.p_PoCo_P;
                match joint.kind {
                    JointKind::Revolute => {
                        let turn = rotation_about(&joint.axis_C, joint.locked_at);
                        (R_C * turn, p_C)
                    }
                    JointKind::Prismatic => (R_C, p_C + R_C * joint.axis_C * joint.locked_at),
                    JointKind::Fixed => (R_C, p_C),
                }
            }
        };
        let nominal = &body.nominal;
        let moved = MassProperties {
            mass: nominal.mass,
            p_BoBcm_B: p_BaseB + R_BaseB * nominal.p_BoBcm_B,
            I_BBcm_B: R_BaseB * nominal.I_BBcm_B * R_BaseB.transpose(),
        }
        .parameters();
        sum.mass += moved.mass;
        sum.mc_B += moved.mc_B;
        sum.I_BBo_B += moved.I_BBo_B;
        poses.push((R_BaseB, p_BaseB));
    }
    let total = sum.mass_properties().unwrap_or(MassProperties::ZERO);
    let system = SystemDescription {
        com_m: total.p_BoBcm_B.into(),
        principal_kg_m2: total.principal().0,
    };
    (sum.mass, system)
}

/// Rotation by an angle about a unit axis (Rodrigues).
fn rotation_about(axis: &Vector3, angle: f64) -> Matrix3 {
    let k = poinsot_spatial::skew(axis);
    Matrix3::identity() + k * angle.sin() + k * k * (1.0 - angle.cos())
}

/// One line per body, without recursion: a chain may have thousands of links.
fn tree(model: &Model) -> Vec<String> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); model.bodies.len()];
    for (k, body) in model.bodies.iter().enumerate() {
        let parent = body
            .joint
            .and_then(|j| model.joints.get(j))
            .map(|j| j.parent);
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
        let joint = body.joint.and_then(|j| model.joints.get(j));
        let by = joint.map_or_else(String::new, |j| {
            format!("  ({}, {})", j.name, joint_word(j.kind))
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
        let e = body.estimate;
        let words = [("mass", e.mass), ("com", e.com), ("inertia", e.inertia)];
        let words: Vec<&str> = words
            .iter()
            .filter(|(_, on)| *on)
            .map(|(w, _)| *w)
            .collect();
        if !words.is_empty() {
            let prior = if body.prior.is_some() {
                " (with prior)"
            } else {
                ""
            };
            out.push(format!("{}: {}{prior}", body.name, words.join(", ")));
        }
    }
    let mut add = |name: &str, what: &str, value: Nuisance| match value {
        Nuisance::Known => {}
        Nuisance::Estimate => out.push(format!("{name}: {what}")),
        Nuisance::Prior(sigma) => {
            out.push(format!("{name}: {what} (prior sigma {})", short(sigma)))
        }
    };
    for thruster in &model.thrusters {
        add(&thruster.name, "scale", thruster.scale);
    }
    for wheel in &model.wheels {
        add(&wheel.name, "misalignment", wheel.misalignment);
    }
    for sensor in &model.sensors {
        add(&sensor.name, "bias", sensor.bias);
        add(&sensor.name, "scale", sensor.scale);
        add(&sensor.name, "misalignment", sensor.misalignment);
        add(&sensor.name, "nonorthogonality", sensor.nonorthogonality);
        add(&sensor.name, "lag", sensor.lag);
    }
    add(
        "environment",
        "disturbance torque",
        model.environment.disturbance_torque,
    );
    add(
        "environment",
        "disturbance torque in inertial axes",
        model.environment.disturbance_torque_inertial,
    );
    add("environment", "drag torque", model.environment.drag_torque);
    if let Some(random) = &model.environment.random_torque {
        out.push(format!(
            "environment: random torque of {} N m about each axis, correlated over {} s",
            random.sigma_N_m, random.correlation_s
        ));
    }
    for wheel in model.wheels.iter().filter(|w| w.estimate) {
        out.push(format!("{}: spin inertia", wheel.name));
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
        self.fmt_parts(f)?;
        section(f, "Environment", &self.environment)?;
        section(f, "Telemetry", &self.telemetry)?;
        section(f, "Unknown", &self.unknown)?;
        section(f, "Notes", &self.notes)
    }
}

impl Description {
    fn fmt_parts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let joints: Vec<String> = self
            .joints
            .iter()
            .map(|j| {
                let axis = if j.kind == "fixed" {
                    String::new()
                } else {
                    format!(", axis ({})", list(&j.axis))
                };
                let spring = j.spring_damper.as_ref();
                let spring = spring.map_or_else(String::new, |words| format!(", {words}"));
                let (name, kind) = (&j.name, j.kind);
                format!("{name}: {kind}, {} -> {}{axis}{spring}", j.parent, j.child)
            })
            .collect();
        section(f, "Joints", &joints)?;
        let wheels: Vec<String> = self
            .wheels
            .iter()
            .map(|w| {
                let spin = short(w.spin_inertia_kg_m2);
                format!(
                    "{}: on {}, axis ({}), {spin} kg m2",
                    w.name,
                    w.body,
                    list(&w.axis)
                )
            })
            .collect();
        section(f, "Wheels", &wheels)?;
        let thrusters: Vec<String> = self
            .thrusters
            .iter()
            .map(|t| {
                let (at, force) = (list(&t.position_m), list(&t.force_direction));
                format!(
                    "{}: on {}, at ({at}) m, force along ({force})",
                    t.name, t.body
                )
            })
            .collect();
        section(f, "Thrusters", &thrusters)?;
        let sensors: Vec<String> = self.sensors.iter().map(SensorDescription::line).collect();
        section(f, "Sensors", &sensors)
    }
}

impl SensorDescription {
    fn line(&self) -> String {
        let mut text = format!("{}: {} on {}", self.name, self.kind, self.body);
        if let Some(from) = &self.seen_from {
            text.push_str(&format!(", seen from {from}"));
        }
        if !self.of.is_empty() {
            text = format!("{}: {} of {}", self.name, self.kind, self.of.join(", "));
        }
        match self.noise {
            Some([x, y, z]) if x == y && y == z => {
                text.push_str(&format!(", noise {} {}", short(x), self.unit));
            }
            Some(sigmas) => text.push_str(&format!(", noise ({}) {}", list(&sigmas), self.unit)),
            None => text.push_str(", no noise declared"),
        }
        if self.quantisation > 0.0 {
            text.push_str(&format!(
                ", steps of {} {}",
                short(self.quantisation),
                self.unit
            ));
        }
        text
    }
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
