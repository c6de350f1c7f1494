//! The table of conventions: one row for each kind of channel and change.

use super::FaultKind;
use crate::diagnosis::candidates::moves;
use crate::fit::experiment::Experiment;
use crate::problem::Problem;
use crate::problem::segment::{InputRate, SensorRecord, SensorValue};
use poinsot_model::{JointKind, SensorKind, rounded};
use poinsot_spatial::Vector3;
use poinsot_telemetry::{Axes, Change, Repair};
use std::f64::consts::{PI, TAU};

/// Factors that make a number of a wrong unit right, and the mistake.
pub(in crate::diagnosis) const UNITS: [(f64, &str); 4] = [
    (PI / 180.0, "degrees used as radians"),
    (PI / 30.0, "revolutions per minute used as rad/s"),
    (TAU, "revolutions used as radians"),
    (180.0 / PI, "radians used as degrees"),
];
/// Ratios that are tried of a joint, of either sign.
const RATIOS: [f64; 9] = [0.2, 0.333, 0.5, 0.667, 0.8, 1.25, 1.5, 2.0, 3.0];
/// Share of a ratio to which it is sought about those, and within which it is one of whole numbers.
const ABOUT: f64 = 0.2;
const SAME: f64 = 0.01;
/// Largest whole number in a ratio that is printed as one.
const TEETH: u32 = 6;
/// Most joints of a vehicle of which each is tried: every trial takes longer with their number, and there are more.
const MOST_JOINTS: usize = 16;
/// Zeros of a joint that are tried, rad, to either side.
const ZERO_STEP: f64 = PI / 12.0;
/// Shares of a typical pulse by which all may be longer or shorter.
const PULSES: [f64; 6] = [-0.3, -0.1, -0.03, 0.03, 0.1, 0.3];

/// What is read by another convention than declared.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Place {
    /// Speeds of these wheels.
    Wheels(Vec<usize>),
    /// Positions and rates of these joints.
    Joints(Vec<usize>),
    /// Force of a thruster.
    Thruster(usize),
    /// The length of every pulse.
    Pulses,
    /// A sensor by its place among those of the first segment.
    Sensor(usize),
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Convention {
    pub place: Place,
    /// What puts it right.
    pub change: Change,
    /// The channel in words.
    pub owner: String,
    /// How far the value may lie from the true one, where it is free.
    pub free: Option<f64>,
}

/// All kinds of conventions that the record can have, those whose trial is quick first.
pub(super) fn all(experiment: &Experiment) -> Vec<Vec<Convention>> {
    let mut all = thrusters(experiment);
    all.extend(wheels(experiment));
    all.push(pulses(experiment));
    all.extend(joints(experiment));
    all.extend(gyro(experiment));
    all.retain(|kind| !kind.is_empty());
    all
}

fn row(place: Place, change: Change, owner: &str) -> Convention {
    Convention {
        place,
        change,
        owner: owner.to_owned(),
        free: None,
    }
}

fn thrusters(experiment: &Experiment) -> Vec<Vec<Convention>> {
    let segments = experiment.problem.segments;
    let fires = |k: usize| {
        let mut firings = segments.iter().flat_map(|s| &s.firings);
        firings.any(|f| f.thruster == k)
    };
    let of = |factor: f64| {
        let all = experiment.thrusters.iter().enumerate();
        let firing = all.filter(|(k, _)| fires(*k));
        let rows = firing.map(|(k, t)| row(Place::Thruster(k), Change::Factor(factor), &t.name));
        rows.collect()
    };
    [0.0, -1.0].map(of).into()
}

