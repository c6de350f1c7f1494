//! Hypotheses: every number of the registry that was not among the unknowns and that the telemetry can show; drifts; known
//! numbers that the fit took as exact, which are many and tried only where the rows are held.

use super::types::FaultKind;
use crate::fit::Fitted;
use crate::fit::experiment::{Experiment, Iterate, MovedVehicle, twin};
use crate::problem::Problem;
use crate::problem::parameters::{Entry, Unknown, UnknownKind, axis_name};
use crate::problem::segment::{InputErrors, InputRate};
use poinsot_dynamics::SensorError;
use poinsot_files::given_memory_limit;
use poinsot_model::{JointKind, KnownNumber, Origin, SensorKind, Wheel};
use poinsot_spatial::TENSOR;

/// Largest number of firings tested one by one.
const FIRINGS: usize = 48;
/// Step of the difference of what a number moves in the vehicle, in its usual uncertainty.
const CHANGE_STEP: f64 = 1.0e-3;

/// Largest number of values in the rows: 64 MiB.
const NUMBERS: usize = 8_000_000;
/// Memory of all that is held together with rows, over that of their values: rows of another draw of the noise, triangles and the fit
/// are there as well.
const BESIDE: f64 = 4.0;

/// Cosine above which two axes are one.
const ALONG: f64 = 0.99;
/// What is tried of a joint that the model holds, rad and m, and of a rotor, as a share of the inertia of its link.
const HELD_OFF_RAD: f64 = 0.1;
const HELD_OFF_M: f64 = 0.01;
/// The same of the zero of one that moves.
const ZERO_OFF_RAD: f64 = 0.01;
const ZERO_OFF_M: f64 = 0.001;
const ROTOR: f64 = 0.01;

/// Candidate faults of one kind.
pub(super) struct Candidate {
    /// Its name.
    pub name: String,
    pub fault: FaultKind,
    pub unknowns: Vec<Unknown>,
    /// What its columns are the slopes of: an unknown for each.
    pub twins: Vec<Twin>,
    /// In place of these the sensor whose bias has the columns, times the time since the start of the record.
    pub ramp: Option<usize>,
}

/// An unknown that moves the predictions as a number of a candidate does.
#[derive(Debug, Clone)]
pub(super) struct Twin {
    pub unknown: Unknown,
    /// Size of the number whose effect has to show in the predictions.
    pub sigma: f64,
}

impl Candidate {
    /// The fault of a group of the registry.
    pub fn of(entries: Vec<Entry>) -> Option<Self> {
        let first = entries.first()?;
        let (name, fault) = (first.hypothesis.clone(), first.fault);
        let unknowns: Vec<Unknown> = entries.into_iter().map(|e| e.unknown).collect();
        Some(Self {
            name,
            fault,
            twins: unknowns.iter().map(Twin::itself).collect(),
            ramp: None,
            unknowns,
        })
    }

    /// Whether it is tried where the record is too long for the rows to be held.
    pub fn is_tried_in_parts(&self) -> bool {
        use UnknownKind::{Changed, Firing, JointPlay};
        let needs_rows = |u: &Unknown| matches!(u.kind, Changed | Firing { .. } | JointPlay(_));
        !self.unknowns.iter().any(needs_rows)
    }

    /// Whether it is scored with others at once: lags of sensors, the force and the torque of a drift.
    pub fn is_scored_with_others(&self) -> bool {
        use UnknownKind::{InertialForce, InertialTorque, Sensor};
        let error = SensorError::Lag;
        self.unknowns.iter().any(|u| match u.kind {
            InertialForce(_) | InertialTorque(_) => true,
            Sensor { error: own, .. } => own == error,
            _ => false,
        })
    }

    /// Whether it is a lag of an input.
    pub fn delays_inputs(&self) -> bool {
        self.unknowns.iter().any(|u| u.kind.delays_drives())
    }
}

impl Twin {
    /// A number that shows whatever its size.
    pub fn itself(unknown: &Unknown) -> Self {
        Self {
            unknown: unknown.clone(),
            sigma: f64::INFINITY,
        }
    }
}

/// A number whose column is made of others.
fn changed(name: String, unit: &'static str, nominal: f64) -> Unknown {
    Unknown::new(UnknownKind::Changed, (name, unit), (nominal, 1.0))
}

