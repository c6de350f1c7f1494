//! The smallest largest of several smooth functions, within linear and smooth limits: sequential quadratic
//! programming with a trust region (Nocedal and Wright 2006, ch. 18; minimax form: Madsen and Schjaer-Jacobsen 1978).
//!
//! Every step solves, by the interior-point solver Clarabel (Goulart and Chen 2024),
//!
//! `min t + mu s + d^T B d / 2`, `f_i + J_i d <= t`, `g_j + G_j d <= s`, `s >= 0`, `x + d` in the polytope, `|d| <= delta`
//!
//! with differences for the slopes and damped BFGS for B. The linear limits hold at every point that is tried.

use crate::polytope::Polytope;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};

/// Step of the differences, in units of the unknowns.
const DIFFERENCE: f64 = 1.0e-5;
/// Limits further below zero than this do not enter a step.
const FAR: f64 = -0.7;
/// Penalty of a violated limit: more than any multiplier of a sensible limit.
const PRICE: f64 = 20.0;
/// Share of the predicted fall from which a step is taken.
const TAKEN: f64 = 0.05;
/// Share from which the trust region grows.
const GOOD: f64 = 0.7;
/// Curvature of B before anything is known of it.
const CURVATURE: f64 = 1.0e-3;
/// Part of the room to a side that a step may not use up, for the round-off of the solver.
const INSIDE: f64 = 1.0e-9;

/// Values of all functions at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Values {
    /// The largest of these is minimised.
    pub objectives: Vec<f64>,
    /// Each is to be at most zero.
    pub limits: Vec<f64>,
}

impl Values {
    /// The largest objective.
    pub fn worst(&self) -> f64 {
        largest(&self.objectives)
    }

    /// How far the worst limit is broken; zero where none is.
    pub fn broken(&self) -> f64 {
        largest(&self.limits).max(0.0)
    }

    /// Objective and price of broken limits.
    pub fn merit(&self) -> f64 {
        self.worst() + PRICE * self.broken()
    }
}

fn largest(all: &[f64]) -> f64 {
    all.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b))
}

/// The functions of a minimax program.
pub trait Minimax {
    /// Values at each point, in their order; `None` where they do not exist. Points may be evaluated side by side.
    fn values(&self, points: &[Vec<f64>]) -> Vec<Option<Values>>;

    /// Whether the search is to stop and give what it has.
    fn stop(&self) -> bool {
        false
    }
}

/// Options of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinimaxOptions {
    /// Most evaluations.
    pub evaluations: usize,
    /// Most steps.
    pub steps: usize,
    /// First size of the trust region, in units of the unknowns.
    pub delta: f64,
    /// The search ends below this predicted reduction.
    pub tolerance: f64,
}

/// Where the search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// The unknowns.
    pub x: Vec<f64>,
    /// Values there.
    pub values: Values,
    /// Evaluations used.
    pub evaluations: usize,
    /// Whether the predicted reduction is below the tolerance.
    pub settled: bool,
}

/// Slopes of all functions at one point, one row per function.
struct Jacobian {
    objectives: DMatrix<f64>,
    limits: DMatrix<f64>,
}

/// What a quadratic program gives.
struct Step {
    d: DVector<f64>,
    /// Merit that the linearised functions have after the step.
    merit: f64,
    /// Multipliers of objectives and limits.
    multipliers: (DVector<f64>, DVector<f64>),
}

/// Searches from a point inside the polytope; `None` where the functions do not exist there.
pub fn minimax(
    program: &impl Minimax,
    polytope: &Polytope,
    start: Vec<f64>,
    options: MinimaxOptions,
) -> Option<Reached> {
    let n = start.len();
    let first = program.values(std::slice::from_ref(&start)).pop()??;
    let mut reached = Reached {
        x: start,
        values: first,
        evaluations: 1,
        settled: false,
    };
    let mut slopes = slopes(program, &mut reached)?;
    let mut B = DMatrix::identity(n, n) * CURVATURE;
    let (mut delta, mut known) = (options.delta, false);
    for _ in 0..options.steps {
        if program.stop() || reached.evaluations + n + 1 > options.evaluations {
            break;
        }
        let Some(step) = quadratic(&reached, &slopes, &B, polytope, delta) else {
            break;
        };
        let promised = reached.values.merit() - step.merit;
        if promised < options.tolerance {
            reached.settled = true;
            break;
        }
        let Some((x, values)) = tried(program, polytope, &reached.x, &step.d) else {
            delta *= 0.25;
            reached.evaluations += 1;
            continue;
        };
        reached.evaluations += 1;
        let fall = reached.values.merit() - values.merit();
        let length = step.d.amax();
        if fall < TAKEN * promised {
            delta = 0.4 * length.min(delta);
            if delta < DIFFERENCE {
                reached.settled = true;
                break;
            }
            continue;
        }
        let moved = DVector::from_vec(x.clone()) - DVector::from_vec(reached.x.clone());
        reached.x = x;
        reached.values = values;
        if fall > GOOD * promised && length > 0.9 * delta {
            delta = (2.0 * delta).min(1.0);
        }
        let Some(next) = self::slopes(program, &mut reached) else {
            break;
        };
        let bend = bent(&step, &slopes, &next);
        update(&mut B, &moved, &bend, &mut known);
        slopes = next;
    }
    Some(reached)
}

