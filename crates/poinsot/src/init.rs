//! The command `init`: telemetry files become a model file, with a question wherever neither names nor data say.

use crate::channel_names::{joint_unit, of_parts, position};
use crate::draft::Draft;
use crate::error::Error;
use crate::proposal::{Line, Proposal};
use crate::propose_sensors::{SensorChannels, noise, owner, vector_sensors};
use crate::survey::Survey;
use poinsot_files::{escaped, rounded};
use poinsot_model::{Joint, Model, SensorKind, UrdfOptions, read_robot, write_model};
use poinsot_telemetry::{
    ChannelName, ChannelSummary, Dimension, Kind, ReadOptions, classify, recognise,
};
use std::path::{Path, PathBuf};

/// Positions beyond this are those of an orbit, m.
const ORBIT: f64 = 1.0e5;

/// Drafts the model of a vehicle from the files of one record, and its URDF if it has joints.
///
/// # Errors
/// Files or URDF cannot be read, or the files have joints and there is no URDF.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("night.csv");
/// std::fs::write(&path, "t_s,GyroX_dps,GyroY_dps,GyroZ_dps,RW1_rpm\n0,1,2,3,900\n1,1,2,3,910\n2,1,2,4,920\n")?;
/// let draft = poinsot::init(&[path], None, &Default::default())?;
/// assert!(draft.text.contains(r#"wheel1_rad_s = { column = "RW1_rpm", unit = "rpm" }"#));
/// assert!(draft.questions().iter().any(|q| q.text == "mass, kg"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn init(files: &[PathBuf], urdf: Option<&Path>, options: &ReadOptions) -> Result<Draft, Error> {
    let robot = urdf
        .map(|urdf| read_robot(urdf, &UrdfOptions::default()))
        .transpose()?;
    let own = robot.as_ref().map(of_parts).unwrap_or_default();
    let mut proposals = Proposal::of_all(files, &own);
    if let Some(robot) = &robot {
        proposals.iter_mut().for_each(|p| p.name_joints(robot));
    }
    let mut survey = Survey::of(files, options, proposals)?;
    let parts = Parts::of(&survey, robot.as_ref());
    survey.proposals.iter_mut().for_each(|p| p.ask_less(&parts));
    if let (None, Some(joint)) = (&robot, parts.joints.first()) {
        let problem = format!("the files have a joint, '{joint}', and nothing says where it is");
        let advice = "give the robot: --urdf ROBOT.urdf";
        return Err(Error::usage("--urdf", "", problem, advice));
    }
    let mut out = block("head", &[]);
    match &robot {
        Some(robot) => out.push_str(&robot_text(robot, &parts)),
        None => out.push_str(&parts.vehicle()),
    }
    let base = robot.as_ref().and_then(|robot| robot.bodies.first());
    let base = base.map_or("spacecraft", |body| body.name.as_str());
    for (table, names) in [("thruster", &parts.thrusters), ("wheel", &parts.wheels)] {
        for name in names {
            out.push_str(&block(table, &[("name", name), ("body", base)]));
        }
    }
    survey.write_sensors(&parts, &mut out);
    write_map(&survey, &mut out);
    Ok(Draft { text: out })
}

/// A part of `init.txt` with its gaps filled.
fn block(name: &str, gaps: &[(&str, &str)]) -> String {
    let mut parts = include_str!("init.txt").split("== ");
    let text = parts.find_map(|part| part.strip_prefix(name)?.strip_prefix('\n'));
    let fill =
        |text: String, (gap, value): &(&str, &str)| text.replace(&format!("{{{gap}}}"), value);
    gaps.iter().fold(text.unwrap_or_default().to_owned(), fill)
}

/// The parts of the vehicle that the channels name.
#[derive(Default)]
struct Parts {
    wheels: Vec<String>,
    thrusters: Vec<String>,
    joints: Vec<String>,
    /// Whether there is a velocity or a position that can show mass and mass centre.
    moves: bool,
}

impl Parts {
    fn of(survey: &Survey, robot: Option<&Model>) -> Self {
        let mut parts = Self::default();
        // Flags, and momenta of wheels, are no channels without a model.
        let unread = |line: &&Line| line.lacks_value() || line.kind == Kind::WheelSpeed;
        let flags = survey.lines().filter(unread).map(|line| &line.key);
        let read = survey.inspection.channels.iter().map(|c| &c.name);
        let channels: Vec<ChannelName> = read.chain(flags).filter_map(|c| classify(c)).collect();
        let is_joint = |channel: &ChannelName| {
            let name = &channel.subject;
            let angle = |c: &ChannelName| c.subject == *name && c.dimension == Dimension::Angle;
            let found = recognise(std::slice::from_ref(&channel.name), &[]).channels;
            channels.iter().any(angle)
                || robot.is_some_and(|robot| robot.joints.iter().any(|j| j.name == *name))
                || found.first().is_some_and(|f| f.kind == Kind::JointRate)
        };
        for channel in &channels {
            let list = match (channel.vector(), channel.dimension) {
                (Some((prefix, _)), _) => {
                    parts.moves |= prefix == "v";
                    continue;
                }
                (_, Dimension::Angle | Dimension::Length) => &mut parts.joints,
                (_, Dimension::AngularVelocity) if is_joint(channel) => &mut parts.joints,
                (_, Dimension::AngularVelocity) => &mut parts.wheels,
                (_, Dimension::Force) => &mut parts.thrusters,
                _ => continue,
            };
            if !list.contains(&channel.subject) {
                list.push(channel.subject.clone());
            }
        }
        parts
    }