/// Candidates that the fit did not have at its answer, and whether their rows can be held; those with slopes of their own first,
/// those made of others last. Where the rows cannot be held, only those with slopes of their own are listed.
pub(super) fn candidates(experiment: &Experiment, fitted: &Fitted) -> (Vec<Candidate>, bool) {
    let mut list = of_registry(experiment);
    let rotors = of_rotors(experiment);
    let (numbers, drifts) = (untested_numbers(experiment), of_drifts(experiment));
    let own = list
        .iter()
        .chain(&rotors)
        .chain(&drifts)
        .map(|c| c.unknowns.len());
    let known = numbers.iter().map(|n| n.components());
    let held = holds(experiment, fitted, own.chain(known).sum());
    if held {
        list.extend(rotors);
        list.extend(of_known_numbers(experiment, &fitted.at, numbers));
        list.extend(drifts);
    } else {
        list.retain(Candidate::is_tried_in_parts);
        list.extend(rotors);
    }
    (list, held)
}

/// Whether the rows, and a triangle, can be held with so many columns of candidates.
fn holds(experiment: &Experiment, fitted: &Fitted, columns: usize) -> bool {
    let width = experiment.parameters.len() + columns;
    let numbers = fitted.rows().max(width) * width;
    let bytes = BESIDE * (numbers * size_of::<f64>()) as f64;
    numbers < NUMBERS && given_memory_limit().is_none_or(|limit| bytes < limit)
}

/// Those that are unknowns of the registry.
fn of_registry(experiment: &Experiment) -> Vec<Candidate> {
    let registry = experiment.problem.registry();
    let fitted = &experiment.parameters.unknowns;
    let read = sensors_read(experiment.problem);
    let mut firings = 0..FIRINGS;
    let has = |kind: &UnknownKind| fitted.iter().any(|u| u.kind == *kind);
    // A known number with uncertainty is an unknown already and is tested against its sigma.
    let known = |entry: &Entry| entry.number.is_some_and(|n| is_unknown(experiment, n));
    let mut list: Vec<Candidate> = Vec::new();
    for group in registry.groups() {
        let Some(first) = group.first().filter(|kind| shows(experiment, &read, kind)) else {
            continue;
        };
        let late = matches!(first, UnknownKind::Firing { .. }) && firings.next().is_none();
        if late || group.iter().any(has) {
            continue;
        }
        let entries = group.iter().filter_map(|kind| registry.entry(kind));
        let entries: Vec<Entry> = entries.collect();
        if entries.iter().any(known) {
            continue;
        }
        let name = match first {
            UnknownKind::Sensor { sensor, .. } => read.iter().find(|r| r.0 == *sensor),
            _ => None,
        };
        let named = |mut candidate: Candidate| {
            if let Some((_, name)) = name {
                let what = &candidate.name;
                candidate.name = format!("{what} of the {}", name.replace('_', " "));
            }
            candidate
        };
        list.extend(Candidate::of(entries).map(named));
    }
    list
}

/// Whether the telemetry can show a number of the registry that is an error.
fn shows(experiment: &Experiment, read: &[(usize, String)], kind: &UnknownKind) -> bool {
    match kind {
        UnknownKind::Sensor { sensor, error } => is_no_frame(experiment, read, *sensor, error),
        UnknownKind::JointOffset(k) if is_held(experiment.problem, *k) => true,
        UnknownKind::JointOffset(k) | UnknownKind::JointScale(k) | UnknownKind::JointPlay(k) => {
            moves(experiment.problem, *k)
        }
        UnknownKind::JointRateScale(k) | UnknownKind::JointRateBias(k) => {
            let segments = experiment.problem.segments.iter();
            let mut rates = segments.map(|s| s.observations.joint(*k).rate);
            moves(experiment.problem, *k) && rates.any(|rate| rate == InputRate::Measured)
        }
        UnknownKind::ThrusterLag(_) => experiment.problem.fires(),
        UnknownKind::InertialForce(_) | UnknownKind::Tide(_) => experiment.sees_translation,
        _ => true,
    }
}

/// Whether a joint moves and its samples may have errors.
pub(super) fn moves(problem: &Problem, joint: usize) -> bool {
    problem.segments.iter().any(|s| {
        let o = &s.observations;
        let mut rates = o.joint_rate.iter().skip(joint).step_by(problem.tree.dof());
        o.joint(joint).errors != InputErrors::None && rates.any(|r| *r != 0.0)
    })
}

/// Whether a joint has no samples: it stands where the model says.
fn is_held(problem: &Problem, joint: usize) -> bool {
    let mut segments = problem.segments.iter();
    segments.all(|s| s.observations.joint(joint).errors == InputErrors::None)
}

