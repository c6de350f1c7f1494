//! `[[joint_torque]]`, `[[initial.joint]]` and the springs of the model as drives of the joints.

use super::fault::did_you_mean;
use super::planner::{Planner, node_remedy};
use poinsot_dynamics::{
    ForceProfile, JointDrive, NodeError, PiecewisePolynomial, Plan, SpringDamper, Tree,
};
use poinsot_formats::case::{InitialJointFile, JointTorqueFile, Placed};
use poinsot_model::{Joint, JointKind};
use poinsot_telemetry::{ReadOptions, read};
use std::ops::Range;
use std::path::Path;

/// Motor and initial state of each joint coordinate.
struct MotorSettings {
    motor: Option<ForceProfile>,
    position: Option<f64>,
    rate: Option<f64>,
}

/// Motor forms in the units of one joint type, with their keys.
struct Forms<'f> {
    constant: (&'static str, Option<&'f Placed<f64>>),
    amplitude: (&'static str, Option<&'f Placed<f64>>),
    values: (&'static str, Option<&'f Placed<Vec<f64>>>),
}

impl Forms<'_> {
    fn spans(&self) -> [(&'static str, Option<Range<usize>>); 3] {
        [
            (self.constant.0, self.constant.1.map(Placed::span)),
            (self.amplitude.0, self.amplitude.1.map(Placed::span)),
            (self.values.0, self.values.1.map(Placed::span)),
        ]
    }
}

