//! What is determined instead of single numbers: combinations and other functions that are constant along the
//! unobservable set.

use crate::answer::body::QuantityEstimator;
use crate::certify::barycentre::Barycentric;
use crate::certify::combination::{Combination, split};
use crate::certify::naming;
use crate::problem::Problem;
use crate::problem::parameters::{Equations, TENSOR, axis_name, tensor_name};
use crate::problem::quantity::Quantity;
use crate::solution::estimate::{DeterminedCombination, Identifiability};
use crate::solution::solved::Solution;
use faer::Mat;
use nalgebra::DVector;
use poinsot_spatial::elements;

/// Largest change of a constant combination along all paths, sigmas.
const STILL: f64 = 0.1;
/// Step of a difference, natural units: its third power and the round-off over it are both below 1e-9.
const GRADIENT_STEP: f64 = 1.0e-4;
/// Gradient of a quantity, relative to its largest possible, below which it is constant.
const FLAT: f64 = 1.0e-9;

/// Linear combinations that the data determine and that are constant along all paths.
pub(crate) fn combinations(estimator: &QuantityEstimator) -> Vec<DeterminedCombination> {
    let solution = estimator.solution;
    let spectrum = solution.of_data();
    let m = spectrum.natural.len();
    let open = unusable(solution);
    let all = split(&open, &spectrum.natural, &naming::weights(solution)).determined;
    let one = |c: &Combination| {
        let gradient = c.gradient(m);
        let mut full = gradient.clone();
        full.resize(solution.parameters.len(), 0.0);
        let lead = c.terms.first()?.0;
        let at = |x: &[f64]| Quantity {
            value: c.value(x),
            gradient: full.clone(),
        };
        let sigma = estimator.sigma_with(&full, 0.0)?;
        let declared = spectrum.sigma(&gradient)?;
        solution
            .holds(&at(&solution.x), declared, at)
            .then(|| DeterminedCombination {
                text: naming::sentence(solution, c),
                coefficients: naming::named(solution, &gradient),
                unit: solution.parameters.unknowns[lead].unit,
                value: c.value(&solution.x),
                sigma,
            })
    };
    all.iter().filter_map(one).collect()
}

/// Orthonormal basis of the unobservable and the inaccurate directions and of all changes along their paths, natural
/// units.
fn unusable(solution: &Solution) -> Mat<f64> {
    let allowed = solution.of_data().experiment();
    let (n, r) = (allowed.natural.len(), allowed.accurate);
    let open = Mat::from_fn(n, n - r, |i, k| allowed.directions[(i, r + k)]);
    let curved = solution
        .unobservable_set
        .walks
        .iter()
        .filter(|w| !w.ends.is_empty());
    let points: Vec<&Vec<f64>> = curved.flat_map(|w| &w.points).collect();
    if r == 0 || points.is_empty() {
        return open;
    }
    // Displacements along the determined directions, in sigmas.
    let moved = Mat::from_fn(r, points.len(), |k, p| {
        let step = |i: usize| (points[p][i] - solution.x[i]) / allowed.natural[i];
        let along = (0..n).map(|i| step(i) * allowed.directions[(i, k)]);
        allowed.singular[k] * along.sum::<f64>()
    });
    let Ok(svd) = moved.thin_svd() else {
        return open;
    };
    let count = r.min(points.len());
    let also: Vec<usize> = (0..count).filter(|j| svd.S()[*j] > STILL).collect();
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for j in also {
        let share = |k: usize| svd.U()[(k, j)] / allowed.singular[k];
        let along = |i: usize| (0..r).map(|k| allowed.directions[(i, k)] * share(k)).sum();
        let w = DVector::from_fn(n, |i, _| along(i));
        basis.extend(naming::across(&w, &basis).try_normalize(0.0));
    }
    let d = open.ncols();
    let element = |i, k| if k < d { open[(i, k)] } else { basis[k - d][i] };
    Mat::from_fn(n, d + basis.len(), element)
}

