//! Builds the plan of a case for a model and collects faults.

use super::fault::{CaseText, did_you_mean};
use super::window::Open;
use crate::error::Fault;
use poinsot_dynamics::{JointMotion, NodeError, PiecewisePolynomial, Plan, Tree, WheelMotion};
use poinsot_formats::case::{FiringFile, JointMotionFile, Placed, WheelMotionFile};
use poinsot_model::Model;
use std::ops::Range;

/// Times and values.
pub(super) type Nodes<'f> = (&'f Placed<Vec<f64>>, &'f Placed<Vec<f64>>);

/// Difference of two numbers in a file that are meant to be equal, relative to a number above one.
const SAME: f64 = 1.0e-9;

/// A motion with its key and the name that it is for; `None` if it is faulty.
type Led<'f, M> = (String, &'f Placed<String>, Option<M>);

/// A motion of a joint or wheel.
trait Motion {
    /// Its nodes, if it has any.
    fn profile(self) -> Option<PiecewisePolynomial>;
    /// The motion through nodes.
    fn of(profile: PiecewisePolynomial) -> Self;
}

impl Motion for JointMotion {
    fn profile(self) -> Option<PiecewisePolynomial> {
        match self {
            Self::Nodes(profile) => Some(profile),
            Self::Fourier(_) => None,
        }
    }

    fn of(profile: PiecewisePolynomial) -> Self {
        Self::Nodes(profile)
    }
}

impl Motion for WheelMotion {
    fn profile(self) -> Option<PiecewisePolynomial> {
        match self {
            Self::Speed(profile) => Some(profile),
            Self::Torque { .. } | Self::Controlled { .. } => None,
        }
    }

    fn of(profile: PiecewisePolynomial) -> Self {
        Self::Speed(profile)
    }
}