fn wheels(experiment: &Experiment) -> Vec<Vec<Convention>> {
    let wheels = &experiment.problem.model.wheels;
    let names: Vec<&str> = wheels.iter().map(|w| w.name.as_str()).collect();
    let exchanged = pairs(&names, Place::Wheels);
    let of = |factor: f64| {
        let own = names.iter().enumerate();
        let own = own.map(|(k, name)| row(Place::Wheels(vec![k]), Change::Factor(factor), name));
        let mut list: Vec<Convention> = own.collect();
        if names.len() > 1 {
            let all = Place::Wheels((0..names.len()).collect());
            list.push(row(all, Change::Factor(factor), "all wheels"));
        }
        list
    };
    let factors = [-1.0].into_iter().chain(UNITS.map(|u| u.0));
    [exchanged].into_iter().chain(factors.map(of)).collect()
}

/// Each two of a kind in each other's column.
fn pairs(names: &[&str], place: fn(Vec<usize>) -> Place) -> Vec<Convention> {
    let of = |j: usize| {
        (0..j).map(move |i| {
            let owner = format!("{} and {}", names[i], names[j]);
            row(place(vec![i, j]), Change::Exchanged, &owner)
        })
    };
    (1..names.len()).flat_map(of).collect()
}

/// All pulses longer or shorter by one time.
fn pulses(experiment: &Experiment) -> Vec<Convention> {
    let segments = experiment.problem.segments.iter();
    let firings = segments.flat_map(|s| &s.firings);
    let mut lengths: Vec<f64> = firings.map(|f| f.end_s - f.start_s).collect();
    if lengths.len() < 2 {
        return Vec::new();
    }
    lengths.sort_by(f64::total_cmp);
    let typical = lengths[lengths.len() / 2];
    let of = |share: f64| Convention {
        free: Some(0.8 * share.abs() * typical),
        ..row(
            Place::Pulses,
            Change::ClosesLate(share * typical),
            "every pulse",
        )
    };
    PULSES.map(of).into()
}

fn joints(experiment: &Experiment) -> Vec<Vec<Convention>> {
    let problem = experiment.problem;
    let model_joints = problem.tree.coordinates.iter();
    let few = problem.tree.dof() <= MOST_JOINTS;
    let model_joints = model_joints.filter(|_| few);
    let joints = model_joints.filter_map(|at| problem.model.joints.get(*at));
    let all: Vec<(usize, &poinsot_model::Joint)> = joints.enumerate().collect();
    let moving = |(k, _): &&(usize, &poinsot_model::Joint)| moves(problem, *k);
    let names: Vec<&str> = all.iter().map(|(_, j)| j.name.as_str()).collect();
    let own = |change: &dyn Fn(usize, &str) -> Vec<Convention>| -> Vec<Convention> {
        let moving = all.iter().filter(moving);
        moving.flat_map(|(k, j)| change(*k, &j.name)).collect()
    };
    let factors = |values: &[f64], free: bool| {
        own(&|k, name| {
            let one = |value: &f64| Convention {
                free: free.then_some(ABOUT * value.abs()),
                ..row(Place::Joints(vec![k]), Change::Factor(*value), name)
            };
            values.iter().map(one).collect()
        })
    };
    let ratios: Vec<f64> = RATIOS.iter().flat_map(|r| [*r, -r]).collect();
    let zeros = own(&|k, name| {
        if all[k].1.kind == JointKind::Prismatic {
            return Vec::new();
        }
        let steps = (-11..=12).filter(|s| *s != 0);
        let one = |s: i32| Convention {
            free: Some(0.6 * ZERO_STEP),
            ..row(
                Place::Joints(vec![k]),
                Change::Offset(f64::from(s) * ZERO_STEP),
                name,
            )
        };
        steps.map(one).collect()
    });
    let alike = |c: &Convention| match &c.place {
        Place::Joints(two) => two.windows(2).all(|w| all[w[0]].1.kind == all[w[1]].1.kind),
        _ => true,
    };
    let exchanged = pairs(&names, Place::Joints).into_iter().filter(alike);
    let units: Vec<f64> = UNITS.iter().map(|u| u.0).collect();
    vec![
        factors(&[-1.0], false),
        exchanged.collect(),
        zeros,
        factors(&ratios, true),
        factors(&units, false),
    ]
}

