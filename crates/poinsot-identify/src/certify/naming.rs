//! Names of unobservable directions: known symmetries of trees first, then numbers.

use crate::certify::combination::{Combination, split};
use crate::problem::Problem;
use crate::problem::parameters::{
    Equations, Parameters, Part, TENSOR, Unknown, UnknownKind, axis_name,
};
use crate::problem::quantity::{self, parameters_in_base};
use crate::problem::question::INTERVAL;
use crate::solution::estimate::UnobservableCombination;
use crate::solution::solved::Solution;
use crate::solution::unobservable_set::{ContinuationPath, POINTS, REACH};
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use poinsot_dynamics::{Link, Motion, SensorError, Tree};
use poinsot_files::significant;
use poinsot_model::{EstimateSet, Model, rounded};
use poinsot_spatial::{InertialParameters, Matrix3, PARAMETER_NAMES, Vector3};

/// A change of the parameters that is unobservable by theory, if it is in the null space: in the unknowns' own units, and in words.
type Symmetry = (Vec<f64>, UnobservableCombination);

/// A direction in words, without a path.
fn in_words(
    coefficients: Vec<(String, f64)>,
    text: String,
    [reason, remedy]: [String; 2],
) -> UnobservableCombination {
    UnobservableCombination {
        coefficients,
        text,
        reason,
        remedy,
        walk: Vec::new(),
    }
}

/// A candidate belongs to the null space if less than this share of it is outside.
const INSIDE: f64 = 1.0e-4;
/// A part of a direction smaller than this share adds nothing new.
const NEW_DIRECTION: f64 = 1.0e-3;
/// Half-width of an interval, natural units, from which on it has no end.
const ENDLESS: f64 = 1.0e3;
/// Coefficients below this share of the largest are left out of sentences.
const SHOWN_SHARE: f64 = 1.0e-3;

/// Names every unobservable direction.
pub(crate) fn unobservable_directions(
    problem: &Problem,
    solution: &Solution,
) -> Vec<UnobservableCombination> {
    let spectrum = solution.of_data();
    let natural = &spectrum.natural;
    let open = spectrum.unobservable_directions();
    let open = DMatrix::from_fn(open.nrows(), open.ncols(), |i, j| open[(i, j)]);
    let mut found: Vec<UnobservableCombination> = Vec::new();
    let mut spanned: Vec<DVector<f64>> = Vec::new();
    for (step, named) in symmetries(problem, solution) {
        if spanned.len() == open.ncols() {
            break;
        }
        let z = DVector::from_vec(spectrum.in_natural_units(&step));
        let inside = &open * open.tr_mul(&z);
        if (&z - &inside).norm() > INSIDE * z.norm() {
            continue;
        }
        if let Some(unit) = across(&inside, &spanned).try_normalize(NEW_DIRECTION * inside.norm()) {
            spanned.push(unit);
            found.push(named);
        }
    }
    let rest = complement(&open, &spanned);
    if rest.ncols() > 0 {
        let weight = weights(solution);
        for combination in split(&rest, natural, &weight).open {
            found.push(in_numbers(problem, solution, &combination));
        }
    }
    found
}

/// Names every direction that the data identify less accurately than asked.
pub(crate) fn inaccurate_directions(
    problem: &Problem,
    solution: &Solution,
) -> Vec<UnobservableCombination> {
    let allowed = solution.of_data().experiment();
    let directions = allowed.inaccurate_directions();
    if directions.ncols() == 0 {
        return Vec::new();
    }
    let asked = problem.relative_accuracy;
    let worst = allowed.sigmas()[allowed.accurate..allowed.rank]
        .iter()
        .fold(0.0, |a, b| f64::max(a, INTERVAL * b));
    let reaches = match worst < ENDLESS {
        true => format!("is up to +-{} % of nominal", significant(100.0 * worst, 2)),
        false => "has no end".to_owned(),
    };
    let one = |combination: &Combination| UnobservableCombination {
        text: format!(
            "{} is determined less accurately than asked",
            sentence(solution, combination)
        ),
        reason: format!(
            "in these directions the 95 % interval {reaches}, wider than the requested +-{} %",
            significant(100.0 * asked, 2)
        ),
        remedy: "record longer or with a larger motion along these directions".to_owned(),
        ..in_numbers(problem, solution, combination)
    };
    let found = split(&directions, &allowed.natural, &weights(solution)).open;
    found.iter().map(one).collect()
}

