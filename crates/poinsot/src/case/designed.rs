//! `[design]`: free motion and objective.

use super::Case;
use super::planner::{Part, Planner};
use super::thrusters::Fired;
use super::window::{Replaced, Window};
use crate::error::Error;
use poinsot_dynamics::PiecewisePolynomial;
use poinsot_formats::case::{CaseFile, DesignFile, DesignJointFile, Objective};
use poinsot_model::Model;

/// Default number of evaluated manoeuvres.
const EVALUATIONS: usize = 12_000;
/// Default number of starts of the search.
const STARTS: usize = 4;

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
        self.planned(model, |planner| {
            if self.file.control.is_some() {
                let problem = "a design commands joints and wheels itself";
                planner.refuse("E0507", "control", problem, "leave [control] out");
            }
            Some(planner.design(&self.file, file))
        })
    }
}

impl Planner<'_> {
    fn design(&mut self, case: &CaseFile, file: &DesignFile) -> Design {
        let mut joints: Vec<Moved> = Vec::new();
        for (i, table) in file.joint.iter().enumerate() {
            let key = format!("design.joint[{i}]");
            let of = self.parts(Part::Joint, table.joints.as_deref(), &key);
            let Some((form, returns)) = self.joint_form(table, &key) else {
                continue;
            };
            for index in of {
                let joint = self.joint(index);
                let one = Moved::new((index, joint.slides()), form, joint.standing_at(), returns);
                self.add(&mut joints, one, &key);
            }
        }
        let mut wheels: Vec<Moved> = Vec::new();
        let mut started: Vec<(usize, String)> = Vec::new();
        for (i, table) in file.wheel.iter().enumerate() {
            let key = format!("design.wheel[{i}]");
            let form = Form::Spline { nodes: table.nodes };
            let (start, returns) = (table.start_speed_rad_s, table.returns.unwrap_or(true));
            for index in self.parts(Part::Wheel, table.wheels.as_deref(), &key) {
                let one = Moved::new((index, false), form, start.unwrap_or(0.0), returns);
                self.add(&mut wheels, one, &key);
                started.extend(start.map(|_| (index, format!("{key}.start_speed_rad_s"))));
            }
        }
        let mut thrusters = self.fired(&file.thruster);
        let window = self.window(file, case.duration_s);
        let mut replaced = self.surroundings(case, window, (&mut joints, &mut wheels));
        replaced.firing = self.firings_around(&case.firing, window, &mut thrusters);
        for moved in joints.iter_mut().chain(&mut wheels) {
            self.take_up(moved, window);
        }
        for (index, key) in started {
            let flown = |m: &Moved| m.index == index && !m.before.is_empty();
            if wheels.iter().any(flown) {
                let problem = "the motion flown first already gives the speed at the start";
                self.refuse("E0507", &key, problem, "leave it out");
            }
        }
        let nothing = joints.is_empty() && wheels.is_empty() && thrusters.is_empty();
        if nothing && self.faults.is_empty() {
            let problem = "no joint, wheel or thruster is free to move";
            let remedy = "add [[design.joint]], [[design.wheel]] or [[design.thruster]]";
            self.refuse("E0507", "design", problem, remedy);
        }
        Design {
            objective: file.objective,
            robust: file.robust,
            priors: file.priors,
            evaluations: file.evaluations.unwrap_or(EVALUATIONS),
            starts: file.starts.unwrap_or(STARTS),
            seed: file.seed,
            window,
            replaced,
            joints,
            wheels,
            thrusters,
        }
    }

    fn add(&mut self, list: &mut Vec<Moved>, one: Moved, key: &str) {
        if list.iter().any(|m| m.index == one.index) {
            let problem = "the same joint or wheel is moved twice";
            self.refuse("E0504", key, problem, "name each in one table");
            return;
        }
        list.push(one);
    }

    fn joint_form(&mut self, table: &DesignJointFile, key: &str) -> Option<(Form, bool)> {
        let returns = table.returns.unwrap_or(true);
        let form = match table.form.as_str() {
            "fourier" => Form::Fourier {
                harmonics: table.harmonics?,
                base_frequency_hz: table.base_frequency_hz,
                at_rest: table.at_rest.unwrap_or(false),
            },
            "spline" => Form::Spline {
                nodes: table.nodes?,
            },
            _ => Form::Slews {
                slews: table.slews?,
            },
        };
        let (problem, remedy) = match form {
            Form::Fourier {
                harmonics: 1,
                at_rest: true,
                ..
            } => (
                "one harmonic cannot start at rest",
                "give harmonics = 2 or more",
            ),
            Form::Slews { slews: 1 } if returns => (
                "one slew between given ends has nothing free",
                "give slews = 2 or more",
            ),
            _ => return Some((form, returns)),
        };
        self.refused("E0507", key, problem, remedy)
    }
}
