//! Role of every segment (thrust on the locked robot, or one joint in motion), and the known bodies.

use super::single_body::Part;
use crate::xu2017::error;
use poinsot_files::Faults;
use poinsot_identify::{Problem, Segment};
use poinsot_model::EstimateSet;

/// Motion below this, or below a few sigmas, means locked, rad or m.
const STILL: f64 = 1.0e-6;
/// Encoder sigmas below which a joint is not moving.
const SIGMAS: f64 = 8.0;

pub(super) struct Roles {
    /// Segments with thrust and all joints locked.
    pub single: Vec<usize>,
    /// For each joint coordinate, the segments in which only it moves.
    pub of_joint: Vec<Vec<usize>>,
    /// Segments in which several joints move.
    pub together: Vec<usize>,
    /// Normal configuration, rad or m.
    pub normal: Vec<f64>,
    /// Whether each body is unknown.
    pub unknown: Vec<bool>,
    /// Bodies of known mass and mass centre and unknown tensor.
    pub tensor_alone: Vec<bool>,
    /// Requested part of the equivalent single body.
    pub part: Part,
}

pub(super) fn roles(problem: &Problem) -> Result<Roles, Faults> {
    let model = problem.model;
    if let Some(wheel) = model.wheels.first() {
        let wheel = wheel.name.clone();
        return Err(error::wheel(&wheel));
    }
    let dof = problem.tree.dof();
    let mut found = Roles {
        single: Vec::new(),
        of_joint: vec![Vec::new(); dof],
        together: Vec::new(),
        normal: vec![0.0; dof],
        unknown: model.bodies.iter().map(|b| b.estimate.any()).collect(),
        tensor_alone: model
            .bodies
            .iter()
            .map(|b| b.estimate == TENSOR_ALONE)
            .collect(),
        part: part(problem)?,
    };
    let moving: Vec<Vec<usize>> = problem
        .segments
        .iter()
        .map(|s| (0..dof).filter(|&j| moves(problem, s, j)).collect())
        .collect();
    for (at, (segment, joints)) in problem.segments.iter().zip(&moving).enumerate() {
        let label = || segment.label.clone();
        match (joints.as_slice(), segment.firings.is_empty()) {
            ([], false) => found.single.push(at),
            ([], true) => {}
            (_, true) if segment.samples.translation.is_none() => {
                let what = "the momentum of a moving joint";
                return Err(error::no_velocity(&label(), what));
            }
            ([one], true) => found.of_joint[*one].push(at),
            (_, true) => found.together.push(at),
            ([first, ..], false) => {
                let joint = joint_name(problem, *first);
                return Err(error::thrust_in_motion(&label(), &joint));
            }
        }
    }
    let nothing = found.single.is_empty() && found.moving_segments() == 0;
    if nothing {
        return Err(error::nothing_moves());
    }
    let several = found.unknown.iter().filter(|u| **u).count() > 1;
    if let Some(&at) = found.together.first().filter(|_| several) {
        let names = moving[at].iter().map(|&j| joint_name(problem, j));
        return Err(error::joints_together(
            &problem.segments[at].label,
            &names.collect::<Vec<_>>().join(", "),
        ));
    }
    found.normal = normal(problem, &moving, several)?;
    Ok(found)
}

impl Roles {
    /// Number of segments in which a joint moves.
    pub fn moving_segments(&self) -> usize {
        self.together.len() + self.of_joint.iter().map(Vec::len).sum::<usize>()
    }
}

/// The second use: mass and mass centre are known, the tensor is not.
pub(super) const TENSOR_ALONE: EstimateSet = EstimateSet {
    mass: false,
    com: false,
    inertia: true,
};

/// Classifies each body as known, unknown, or unknown in its tensor only. For the whole only the tensor is requested
/// if that holds for all unknown bodies.
fn part(problem: &Problem) -> Result<Part, Faults> {
    let asked = || problem.model.bodies.iter().filter(|b| b.estimate.any());
    if asked().count() > 0 && asked().all(|b| b.estimate == TENSOR_ALONE) {
        return Ok(Part::Inertia);
    }
    match asked().find(|b| b.estimate != EstimateSet::ALL && b.estimate != TENSOR_ALONE) {
        Some(b) => Err(error::partly_known(&b.name)),
        None => Ok(Part::All),
    }
}

fn positions<'a>(
    problem: &Problem,
    segment: &'a Segment,
    joint: usize,
) -> impl Iterator<Item = f64> + 'a {
    let dof = problem.tree.dof().max(1);
    segment
        .samples
        .joint_position
        .iter()
        .skip(joint)
        .step_by(dof)
        .copied()
}

fn tolerance(problem: &Problem, joint: usize) -> f64 {
    let variance = problem.noise.joint_position.get(joint).copied();
    STILL + SIGMAS * variance.unwrap_or(0.0).sqrt()
}

fn moves(problem: &Problem, segment: &Segment, joint: usize) -> bool {
    let (low, high) = positions(problem, segment, joint)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), q| {
            (a.min(q), b.max(q))
        });
    high - low > tolerance(problem, joint)
}

/// Position of every joint while locked; its first position if it is never locked. With several unknown bodies, only
/// one configuration is allowed.
fn normal(problem: &Problem, moving: &[Vec<usize>], one_needed: bool) -> Result<Vec<f64>, Faults> {
    (0..problem.tree.dof())
        .map(|joint| {
            let first = |at: usize| positions(problem, &problem.segments[at], joint).next();
            let mut locked = (0..moving.len()).filter(|&at| !moving[at].contains(&joint));
            let Some(reference) = locked.next().and_then(first) else {
                return Ok(first(0).unwrap_or(0.0));
            };
            for at in locked.filter(|_| one_needed) {
                let found = first(at).unwrap_or(reference);
                if (found - reference).abs() > tolerance(problem, joint) {
                    return Err(error::other_configuration(
                        &problem.segments[at].label,
                        &joint_name(problem, joint),
                        found,
                        reference,
                    ));
                }
            }
            Ok(reference)
        })
        .collect()
}

pub(super) fn joint_name(problem: &Problem, coordinate: usize) -> String {
    let at = problem.tree.coordinates.get(coordinate);
    at.and_then(|&k| problem.model.joints.get(k))
        .map_or(String::new(), |j| j.name.clone())
}
