//! Builds the plan of a case for a model and collects faults.

use super::fault::{CaseText, did_you_mean};
use crate::error::CaseFault;
use poinsot_dynamics::{NodeError, Plan, Tree};
use poinsot_formats::case::{FiringFile, JointMotionFile, Placed, WheelMotionFile};
use poinsot_model::Model;
use std::ops::Range;

/// Times and values.
pub(super) type Nodes<'f> = (&'f Placed<Vec<f64>>, &'f Placed<Vec<f64>>);

pub(super) struct Planner<'c> {
    pub text: &'c CaseText,
    pub model: &'c Model,
    /// Wheels that need no motion in the case.
    pub open_wheels: &'c [usize],
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
        let mut moved = vec![false; plan.joints.len()];
        for (i, table) in joints.iter().enumerate() {
            let key = format!("joint_motion[{i}]");
            let Some(k) = self.joint(&tree, &table.joint, &key) else {
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
        for (k, (wheel, driven)) in self.model.wheels.iter().zip(driven).enumerate() {
            if !driven && !self.open_wheels.contains(&k) {
                let problem = format!("the case does not prescribe wheel \"{}\"", wheel.name);
                let remedy =
                    "add a [[wheel_motion]], with time_s = [0.0], speed_rad_s = [0.0] for rest";
                let fault =
                    self.text
                        .fault("E0504", "wheel_motion", output.clone(), problem, remedy);
                self.faults.push(CaseFault {
                    value: String::new(),
                    ..fault
                });
            }
        }
        plan.firings = self.firings(firings);
        (plan, moved)
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