/// Requested numbers that do not enter the equations of rotation: mass, and without thrust the mass centre.
pub(crate) fn absent(parameters: &Parameters) -> Vec<UnobservableCombination> {
    if parameters.equations != Equations::Rotation {
        return Vec::new();
    }
    let asked = parameters.estimate.iter().zip(&parameters.body_names);
    let mut all = Vec::new();
    let shown_by_thrust = |axis: &usize| {
        let mut unknowns = parameters.unknowns.iter();
        unknowns.any(|u| u.kind == UnknownKind::MassCentre(*axis))
    };
    for (asked, body) in asked {
        let mut open = |number: String, what: &str, reason: &str, remedy: &str| {
            let coefficients = vec![(format!("{body}.{what}"), 1.0)];
            let text = format!("{number} cannot be determined");
            all.push(in_words(
                coefficients,
                text,
                [reason, remedy].map(str::to_owned),
            ));
        };
        if asked.mass {
            open(
                format!("mass of {body}"),
                "m",
                "only rotation is measured, which does not depend on the mass",
                "measure velocity or position while a known force acts",
            );
        }
        for axis in (0..3).filter(|axis| asked.com && !shown_by_thrust(axis)) {
            let axis = axis_name(axis);
            open(
                format!("{axis} of the mass centre of {body}"),
                &format!("com_{axis}"),
                "only rotation is measured, no thruster fires, and the rotation does not depend on the mass centre",
                "fire a thruster of known force, or add an accelerometer",
            );
        }
    }
    all
}

/// Weights of the unknowns as leading parameters of unobservable directions: products before moments.
pub(crate) fn weights(solution: &Solution) -> Vec<f64> {
    let product = |k: usize| TENSOR[k].0 != TENSOR[k].1;
    solution.parameters.unknowns[..solution.of_data().natural.len()]
        .iter()
        .map(|u| match &u.kind {
            UnknownKind::CentralInertia(k) if product(*k) => 4.0,
            UnknownKind::Barycentric(parts) => match parts.first() {
                Some((at, _)) if at % 10 >= 4 && product(at % 10 - 4) => 1.2,
                _ => 1.0,
            },
            _ => 1.0,
        })
        .collect()
}

