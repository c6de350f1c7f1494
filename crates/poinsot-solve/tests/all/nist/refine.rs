//! Linear least squares with iterative refinement, so that errors of the factorisation vanish.
//!
//! The triangle of `[A | b]` in double precision gives a first answer. The residual of the normal equations,
//! `A^T (b - A x)`, is then computed in double-double precision, and corrected with the same triangle,
//! `R^T R dx = A^T (b - A x)` (Bjorck 1987, seminormal equations with refinement). The residual is recomputed from x
//! each time. One double-precision triangle therefore suffices for a condition number (of equally scaled columns)
//! below about 1e15.

use crate::nist::double_double::DoubleDouble;
use poinsot_solve::Triangle;

/// Largest number of corrections.
const CORRECTIONS: usize = 30;

/// A refined answer.
#[derive(Debug, Clone)]
pub struct Refined {
    /// Values of the unknowns.
    pub x: Vec<DoubleDouble>,
    /// Residual sum of squares.
    pub rss: f64,
    /// Largest relative size of the last correction; large if refinement does not converge.
    pub last: f64,
}

/// Solves the triangle of `[A | b]` in double precision.
pub fn solve_triangle(triangle: &Triangle) -> Vec<f64> {
    let n = triangle.r.ncols().saturating_sub(1);
    let rhs: Vec<f64> = (0..n).map(|i| triangle.r[(i, n)]).collect();
    back_substituted(triangle, rhs)
}

/// Refines the answer of a triangle; `value(i, j)` are the rows of `[A | b]` behind it.
pub fn refine(triangle: &Triangle, value: impl Fn(usize, usize) -> DoubleDouble) -> Refined {
    let n = triangle.r.ncols().saturating_sub(1);
    let mut x: Vec<DoubleDouble> = solve_triangle(triangle)
        .into_iter()
        .map(DoubleDouble::from)
        .collect();
    let mut last = f64::INFINITY;
    let mut rss = DoubleDouble::default();
    for _ in 0..CORRECTIONS {
        let mut gradient = vec![DoubleDouble::default(); n];
        rss = DoubleDouble::default();
        for i in 0..triangle.rows {
            let row: Vec<DoubleDouble> = (0..=n).map(|j| value(i, j)).collect();
            let residual = row.iter().zip(&x).fold(row[n], |r, (a, x)| r - *a * *x);
            for (g, a) in gradient.iter_mut().zip(&row) {
                *g = *g + *a * residual;
            }
            rss = rss + residual * residual;
        }
        let dx = seminormal(triangle, gradient.iter().map(|g| g.hi).collect());
        let relative =
            |(d, x): (&f64, &DoubleDouble)| if *d == 0.0 { 0.0 } else { (d / x.hi).abs() };
        let change = dx.iter().zip(&x).map(relative).fold(0.0, f64::max);
        if change >= last {
            break;
        }
        last = change;
        for (x, d) in x.iter_mut().zip(&dx) {
            *x = *x + DoubleDouble::from(*d);
        }
    }
    Refined {
        x,
        rss: rss.hi,
        last,
    }
}

/// Solves `R^T R dx = g`.
fn seminormal(triangle: &Triangle, g: Vec<f64>) -> Vec<f64> {
    let r = &triangle.r;
    let mut y = g;
    for i in 0..y.len() {
        let known: f64 = (0..i).map(|k| r[(k, i)] * y[k]).sum();
        y[i] = (y[i] - known) / r[(i, i)];
    }
    back_substituted(triangle, y)
}

/// Solves `R x = d`.
fn back_substituted(triangle: &Triangle, d: Vec<f64>) -> Vec<f64> {
    let r = &triangle.r;
    let mut x = d;
    for i in (0..x.len()).rev() {
        let known: f64 = (i + 1..x.len()).map(|j| r[(i, j)] * x[j]).sum();
        x[i] = (x[i] - known) / r[(i, i)];
    }
    x
}