    /// Whether something moves the mass centre, so that velocity and position count.
    fn shows_mass(&self) -> bool {
        !self.thrusters.is_empty() || !self.joints.is_empty()
    }

    /// What a sensor needs that no file says.
    fn missing(&self, of: &SensorChannels<'_>) -> Option<&'static str> {
        let far = |c: &&ChannelSummary| c.max.abs().max(c.min.abs()) > ORBIT;
        match of.kind {
            SensorKind::Gyro | SensorKind::Attitude => None,
            kind if kind.is_scalar() => None,
            kind if kind.is_relative() => Some("the bodies: body and seen_from"),
            SensorKind::Direction => Some("the measured vector in inertial axes, reference_N"),
            SensorKind::Accelerometer => Some("its position, position_m"),
            SensorKind::Position if of.channels.iter().any(far) => Some("gravity in [environment]"),
            _ if !self.shows_mass() => Some("a thruster or a joint: nothing else changes it"),
            _ => None,
        }
    }

    fn vehicle(&self) -> String {
        let (com, estimate) = match (self.thrusters.is_empty(), self.moves) {
            (true, _) => ("com known", r#"["inertia"]"#),
            (false, false) => ("com asked", r#"["com", "inertia"]"#),
            (false, true) => ("com asked", r#"["mass", "com", "inertia"]"#),
        };
        let com = block(com, &[]);
        let gaps = [("com", com.trim_end()), ("estimate", estimate)];
        block("vehicle", &gaps)
    }
}

/// The model of a robot, with what is unknown and the locked joints as questions.
fn robot_text(robot: &Model, parts: &Parts) -> String {
    let (mut out, mut table, mut bodies) = (String::new(), String::new(), 0);
    for line in write_model(robot).lines() {
        out.push_str(line);
        out.push('\n');
        if line.starts_with('[') {
            line.clone_into(&mut table);
        }
        let Some(name) = line.strip_prefix("name = ") else {
            continue;
        };
        let name = name.trim_matches('"');
        if table == "[[body]]" {
            bodies += 1;
            out.push_str(&match bodies {
                1 => block("unknown", &[("name", name)]),
                _ => "estimate = false\n".to_owned(),
            });
        }
        let own = |joint: &&Joint| table == "[[joint]]" && joint.name == name;
        let Some(joint) = robot.moving_joints().find(own) else {
            continue;
        };
        let unit = joint_unit(joint);
        if !parts.joints.iter().any(|joint| joint == name) {
            out.push_str(&block("locked", &[("name", name), ("unit", unit)]));
        }
    }
    out
}

impl Survey {
    /// The sensors and their noise.
    fn write_sensors(&self, parts: &Parts, out: &mut String) {
        let channels = &self.inspection.channels;
        let complete = |s: &SensorChannels<'_>| s.channels.len() == s.kind.columns().len();
        let vectors = vector_sensors(&self.inspection).into_iter();
        let vectors = vectors.filter(complete);
        let joints = [SensorKind::JointPosition, SensorKind::JointRate].into_iter();
        let joints = joints.flat_map(|kind| [(kind, false), (kind, true)]);
        let joints = joints.map(|(kind, slides)| (kind, slides, &parts.joints));
        let wheels = std::iter::once((SensorKind::WheelSpeed, false, &parts.wheels));
        let of_parts = wheels.chain(joints).map(|(kind, slides, parts)| {
            let unit = kind.unit(slides);
            let names: Vec<String> = parts.iter().map(|part| format!("{part}_{unit}")).collect();
            let own = channels.iter().filter(|c| names.contains(&c.name));
            SensorChannels {
                name: format!("{}{}", kind.word(), if slides { "_m" } else { "" }),
                kind,
                slides,
                channels: own.collect(),
            }
        });
        let of_parts = of_parts.filter(|sensor| !sensor.channels.is_empty());
        for sensor in vectors.chain(of_parts) {
            self.write_sensor(parts, &sensor, out);
        }
    }

    fn write_sensor(&self, parts: &Parts, of: &SensorChannels<'_>, out: &mut String) {
        let (kind, channels) = (of.kind, &of.channels);
        let table = |last| [("name", of.name.as_str()), ("type", kind.word()), last];
        if let Some(missing) = parts.missing(of) {
            out.push_str(&block("unused", &table(("missing", missing))));
            return;
        }
        let open = self.is_open(channels);
        let mut line = match noise(of) {
            Some(line) if !open => line,
            // Joints and wheels without noise are taken as exact.
            None if kind.is_scalar() && !open => return,
            _ => question(of),
        };
        if kind.is_scalar() && kind != SensorKind::WheelSpeed {
            let end = format!("_{}", kind.unit(of.slides));
            let joints = channels.iter().filter_map(|c| c.name.strip_suffix(&end));
            line = format!("of = {:?}\n{line}", joints.collect::<Vec<_>>());
        }
        out.push_str(&block("sensor", &table(("line", &line))));
        let mut all = self.inspection.channels.iter();
        if kind == SensorKind::Gyro && all.any(|c| owner(c).1 == "q_w") {
            out.push_str(&block("gyro", &[]));
        }
    }

    /// Whether the unit of a channel is a question.
    fn is_open(&self, channels: &[&ChannelSummary]) -> bool {
        let open = |line: &&Line| line.choices.iter().any(|c| c.key == "unit" && !c.sure);
        let mut lines = self.lines().filter(open);
        lines.any(|line| channels.iter().any(|c| c.name == line.key))
    }
}

/// The question for a noise that the data do not show, or show in a unit that is a question.
fn question(of: &SensorChannels<'_>) -> String {
    let unit = of.kind.unit(of.slides);
    let seen = of.channels.iter().filter_map(|c| c.noise);
    let shown = match seen.reduce(f64::max) {
        Some(largest) => format!("{} in the unit of the columns", rounded(largest, 2)),
        None => "the data show none".to_owned(),
    };
    let printed = unit.replace('_', "/");
    let gaps = [
        ("unit", unit),
        ("name", &of.name),
        ("printed", &printed),
        ("shown", &shown),
    ];
    block("noise", &gaps).trim_end().to_owned()
}

fn write_map(survey: &Survey, out: &mut String) {
    let of_all = survey.inspection.sources.len() == 1;
    for proposal in survey.proposals.iter().filter(|p| !p.is_plain()) {
        out.push('\n');
        out.push_str(&proposal.text(true, of_all));
    }
    let rest = survey.proposals.iter().flat_map(|p| &p.rest);
    let rest: Vec<&str> = rest.map(String::as_str).collect();
    if !rest.is_empty() {
        out.push_str(&block("rest", &[("list", &escaped(&rest.join(", ")))]));
    }
    let tests = survey.inspection.conventions.iter();
    for test in tests.filter(|test| test.is_contradicted()) {
        let problem = test.fault().to_string();
        out.push_str(&block("contradiction", &[("problem", &problem)]));
    }
}

impl Proposal {
    /// Leaves out columns with questions that no sensor of the draft uses.
    fn ask_less(&mut self, parts: &Parts) {
        let rest = &mut self.rest;
        self.lines.retain(|line| {
            let used = match line.kind {
                Kind::SpecificForce | Kind::AngularAcceleration => false,
                Kind::Velocity | Kind::Position => parts.shows_mass(),
                _ => true,
            };
            let kept = used || line.choices.iter().all(|choice| choice.sure);
            rest.extend(line.columns.iter().filter(|_| !kept).cloned());
            kept
        });
    }

    /// Gives the columns of joints the names of the model's joints: by the words of the name, or by the number.
    fn name_joints(&mut self, robot: &Model) {
        let letters = |c: char| !c.is_alphanumeric();
        let plain = |text: &str| text.to_lowercase().replace(letters, "");
        let number = |text: &str| text.replace(|c: char| !c.is_ascii_digit(), "");
        let rest = &mut self.rest;
        self.lines.retain_mut(|line| {
            let rate = match line.kind {
                Kind::JointAngle | Kind::JointPlace => "",
                Kind::JointRate | Kind::JointSpeed => "_s",
                _ => return true,
            };
            let column = line.columns.concat();
            let own = line.key.split('_').next().map(number).unwrap_or_default();
            let named = |j: &&Joint| plain(&column).contains(&plain(&j.name));
            let numbered = |j: &&Joint| !own.is_empty() && number(&j.name) == own;
            let named: Vec<&Joint> = robot.moving_joints().filter(named).collect();
            let numbered: Vec<&Joint> = robot.moving_joints().filter(numbered).collect();
            let (([joint], _) | ([], [joint])) = (&named[..], &numbered[..]) else {
                rest.push(column);
                return false;
            };
            line.key = format!("{}{rate}", position(joint));
            // A unit that is a question is that of the joint.
            let channel = classify(&line.key);
            if let (Some(choice), Some(channel)) = (line.choice("unit"), channel)
                && !choice.sure
            {
                channel.dimension.si().clone_into(&mut choice.word);
            }
            true
        });
    }
}
