//! `[[joint_torque]]`, `[[initial.joint]]` and the springs of the model as drives of the joints.

use super::fault::did_you_mean;
use super::planner::{Part, Planner, node_remedy};
use poinsot_dynamics::{ForceProfile, JointDrive, NodeError, PiecewisePolynomial, Plan};
use poinsot_formats::case::{InitialJointFile, JointTorqueFile};
use poinsot_model::{Joint, JointKind};
use poinsot_telemetry::{ReadOptions, read};
use std::path::Path;

/// Keys that belong to one form of a motor.
const FORMS: [(&str, &str); 5] = [
    ("frequency_rad_s", "sinusoid"),
    ("phase_rad", "sinusoid"),
    ("time_s", "table"),
    ("column", "file"),
    ("interpolation", "interpolation"),
];

/// Motor and initial state of each joint coordinate.
#[derive(Default)]
struct MotorSettings {
    motor: Option<ForceProfile>,
    position: Option<f64>,
    rate: Option<f64>,
}

/// Creates a profile from times and values.
pub(super) type Build = fn(&[f64], &[f64]) -> Result<PiecewisePolynomial, NodeError>;

/// Interpolations of a torque; constant as from a digital controller.
pub(super) const OF_TORQUE: [(&str, Build); 2] = [
    ("constant", PiecewisePolynomial::steps),
    ("linear", PiecewisePolynomial::linear),
];

