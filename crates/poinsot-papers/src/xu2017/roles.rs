//! Role of every segment (thrust on the locked robot, or one joint in motion), and the known bodies.

use super::single_body::Part;
use crate::samples::spread;
use poinsot_files::{Faults, Place, rounded};
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
    let (model, dof) = (problem.model, problem.tree.dof());
    if let Some(wheel) = model.wheels.first() {
        let place = Place::item("wheel", &wheel.name);
        let what = "xu2017 knows no momentum wheels";
        let advice = "take it out of the model if it stands still, or use --method auto";
        return Err(Faults::one("E0531", place, what, advice));
    }
    let tensor_alone = model.bodies.iter().map(|b| b.estimate == TENSOR_ALONE);
    let mut found = Roles {
        single: Vec::new(),
        of_joint: vec![Vec::new(); dof],
        together: Vec::new(),
        normal: vec![0.0; dof],
        unknown: model.bodies.iter().map(|b| b.estimate.any()).collect(),
        tensor_alone: tensor_alone.collect(),
        part: part(problem)?,
    };
    let moving = |s: &Segment| (0..dof).filter(|&j| moves(problem, s, j)).collect();
    let moving: Vec<Vec<usize>> = problem.segments.iter().map(moving).collect();
    for (at, (segment, joints)) in problem.segments.iter().zip(&moving).enumerate() {
        match (joints.as_slice(), segment.firings.is_empty()) {
            ([], false) => found.single.push(at),
            ([], true) => {}
            (_, true) if segment.samples.translation.is_none() => {
                return Err(no_velocity(segment));
            }
            ([one], true) => found.of_joint[*one].push(at),
            (_, true) => found.together.push(at),
            ([first, ..], false) => {
                let joint = joint_name(problem, *first);
                let place = Place::item("segment", &segment.label);
                let what = format!(
                    "a thruster fires while joint '{joint}' moves: xu2017 takes momentum as conserved then"
                );
                let advice = "cut the firing out, or use --method auto";
                return Err(Faults::one("E0536", place, what, advice));
            }
        }
    }
    if found.single.is_empty() && found.moving_segments() == 0 {
        let what = "no segment has thrust with the joints locked, and in none does a joint move: xu2017 has nothing to work on";
        let advice = "fire thrusters or drive a joint, or use --method auto";
        return Err(Faults::one("E0539", Place::default(), what, advice));
    }
    let several = found.unknown.iter().filter(|u| **u).count() > 1;
    if let Some(&at) = found.together.first().filter(|_| several) {
        let names = moving[at].iter().map(|&j| joint_name(problem, j));
        let joints = names.collect::<Vec<_>>().join(", ");
        let place = Place::item("segment", &problem.segments[at].label);
        let what = format!(
            "joints {joints} move together: xu2017 unlocks one joint at a time unless a single body is unknown"
        );
        let advice = "split the motion, or use --method auto";
        return Err(Faults::one("E0535", place, what, advice));
    }
    found.normal = normal(problem, &moving, several)?;
    Ok(found)
}

/// A moving joint without measured velocity.
pub(super) fn no_velocity(segment: &Segment) -> Faults {
    let place = Place::item("segment", &segment.label);
    let what =
        "no velocity channel (v_x v_y v_z): xu2017 needs it for the momentum of a moving joint";
    Faults::one("E0534", place, what, "add it, or use --method auto")
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
        Some(b) => Err(Faults::one(
            "E0532",
            Place::item("body", &b.name),
            "estimate: xu2017 takes a body as known, as unknown (estimate = true), or with known mass and mass centre (estimate = [\"inertia\"])",
            "change it, or use --method auto",
        )),
        None => Ok(Part::All),
    }
}

fn positions<'a>(
    problem: &Problem,
    segment: &'a Segment,
    joint: usize,
) -> impl Iterator<Item = f64> + 'a {
    let (all, dof) = (&segment.samples.joint_position, problem.tree.dof());
    all.iter().skip(joint).step_by(dof.max(1)).copied()
}

fn tolerance(problem: &Problem, joint: usize) -> f64 {
    let variance = problem.noise.joint_position.get(joint).copied();
    STILL + SIGMAS * variance.unwrap_or(0.0).sqrt()
}

fn moves(problem: &Problem, segment: &Segment, joint: usize) -> bool {
    spread(positions(problem, segment, joint)) > tolerance(problem, joint)
}

/// Position of every joint while locked; its first position if it is never locked. With several unknown bodies, only
/// one configuration is allowed.
fn normal(problem: &Problem, moving: &[Vec<usize>], one_needed: bool) -> Result<Vec<f64>, Faults> {
    let of = |joint: usize| {
        let first = |at: usize| positions(problem, &problem.segments[at], joint).next();
        let mut locked = (0..moving.len()).filter(|&at| !moving[at].contains(&joint));
        let Some(reference) = locked.next().and_then(first) else {
            return Ok(first(0).unwrap_or(0.0));
        };
        for at in locked.filter(|_| one_needed) {
            let found = first(at).unwrap_or(reference);
            if (found - reference).abs() > tolerance(problem, joint) {
                let place = Place::item("segment", &problem.segments[at].label);
                let what = format!(
                    "joint '{}' is locked at {}, elsewhere at {} (rad or m): (43)-(46) need one normal configuration in all segments",
                    joint_name(problem, joint),
                    rounded(found, 6),
                    rounded(reference, 6)
                );
                let advice = "bring the joint back, or use --method auto";
                return Err(Faults::one("E0537", place, what, advice));
            }
        }
        Ok(reference)
    };
    (0..problem.tree.dof()).map(of).collect()
}

pub(super) fn joint_name(problem: &Problem, coordinate: usize) -> String {
    let at = problem.tree.coordinates.get(coordinate);
    at.and_then(|&k| problem.model.joints.get(k))
        .map_or(String::new(), |j| j.name.clone())
}