/// The point after a step, drawn back inside where the solver's round-off left the polytope.
fn tried(
    program: &impl Minimax,
    polytope: &Polytope,
    x: &[f64],
    d: &DVector<f64>,
) -> Option<(Vec<f64>, Values)> {
    let room = polytope.reach(x, d.as_slice()).min(1.0);
    let at: Vec<f64> = x.iter().zip(d.iter()).map(|(x, d)| x + room * d).collect();
    let values = program.values(std::slice::from_ref(&at)).pop()??;
    values.merit().is_finite().then_some((at, values))
}

/// One-sided differences. A function that does not exist beside the point ends the search.
fn slopes(program: &impl Minimax, reached: &mut Reached) -> Option<Jacobian> {
    let n = reached.x.len();
    let beside: Vec<Vec<f64>> = (0..n)
        .map(|j| {
            let mut x = reached.x.clone();
            x[j] += DIFFERENCE;
            x
        })
        .collect();
    let all = program.values(&beside);
    reached.evaluations += n;
    let all: Vec<Values> = all.into_iter().collect::<Option<_>>()?;
    let here = &reached.values;
    let slope = |there: f64, here: f64| (there - here) / DIFFERENCE;
    let objectives = DMatrix::from_fn(here.objectives.len(), n, |i, j| {
        slope(all[j].objectives[i], here.objectives[i])
    });
    let limits = DMatrix::from_fn(here.limits.len(), n, |i, j| {
        slope(all[j].limits[i], here.limits[i])
    });
    let finite = objectives
        .iter()
        .chain(limits.iter())
        .all(|x| x.is_finite());
    finite.then_some(Jacobian { objectives, limits })
}

/// Change of the slope of the Lagrangian.
fn bent(step: &Step, before: &Jacobian, after: &Jacobian) -> DVector<f64> {
    let (objectives, limits) = &step.multipliers;
    (&after.objectives - &before.objectives).transpose() * objectives
        + (&after.limits - &before.limits).transpose() * limits
}

/// Powell's damped BFGS.
fn update(B: &mut DMatrix<f64>, s: &DVector<f64>, y: &DVector<f64>, known: &mut bool) {
    let sy = s.dot(y);
    if !*known && sy > 0.0 {
        *B = DMatrix::identity(s.len(), s.len()) * (y.dot(y) / sy).max(CURVATURE);
        *known = true;
    }
    let Bs = &*B * s;
    let sBs = s.dot(&Bs);
    if sBs.is_nan() || sBs <= f64::MIN_POSITIVE {
        return;
    }
    let theta = match sy >= 0.2 * sBs {
        true => 1.0,
        false => 0.8 * sBs / (sBs - sy),
    };
    let r = y * theta + &Bs * (1.0 - theta);
    let sr = s.dot(&r);
    if sr > 1.0e-14 * sBs {
        *B += &r * r.transpose() / sr - &Bs * Bs.transpose() / sBs;
    }
}

/// Rows `a^T (d, t, s) <= b` of the quadratic program.
#[derive(Default)]
struct Rows {
    entries: Vec<(usize, usize, f64)>,
    bounds: Vec<f64>,
}

impl Rows {
    fn push(&mut self, a: impl IntoIterator<Item = (usize, f64)>, bound: f64) {
        let row = self.bounds.len();
        let entries = a.into_iter().filter(|(_, x)| *x != 0.0);
        self.entries.extend(entries.map(|(j, x)| (row, j, x)));
        self.bounds.push(bound);
    }

    fn matrix(&self, columns: usize) -> CscMatrix<f64> {
        let rows = self.entries.iter().map(|e| e.0).collect();
        let cols = self.entries.iter().map(|e| e.1).collect();
        let values = self.entries.iter().map(|e| e.2).collect();
        CscMatrix::new_from_triplets(self.bounds.len(), columns, rows, cols, values)
    }
}

