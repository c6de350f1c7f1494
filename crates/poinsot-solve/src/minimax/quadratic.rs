//! The step of the minimax search: a quadratic program of linearised functions within the sides that it can reach.

use super::{PRICE, Values};
use crate::polytope::{Polytope, Side};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};
use nalgebra::{DMatrix, DVector};

/// Limits further below zero are not included in a step.
const FAR: f64 = -0.7;
/// A side is a row of the first quadratic program if it is within this fraction of the longest step.
const LIKELY: f64 = 0.3;
/// Fraction of the distance to a side that a step must keep, for the solver's round-off.
const INSIDE: f64 = 1.0e-9;

/// Jacobian of all functions at one point, one row per function.
pub struct Jacobian {
    pub objectives: DMatrix<f64>,
    pub limits: DMatrix<f64>,
}

impl Jacobian {
    /// The nearest Jacobian that explains a step: `J + (f - f0 - J d) d^T / d^T d`.
    pub fn following(&self, d: &DVector<f64>, before: &Values, after: &Values) -> Self {
        let share = d.transpose() / d.norm_squared();
        let next = |J: &DMatrix<f64>, before: &[f64], after: &[f64]| {
            let change = after.iter().zip(before).map(|(a, b)| a - b);
            J + (DVector::from_iterator(after.len(), change) - J * d) * &share
        };
        Self {
            objectives: next(&self.objectives, &before.objectives, &after.objectives),
            limits: next(&self.limits, &before.limits, &after.limits),
        }
    }

    /// Values at the end of a step without the change that the Jacobian tells.
    pub fn without(&self, d: &DVector<f64>, after: &Values) -> Values {
        let less = |J: &DMatrix<f64>, after: &[f64]| {
            let told = J * d;
            after.iter().zip(&told).map(|(a, t)| a - t).collect()
        };
        Values {
            objectives: less(&self.objectives, &after.objectives),
            limits: less(&self.limits, &after.limits),
        }
    }
}

/// Solution of a quadratic program.
pub struct Step {
    pub d: DVector<f64>,
    /// Merit of the linearised functions after the step.
    pub merit: f64,
    /// Multipliers of objectives and limits.
    pub multipliers: (DVector<f64>, DVector<f64>),
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

/// A side of the polytope within reach of the trust region: `factor a^T d <= bound`.
struct Near<'p> {
    side: &'p Side,
    factor: f64,
    bound: f64,
    /// Whether it is a row of the quadratic program; others are only checked.
    is_row: bool,
}

impl Near<'_> {
    fn excess(&self, d: &[f64]) -> f64 {
        self.factor * self.side.at(d) - self.bound
    }
}

/// The sides within reach of a step; those within a fraction of its length are rows.
fn near_sides<'p>(polytope: &'p Polytope, x: &[f64], delta: f64) -> Vec<Near<'p>> {
    let mut near = Vec::new();
    for side in &polytope.sides {
        let value = side.at(x);
        let most: f64 = side.a.iter().map(|(_, a)| a.abs() * delta).sum();
        for (factor, room) in [(1.0, side.high - value), (-1.0, value - side.low)] {
            if room < most {
                near.push(Near {
                    side,
                    factor,
                    bound: (room * (1.0 - INSIDE)).max(0.0),
                    is_row: room < LIKELY * most,
                });
            }
        }
    }
    near
}

/// The step of the linearised functions. Only few of many sides are active, so rows are added until the step violates
/// none.
pub fn quadratic(
    (x, values): (&[f64], &Values),
    slopes: &Jacobian,
    B: &DMatrix<f64>,
    polytope: &Polytope,
    delta: f64,
) -> Option<Step> {
    let mut sides = near_sides(polytope, x, delta);
    loop {
        let step = solved(values, slopes, B, &sides, delta)?;
        let mut holds = true;
        for near in sides.iter_mut().filter(|near| !near.is_row) {
            near.is_row = near.excess(step.d.as_slice()) > 0.0;
            holds &= !near.is_row;
        }
        if holds {
            return Some(step);
        }
    }
}

fn solved(
    values: &Values,
    slopes: &Jacobian,
    B: &DMatrix<f64>,
    sides: &[Near],
    delta: f64,
) -> Option<Step> {
    let n = B.nrows();
    let (t, s) = (n, n + 1);
    let mut rows = Rows::default();
    for (i, f) in values.objectives.iter().enumerate() {
        let slope = slopes.objectives.row(i);
        rows.push(slope.iter().copied().enumerate().chain([(t, -1.0)]), -f);
    }
    let near: Vec<usize> = (0..values.limits.len())
        .filter(|j| values.limits[*j] > FAR)
        .collect();
    for &j in &near {
        let slope = slopes.limits.row(j);
        let row = slope.iter().copied().enumerate().chain([(s, -1.0)]);
        rows.push(row, -values.limits[j]);
    }
    rows.push([(s, -1.0)], 0.0);
    for j in 0..n {
        rows.push([(j, 1.0)], delta);
        rows.push([(j, -1.0)], delta);
    }
    for side in sides.iter().filter(|side| side.is_row) {
        let row = side.side.a.iter();
        rows.push(row.map(|(j, a)| (*j, side.factor * a)), side.bound);
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
    let is_solved = matches!(
        solver.solution.status,
        SolverStatus::Solved | SolverStatus::AlmostSolved
    );
    if !is_solved {
        return None;
    }
    let (x, z) = (&solver.solution.x, &solver.solution.z);
    let objectives = values.objectives.len();
    let mut limits = DVector::zeros(values.limits.len());
    for (row, &j) in near.iter().enumerate() {
        limits[j] = z[objectives + row];
    }
    Some(Step {
        d: DVector::from_column_slice(&x[..n]),
        merit: x[t] + PRICE * x[s].max(0.0),
        multipliers: (DVector::from_column_slice(&z[..objectives]), limits),
    })
}