/// Axes and units of the gyro of a record without attitude; with one, both are compared as they are read.
fn gyro(experiment: &Experiment) -> Vec<Vec<Convention>> {
    let segments = experiment.problem.segments;
    if segments
        .iter()
        .any(|s| s.observations.reads(SensorKind::Attitude))
    {
        return Vec::new();
    }
    let Some(sensors) = segments.first().map(|s| &s.observations.sensors) else {
        return Vec::new();
    };
    let gyros = sensors
        .iter()
        .enumerate()
        .filter(|(_, s)| s.kind == SensorKind::Gyro);
    let gyros: Vec<(usize, &SensorRecord)> = gyros.collect();
    let of = |changes: Vec<Change>| -> Vec<Convention> {
        let each = |(k, s): &(usize, &SensorRecord)| {
            let (place, name) = (Place::Sensor(*k), format!("the {}", s.name));
            let rows = changes.iter().map(|c| row(place.clone(), *c, &name));
            rows.collect::<Vec<_>>()
        };
        gyros.iter().flat_map(each).collect()
    };
    let axes = Axes::all().filter(|axes| *axes != Axes::IDENTITY);
    let units = UNITS.iter().take(2).map(|u| Change::Factor(u.0));
    vec![of(axes.map(Change::Axes).collect()), of(units.collect())]
}

impl Convention {
    pub fn value(&self) -> f64 {
        match self.change {
            Change::Factor(x) | Change::Offset(x) | Change::ClosesLate(x) => x,
            _ => f64::NAN,
        }
    }

    pub fn with_value(mut self, value: f64) -> Self {
        match &mut self.change {
            Change::Factor(x) | Change::Offset(x) | Change::ClosesLate(x) => *x = value,
            _ => {}
        }
        self
    }

    /// The same with a ratio of whole numbers or a zero by an eighth of a turn, where the value is near one.
    pub fn rounded(&self) -> Option<Self> {
        let value = self.value();
        let known = match (&self.place, self.change) {
            (_, Change::Offset(_)) => (value / (PI / 4.0)).round() * (PI / 4.0),
            (_, Change::Factor(_)) => ratio(value)?,
            _ => return None,
        };
        let near = (known - value).abs() < SAME * value.abs();
        near.then(|| self.clone().with_value(known))
    }

    pub fn fault(&self) -> FaultKind {
        match (&self.place, self.change) {
            (Place::Thruster(_), _) => FaultKind::Thrust,
            (Place::Wheels(_), Change::Exchanged) => FaultKind::WheelExchange,
            (Place::Wheels(_), Change::Factor(x)) if x < 0.0 => FaultKind::WheelSign,
            (_, Change::Factor(x)) if unit(x).is_some() => FaultKind::Units,
            _ => FaultKind::Convention,
        }
    }

    /// The mistake.
    pub fn words(&self) -> String {
        let owner = &self.owner;
        match (&self.place, self.change) {
            (Place::Thruster(_), Change::Factor(0.0)) => format!("no force of {owner}"),
            (Place::Thruster(_), _) => format!("a wrong direction of {owner}"),
            (_, Change::ClosesLate(x)) => {
                let off = if x < 0.0 { "shorter" } else { "longer" };
                format!(
                    "{owner} {} s {off} than commanded (closes_late_s = {} in the columns of the thrusters)",
                    rounded(x.abs(), 3),
                    rounded(x, 3)
                )
            }
            (Place::Wheels(_), Change::Exchanged) => format!("exchanged speeds of {owner}"),
            (_, Change::Offset(x)) => {
                let degrees = rounded(x.to_degrees(), 4);
                format!("another zero of {owner} (offset = {degrees} deg in its column)")
            }
            (_, Change::Axes(axes)) => {
                format!("other axes of {owner} (body axes = {axes})")
            }
            (_, Change::Factor(x)) => match unit(x) {
                Some(words) => format!("a wrong unit of {owner} ({words})"),
                None if x == -1.0 && matches!(self.place, Place::Joints(_)) => {
                    format!("a wrong sign of {owner} (sign = -1 in its columns)")
                }
                None if x == -1.0 => format!("a wrong sign of {owner}"),
                None => format!(
                    "another ratio of {owner} (scale = {} in its columns)",
                    rounded(x, 6)
                ),
            },
            _ => format!("exchanged columns of {owner}"),
        }
    }