impl Planner<'_> {
    /// Puts the drives of free joints into the plan. A joint with a motor, or with a spring and no prescribed motion, is
    /// free; `led` marks joints with prescribed motion.
    pub(super) fn drives(
        &mut self,
        torques: &[JointTorqueFile],
        initial: &[InitialJointFile],
        plan: &mut Plan,
        led: &[bool],
    ) {
        let mut own: Vec<MotorSettings> = led.iter().map(|_| MotorSettings::default()).collect();
        for (i, table) in torques.iter().enumerate() {
            let key = format!("joint_torque[{i}]");
            let named = format!("{key}.joint");
            let Some(k) = self.part(Part::Joint, &table.joint, &named) else {
                continue;
            };
            if led[k] || own[k].motor.is_some() {
                self.twice(&named);
                continue;
            }
            let motor = self.motor(table, k, &key);
            own[k].motor = Some(motor.unwrap_or_else(ForceProfile::none));
        }
        for (i, table) in initial.iter().enumerate() {
            let key = format!("initial.joint[{i}]");
            let named = format!("{key}.joint");
            let Some(k) = self.part(Part::Joint, &table.joint, &named) else {
                continue;
            };
            let free = own[k].motor.is_some() || self.joint(k).is_passive();
            if led[k] || !free {
                let problem = if led[k] {
                    "the joint's motion is prescribed, and so is its initial state"
                } else {
                    "this joint has no drive: it stays locked at the model's position"
                };
                let remedy = "leave it out; a start belongs to a joint with [[joint_torque]] or with spring_damper in the model";
                self.refuse("E0507", &named, problem, remedy);
                continue;
            }
            if own[k].position.is_some() || own[k].rate.is_some() {
                self.twice(&named);
                continue;
            }
            self.other_unit(k, &key, table);
            own[k].position = table.position_rad.or(table.position_m);
            own[k].rate = table.rate_rad_s.or(table.rate_m_s);
        }
        for (k, own) in own.into_iter().enumerate() {
            let joint = self.joint(k);
            if led[k] || (own.motor.is_none() && !joint.is_passive()) {
                continue;
            }
            let spring = joint.spring_damper;
            plan.joints[k] = JointDrive::Force {
                motor: own.motor.unwrap_or_else(ForceProfile::none),
                spring: spring.unwrap_or_default(),
                // A spring without initial conditions starts at rest.
                initial_position: own
                    .position
                    .unwrap_or_else(|| spring.map_or(joint.standing_at(), |s| s.rest)),
                initial_rate: own.rate.unwrap_or(0.0),
            };
        }
    }

    /// The motor of one table: exactly one of constant, sinusoid, table or file.
    fn motor(&mut self, table: &JointTorqueFile, k: usize, key: &str) -> Option<ForceProfile> {
        if self.other_unit(k, key, table) {
            return None;
        }
        let joint = self.joint(k);
        let (unit, name) = match joint.kind {
            JointKind::Prismatic => ("N", "force_N"),
            _ => ("N_m", "torque_N_m"),
        };
        let constant = table.constant_N_m.or(table.constant_N);
        let amplitude = table.amplitude_N_m.or(table.amplitude_N);
        let values = table.torque_N_m.as_ref().or(table.force_N.as_ref());
        match (constant, amplitude, values, &table.file) {
            (Some(x), None, None, None) => {
                self.only(table, key, &["constant"])?;
                Some(ForceProfile::Nodes(PiecewisePolynomial::constant(x)))
            }
            (None, Some(x), None, None) => {
                self.only(table, key, &["sinusoid"])?;
                self.sinusoid(table, x, key)
            }
            (None, None, Some(x), None) => {
                self.only(table, key, &["table", "interpolation"])?;
                let Some(time) = &table.time_s else {
                    let problem = format!("{name} needs time_s");
                    return self.refused("E0502", key, problem, "add time_s = [...]");
                };
                let build = self.interpolation(table.interpolation.as_deref(), OF_TORQUE, key)?;
                let profile = self.checked(build(time, x), key, name)?;
                Some(ForceProfile::Nodes(profile.starting_from(0.0)))
            }
            (None, None, None, Some(file)) => {
                self.only(table, key, &["file", "interpolation"])?;
                self.torque_file(table, file, joint, key)
            }
            _ => {
                let problem =
                    "a joint's motor needs exactly one of constant, sinusoid, table and file";
                let remedy = format!(
                    "give constant_{unit}; or amplitude_{unit} with frequency_rad_s; or time_s with {name}; or file"
                );
                self.refused("E0507", key, problem, remedy)
            }
        }
    }

    /// Rejects keys of another motor form.
    fn only(&mut self, table: &JointTorqueFile, key: &str, forms: &[&str]) -> Option<()> {
        let given = serde_json::to_value(table).unwrap_or_default();
        let mut stray = FORMS.iter().filter(|(name, _)| !given[name].is_null());
        let Some((name, _)) = stray.find(|(_, form)| !forms.contains(form)) else {
            return Some(());
        };
        let problem = format!("this key does not belong to a motor given as {}", forms[0]);
        self.refused("E0507", &format!("{key}.{name}"), problem, "leave it out")
    }

    fn sinusoid(
        &mut self,
        table: &JointTorqueFile,
        amplitude: f64,
        key: &str,
    ) -> Option<ForceProfile> {
        if table.frequency_rad_s.is_none() {
            let remedy = "add it: torque = amplitude sin(frequency t + phase)";
            self.refuse("E0502", key, "a sinusoid needs frequency_rad_s", remedy);
        }
        Some(ForceProfile::Sine {
            amplitude,
            frequency: table.frequency_rad_s?,
            phase: table.phase_rad.unwrap_or(0.0),
        })
    }

    /// What an interpolation builds; the first of those that are possible where none is given.
    pub(super) fn interpolation(
        &mut self,
        given: Option<&str>,
        possible: [(&str, Build); 2],
        key: &str,
    ) -> Option<Build> {
        let [(usual, _), (other, _)] = possible;
        let word = given.unwrap_or(usual);
        let found = possible.iter().find(|(name, _)| *name == word);
        if found.is_none() {
            let remedy = format!("use \"{usual}\" or \"{other}\"");
            let key = format!("{key}.interpolation");
            self.refuse("E0507", &key, "no such interpolation here", remedy);
        }
        found.map(|(_, build)| *build)
    }

    /// The torque of a joint in a file.
    fn torque_file(
        &mut self,
        table: &JointTorqueFile,
        file: &str,
        joint: &Joint,
        key: &str,
    ) -> Option<ForceProfile> {
        let build = self.interpolation(table.interpolation.as_deref(), OF_TORQUE, key)?;
        let unit = if joint.slides() { "N" } else { "Nm" };
        let usual = || format!("{}_{unit}", joint.name);
        let column = table.column.clone().unwrap_or_else(usual);
        let profile = self.column(file, &column, &[&format!("_{unit}")], build, key)?;
        Some(ForceProfile::Nodes(profile.starting_from(0.0)))
    }

    /// A column of a telemetry file next to the case; its name ends in one of `units`.
    pub(super) fn column(
        &mut self,
        file: &str,
        column: &str,
        units: &[&str],
        build: Build,
        key: &str,
    ) -> Option<PiecewisePolynomial> {
        let folder = self.text.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(file);
        let key = format!("{key}.file");
        let found = match read(&[&path], &ReadOptions::default()) {
            Ok(found) => found,
            Err(e) => {
                let (problem, remedy) = match e.list.as_slice() {
                    [fault] if fault.code == "E0201" => (
                        fault.problem.clone(),
                        "give the path of a telemetry file, from the folder of the case",
                    ),
                    _ => (e.to_string(), "or give another file"),
                };
                return self.refused("E0511", &key, problem, remedy);
            }
        };
        let Some(channel) = found.channel(column) else {
            let names = found.channels.iter().map(|c| c.name.as_str());
            let remedy = did_you_mean(column, names);
            let problem = format!("the file has no column \"{column}\"");
            return self.refused("E0511", &key, problem, remedy);
        };
        if !units.iter().any(|unit| column.ends_with(unit)) {
            let problem = format!("column \"{column}\" is of another quantity");
            let remedy = format!("name a column that ends in {}", units.join(" or "));
            return self.refused("E0511", &key, problem, remedy);
        }
        let built = build(&channel.time_s, &channel.values).map_err(|e| {
            let problem = format!("column \"{column}\": {e}");
            self.refuse("E0511", &key, problem, node_remedy(&e));
        });
        built.ok()
    }
}
