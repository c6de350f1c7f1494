//! `[design]`: free motion and objective.

use super::Case;
use super::planner::Planner;
use super::thrusters::Fired;
use super::window::{Replaced, Window};
use crate::error::Error;
use poinsot_dynamics::{PiecewisePolynomial, Tree};
use poinsot_formats::case::{
    CaseFile, DesignFile, DesignJointFile, DesignWheelFile, Objective, Placed,
};
use poinsot_model::{JointKind, Model};
use std::ops::Range;

/// Default number of evaluated manoeuvres.
const EVALUATIONS: usize = 12_000;
/// Default number of starts of the search.
const STARTS: usize = 4;
/// Largest number of free numbers per joint or wheel.
const MOST: usize = 64;

/// Form of motion of one joint or wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// `sum_k a_k sin(2 pi k f t) + b_k cos(2 pi k f t)` about the locked position.
    Fourier {
        /// Harmonics.
        harmonics: usize,
        /// Base frequency f, Hz; default: one period over the duration.
        base_frequency_hz: Option<f64>,
        /// Starts at the locked position with zero rate and acceleration.
        at_rest: bool,
    },
    /// A cubic spline through equally spaced nodes, at rest at both ends.
    Spline {
        /// Nodes, both ends included.
        nodes: usize,
    },
    /// Rest-to-rest quintics of equal duration.
    Slews {
        /// Number of slews.
        slews: usize,
    },
}

/// One joint coordinate or wheel moved by a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// Index of the joint coordinate or wheel.
    pub index: usize,
    /// Whether it is a prismatic joint.
    pub slides: bool,
    /// Form of motion.
    pub form: Form,
    /// Joint position or wheel speed where the designed motion starts.
    pub start: f64,
    /// The same where it ends, unless that is free. A Fourier series ends where it started.
    pub end: Option<f64>,
    /// Motions that are flown first, in order.
    pub before: Vec<PiecewisePolynomial>,
    /// Motions that are flown next, in order.
    pub after: Vec<PiecewisePolynomial>,
}

/// Free motion and objective of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Objective to be minimised.
    pub objective: Objective,
    /// Whether vehicles of the prior are included, not only the nominal one.
    pub robust: bool,
    /// Whether declared priors of mass properties are included in the sigmas.
    pub priors: bool,
    /// Largest number of evaluated manoeuvres.
    pub evaluations: usize,
    /// Starts of the search.
    pub starts: usize,
    /// Seed of the search.
    pub seed: u64,
    /// The part of the record that is designed.
    pub window: Window,
    /// What it replaces in the case.
    pub replaced: Replaced,
    /// Joints moved by the design.
    pub joints: Vec<Moved>,
    /// Wheels moved by the design.
    pub wheels: Vec<Moved>,
    /// Thrusters whose firings the design times.
    pub thrusters: Vec<Fired>,
}

impl Moved {
    fn new((index, slides): (usize, bool), form: Form, start: f64, returns: bool) -> Self {
        Self {
            index,
            slides,
            form,
            start,
            end: returns.then_some(start),
            before: Vec::new(),
            after: Vec::new(),
        }
    }

    /// Number of free numbers whose values are those of the motion at its nodes.
    pub fn free_nodes(&self, nodes: usize) -> usize {
        nodes - 1 - usize::from(self.end.is_some())
    }
}

impl Case {
    /// The free motion of this case; `None` without `[design]`.
    ///
    /// # Errors
    /// All faults with this model.
    pub fn design(&self, model: &Model) -> Result<Option<Design>, Error> {
        let Some(file) = &self.file.design else {
            return Ok(None);
        };
        let mut planner = self.planner(model);
        if let Some(control) = &self.file.control {
            let problem = "a design commands joints and wheels itself";
            planner.refuse(
                "E0507",
                "control",
                control.span(),
                problem,
                "leave [control] out",
            );
        }
        let design = planner.design(&self.file, file.get_ref(), file.span());
        match planner.faults.is_empty() {
            true => Ok(Some(design)),
            false => Err(Error::sorted(planner.faults)),
        }
    }
}

