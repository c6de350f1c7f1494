//! Builds the plan of a case for a model and collects faults.

use super::fault::{KeyText, did_you_mean};
use super::window::Open;
use crate::error::Fault;
use nalgebra::Quaternion;
use poinsot_dynamics::{JointMotion, NodeError, PiecewisePolynomial, Plan, Tree, WheelMotion};
use poinsot_files::rounded;
use poinsot_formats::case::{FiringFile, JointMotionFile, WheelMotionFile};
use poinsot_model::{Joint, Model};
use poinsot_spatial::UnitQuaternion;

/// Difference of two numbers in a file that are meant to be equal, relative to a number above one.
const SAME: f64 = 1.0e-9;

/// A motion with its key; `None` if it is faulty.
type Led<M> = (String, Option<M>);

/// The nodes of a joint's motion, if it has any.
pub(super) fn nodes_of_joint(motion: JointMotion) -> Option<PiecewisePolynomial> {
    match motion {
        JointMotion::Nodes(profile) => Some(profile),
        JointMotion::Fourier(_) => None,
    }
}

/// The nodes of a wheel's motion, if it has any.
pub(super) fn nodes_of_wheel(motion: WheelMotion) -> Option<PiecewisePolynomial> {
    match motion {
        WheelMotion::Speed(profile) => Some(profile),
        WheelMotion::Torque { .. } | WheelMotion::Controlled { .. } => None,
    }
}

/// A kind of parts that a case names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    Body,
    /// A moving joint, by its coordinate.
    Joint,
    Wheel,
    Thruster,
}

impl Part {
    fn word(self) -> &'static str {
        match self {
            Self::Body => "body",
            Self::Joint => "joint",
            Self::Wheel => "wheel",
            Self::Thruster => "thruster",
        }
    }

    /// The names of all parts of this kind.
    fn names(self, model: &Model) -> Vec<&str> {
        match self {
            Self::Body => model.bodies.iter().map(|b| b.name.as_str()).collect(),
            Self::Joint => model.joints.iter().map(|j| j.name.as_str()).collect(),
            Self::Wheel => model.wheels.iter().map(|w| w.name.as_str()).collect(),
            Self::Thruster => model.thrusters.iter().map(|t| t.name.as_str()).collect(),
        }
    }
}

pub(super) struct Planner<'c> {
    pub text: &'c KeyText,
    pub model: &'c Model,
    pub tree: Tree,
    /// What a design fills.
    pub open: Open,
    pub faults: Vec<Fault>,
}

impl<'c> Planner<'c> {
    pub fn refuse(
        &mut self,
        code: &'static str,
        key: &str,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let fault = self.text.fault(code, key, problem, remedy);
        self.faults.push(fault);
    }