    /// The change of the map that declares it; `None` where it is one of the model.
    pub fn repair(&self, problem: &Problem) -> Option<Repair> {
        let model = problem.model;
        let of_joint = |k: &usize| -> Vec<String> {
            let at = problem.tree.coordinates.get(*k);
            let joint = at.and_then(|at| model.joints.get(*at));
            let mut segments = problem.segments.iter();
            let measured = segments.any(|s| s.observations.joint(*k).rate == InputRate::Measured);
            let rate = measured && !matches!(self.change, Change::Offset(_));
            let position = joint.map(|joint| {
                let unit = SensorKind::JointPosition.unit(joint.kind == JointKind::Prismatic);
                format!("{}_{unit}", joint.name)
            });
            let rate = position.iter().filter(|_| rate).map(|p| format!("{p}_s"));
            position.iter().cloned().chain(rate).collect()
        };
        let channels: Vec<String> = match &self.place {
            Place::Wheels(which) => {
                let wheels = which.iter().filter_map(|k| model.wheels.get(*k));
                wheels
                    .map(|wheel| format!("{}_rad_s", wheel.name))
                    .collect()
            }
            Place::Joints(which) => which.iter().flat_map(of_joint).collect(),
            Place::Pulses => {
                let thrusters = model.thrusters.iter();
                thrusters.map(|t| format!("{}_N", t.name)).collect()
            }
            Place::Sensor(_) => SensorKind::Gyro
                .columns()
                .iter()
                .map(|c| (*c).to_owned())
                .collect(),
            Place::Thruster(_) => return None,
        };
        let change = self.change;
        Some(Repair { channels, change })
    }

    /// Name, value and unit of what puts it right.
    pub fn values(&self) -> Option<(String, f64, &'static str)> {
        let owner = self.owner.trim_start_matches("the ");
        match (&self.place, self.change) {
            (_, Change::Factor(x)) => Some((format!("{owner}.factor"), x, "1")),
            (_, Change::ClosesLate(x)) => Some(("thrust.closes_late".to_owned(), x, "s")),
            (_, Change::Offset(x)) => Some((format!("{owner}.offset"), x, "rad")),
            _ => None,
        }
    }
}

fn unit(factor: f64) -> Option<&'static str> {
    let same = |x: f64| (factor / x - 1.0).abs() < SAME;
    UNITS.iter().find(|u| same(u.0)).map(|u| u.1)
}

/// The nearest ratio of small whole numbers.
fn ratio(value: f64) -> Option<f64> {
    let all = (1..=TEETH).flat_map(|a| (1..=TEETH).map(move |b| f64::from(a) / f64::from(b)));
    let distance = |r: &f64| (r - value.abs()).abs();
    let nearest = all.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map(|r| r.copysign(value))
}

/// A vector in other axes or units.
pub(super) fn turned(change: Change, v: &Vector3) -> Vector3 {
    match change {
        Change::Axes(axes) => axes.turned(v),
        Change::Factor(x) => x * v,
        _ => *v,
    }
}

/// A value of a sensor in other axes or units.
pub(super) fn changed(value: SensorValue, change: Change) -> SensorValue {
    match value {
        SensorValue::Vector(v) => SensorValue::Vector(turned(change, &v)),
        value => value,
    }
}