impl Planner<'_> {
    fn design(&mut self, case: &CaseFile, file: &DesignFile, span: Range<usize>) -> Design {
        let tree = Tree::new(self.model);
        let mut joints: Vec<Moved> = Vec::new();
        for (i, table) in file.joint.iter().enumerate() {
            let key = format!("design.joint[{i}]");
            let of = self.joints_of(&tree, table.get_ref().joints.as_deref(), &key);
            let Some((form, returns)) = self.joint_form(table.get_ref(), table.span(), &key) else {
                continue;
            };
            for index in of {
                let joint = &self.model.joints[tree.coordinates[index]];
                let slides = joint.kind == JointKind::Prismatic;
                let one = Moved::new((index, slides), form, joint.standing_at(), returns);
                self.add(&mut joints, one, table.span(), &key);
            }
        }
        let mut wheels: Vec<Moved> = Vec::new();
        let mut started: Vec<(usize, String, Range<usize>)> = Vec::new();
        for (i, table) in file.wheel.iter().enumerate() {
            let key = format!("design.wheel[{i}]");
            let of = self.wheels_of(table.get_ref().wheels.as_deref(), &key);
            let Some((form, start, returns)) = self.wheel_form(table.get_ref(), &key) else {
                continue;
            };
            let given = table.get_ref().start_speed_rad_s.as_ref();
            let given = given.map(|x| (format!("{key}.start_speed_rad_s"), x.span()));
            for index in of {
                let one = Moved::new((index, false), form, start, returns);
                self.add(&mut wheels, one, table.span(), &key);
                started.extend(given.clone().map(|(key, span)| (index, key, span)));
            }
        }
        let mut thrusters = self.fired(&file.thruster);
        let window = self.window(file, *case.duration_s.get_ref());
        let mut replaced = self.surroundings(case, window, (&mut joints, &mut wheels));
        replaced.firing = self.firings_around(&case.firing, window, &mut thrusters);
        for moved in joints.iter_mut().chain(&mut wheels) {
            self.take_up(moved, window, span.clone());
        }
        for (index, key, span) in started {
            if wheels
                .iter()
                .any(|m| m.index == index && !m.before.is_empty())
            {
                let problem = "the motion flown first already gives the speed at the start";
                self.refuse("E0507", &key, span, problem, "leave it out");
            }
        }
        let nothing = joints.is_empty() && wheels.is_empty() && thrusters.is_empty();
        if nothing && self.faults.is_empty() {
            let problem = "no joint, wheel or thruster is free to move";
            let remedy = "add [[design.joint]], [[design.wheel]] or [[design.thruster]]";
            self.refuse("E0507", "design", span, problem, remedy);
        }
        Design {
            objective: file.objective,
            robust: file.robust,
            priors: file.priors,
            evaluations: self.count(file.evaluations.as_ref(), EVALUATIONS, "design.evaluations"),
            starts: self.count(file.starts.as_ref(), STARTS, "design.starts"),
            seed: file.seed,
            window,
            replaced,
            joints,
            wheels,
            thrusters,
        }
    }

    fn add(&mut self, list: &mut Vec<Moved>, one: Moved, span: Range<usize>, key: &str) {
        if list.iter().any(|m| m.index == one.index) {
            let problem = "the same joint or wheel is moved twice";
            self.refuse("E0504", key, span, problem, "name each in one table");
            return;
        }
        list.push(one);
    }

    fn count(&mut self, given: Option<&Placed<usize>>, default: usize, key: &str) -> usize {
        match given {
            Some(x) if *x.get_ref() == 0 => {
                self.refuse(
                    "E0505",
                    key,
                    x.span(),
                    "must be at least 1",
                    "give a whole number",
                );
                default
            }
            Some(x) => *x.get_ref(),
            None => default,
        }
    }

    fn joint_form(
        &mut self,
        table: &DesignJointFile,
        span: Range<usize>,
        key: &str,
    ) -> Option<(Form, bool)> {
        let returns = table.returns.as_ref().is_none_or(|x| *x.get_ref());
        let word = table.form.get_ref().as_str();
        let extra = |fourier: bool, nodes: bool, slews: bool| {
            let of_fourier = [
                table.harmonics.as_ref().map(Placed::span),
                table.base_frequency_hz.as_ref().map(Placed::span),
                table.at_rest.as_ref().map(Placed::span),
            ];
            let of_nodes = table.nodes.as_ref().map(Placed::span);
            let of_slews = table.slews.as_ref().map(Placed::span);
            let of_ends = table.returns.as_ref().map(Placed::span);
            let mut wrong = of_fourier.into_iter().flatten().filter(|_| !fourier);
            let others = [(of_nodes, nodes), (of_slews, slews), (of_ends, !fourier)];
            let mut others = others.into_iter().filter(|(_, own)| !own);
            wrong.next().or_else(|| others.find_map(|(span, _)| span))
        };
        let (stray, form) = match word {
            "fourier" => {
                let harmonics = self.needed(table.harmonics.as_ref(), "harmonics", 1, span, key)?;
                let base = table.base_frequency_hz.as_ref();
                if let Some(f) = base.filter(|f| !(f.get_ref().is_finite() && *f.get_ref() > 0.0)) {
                    let key = format!("{key}.base_frequency_hz");
                    self.refuse(
                        "E0505",
                        &key,
                        f.span(),
                        "must be a positive number",
                        "give one",
                    );
                }
                let at_rest = table.at_rest.as_ref().is_some_and(|x| *x.get_ref());
                if at_rest && harmonics < 2 {
                    let problem = "one harmonic cannot start at rest";
                    self.refuse(
                        "E0507",
                        key,
                        table.form.span(),
                        problem,
                        "give harmonics = 2 or more",
                    );
                }
                let form = Form::Fourier {
                    harmonics,
                    base_frequency_hz: base.map(|f| *f.get_ref()),
                    at_rest,
                };
                (extra(true, false, false), form)
            }
            "spline" => {
                let nodes = self.needed(table.nodes.as_ref(), "nodes", 3, span, key)?;
                (extra(false, true, false), Form::Spline { nodes })
            }
            "slews" => {
                let least = if returns { 2 } else { 1 };
                let slews = self.needed(table.slews.as_ref(), "slews", least, span, key)?;
                (extra(false, false, true), Form::Slews { slews })
            }
            _ => {
                let remedy = super::did_you_mean(word, ["fourier", "spline", "slews"].into_iter());
                let key = format!("{key}.form");
                self.refuse("E0507", &key, table.form.span(), "no such form", remedy);
                return None;
            }
        };
        if let Some(span) = stray {
            let problem = format!("this key does not belong to form = \"{word}\"");
            self.refuse("E0507", key, span, problem, "leave it out");
        }
        Some((form, returns))
    }

    pub(super) fn needed(
        &mut self,
        given: Option<&Placed<usize>>,
        name: &str,
        least: usize,
        span: Range<usize>,
        key: &str,
    ) -> Option<usize> {
        let key = format!("{key}.{name}");
        match given {
            None => {
                let remedy = format!("add {name} = N");
                self.refuse("E0502", &key, span, "this form needs it", remedy);
                None
            }
            Some(x) if !(least..=MOST).contains(x.get_ref()) => {
                let problem = format!("must lie between {least} and {MOST}");
                self.refuse(
                    "E0505",
                    &key,
                    x.span(),
                    problem,
                    "give a number between them",
                );
                None
            }
            Some(x) => Some(*x.get_ref()),
        }
    }

    fn wheel_form(&mut self, table: &DesignWheelFile, key: &str) -> Option<(Form, f64, bool)> {
        let span = table.nodes.span();
        let nodes = self.needed(Some(&table.nodes), "nodes", 3, span, key)?;
        let start = table.start_speed_rad_s.as_ref();
        if let Some(x) = start.filter(|x| !x.get_ref().is_finite()) {
            let key = format!("{key}.start_speed_rad_s");
            self.refuse(
                "E0505",
                &key,
                x.span(),
                "not finite",
                "give a finite number",
            );
        }
        let returns = table.returns.as_ref().is_none_or(|x| *x.get_ref());
        let start = start.map_or(0.0, |x| *x.get_ref());
        Some((Form::Spline { nodes }, start, returns))
    }
}