/// Creates a profile from times and values.
pub(super) type Build = fn(&[f64], &[f64]) -> Result<PiecewisePolynomial, NodeError>;

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
        let tree = Tree::new(self.model);
        let none = || MotorSettings {
            motor: None,
            position: None,
            rate: None,
        };
        let mut own: Vec<MotorSettings> = (0..tree.dof()).map(|_| none()).collect();
        for (i, table) in torques.iter().enumerate() {
            let key = format!("joint_torque[{i}]");
            let Some(k) = self.joint(&tree, &table.joint, &key) else {
                continue;
            };
            if led[k] || own[k].motor.is_some() {
                self.twice(&format!("{key}.joint"), &table.joint);
                continue;
            }
            let joint = &self.model.joints[tree.coordinates[k]];
            let motor = self.motor(table, joint, &key);
            own[k].motor = Some(motor.unwrap_or_else(ForceProfile::none));
        }
        for (i, table) in initial.iter().enumerate() {
            let key = format!("initial.joint[{i}]");
            let Some(k) = self.joint(&tree, &table.joint, &key) else {
                continue;
            };
            let joint = &self.model.joints[tree.coordinates[k]];
            let free = own[k].motor.is_some() || joint.spring_damper.is_some();
            if led[k] || !free {
                let problem = if led[k] {
                    "the joint's motion is prescribed, and so is its initial state"
                } else {
                    "this joint has no drive: it stays locked at the model's position"
                };
                let remedy = "leave it out; a start belongs to a joint with [[joint_torque]] or with spring_damper in the model";
                let span = table.joint.span();
                self.refuse("E0507", &format!("{key}.joint"), span, problem, remedy);
                continue;
            }
            if own[k].position.is_some() || own[k].rate.is_some() {
                self.twice(&format!("{key}.joint"), &table.joint);
                continue;
            }
            (own[k].position, own[k].rate) = self.initial_joint(table, joint.kind, &key);
        }
        for (k, own) in own.into_iter().enumerate() {
            let joint = &self.model.joints[tree.coordinates[k]];
            if led[k] || (own.motor.is_none() && joint.spring_damper.is_none()) {
                continue;
            }
            let spring = joint.spring_damper;
            plan.joints[k] = JointDrive::Force {
                motor: own.motor.unwrap_or_else(ForceProfile::none),
                spring: spring.map_or_else(SpringDamper::default, |s| SpringDamper {
                    stiffness: s.stiffness,
                    rest: s.rest,
                    damping: s.damping,
                }),
                // A spring without initial conditions starts at rest.
                initial_position: own
                    .position
                    .unwrap_or_else(|| spring.map_or(joint.standing_at(), |s| s.rest)),
                initial_rate: own.rate.unwrap_or(0.0),
            };
        }
    }

    fn initial_joint(
        &mut self,
        table: &InitialJointFile,
        kind: JointKind,
        key: &str,
    ) -> (Option<f64>, Option<f64>) {
        let turning = [
            ("position_rad", &table.position_rad),
            ("rate_rad_s", &table.rate_rad_s),
        ];
        let sliding = [
            ("position_m", &table.position_m),
            ("rate_m_s", &table.rate_m_s),
        ];
        let (own, other) = match kind {
            JointKind::Prismatic => (sliding, turning),
            _ => (turning, sliding),
        };
        for ((name, value), (wanted, _)) in other.into_iter().zip(own) {
            if let Some(value) = value {
                self.wrong_unit(&format!("{key}.{name}"), value.span(), kind, wanted);
            }
        }
        let [position, rate] = own.map(|(name, value)| {
            let value = value.as_ref()?;
            if !value.get_ref().is_finite() {
                let key = format!("{key}.{name}");
                self.refuse(
                    "E0505",
                    &key,
                    value.span(),
                    "not finite",
                    "write a finite number",
                );
            }
            Some(*value.get_ref())
        });
        (position, rate)
    }

    /// The motor of one table: exactly one of constant, sinusoid, table or file.
    fn motor(&mut self, table: &JointTorqueFile, joint: &Joint, key: &str) -> Option<ForceProfile> {
        let turning = Forms {
            constant: ("constant_N_m", table.constant_N_m.as_ref()),
            amplitude: ("amplitude_N_m", table.amplitude_N_m.as_ref()),
            values: ("torque_N_m", table.torque_N_m.as_ref()),
        };
        let sliding = Forms {
            constant: ("constant_N", table.constant_N.as_ref()),
            amplitude: ("amplitude_N", table.amplitude_N.as_ref()),
            values: ("force_N", table.force_N.as_ref()),
        };
        let (own, other) = match joint.kind {
            JointKind::Prismatic => (sliding, turning),
            _ => (turning, sliding),
        };
        for ((name, span), (wanted, _)) in other.spans().into_iter().zip(own.spans()) {
            if let Some(span) = span {
                self.wrong_unit(&format!("{key}.{name}"), span, joint.kind, wanted);
                return None;
            }
        }
        match (own.constant.1, own.amplitude.1, own.values.1, &table.file) {
            (Some(x), None, None, None) => {
                self.finite(&format!("{key}.{}", own.constant.0), x)?;
                self.only(table, key, &["constant"])?;
                let held = PiecewisePolynomial::constant(*x.get_ref());
                Some(ForceProfile::Nodes(held))
            }
            (None, Some(x), None, None) => {
                self.finite(&format!("{key}.{}", own.amplitude.0), x)?;
                self.only(table, key, &["sinusoid"])?;
                self.sinusoid(table, *x.get_ref(), key)
            }
            (None, None, Some(x), None) => {
                self.only(table, key, &["table", "interpolation"])?;
                let Some(time) = &table.time_s else {
                    let problem = format!("{} needs time_s", own.values.0);
                    let span = table.joint.span();
                    self.refuse("E0502", key, span, problem, "add time_s = [...]");
                    return None;
                };
                let build = self.interpolation(table, key)?;
                let built = build(time.get_ref(), x.get_ref());
                let profile = self.checked(built, (time, x), key)?;
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
                    "give {}; or {} with frequency_rad_s; or time_s with {}; or file",
                    own.constant.0, own.amplitude.0, own.values.0
                );
                self.refuse("E0507", key, table.joint.span(), problem, remedy);
                None
            }
        }
    }

    /// Rejects keys of another motor form.
    fn only(&mut self, table: &JointTorqueFile, key: &str, forms: &[&str]) -> Option<()> {
        let keys: [(&str, Option<Range<usize>>, &str); 5] = [
            (
                "frequency_rad_s",
                table.frequency_rad_s.as_ref().map(Placed::span),
                "sinusoid",
            ),
            (
                "phase_rad",
                table.phase_rad.as_ref().map(Placed::span),
                "sinusoid",
            ),
            ("time_s", table.time_s.as_ref().map(Placed::span), "table"),
            ("column", table.column.as_ref().map(Placed::span), "file"),
            (
                "interpolation",
                table.interpolation.as_ref().map(Placed::span),
                "interpolation",
            ),
        ];
        for (name, span, form) in keys {
            if let Some(span) = span.filter(|_| !forms.contains(&form)) {
                let problem = format!("this key does not belong to a motor given as {}", forms[0]);
                self.refuse(
                    "E0507",
                    &format!("{key}.{name}"),
                    span,
                    problem,
                    "leave it out",
                );
                return None;
            }
        }
        Some(())
    }

    fn sinusoid(
        &mut self,
        table: &JointTorqueFile,
        amplitude: f64,
        key: &str,
    ) -> Option<ForceProfile> {
        let Some(frequency) = &table.frequency_rad_s else {
            let problem = "a sinusoid needs frequency_rad_s";
            let remedy = "add it: torque = amplitude sin(frequency t + phase)";
            self.refuse("E0502", key, table.joint.span(), problem, remedy);
            return None;
        };
        self.finite(&format!("{key}.frequency_rad_s"), frequency)?;
        if let Some(phase) = &table.phase_rad {
            self.finite(&format!("{key}.phase_rad"), phase)?;
        }
        Some(ForceProfile::Sine {
            amplitude,
            frequency: *frequency.get_ref(),
            phase: table.phase_rad.as_ref().map_or(0.0, |x| *x.get_ref()),
        })
    }

    /// Interpolation between nodes: constant (as from a digital controller) or linear.
    fn interpolation(&mut self, table: &JointTorqueFile, key: &str) -> Option<Build> {
        match &table.interpolation {
            None => Some(PiecewisePolynomial::steps),
            Some(word) => match word.get_ref().as_str() {
                "constant" => Some(PiecewisePolynomial::steps),
                "linear" => Some(PiecewisePolynomial::linear),
                _ => {
                    let key = format!("{key}.interpolation");
                    let remedy = "use \"constant\" or \"linear\"";
                    self.refuse(
                        "E0507",
                        &key,
                        word.span(),
                        "no such interpolation here",
                        remedy,
                    );
                    None
                }
            },
        }
    }

    /// The torque of a joint in a file.
    fn torque_file(
        &mut self,
        table: &JointTorqueFile,
        file: &Placed<String>,
        joint: &Joint,
        key: &str,
    ) -> Option<ForceProfile> {
        let build = self.interpolation(table, key)?;
        let unit = match joint.kind {
            JointKind::Prismatic => "N",
            _ => "Nm",
        };
        let column = match &table.column {
            Some(column) => column.get_ref().clone(),
            None => format!("{}_{unit}", joint.name),
        };
        let profile = self.column(file, &column, &[&format!("_{unit}")], build, key)?;
        Some(ForceProfile::Nodes(profile.starting_from(0.0)))
    }

    /// A column of a telemetry file next to the case; its name ends in one of `units`.
    pub(super) fn column(
        &mut self,
        file: &Placed<String>,
        column: &str,
        units: &[&str],
        build: Build,
        key: &str,
    ) -> Option<PiecewisePolynomial> {
        let folder = self.text.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(file.get_ref());
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
                self.refuse("E0511", &key, file.span(), problem, remedy);
                return None;
            }
        };
        let Some(channel) = found.channel(column) else {
            let names = found.channels.iter().map(|c| c.name.as_str());
            let remedy = did_you_mean(column, names);
            let problem = format!("the file has no column \"{column}\"");
            self.refuse("E0511", &key, file.span(), problem, remedy);
            return None;
        };
        if !units.iter().any(|unit| column.ends_with(unit)) {
            let problem = format!("column \"{column}\" is of another quantity");
            let remedy = format!("name a column that ends in {}", units.join(" or "));
            self.refuse("E0511", &key, file.span(), problem, remedy);
            return None;
        }
        match build(&channel.time_s, &channel.values) {
            Ok(profile) => Some(profile),
            Err(e) => {
                let problem = format!("column \"{column}\": {e}");
                self.refuse("E0511", &key, file.span(), problem, node_remedy(&e));
                None
            }
        }
    }

    fn finite(&mut self, key: &str, x: &Placed<f64>) -> Option<()> {
        if x.get_ref().is_finite() {
            return Some(());
        }
        self.refuse(
            "E0505",
            key,
            x.span(),
            "not finite",
            "write a finite number",
        );
        None
    }

    fn wrong_unit(&mut self, key: &str, span: Range<usize>, kind: JointKind, wanted: &str) {
        let problem = match kind {
            JointKind::Prismatic => "a prismatic joint moves in metres and newtons",
            _ => "a revolute joint moves in radians and newton metres",
        };
        self.refuse("E0507", key, span, problem, format!("use {wanted}"));
    }
}