    /// Nothing in place of what is refused.
    pub fn refused<T>(
        &mut self,
        code: &'static str,
        key: &str,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Option<T> {
        self.refuse(code, key, problem, remedy);
        None
    }

    /// The plan of a case, and the joint coordinates that it moves; other joints keep their locked position.
    pub fn plan(
        &mut self,
        joints: &[JointMotionFile],
        wheels: &[WheelMotionFile],
        firings: &[FiringFile],
    ) -> (Plan, Vec<bool>) {
        let mut plan = Plan::hold(self.model);
        let mut led: Vec<Vec<Led<JointMotion>>> = vec![Vec::new(); plan.joints.len()];
        for (i, table) in joints.iter().enumerate() {
            let key = format!("joint_motion[{i}]");
            let own = format!("{key}.joint");
            if let Some(k) = self.part(Part::Joint, &table.joint, &own) {
                led[k].push((own, self.joint_motion(table, k, &key)));
            }
        }
        let moved: Vec<bool> = led.iter().map(|tables| !tables.is_empty()).collect();
        for (k, tables) in led.into_iter().enumerate() {
            let open = self.open.joints.contains(&k);
            let all = self.one_after_another(tables, open, nodes_of_joint, JointMotion::Nodes);
            if let Some(motion) = all {
                plan.joints[k] = motion.into();
            }
        }
        let mut driven: Vec<Vec<Led<WheelMotion>>> = vec![Vec::new(); plan.wheels.len()];
        for (i, table) in wheels.iter().enumerate() {
            let key = format!("wheel_motion[{i}]");
            let own = format!("{key}.wheel");
            if let Some(k) = self.part(Part::Wheel, &table.wheel, &own) {
                driven[k].push((own, self.wheel_motion(table, &key)));
            }
        }
        for (k, (wheel, tables)) in self.model.wheels.iter().zip(driven).enumerate() {
            let open = self.open.wheels.contains(&k);
            if tables.is_empty() && !open {
                let problem = format!("the case does not prescribe wheel \"{}\"", wheel.name);
                let remedy =
                    "add a [[wheel_motion]], with time_s = [0.0], speed_rad_s = [0.0] for rest";
                self.refuse("E0504", "wheel_motion", problem, remedy);
            }
            let all = self.one_after_another(tables, open, nodes_of_wheel, WheelMotion::Speed);
            if let Some(motion) = all {
                plan.wheels[k] = motion;
            }
        }
        plan.firings = self.firings(firings);
        (plan, moved)
    }

    /// The motions of one joint or wheel as one, by their nodes. It must not jump, except where a design fills the time between.
    fn one_after_another<M>(
        &mut self,
        mut tables: Vec<Led<M>>,
        open: bool,
        nodes: fn(M) -> Option<PiecewisePolynomial>,
        through: fn(PiecewisePolynomial) -> M,
    ) -> Option<M> {
        if tables.len() < 2 {
            return tables.pop()?.1;
        }
        let mut profiles: Vec<(String, PiecewisePolynomial)> = Vec::new();
        for (key, motion) in tables {
            match nodes(motion?) {
                Some(profile) => profiles.push((key, profile)),
                None => {
                    let problem = "a second motion for the same joint or wheel";
                    let remedy = "only nodes of positions or speeds follow each other; keep one";
                    return self.refused("E0504", &key, problem, remedy);
                }
            }
        }
        let begin = |p: &PiecewisePolynomial| p.nodes().first().copied().unwrap_or(0.0);
        profiles.sort_by(|a, b| begin(&a.1).total_cmp(&begin(&b.1)));
        let mut all = PiecewisePolynomial::default();
        for (key, next) in profiles {
            let Ok(both) = all.clone().then(&next) else {
                let problem = "a second motion for the same joint or wheel at the same time";
                let remedy = "keep one of the two, or let one begin after the other has ended";
                return self.refused("E0504", &key, problem, remedy);
            };
            let (from, to) = (all.ends().1, next.ends().0);
            let end = all.nodes().last().copied();
            let jumps = end.is_some() && (from - to).abs() > SAME * from.abs().max(1.0);
            let is_designed =
                open && end.is_some_and(|e| self.open.window.is_between(e, begin(&next)));
            if jumps && !is_designed {
                let problem = format!("it begins at {to}, but the motion before it ends at {from}");
                let remedy = "let one begin where the other ends";
                return self.refused("E0507", &key, problem, remedy);
            }
            all = both;
        }
        Some(through(all))
    }

    /// Index of a part; reports a name that the model does not have, and a joint that does not move.
    pub(super) fn part(&mut self, kind: Part, name: &str, key: &str) -> Option<usize> {
        let names = kind.names(self.model);
        let found = names.iter().position(|own| *own == name);
        let Some(at) = found else {
            let problem = format!("the model has no {} of this name", kind.word());
            return self.refused("E0504", key, problem, did_you_mean(name, names.into_iter()));
        };
        if kind != Part::Joint {
            return found;
        }
        let coordinate = self.tree.coordinates.iter().position(|k| *k == at);
        if coordinate.is_none() {
            let problem = "a fixed joint does not move";
            self.refuse("E0507", key, problem, "leave it out");
        }
        coordinate
    }

    /// Indices of the parts of a list of names; of all without a list.
    pub(super) fn parts(&mut self, kind: Part, names: Option<&[String]>, key: &str) -> Vec<usize> {
        let Some(names) = names else {
            return match kind {
                Part::Joint => (0..self.tree.dof()).collect(),
                _ => (0..kind.names(self.model).len()).collect(),
            };
        };
        let of = |(k, name): (usize, &String)| {
            self.part(kind, name, &format!("{key}.{}s[{k}]", kind.word()))
        };
        names.iter().enumerate().filter_map(of).collect()
    }

    /// The joint of a coordinate.
    pub(super) fn joint(&self, coordinate: usize) -> &'c Joint {
        &self.model.joints[self.tree.coordinates[coordinate]]
    }

    /// An attitude; printed quaternions are rounded, a larger deviation of the norm is another mistake.
    pub(super) fn attitude(&mut self, [x, y, z, w]: [f64; 4], key: &str) -> Option<UnitQuaternion> {
        let q = Quaternion::new(w, x, y, z);
        if !q.norm().is_finite() || (q.norm() - 1.0).abs() > 1e-3 {
            let problem = format!("norm {} is not 1", rounded(q.norm(), 6));
            let remedy = "give a unit quaternion, scalar last, body to inertial";
            return self.refused("E0505", key, problem, remedy);
        }
        Some(UnitQuaternion::new_normalize(q))
    }

    pub(super) fn twice(&mut self, key: &str) {
        let problem = "a second motion for the same joint or wheel";
        self.refuse("E0504", key, problem, "keep one of the two");
    }

    /// What was built from times and values; `values` is the key of the values below `key`.
    pub(super) fn checked<T>(
        &mut self,
        built: Result<T, NodeError>,
        key: &str,
        values: &str,
    ) -> Option<T> {
        let checked = built.map_err(|error| {
            let (code, name) = match error {
                NodeError::Empty | NodeError::Length { .. } => ("E0506", values),
                NodeError::NotFinite(_) => ("E0505", values),
                NodeError::NotIncreasing(_) => ("E0506", "time_s"),
            };
            let key = format!("{key}.{name}");
            self.refuse(code, &key, error.to_string(), node_remedy(&error));
        });
        checked.ok()
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