/// A combination as a sentence of numbers, largest share first.
pub(crate) fn sentence(solution: &Solution, combination: &Combination) -> String {
    let unknowns = &solution.parameters.unknowns;
    let natural = &solution.of_data().natural;
    let lead = combination
        .terms
        .first()
        .map_or(1.0, |(at, c)| (c * natural[*at]).abs());
    let mut text = String::new();
    for (at, c) in &combination.terms {
        if (c * natural[*at]).abs() < SHOWN_SHARE * lead {
            continue;
        }
        let sign = match (text.is_empty(), *c < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = c.abs();
        let factor = match four_digits(size).as_str() {
            "1.000" | "1.0000" => String::new(),
            text => format!("{text} "),
        };
        text.push_str(&format!("{sign}{factor}{}", unknowns[*at].name));
    }
    text
}

fn four_digits(x: f64) -> String {
    if (1.0e-3..1.0e4).contains(&x) {
        let decimals = (3.0 - x.log10().floor()).max(0.0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.3e}")
    }
}

/// Names and coefficients of a move.
pub(crate) fn named(solution: &Solution, step: &[f64]) -> Vec<(String, f64)> {
    solution
        .parameters
        .unknowns
        .iter()
        .zip(step)
        .filter(|(_, s)| **s != 0.0)
        .map(|(u, s)| (u.name.clone(), *s))
        .collect()
}

fn symmetries(problem: &Problem, solution: &Solution) -> Vec<Symmetry> {
    if solution.parameters.equations == Equations::Rotation {
        return Vec::new();
    }
    let mut list = Vec::new();
    for child in 1..problem.tree.bodies() {
        joint_symmetries(problem, solution, child, &mut list);
    }
    if solution.explained.is_none() {
        let m = solution.of_data().natural.len();
        for step in [solution.x.clone(), solution.parameters.nominal_vector()] {
            let step = within_its_errors(solution, &step[..m]);
            let text = "the common scale of all masses, first moments and inertias";
            let why = [
                "every force and momentum in the data is proportional to the unknowns: no known quantity sets their scale",
                "fire a thruster of known force, turn a wheel of known spin inertia, or fix one body",
            ];
            let coefficients = named(solution, &step);
            list.push((
                step,
                in_words(coefficients, text.to_owned(), why.map(str::to_owned)),
            ));
        }
    }
    list
}

/// A direction of unknowns as near to the null space as their errors allow: along each identified direction up to a sigma.
fn within_its_errors(solution: &Solution, step: &[f64]) -> Vec<f64> {
    let spectrum = solution.of_data();
    let natural = &spectrum.natural;
    let z = spectrum.in_natural_units(step);
    let mut out = step.to_vec();
    for (k, sigma) in spectrum.sigmas()[..spectrum.rank].iter().enumerate() {
        let error = spectrum.along(&z, k).clamp(-sigma, *sigma);
        for (i, (value, unit)) in out.iter_mut().zip(natural).enumerate() {
            *value -= error * spectrum.directions[(i, k)] * unit;
        }
    }
    out
}

/// Unobservable exchanges between a body and its parent: revolute joint, mass on its axis; prismatic joint, the inertia
/// tensor; fixed joint, all parameters.
fn joint_symmetries(
    problem: &Problem,
    solution: &Solution,
    child: usize,
    list: &mut Vec<Symmetry>,
) {
    let (model, tree) = (problem.model, problem.tree);
    let link = &tree.links[child];
    let parent = link.parent;
    let all = |b: usize| solution.parameters.estimate[b] == EstimateSet::ALL;
    if !all(child) || !all(parent) {
        return;
    }
    let (c, p) = (&model.bodies[child].name, &model.bodies[parent].name);
    let joint = joint_name(model, child);
    let still = stopped_at(problem, child);
    let moves = moves(link, still.is_some(), [c, p, &joint]);
    let why = match (link.motion, still.is_some()) {
        (Motion::Revolute(_) | Motion::Prismatic(_), false) => [
            format!(
                "mass on the axis of {joint} cannot be attributed to {c} or to {p} by any motion, thrust or joint torque"
            ),
            format!("fix one parameter of {c} or {p}, or declare a prior"),
        ],
        (Motion::Fixed | Motion::Free, _) => [
            format!("{joint} is fixed"),
            format!("fix {c} or {p}, or declare a prior"),
        ],
        (_, true) => [format!("{joint} did not move"), format!("move {joint}")],
    };
    let (R, at) = relative_place(tree, child, still.unwrap_or(0.0));
    let map = parameters_in_base(&R, &at);
    for (text, given) in moves {
        let mut pi = vec![[0.0; 10]; tree.bodies()];
        let delta = given.to_array();
        pi[child] = delta;
        for (k, column) in map.iter().enumerate() {
            for (row, value) in column.iter().enumerate() {
                pi[parent][row] -= value * delta[k];
            }
        }
        let step = as_unknowns(solution, &pi);
        let words = in_words(named(solution, &step), text, why.clone());
        list.push((step, words));
    }
}

/// An exchange between a body and its parent, with its text: `names` are those of the body, its parent and the joint.
fn moves(link: &Link, stands: bool, [c, p, joint]: [&str; 3]) -> Vec<(String, InertialParameters)> {
    let u = link.axis_C;
    let line = Matrix3::identity() - u * u.transpose();
    let each = |from: usize, words: &dyn Fn(&str) -> String| {
        let unit = |k| InertialParameters::from_array(&quantity::unit(k));
        let one = |k| (words(PARAMETER_NAMES[k]), unit(k));
        (from..10).map(one).collect()
    };
    match (link.motion, stands) {
        (Motion::Revolute(_), false) => vec![
            (
                format!(
                    "mass of {c} can be exchanged with mass of {p} (a point mass on the axis of {joint})"
                ),
                ten(1.0, Vector3::zeros(), Matrix3::zeros()),
            ),
            (
                format!(
                    "first moment of {c} along the axis of {joint} can be exchanged with that of {p}"
                ),
                ten(0.0, u, Matrix3::zeros()),
            ),
            (
                format!(
                    "a line inertia on the axis of {joint} can be exchanged between {c} and {p}"
                ),
                ten(0.0, Vector3::zeros(), line),
            ),
        ],
        (Motion::Prismatic(_), false) => each(4, &|name| {
            format!(
                "inertia element {name} of {c} can be exchanged with the inertia of {p} ({joint} slides without rotation)"
            )
        }),
        _ => each(0, &|name| {
            format!("{name} of {c} can be exchanged with {p}: the two moved as one body")
        }),
    }
}

fn ten(mass: f64, mc_B: Vector3, I_BBo_B: Matrix3) -> InertialParameters {
    InertialParameters {
        mass,
        mc_B,
        I_BBo_B,
    }
}

/// The joint position of a body that never moved relative to its parent; `None` if it moved.
fn stopped_at(problem: &Problem, child: usize) -> Option<f64> {
    let (k, dof) = match problem.tree.links[child].motion {
        Motion::Revolute(k) | Motion::Prismatic(k) => (k, problem.tree.dof()),
        Motion::Fixed | Motion::Free => return Some(0.0),
    };
    let mut positions = problem
        .segments
        .iter()
        .flat_map(|s| s.samples.joint_position.iter().skip(k).step_by(dof.max(1)));
    let first = *positions.next()?;
    positions
        .all(|q| (q - first).abs() < 1.0e-9)
        .then_some(first)
}

fn relative_place(tree: &Tree, child: usize, position: f64) -> (Matrix3, Vector3) {
    let link = &tree.links[child];
    match link.motion {
        Motion::Revolute(_) => {
            let turn = nalgebra::Rotation3::new(link.axis_C * position);
            (link.R_PC_zero * turn.matrix(), link.p_PoCo_P)
        }
        Motion::Prismatic(_) => (link.R_PC_zero, link.p_PoCo_P + link.axis_P * position),
        Motion::Fixed | Motion::Free => (link.R_PC_zero, link.p_PoCo_P),
    }
}

fn joint_name(model: &Model, child: usize) -> String {
    let joint = model.joint_of(&model.bodies[child]);
    joint.map_or_else(|| "joint".to_owned(), |j| j.name.clone())
}

/// A change of all barycentric parameters as a change of the unknowns (bodies wholly unknown).
fn as_unknowns(solution: &Solution, pi: &[[f64; 10]]) -> Vec<f64> {
    solution.parameters.unknowns[..solution.of_data().natural.len()]
        .iter()
        .map(|u| match &u.kind {
            UnknownKind::Barycentric(parts) => {
                parts.first().map_or(0.0, |(at, _)| pi[at / 10][at % 10])
            }
            _ => 0.0,
        })
        .collect()
}

fn in_numbers(
    problem: &Problem,
    solution: &Solution,
    combination: &Combination,
) -> UnobservableCombination {
    let m = solution.of_data().natural.len();
    let coefficients = named(solution, &combination.gradient(m));
    let words = sentence(solution, combination);
    let text = format!("{words} is an unobservable direction");
    in_words(coefficients, text, poor_motion(problem, solution))
}

/// Values along a path of all unknowns of each changed body; none if the path ended early.
pub(crate) fn values_along_path(
    solution: &Solution,
    walk: &ContinuationPath,
) -> Vec<(String, Vec<f64>)> {
    let m = solution.of_data().natural.len();
    if walk.points.len() != 2 * POINTS + 1 {
        return Vec::new();
    }
    let unknowns = || solution.parameters.unknowns[..m].iter().enumerate();
    let owner = |u: &Unknown| u.kind.part();
    let moves = |i: usize, u: &Unknown| {
        let mut far = walk.points.iter().map(|x| (x[i] - solution.x[i]).abs());
        far.any(|d| d > SHOWN_SHARE * u.natural * REACH)
    };
    let moved = unknowns().filter(|(i, u)| moves(*i, u));
    let moved: Vec<Option<Part>> = moved.map(|(_, u)| owner(u)).collect();
    unknowns()
        .filter(|(_, u)| moved.contains(&owner(u)))
        .map(|(i, u)| (u.name.clone(), walk.points.iter().map(|x| x[i]).collect()))
        .collect()
}

/// Why a direction without a closed form is unobservable: the rotation of the base.
fn poor_motion(problem: &Problem, solution: &Solution) -> [String; 2] {
    let mut spread = Matrix3::zeros();
    let mut count = 0.0;
    // A gyro at rest reads its bias.
    let bias = Vector3::from_fn(|axis, _| {
        let error = SensorError::Bias(axis);
        let sensor = problem.noise.gyro_sensor;
        let own = sensor.map(|sensor| UnknownKind::Sensor { sensor, error });
        let place = own.and_then(|kind| solution.parameters.place(&kind));
        place.map_or(0.0, |k| solution.x[k])
    });
    for segment in problem.segments {
        for w in segment.samples.w_NB_B.iter().map(|w| w - bias) {
            spread += w * w.transpose();
            count += 1.0;
        }
    }
    let eigen = nalgebra::SymmetricEigen::new(spread / f64::max(count, 1.0));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let noise = (problem.noise.gyro.trace() / 3.0 * problem.noise.seen_gyro).sqrt();
    let rms = order.map(|k| (eigen.eigenvalues[k] - noise * noise).max(0.0).sqrt());
    let mut axis = eigen.eigenvectors.column(order[0]).into_owned();
    if axis.max() < -axis.min() {
        axis = -axis;
    }
    let allowed = solution.of_data().experiment();
    let weak = allowed.sigmas().get(allowed.rank).copied();
    let weak = weak.unwrap_or(f64::INFINITY);
    if rms[0] <= 3.0 * noise {
        return [
            format!(
                "the base hardly rotated: {:.1e} rad/s rms, with gyro noise {noise:.1e} rad/s",
                rms[0]
            ),
            "rotate the base about two axes with wheels, joints or thrusters".to_owned(),
        ];
    }
    if rms[1] < 0.05 * rms[0] {
        return [
            format!(
                "the base rotated about one axis only, n = ({:.3}, {:.3}, {:.3}) in body axes (transverse rate {:.1e} of the axial rate); the data determine only I n of the inertia tensor ({})",
                axis.x,
                axis.y,
                axis.z,
                rms[1] / rms[0],
                best_open(weak)
            ),
            "rotate about a second axis, as perpendicular to n as possible".to_owned(),
        ];
    }
    [
        format!(
            "the excitation is too small for the declared noise ({})",
            best_open(weak)
        ),
        "move more joints at once, rotate about more axes, or record longer".to_owned(),
    ]
}

/// Sigma of the best undetermined direction.
fn best_open(sigma: f64) -> String {
    let sigma = rounded(sigma, 2);
    format!("the best unobservable direction has a sigma of {sigma} times the nominal")
}

/// The part of a direction across orthonormal ones; twice is enough (Parlett 1980).
pub(crate) fn across(z: &DVector<f64>, spanned: &[DVector<f64>]) -> DVector<f64> {
    let mut left = z.clone();
    for unit in spanned.iter().chain(spanned) {
        left.axpy(-unit.dot(&left), unit, 1.0);
    }
    left
}

/// Basis of the part of `open` outside `spanned`.
fn complement(open: &DMatrix<f64>, spanned: &[DVector<f64>]) -> Mat<f64> {
    let mut all = spanned.to_vec();
    // Largest remainder first: a greedy choice keeps the basis well conditioned.
    while all.len() < open.ncols() {
        let left = open.column_iter().map(|c| across(&c.into_owned(), &all));
        let best = left.max_by(|a, b| a.norm().total_cmp(&b.norm()));
        let Some(unit) = best.and_then(|left| left.try_normalize(0.0)) else {
            break;
        };
        all.push(unit);
    }
    let fresh = &all[spanned.len()..];
    Mat::from_fn(open.nrows(), fresh.len(), |i, k| fresh[k][i])
}