pub(super) struct Planner<'c> {
    pub text: &'c CaseText,
    pub model: &'c Model,
    /// What a design fills.
    pub open: Open,
    pub faults: Vec<Fault>,
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

    /// The plan of a case, and the joint coordinates that it moves; other joints keep their locked position.
    pub fn plan(
        &mut self,
        joints: &[JointMotionFile],
        wheels: &[WheelMotionFile],
        firings: &[FiringFile],
        output: Range<usize>,
    ) -> (Plan, Vec<bool>) {
        let tree = Tree::new(self.model);
        let mut plan = Plan::hold(self.model);
        let mut led: Vec<Vec<Led<JointMotion>>> = plan.joints.iter().map(|_| Vec::new()).collect();
        for (i, table) in joints.iter().enumerate() {
            let key = format!("joint_motion[{i}]");
            let Some(k) = self.joint(&tree, &table.joint, &key) else {
                continue;
            };
            let kind = self.model.joints[tree.coordinates[k]].kind;
            let motion = self.joint_motion(table, kind, &key);
            led[k].push((format!("{key}.joint"), &table.joint, motion));
        }
        let moved: Vec<bool> = led.iter().map(|tables| !tables.is_empty()).collect();
        for (k, tables) in led.into_iter().enumerate() {
            let open = self.open.joints.contains(&k);
            if let Some(motion) = self.one_after_another(tables, open) {
                plan.joints[k] = motion.into();
            }
        }
        let mut driven: Vec<Vec<Led<WheelMotion>>> =
            plan.wheels.iter().map(|_| Vec::new()).collect();
        for (i, table) in wheels.iter().enumerate() {
            let key = format!("wheel_motion[{i}]");
            let Some(k) = self.model.wheel(table.wheel.get_ref()) else {
                let names = self.model.wheels.iter().map(|w| w.name.as_str());
                let remedy = did_you_mean(table.wheel.get_ref(), names);
                self.unknown("wheel", &format!("{key}.wheel"), &table.wheel, remedy);
                continue;
            };
            let motion = self.wheel_motion(table, &key);
            driven[k].push((format!("{key}.wheel"), &table.wheel, motion));
        }
        for (k, (wheel, tables)) in self.model.wheels.iter().zip(driven).enumerate() {
            let is_driven = !tables.is_empty();
            let open = self.open.wheels.contains(&k);
            if let Some(motion) = self.one_after_another(tables, open) {
                plan.wheels[k] = motion;
            }
            if !is_driven && !self.open.wheels.contains(&k) {
                let problem = format!("the case does not prescribe wheel \"{}\"", wheel.name);
                let remedy =
                    "add a [[wheel_motion]], with time_s = [0.0], speed_rad_s = [0.0] for rest";
                let text = &self.text;
                let fault = text.fault("E0504", "wheel_motion", output.clone(), problem, remedy);
                self.faults.push(fault.with_value(""));
            }
        }
        plan.firings = self.firings(firings);
        (plan, moved)
    }

    /// The motions of one joint or wheel as one. It must not jump, except where a design fills the time between.
    fn one_after_another<M: Motion>(&mut self, mut tables: Vec<Led<M>>, open: bool) -> Option<M> {
        if tables.len() < 2 {
            return tables.pop()?.2;
        }
        let mut profiles: Vec<(String, &Placed<String>, PiecewisePolynomial)> = Vec::new();
        for (key, name, motion) in tables {
            match motion?.profile() {
                Some(profile) => profiles.push((key, name, profile)),
                None => {
                    let problem = "a second motion for the same joint or wheel";
                    let remedy = "only nodes of positions or speeds follow each other; keep one";
                    self.refuse("E0504", &key, name.span(), problem, remedy);
                    return None;
                }
            }
        }
        let begin = |p: &PiecewisePolynomial| p.nodes().first().copied().unwrap_or(0.0);
        profiles.sort_by(|a, b| begin(&a.2).total_cmp(&begin(&b.2)));
        let mut all = PiecewisePolynomial::default();
        for (key, name, next) in profiles {
            let Ok(both) = all.clone().then(&next) else {
                let problem = "a second motion for the same joint or wheel at the same time";
                let remedy = "keep one of the two, or let one begin after the other has ended";
                self.refuse("E0504", &key, name.span(), problem, remedy);
                return None;
            };
            let (from, to) = (all.ends().1, next.ends().0);
            let end = all.nodes().last().copied();
            let jumps = end.is_some() && (from - to).abs() > SAME * from.abs().max(1.0);
            let is_designed =
                open && end.is_some_and(|e| self.open.window.is_between(e, begin(&next)));
            if jumps && !is_designed {
                let problem = format!("it begins at {to}, but the motion before it ends at {from}");
                let remedy = "let one begin where the other ends";
                self.refuse("E0507", &key, name.span(), problem, remedy);
                return None;
            }
            all = both;
        }
        Some(M::of(all))
    }

    pub(super) fn unknown(&mut self, what: &str, key: &str, name: &Placed<String>, remedy: String) {
        let problem = format!("the model has no {what} of this name");
        self.refuse("E0504", key, name.span(), problem, remedy);
    }

    pub(super) fn twice(&mut self, key: &str, name: &Placed<String>) {
        let problem = "a second motion for the same joint or wheel";
        self.refuse("E0504", key, name.span(), problem, "keep one of the two");
    }

    pub(super) fn checked<T>(
        &mut self,
        built: Result<T, NodeError>,
        nodes: Nodes,
        key: &str,
    ) -> Option<T> {
        let error = match built {
            Ok(built) => return Some(built),
            Err(error) => error,
        };
        let (code, key, span) = match error {
            NodeError::Empty | NodeError::Length { .. } => {
                ("E0506", key.to_owned(), nodes.1.span())
            }
            NodeError::NotFinite(_) => ("E0505", key.to_owned(), nodes.1.span()),
            NodeError::NotIncreasing(_) => ("E0506", format!("{key}.time_s"), nodes.0.span()),
        };
        self.refuse(code, &key, span, error.to_string(), node_remedy(&error));
        None
    }
}

pub(super) fn node_remedy(error: &NodeError) -> &'static str {
    match error {
        NodeError::Empty => "give at least one",
        NodeError::Length { .. } => "give one value per time",
        NodeError::NotFinite(_) => "write finite numbers (nodes count from 0)",
        NodeError::NotIncreasing(_) => "sort the times and leave out repeats (nodes count from 0)",
    }
}