/// Nonlinear functions of the unknowns that the data determine and that are constant along all paths: augmented
/// inertias and couplings of a tree with measured rotation only. Empty if combinations express all determined
/// directions.
pub(crate) fn functions(
    problem: &Problem,
    estimator: &QuantityEstimator,
) -> Vec<DeterminedCombination> {
    let solution = estimator.solution;
    let curved = solution.unobservable_set.here.is_some();
    if !curved || solution.parameters.equations != Equations::Momentum {
        return Vec::new();
    }
    let x = &solution.x;
    let (Some(here), Some(slopes)) = (values(problem, solution, x), slopes(problem, solution, x))
    else {
        return Vec::new();
    };
    let (natural, set) = (&solution.of_data().natural, &solution.unobservable_set);
    let along: Vec<(&Vec<f64>, Vec<f64>)> = set
        .points()
        .filter_map(|x| Some((x, values(problem, solution, x)?)))
        .collect();
    let ends = set.walks.iter().flat_map(|w| &w.ends);
    let ends: Vec<(&Vec<f64>, Vec<Vec<f64>>)> = ends
        .filter_map(|(x, _)| Some((x, self::slopes(problem, solution, x)?)))
        .collect();
    let units = solution.parameters.natural.iter().map(|(m, l)| m * l * l);
    let inertia = units.fold(0.0, f64::max);
    let mut found = Vec::new();
    for (k, text) in names(solution).into_iter().enumerate() {
        let quantity = Quantity {
            value: here[k],
            gradient: slopes[k].clone(),
        };
        let pairs = quantity.gradient.iter().zip(natural);
        let slope = pairs.map(|(g, u)| (g * u).abs()).fold(0.0, f64::max);
        if slope <= FLAT * inertia {
            continue;
        }
        let declared = solution
            .of_data()
            .sigma(&quantity.gradient[..natural.len()]);
        let stated = estimator.sigma_with(&quantity.gradient, 0.0);
        let (Some(declared), Some(sigma)) = (declared, stated) else {
            continue;
        };
        let at = |x: &[f64]| {
            let value = along.iter().find(|(p, _)| p.as_slice() == x);
            let slope = ends.iter().find(|(p, _)| p.as_slice() == x);
            Quantity {
                value: value.map_or(f64::NAN, |v| v.1[k]),
                gradient: slope.map_or_else(Vec::new, |s| s.1[k].clone()),
            }
        };
        if solution.holds(&quantity, declared, at) {
            found.push(DeterminedCombination {
                text,
                coefficients: Vec::new(),
                unit: "kg m2",
                value: here[k],
                sigma,
            });
        }
    }
    found
}

/// Elements of the augmented inertias and couplings.
fn values(problem: &Problem, solution: &Solution, x: &[f64]) -> Option<Vec<f64>> {
    let all = Barycentric::new(problem.tree, &solution.parameters.bodies(x))?;
    let inertias = all.K.iter().flat_map(elements);
    // Row by row.
    let couplings = all.D.iter().map(|(.., D)| D.transpose());
    let couplings = couplings.flat_map(|D| D.iter().copied().collect::<Vec<_>>());
    Some(inertias.chain(couplings).collect())
}

/// Their slopes over the unknowns, by differences.
fn slopes(problem: &Problem, solution: &Solution, x: &[f64]) -> Option<Vec<Vec<f64>>> {
    let mut all = vec![vec![0.0; x.len()]; values(problem, solution, x)?.len()];
    for (i, unit) in solution.of_data().natural.iter().enumerate() {
        let at = |step: f64| {
            let mut moved = x.to_vec();
            moved[i] += step * unit;
            values(problem, solution, &moved)
        };
        let pairs = at(GRADIENT_STEP)?.into_iter().zip(at(-GRADIENT_STEP)?);
        for (slope, (up, down)) in all.iter_mut().zip(pairs) {
            slope[i] = (up - down) / (2.0 * GRADIENT_STEP * unit);
        }
    }
    Some(all)
}

/// Names of [`values`].
fn names(solution: &Solution) -> Vec<String> {
    let bodies = &solution.parameters.body_names;
    let mut list = Vec::new();
    for body in bodies {
        let one = |k: usize| format!("K_{} of {body}", tensor_name(k));
        list.extend((0..TENSOR.len()).map(one));
    }
    for (i, own) in bodies.iter().enumerate() {
        for other in &bodies[i + 1..] {
            list.extend((0..9).map(|k| {
                let element = [k / 3, k % 3].map(axis_name).concat();
                format!("D_{element} of {own} and {other}")
            }));
        }
    }
    list
}

/// Warning if combinations do not express all determined directions, or if the rank changes along a path.
pub(crate) fn withheld(found: &Identifiability) -> Option<String> {
    let linear = |c: &&DeterminedCombination| !c.coefficients.is_empty();
    let combinations = found.determined.iter().filter(linear).count();
    if found.ranks.is_empty() || found.determined.is_empty() || combinations >= found.rank {
        return None;
    }
    let others = found.determined.len() - combinations;
    let mut text = format!(
        "{} of {} determined directions are not linear combinations along paths of equal prediction: {} combinations are withheld",
        found.rank - combinations,
        found.rank,
        found.rank - combinations
    );
    if others > 0 {
        text.push_str(&format!(
            "; {others} augmented inertias K (about barycentres) and couplings D of two bodies are given instead"
        ));
    }
    if found.ranks.iter().any(|r| *r != found.ranks[0]) {
        let ranks: Vec<String> = found.ranks.iter().map(usize::to_string).collect();
        text += "; the rank changes along the set of equal prediction: ";
        text += &ranks.join(", ");
    }
    Some(text)
}