/// Rotors of geared motors that the model does not have, one in each joint that turns.
///
/// A rotor of spin inertia J and gear ratio n has the momentum `n J q'` along the joint axis, beside the one that its
/// carrier has anyway: that of a link with more inertia `n J` about the axis, and a parent with as much less.
fn of_rotors(experiment: &Experiment) -> Vec<Candidate> {
    let problem = experiment.problem;
    let of = |coordinate: usize| {
        let joint = problem.registry().joint(coordinate)?;
        let (axis_C, axis_P) = (joint.axis_C, joint.R_PC_zero * joint.axis_C);
        let along = |w: &Wheel| w.axis_B.dot(&axis_P).abs() > ALONG;
        let mut wheels = problem.model.wheels.iter();
        let declared = wheels.any(|w| w.body == joint.parent && along(w));
        if joint.kind != JointKind::Revolute || declared || !moves(problem, coordinate) {
            return None;
        }
        let parts = [(joint.child, axis_C, 1.0), (joint.parent, axis_P, -1.0)];
        let slopes = parts.iter().flat_map(|(body, a, sign)| {
            let elements = TENSOR.iter().enumerate();
            elements.map(move |(k, &(i, j))| (10 * body + 4 + k, sign * a[i] * a[j]))
        });
        let number = changed(format!("{}.rotor", joint.name), "kg m2", 0.0);
        let twin = Unknown {
            kind: UnknownKind::Barycentric(slopes.collect()),
            ..number.clone()
        };
        Some(Candidate {
            name: format!("a geared rotor in {}", joint.name),
            fault: FaultKind::GearedRotor,
            twins: vec![Twin::itself(&twin)],
            ramp: None,
            unknowns: vec![number],
        })
    };
    (0..problem.tree.dof()).filter_map(of).collect()
}

/// What an answer takes for granted without a sample, and by how much that is tried.
pub(super) struct Assumption {
    /// Place among the numbers of all candidates.
    pub place: usize,
    pub what: String,
    /// What is tried, in words and in the unit of the number.
    pub change: String,
    pub step: f64,
    /// Whether samples may tell of it.
    pub is_tested: bool,
}

/// The assumptions among the candidates: joints that the model holds, and no geared rotors.
pub(super) fn assumptions(problem: &Problem, candidates: &[Candidate]) -> Vec<Assumption> {
    let numbers = candidates.iter();
    let numbers = numbers.flat_map(|c| c.unknowns.iter().map(move |u| (c.fault, u)));
    let of = |(place, (fault, unknown)): (usize, (FaultKind, &Unknown))| match &unknown.kind {
        UnknownKind::JointOffset(k) => {
            let (joint, held) = (problem.registry().joint(*k)?, is_held(problem, *k));
            let step = match (joint.kind, held) {
                (JointKind::Prismatic, true) => HELD_OFF_M,
                (JointKind::Prismatic, false) => ZERO_OFF_M,
                (_, true) => HELD_OFF_RAD,
                (_, false) => ZERO_OFF_RAD,
            };
            let (name, unit) = (&joint.name, unknown.unit);
            Some(Assumption {
                place,
                what: match held {
                    true => format!("{name} locked at {} {unit}", joint.standing_at()),
                    false => format!("the zero of {name}"),
                },
                change: format!("{step} {unit} off"),
                step,
                is_tested: !held,
            })
        }
        _ if fault == FaultKind::GearedRotor => {
            let name = unknown.name.strip_suffix(".rotor")?;
            let joint = problem.model.joints.iter().find(|j| j.name == name)?;
            let link = problem.model.bodies.get(joint.child)?.nominal.parameters();
            let step = ROTOR * joint.axis_C.dot(&(link.I_BBo_B * joint.axis_C));
            Some(Assumption {
                place,
                what: "no geared rotors in the joints".to_owned(),
                change: format!("1 % of the inertia of the link of {name} in one"),
                step,
                is_tested: false,
            })
        }
        _ => None,
    };
    numbers.enumerate().filter_map(of).collect()
}

/// Whether an error of a sensor is one, if the sensor is read. A bias, scale or turn of the only sensor of the pose, or of a
/// velocity, is the choice of a frame, or equals the opposite error of another sensor of the same motion.
fn is_no_frame(
    experiment: &Experiment,
    read: &[(usize, String)],
    sensor: usize,
    error: &SensorError,
) -> bool {
    let kind = |sensor: usize| experiment.problem.model.sensors[sensor].kind;
    let own = kind(sensor);
    let translates = matches!(own, SensorKind::Position | SensorKind::Velocity);
    let unseen = translates && !experiment.sees_translation;
    if !read.iter().any(|r| r.0 == sensor) || unseen {
        return false;
    }
    let framed = translates || own == SensorKind::Attitude;
    let alone = read.iter().filter(|(s, _)| kind(*s) == own).count() == 1;
    // A misaligned tracker is more than a choice of N.
    let turned = own.is_rotation() && matches!(error, SensorError::Bias(_));
    !framed || !alone || *error == SensorError::Lag || turned
}

