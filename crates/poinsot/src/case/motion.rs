//! Joint, wheel and thruster tables of a case as motions of a model.

use super::fault::{CaseFault, CaseText, did_you_mean};
use super::file::{FiringFile, JointMotionFile, WheelMotionFile};
use poinsot_dynamics::{
    Firing, Fourier, JointMotion, NodeError, PiecewisePolynomial, Plan, Tree, WheelMotion,
};
use poinsot_model::{JointKind, Model};
use std::ops::Range;
use toml::Spanned;

type Nodes<'f> = (&'f Spanned<Vec<f64>>, &'f Spanned<Vec<f64>>);

/// Collects the plan and what is wrong with it.
pub(super) struct Planner<'c> {
    pub text: &'c CaseText,
    pub model: &'c Model,
    pub faults: Vec<CaseFault>,
}

impl Planner<'_> {
    pub fn refuse(
        &mut self,
        code: &'static str,
        key: &str,
        span: Range<usize>,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let fault = self.text.fault(code, key, span, problem, remedy);
        self.faults.push(fault);
    }

    /// The plan of a case; joints without motion stay where the model locks them.
    pub fn plan(
        &mut self,
        joints: &[JointMotionFile],
        wheels: &[WheelMotionFile],
        firings: &[FiringFile],
        output: Range<usize>,
    ) -> Plan {
        let tree = Tree::new(self.model);
        let mut plan = Plan::hold(self.model, &tree.coordinates);
        let mut moved = vec![false; plan.joints.len()];
        for (i, table) in joints.iter().enumerate() {
            let key = format!("joint_motion[{i}]");
            let Some(k) = self.joint(&tree, table, &key) else {
                continue;
            };
            if std::mem::replace(&mut moved[k], true) {
                self.twice(&format!("{key}.joint"), &table.joint);
            }
            let kind = self.model.joints[tree.coordinates[k]].kind;
            if let Some(motion) = self.joint_motion(table, kind, &key) {
                plan.joints[k] = motion;
            }
        }
        let mut driven = vec![false; plan.wheels.len()];
        for (i, table) in wheels.iter().enumerate() {
            let key = format!("wheel_motion[{i}]");
            let Some(k) = self.model.wheel(table.wheel.get_ref()) else {
                let names = self.model.wheels.iter().map(|w| w.name.as_str());
                let remedy = did_you_mean(table.wheel.get_ref(), names);
                self.unknown("wheel", &format!("{key}.wheel"), &table.wheel, remedy);
                continue;
            };
            if std::mem::replace(&mut driven[k], true) {
                self.twice(&format!("{key}.wheel"), &table.wheel);
            }
            if let Some(motion) = self.wheel_motion(table, &key) {
                plan.wheels[k] = motion;
            }
        }
        for (wheel, driven) in self.model.wheels.iter().zip(driven) {
            if !driven {
                let problem = format!("nothing says how wheel \"{}\" turns", wheel.name);
                let remedy =
                    "add a [[wheel_motion]], with time_s = [0.0], speed_rad_s = [0.0] for rest";
                let fault =
                    self.text
                        .fault("E0304", "wheel_motion", output.clone(), problem, remedy);
                self.faults.push(CaseFault {
                    value: String::new(),
                    ..fault
                });
            }
        }
        plan.firings = self.firings(firings);
        plan
    }

    fn unknown(&mut self, what: &str, key: &str, name: &Spanned<String>, remedy: String) {
        let problem = format!("the model has no {what} of this name");
        self.refuse("E0304", key, name.span(), problem, remedy);
    }

    fn twice(&mut self, key: &str, name: &Spanned<String>) {
        let problem = "a second motion for the same thing";
        self.refuse("E0304", key, name.span(), problem, "keep one of the two");
    }

    fn joint(&mut self, tree: &Tree, table: &JointMotionFile, key: &str) -> Option<usize> {
        let (name, key) = (table.joint.get_ref(), format!("{key}.joint"));
        let Some(j) = self.model.joint(name) else {
            let names = self.model.joints.iter().map(|j| j.name.as_str());
            self.unknown("joint", &key, &table.joint, did_you_mean(name, names));
            return None;
        };
        let coordinate = tree.coordinates.iter().position(|k| *k == j);
        if coordinate.is_none() {
            let problem = "a fixed joint does not move";
            self.refuse("E0307", &key, table.joint.span(), problem, "leave it out");
        }
        coordinate
    }

    fn joint_motion(
        &mut self,
        table: &JointMotionFile,
        kind: JointKind,
        key: &str,
    ) -> Option<JointMotion> {
        let slides = kind == JointKind::Prismatic;
        let wrong = if slides {
            [&table.position_rad, &table.sine_rad, &table.cosine_rad]
        } else {
            [&table.position_m, &table.sine_m, &table.cosine_m]
        };
        let offset = if slides {
            &table.offset_rad
        } else {
            &table.offset_m
        };
        let spans = wrong.into_iter().flatten().map(Spanned::span);
        if let Some(span) = spans.chain(offset.iter().map(Spanned::span)).next() {
            let (problem, remedy) = if slides {
                (
                    "a prismatic joint moves in metres",
                    "use the keys that end in _m",
                )
            } else {
                (
                    "a revolute joint moves in radians",
                    "use the keys that end in _rad",
                )
            };
            self.refuse("E0307", key, span, problem, remedy);
            return None;
        }
        let word = table.interpolation.get_ref().as_str();
        match word {
            "quintic_rest" | "cubic_clamped" => {
                let position = if slides {
                    &table.position_m
                } else {
                    &table.position_rad
                };
                let nodes = self.nodes(table, position.as_ref(), key)?;
                let motion = match word {
                    "quintic_rest" => JointMotion::quintic_rest,
                    _ => JointMotion::cubic_clamped,
                };
                let motion = motion(nodes.0.get_ref(), nodes.1.get_ref());
                self.checked(motion, nodes, key)
            }
            "fourier" => self.fourier(table, slides, key),
            _ => {
                let words = ["quintic_rest", "cubic_clamped", "fourier"];
                let remedy = did_you_mean(word, words.into_iter()).replace("the model has", "use");
                let key = format!("{key}.interpolation");
                let span = table.interpolation.span();
                self.refuse("E0307", &key, span, "no such interpolation", remedy);
                None
            }
        }
    }

    fn nodes<'f>(
        &mut self,
        table: &'f JointMotionFile,
        position: Option<&'f Spanned<Vec<f64>>>,
        key: &str,
    ) -> Option<Nodes<'f>> {
        let harmonics = [
            &table.sine_rad,
            &table.sine_m,
            &table.cosine_rad,
            &table.cosine_m,
        ];
        if let Some(x) = harmonics.into_iter().flatten().next() {
            let problem = "harmonics belong to interpolation = \"fourier\"";
            self.refuse("E0307", key, x.span(), problem, "leave them out");
        }
        match (&table.time_s, position) {
            (Some(time), Some(position)) => Some((time, position)),
            _ => {
                let problem = "time_s and position are needed";
                let remedy = "add time_s = [...] and position_rad = [...] (prismatic: position_m)";
                self.refuse("E0302", key, table.joint.span(), problem, remedy);
                None
            }
        }
    }

    fn fourier(&mut self, table: &JointMotionFile, slides: bool, key: &str) -> Option<JointMotion> {
        let (offset, sine, cosine) = if slides {
            (&table.offset_m, &table.sine_m, &table.cosine_m)
        } else {
            (&table.offset_rad, &table.sine_rad, &table.cosine_rad)
        };
        if let Some(time) = &table.time_s {
            let problem = "a Fourier series has no nodes";
            self.refuse(
                "E0307",
                &format!("{key}.time_s"),
                time.span(),
                problem,
                "leave it out",
            );
        }
        let Some(frequency) = &table.base_frequency_hz else {
            let problem = "a Fourier series needs base_frequency_hz";
            self.refuse("E0302", key, table.joint.span(), problem, "add it");
            return None;
        };
        let list =
            |x: &Option<Spanned<Vec<f64>>>| x.as_ref().map_or(Vec::new(), |x| x.get_ref().clone());
        let fourier = Fourier {
            offset: offset.as_ref().map_or(0.0, |x| *x.get_ref()),
            base_frequency_hz: *frequency.get_ref(),
            sine: list(sine),
            cosine: list(cosine),
        };
        let coefficients = || fourier.sine.iter().chain(&fourier.cosine);
        if !fourier.offset.is_finite() || !coefficients().all(|x| x.is_finite()) {
            let problem = "a coefficient is not finite";
            self.refuse("E0305", key, table.joint.span(), problem, "correct it");
            return None;
        }
        let base = fourier.base_frequency_hz;
        if !base.is_finite() || base <= 0.0 {
            let key = format!("{key}.base_frequency_hz");
            self.refuse(
                "E0305",
                &key,
                frequency.span(),
                "must be a positive number",
                "correct it",
            );
            return None;
        }
        Some(JointMotion::Fourier(fourier))
    }

    fn wheel_motion(&mut self, table: &WheelMotionFile, key: &str) -> Option<WheelMotion> {
        let word = table.interpolation.as_ref().map(|w| w.get_ref().as_str());
        let (values, torque) = match (&table.speed_rad_s, &table.torque_N_m) {
            (Some(speed), None) => (speed, false),
            (None, Some(torque)) => (torque, true),
            _ => {
                let problem = "a wheel needs either speed_rad_s or torque_N_m";
                self.refuse(
                    "E0307",
                    key,
                    table.wheel.span(),
                    problem,
                    "give one of the two",
                );
                return None;
            }
        };
        let build = match (word, torque) {
            (None | Some("linear"), false) | (Some("linear"), true) => PiecewisePolynomial::linear,
            (None | Some("constant"), true) => PiecewisePolynomial::steps,
            (Some("cubic_clamped"), false) => PiecewisePolynomial::cubic_clamped,
            (Some(_), _) => {
                let span = table.interpolation.as_ref().map_or(0..0, Spanned::span);
                let problem = "no such interpolation here";
                let remedy = if torque {
                    "use \"constant\" or \"linear\""
                } else {
                    "use \"linear\" or \"cubic_clamped\""
                };
                self.refuse(
                    "E0307",
                    &format!("{key}.interpolation"),
                    span,
                    problem,
                    remedy,
                );
                return None;
            }
        };
        let profile = build(table.time_s.get_ref(), values.get_ref());
        let profile = self.checked(profile, (&table.time_s, values), key)?;
        let initial = table.initial_speed_rad_s.as_ref();
        if torque {
            let initial_speed = initial.map_or(0.0, |x| *x.get_ref());
            if !initial_speed.is_finite() {
                let problem = "the initial speed is not finite";
                self.refuse("E0305", key, table.wheel.span(), problem, "correct it");
            }
            return Some(WheelMotion::Torque {
                initial_speed,
                torque: profile.starting_from(0.0),
            });
        }
        if let Some(x) = initial {
            let key = format!("{key}.initial_speed_rad_s");
            let problem = "speed_rad_s already says the initial speed";
            self.refuse("E0307", &key, x.span(), problem, "leave it out");
        }
        Some(WheelMotion::Speed(profile))
    }

    fn checked<T>(&mut self, built: Result<T, NodeError>, nodes: Nodes, key: &str) -> Option<T> {
        let error = match built {
            Ok(built) => return Some(built),
            Err(error) => error,
        };
        let (code, key, span) = match error {
            NodeError::Empty | NodeError::Length { .. } => {
                ("E0306", key.to_owned(), nodes.1.span())
            }
            NodeError::NotFinite(_) => ("E0305", key.to_owned(), nodes.1.span()),
            NodeError::NotIncreasing(_) => ("E0306", format!("{key}.time_s"), nodes.0.span()),
        };
        self.refuse(
            code,
            &key,
            span,
            error.to_string(),
            "correct the nodes (counted from 0)",
        );
        None
    }

    fn firings(&mut self, tables: &[FiringFile]) -> Vec<Firing> {
        let mut firings: Vec<Firing> = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let key = |name: &str| format!("firing[{i}].{name}");
            let name = table.thruster.get_ref();
            let (on, off) = (*table.on_s.get_ref(), *table.off_s.get_ref());
            let force = *table.force_N.get_ref();
            if !on.is_finite() || !off.is_finite() || off <= on {
                let problem = "the firing ends before it begins, or is not finite";
                let remedy = "off_s must lie after on_s";
                self.refuse("E0305", &key("off_s"), table.off_s.span(), problem, remedy);
            }
            if !force.is_finite() || force < 0.0 {
                let problem = "a thruster pushes along its force_direction only";
                let remedy = "give a finite force that is not negative";
                self.refuse(
                    "E0305",
                    &key("force_N"),
                    table.force_N.span(),
                    problem,
                    remedy,
                );
            }
            let Some(thruster) = self.model.thruster(name) else {
                let names = self.model.thrusters.iter().map(|t| t.name.as_str());
                let remedy = did_you_mean(name, names);
                self.unknown("thruster", &key("thruster"), &table.thruster, remedy);
                continue;
            };
            let same = |f: &&Firing| f.thruster == thruster && f.on < off && on < f.off;
            if firings.iter().any(|f| same(&f)) {
                let problem = "the thruster already fires at that time";
                let remedy = "let firings of one thruster not overlap";
                self.refuse("E0307", &key("on_s"), table.on_s.span(), problem, remedy);
            }
            firings.push(Firing {
                thruster,
                on,
                off,
                force,
            });
        }
        firings
    }
}