fn quadratic(
    at: &Reached,
    slopes: &Jacobian,
    B: &DMatrix<f64>,
    polytope: &Polytope,
    delta: f64,
) -> Option<Step> {
    let n = at.x.len();
    let (t, s) = (n, n + 1);
    let mut rows = Rows::default();
    for (i, f) in at.values.objectives.iter().enumerate() {
        let slope = slopes.objectives.row(i);
        rows.push(slope.iter().copied().enumerate().chain([(t, -1.0)]), -f);
    }
    let near: Vec<usize> = (0..at.values.limits.len())
        .filter(|j| at.values.limits[*j] > FAR)
        .collect();
    for &j in &near {
        let slope = slopes.limits.row(j);
        let row = slope.iter().copied().enumerate().chain([(s, -1.0)]);
        rows.push(row, -at.values.limits[j]);
    }
    rows.push([(s, -1.0)], 0.0);
    for j in 0..n {
        rows.push([(j, 1.0)], delta);
        rows.push([(j, -1.0)], delta);
    }
    for side in &polytope.sides {
        let value = side.at(&at.x);
        let most: f64 = side.a.iter().map(|(_, a)| a.abs() * delta).sum();
        if side.high - value < most {
            let bound = (side.high - value) * (1.0 - INSIDE);
            rows.push(side.a.iter().copied(), bound.max(0.0));
        }
        if value - side.low < most {
            let bound = (value - side.low) * (1.0 - INSIDE);
            rows.push(side.a.iter().map(|(j, a)| (*j, -a)), bound.max(0.0));
        }
    }
    let mut upper = Rows::default();
    for j in 0..n {
        upper.push((j..n).map(|i| (i, B[(j, i)])), 0.0);
    }
    upper.bounds.resize(n + 2, 0.0);
    let mut q = vec![0.0; n + 2];
    (q[t], q[s]) = (1.0, PRICE);
    let settings = DefaultSettings {
        verbose: false,
        ..DefaultSettings::default()
    };
    let cones = [SupportedConeT::NonnegativeConeT(rows.bounds.len())];
    let (P, A) = (upper.matrix(n + 2), rows.matrix(n + 2));
    let mut solver = DefaultSolver::new(&P, &q, &A, &rows.bounds, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(
        solver.solution.status,
        SolverStatus::Solved | SolverStatus::AlmostSolved
    );
    if !solved {
        return None;
    }
    let (x, z) = (&solver.solution.x, &solver.solution.z);
    let objectives = at.values.objectives.len();
    let mut limits = DVector::zeros(at.values.limits.len());
    for (row, &j) in near.iter().enumerate() {
        limits[j] = z[objectives + row];
    }
    Some(Step {
        d: DVector::from_column_slice(&x[..n]),
        merit: x[t] + PRICE * x[s].max(0.0),
        multipliers: (DVector::from_column_slice(&z[..objectives]), limits),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polytope::Side;

    struct Functions<F: Fn(&[f64]) -> Values>(F);

    impl<F: Fn(&[f64]) -> Values> Minimax for Functions<F> {
        fn values(&self, points: &[Vec<f64>]) -> Vec<Option<Values>> {
            points.iter().map(|x| Some((self.0)(x))).collect()
        }
    }

    const OPTIONS: MinimaxOptions = MinimaxOptions {
        evaluations: 2000,
        steps: 200,
        delta: 0.5,
        tolerance: 1.0e-10,
    };

    /// Problem CB2 of Charalambous and Bandler 1976: 1.9522245 at (1.1390, 0.8996).
    #[test]
    fn paper_the_smallest_largest_of_three_functions_is_that_of_charalambous_and_bandler() {
        let program = Functions(|x: &[f64]| Values {
            objectives: vec![
                x[0].powi(2) + x[1].powi(4),
                (2.0 - x[0]).powi(2) + (2.0 - x[1]).powi(2),
                2.0 * (x[1] - x[0]).exp(),
            ],
            limits: Vec::new(),
        });
        let found = minimax(&program, &Polytope::default(), vec![2.0, 2.0], OPTIONS).unwrap();
        assert!(found.settled);
        assert!(
            (found.values.worst() - 1.952_224_5).abs() < 1.0e-6,
            "{found:?}"
        );
        assert!((found.x[0] - 1.1390).abs() < 1.0e-3 && (found.x[1] - 0.8996).abs() < 1.0e-3);
    }

    /// Hock and Schittkowski 1981, problem 24 (linear limits: -1 at (3, sqrt 3)) and problem 22 (one smooth limit: 1 at
    /// (1, 1)).
    #[test]
    fn paper_problems_with_limits_end_at_the_solutions_of_hock_and_schittkowski() {
        let program = Functions(|x: &[f64]| Values {
            objectives: vec![((x[0] - 3.0).powi(2) - 9.0) * x[1].powi(3) / (27.0 * 3.0_f64.sqrt())],
            limits: Vec::new(),
        });
        let root = 3.0_f64.sqrt();
        let side = |a: f64, b: f64, low: f64, high: f64| Side {
            a: vec![(0, a), (1, b)],
            low,
            high,
        };
        let polytope = Polytope {
            sides: vec![
                side(1.0 / root, -1.0, 0.0, f64::INFINITY),
                side(1.0, root, 0.0, 6.0),
                side(1.0, 0.0, 0.0, f64::INFINITY),
                side(0.0, 1.0, 0.0, f64::INFINITY),
            ],
        };
        let found = minimax(&program, &polytope, vec![1.0, 0.5], OPTIONS).unwrap();
        assert!((found.values.worst() + 1.0).abs() < 1.0e-6, "{found:?}");
        assert!(polytope.holds(&found.x, 1.0e-12));

        let program = Functions(|x: &[f64]| Values {
            objectives: vec![(x[0] - 2.0).powi(2) + (x[1] - 1.0).powi(2)],
            limits: vec![x[0] + x[1] - 2.0, x[0].powi(2) - x[1]],
        });
        let found = minimax(&program, &Polytope::default(), vec![2.0, 2.0], OPTIONS).unwrap();
        assert!((found.values.worst() - 1.0).abs() < 1.0e-5, "{found:?}");
        assert!(found.values.broken() < 1.0e-6);
    }
}