/// Drifts of biases: of rates, and of the attitude.
fn of_drifts(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let of = |(sensor, name): (usize, String)| {
        let own = &model.sensors[sensor];
        let unit = match own.kind {
            SensorKind::Gyro => "rad/s2",
            SensorKind::Attitude => "rad/s",
            _ => return None,
        };
        let number = |axis: usize| {
            let name = format!("{}.bias_drift_{}", own.name, axis_name(axis));
            changed(name, unit, 0.0)
        };
        Some(Candidate {
            name: format!("a drift of the bias of the {}", name.replace('_', " ")),
            fault: FaultKind::BiasDrift,
            unknowns: (0..3).map(number).collect(),
            twins: Vec::new(),
            ramp: Some(sensor),
        })
    };
    let read = sensors_read(experiment.problem).into_iter();
    read.filter_map(of).collect()
}

/// Sensors of the model that have samples in any segment, with their names in results.
pub(super) fn sensors_read(problem: &Problem) -> Vec<(usize, String)> {
    let mut list: Vec<(usize, String)> = Vec::new();
    let segments = problem.segments.iter();
    for record in segments.flat_map(|s| &s.observations.sensors) {
        let known = |sensor: usize| list.iter().any(|s| s.0 == sensor);
        if let Some(sensor) = record.sensor.filter(|s| !known(*s))
            && !record.samples.is_empty()
            && !record.is_exact()
        {
            list.push((sensor, record.name.clone()));
        }
    }
    list
}

/// Whether a number of the model is an unknown of the fit.
fn is_unknown(experiment: &Experiment, number: KnownNumber) -> bool {
    let unknowns = experiment.parameters.unknowns.iter();
    let mut known = unknowns.filter_map(|u| u.kind.known());
    known.any(|k| k.number == number)
}

/// Numbers whose errors are no candidates otherwise.
fn untested_numbers(experiment: &Experiment) -> Vec<KnownNumber> {
    let model = experiment.problem.model;
    let is_candidate = |number: &KnownNumber| {
        matches!(
            number,
            KnownNumber::SpinInertia(_)
                | KnownNumber::WheelAxis(_)
                | KnownNumber::Force(_)
                | KnownNumber::SpecificImpulse(_)
                | KnownNumber::PropellantPlace(_)
                | KnownNumber::Mounting(_)
        )
    };
    let numbers = model.known_numbers().into_iter();
    numbers
        .filter(|n| n.is_known(model) && !is_unknown(experiment, *n) && !is_candidate(n))
        .collect()
}

/// Hypotheses of other values of these numbers.
fn of_known_numbers(
    experiment: &Experiment,
    at: &Iterate,
    numbers: Vec<KnownNumber>,
) -> Vec<Candidate> {
    let Some(moved) = MovedVehicle::new(experiment, at) else {
        return Vec::new();
    };
    let there = moved.vehicle.problem(experiment.problem);
    let model = experiment.problem.model;
    numbers
        .into_iter()
        .map(|number| {
            let components = 0..number.components();
            let twin_of = |c: usize| {
                let usual = number.usual_sigma(Origin::Cad);
                let sigma = number.absolute(model, c, usual);
                let shift = (number, c, CHANGE_STEP * sigma);
                let own = (&moved.vehicle.parameters, &moved.base.x);
                let found = twin((&there, model), own.0, own.1, shift);
                let none = || changed(number.name(model, c), number.unit(), 0.0);
                let unknown = found.map_or_else(none, |(unknown, _)| unknown);
                Twin { unknown, sigma }
            };
            let name = number.name(model, 0);
            let what = match number {
                KnownNumber::Mass(_) => name.clone(),
                _ => name
                    .rsplit_once('_')
                    .map_or(name.clone(), |n| n.0.to_owned()),
            };
            let unknown = |c| changed(number.name(model, c), number.unit(), number.value(model, c));
            Candidate {
                name: format!("another {what} than known"),
                fault: FaultKind::KnownNumber,
                unknowns: components.clone().map(unknown).collect(),
                twins: components.map(twin_of).collect(),
                ramp: None,
            }
        })
        .collect()
}
