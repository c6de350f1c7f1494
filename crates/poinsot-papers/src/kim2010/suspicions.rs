//! Warnings about wheels and tachometers.

use crate::samples::{column, spread};
use crate::study::statistics::largest;
use poinsot_identify::{Estimate, Problem, Segment, linear};
use poinsot_spatial::{Matrix3, Vector3};

/// Consecutive samples at one speed that indicate a limit.
const PLATEAU: usize = 10;
/// Chi-square per degree of freedom above which wheel signs are tested.
const MISFIT: f64 = 4.0;
/// Least axis component of a wheel that counts for an axis.
const SERVES: f64 = 0.5;

/// Warnings about wheels: too few, not moving, saturated, or with a flipped sign.
pub(super) fn suspicions(problem: &Problem, I: &Matrix3, certificate: &Estimate) -> Vec<String> {
    let wheels = &problem.model.wheels;
    let mut list = Vec::new();
    let axes = wheels.iter().map(|w| w.axis_B * w.axis_B.transpose());
    let squares = axes.sum::<Matrix3>().symmetric_eigenvalues();
    let span = squares.iter().filter(|x| **x > 1e-9).count();
    if span < 3 {
        list.push(format!(
            "{} wheel(s) whose axes span {span} of 3 directions: the paper's manoeuvre needs a wheel about every axis; is a wheel missing in the model?",
            wheels.len()
        ));
    }
    for (k, wheel) in wheels.iter().enumerate() {
        // Speed differences below this are negligible, rad/s.
        let variance = problem.noise.wheel_speed.get(k).copied();
        let still = 6.0 * variance.unwrap_or(0.0).sqrt() + 1e-9;
        let speeds = |s: &Segment| column(&s.samples.wheel_speed, k, wheels.len()).collect();
        let speeds: Vec<Vec<f64>> = problem.segments.iter().map(speeds).collect();
        if speeds.iter().all(|s| spread(s.iter().copied()) <= still) {
            list.push(format!(
                "wheel '{}' never changes its speed: it exchanges no momentum, and rotation about its axis is hardly excited; if it did move, its column is stuck",
                wheel.name
            ));
        }
        for (segment, speeds) in problem.segments.iter().zip(&speeds) {
            if let Some((speed, samples)) = plateau(speeds, still) {
                list.push(format!(
                    "wheel '{}' stays at its largest speed, {speed:.1} rad/s, for {samples} samples of '{}': a saturated wheel; momentum is conserved all the same, but if the tachometer clips there, every number is wrong",
                    wheel.name, segment.label
                ));
            }
        }
    }
    list.extend(flipped(problem, I, certificate));
    list
}

/// The largest speed, if the wheel stays there for some time between start and end.
fn plateau(speeds: &[f64], same: f64) -> Option<(f64, usize)> {
    let (first, last) = (speeds.first()?.abs(), speeds.last()?.abs());
    let top = largest(speeds.iter().map(|x| x.abs()));
    if spread(speeds.iter().copied()) <= 10.0 * same || top - first.max(last) <= 10.0 * same {
        return None;
    }
    // A smooth maximum is flat too, but only for a few samples of a well sampled slew.
    let at_top = |x: &f64| top - x.abs() <= 1e-6 * top + same / 6.0;
    let runs = speeds.chunk_by(|a, b| at_top(a) == at_top(b));
    let longest = runs.filter(|run| at_top(&run[0])).map(<[f64]>::len).max()?;
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
    let worst = |e: &Estimate| largest(e.fit.iter().map(|f| f.chi2_per_dof));
    let now = worst(certificate);
    if !list.is_empty() || now <= MISFIT {
        return list;
    }
    for (k, wheel) in model.wheels.iter().enumerate() {
        let (mut turned, mut tree) = (model.clone(), problem.tree.clone());
        turned.wheels[k].axis_B = -wheel.axis_B;
        tree.rotors[k].axis_B = -tree.rotors[k].axis_B;
        let other = linear(&Problem {
            model: &turned,
            tree: &tree,
            ..*problem
        });
        if other.is_ok_and(|e| worst(&e) < now / MISFIT) {
            list.push(format!(
                "reversing the axis of wheel '{}' reduces chi-square by more than {MISFIT} times: its sign is probably wrong",
                wheel.name
            ));
        }
    }
    list
}
