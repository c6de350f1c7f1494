//! Warnings about wheels and tachometers.

use poinsot_identify::{Estimate, Problem, Segment, linear};
use poinsot_model::Model;
use poinsot_spatial::{Matrix3, Vector3};

/// Consecutive samples at one speed that indicate a limit.
const PLATEAU: usize = 10;
/// Chi-square per degree of freedom above which wheel signs are tested.
const MISFIT: f64 = 4.0;
/// Least axis component of a wheel that counts for an axis.
const SERVES: f64 = 0.5;

/// Warnings about wheels: too few, not moving, saturated, or with a flipped sign.
pub(super) fn suspicions(problem: &Problem, I: &Matrix3, certificate: &Estimate) -> Vec<String> {
    let model = problem.model;
    let mut list = Vec::new();
    let gram: Matrix3 = model
        .wheels
        .iter()
        .map(|w| w.axis_B * w.axis_B.transpose())
        .sum();
    let span = gram
        .symmetric_eigenvalues()
        .iter()
        .filter(|x| **x > 1e-9)
        .count();
    if span < 3 {
        list.push(format!(
            "{} wheel(s) whose axes span {span} of 3 directions: the paper's manoeuvre needs a wheel about every axis; is a wheel missing in the model?",
            model.wheels.len()
        ));
    }
    for k in 0..model.wheels.len() {
        let moves = problem
            .segments
            .iter()
            .any(|s| range(s, model, k) > still(problem, k));
        if !moves {
            list.push(format!(
                "wheel '{}' never changes its speed: it exchanges no momentum, and rotation about its axis is hardly excited; if it did move, its column is stuck",
                model.wheels[k].name
            ));
        }
        for segment in problem.segments {
            if let Some((speed, samples)) = plateau(segment, model, k, still(problem, k)) {
                list.push(format!(
                    "wheel '{}' stays at its largest speed, {speed:.1} rad/s, for {samples} samples of '{}': a saturated wheel; momentum is conserved all the same, but if the tachometer clips there, every number is wrong",
                    model.wheels[k].name, segment.label
                ));
            }
        }
    }
    list.extend(flipped(problem, I, certificate));
    list
}

fn speeds<'s>(segment: &'s Segment, model: &Model, k: usize) -> impl Iterator<Item = f64> + 's {
    let wheels = model.wheels.len();
    segment
        .samples
        .wheel_speed
        .iter()
        .skip(k)
        .step_by(wheels)
        .copied()
}

/// Speed differences below this are negligible, rad/s.
fn still(problem: &Problem, k: usize) -> f64 {
    let variance = problem.noise.wheel_speed.get(k).copied().unwrap_or(0.0);
    6.0 * variance.sqrt() + 1e-9
}

fn range(segment: &Segment, model: &Model, k: usize) -> f64 {
    let (low, high) = speeds(segment, model, k)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
    high - low
}

/// The largest speed, if the wheel stays there for some time between start and end.
fn plateau(segment: &Segment, model: &Model, k: usize, same: f64) -> Option<(f64, usize)> {
    let all: Vec<f64> = speeds(segment, model, k).map(f64::abs).collect();
    let (first, last) = (*all.first()?, *all.last()?);
    let top = all.iter().fold(0.0_f64, |m, x| m.max(*x));
    if range(segment, model, k) <= 10.0 * same || top - first.max(last) <= 10.0 * same {
        return None;
    }
    let (mut longest, mut run) = (0, 0);
    for x in &all {
        // A smooth maximum is flat too, but only for a few samples of a well sampled slew.
        run = if top - x <= 1e-6 * top + same / 6.0 {
            run + 1
        } else {
            0
        };
        longest = longest.max(run);
    }
    (longest >= PLATEAU).then_some((top, longest))
}

/// A wheel with the wrong sign, indicated by a negative moment or by a misfit that one sign change removes.
fn flipped(problem: &Problem, I: &Matrix3, certificate: &Estimate) -> Vec<String> {
    let model = problem.model;
    let mut list = Vec::new();
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        if I[(axis, axis)] > 0.0 {
            continue;
        }
        let e = Vector3::ith(axis, 1.0);
        let wheels = model
            .wheels
            .iter()
            .filter(|w| w.axis_B.dot(&e).abs() > SERVES);
        let names: Vec<String> = wheels.map(|w| format!("'{}'", w.name)).collect();
        list.push(format!(
            "the moment of inertia about {name} is {:.3} kg m2, which is negative: the sign of wheel {} is probably wrong (axis in the model, or speed column)",
            I[(axis, axis)],
            names.join(" or ")
        ));
    }
    let worst = |e: &Estimate| e.fit.iter().fold(0.0_f64, |m, f| m.max(f.chi2_per_dof));
    let now = worst(certificate);
    if list.is_empty() && now > MISFIT {
        for k in 0..model.wheels.len() {
            let mut turned = model.clone();
            turned.wheels[k].axis_B = -turned.wheels[k].axis_B;
            let mut tree = problem.tree.clone();
            tree.rotors[k].axis_B = -tree.rotors[k].axis_B;
            let other = linear(&Problem {
                model: &turned,
                tree: &tree,
                ..*problem
            });
            if other.is_ok_and(|e| worst(&e) < now / MISFIT) {
                list.push(format!(
                    "reversing the axis of wheel '{}' reduces chi-square by more than {MISFIT} times: its sign is probably wrong",
                    model.wheels[k].name
                ));
            }
        }
    }
    list
}
