//! Unweighted least squares of one step, with the rank of its matrix.
//!
//! Blockwise Householder QR, then the singular values of the triangle with columns in natural units. Normal equations
//! are avoided, because they square the condition number.

use faer::Mat;
use nalgebra::{SMatrix, SVector};
use poinsot_solve::BlockQr;

/// The least-squares solution of `T (x, 1) = 0`, `T = [A | -b]`.
#[derive(Debug, Clone)]
pub struct Step<const N: usize> {
    /// Solution; zero along directions that are not determined.
    pub x: SVector<f64, N>,
    /// Singular values of the unscaled `A`, descending.
    pub singular: [f64; N],
    /// Number of singular values above round-off.
    pub structural_rank: usize,
    /// `||A x - b||^2`.
    pub residual: f64,
    /// `||b||^2`.
    pub rhs: f64,
    /// Unit vectors along which `x` is not determined.
    pub open: Vec<SVector<f64, N>>,
}

impl<const N: usize> Step<N> {
    /// The solution with the nominal numbers along directions that are not determined.
    pub(super) fn completed(&self, nominal: &SVector<f64, N>) -> SVector<f64, N> {
        let along = |v: &SVector<f64, N>| v * v.dot(nominal);
        self.x + self.open.iter().map(along).sum::<SVector<f64, N>>()
    }
}

/// Solves one step; `W = N + 1`.
///
/// ```
/// use nalgebra::SMatrix;
/// use poinsot_papers::ma2008::solve;
///
/// // [A | -b]: x = 2, y = 3 and their sum 5.
/// let rows = SMatrix::<f64, 3, 3>::new(1.0, 0.0, -2.0, 0.0, 1.0, -3.0, 1.0, 1.0, -5.0);
/// let step = solve::<2, 3>(&[rows]);
/// assert!((step.x[0] - 2.0).abs() < 1.0e-14 && (step.x[1] - 3.0).abs() < 1.0e-14);
/// assert_eq!(step.structural_rank, 2);
/// ```
pub fn solve<const N: usize, const W: usize>(rows: &[SMatrix<f64, 3, W>]) -> Step<N> {
    const { assert!(W == N + 1) }
    let mut qr = BlockQr::new(W);
    for block in rows {
        qr.push(3, |i, j| block[(i, j)]);
    }
    let r = qr.finish().r;
    let triangle = SMatrix::<f64, N, N>::from_fn(|i, j| r[(i, j)]);
    let rhs = SVector::<f64, N>::from_fn(|i, _| -r[(i, N)]);
    let mut step = Step {
        x: SVector::zeros(),
        singular: [f64::NAN; N],
        structural_rank: 0,
        residual: f64::NAN,
        rhs: f64::NAN,
        open: Vec::new(),
    };
    let matrix = Mat::from_fn(N, N, |i, j| triangle[(i, j)]);
    let finite = triangle.iter().all(|t| t.is_finite());
    let Some(svd) = finite.then(|| matrix.svd().ok()).flatten() else {
        return step;
    };
    let singular: [f64; N] = std::array::from_fn(|k| svd.S()[k]);
    let [V, U] = [svd.V(), svd.U()].map(|m| SMatrix::<f64, N, N>::from_fn(|i, j| m[(i, j)]));
    let floor = (32.0 * N as f64 * f64::EPSILON * singular[0]).max(f64::MIN_POSITIVE);
    step.structural_rank = singular.iter().filter(|s| **s > floor).count();
    if step.structural_rank == N {
        // At full rank, back substitution is the most accurate.
        step.x = triangle.solve_upper_triangular(&rhs).unwrap_or(step.x);
    } else {
        for (k, s) in singular.iter().enumerate().take(step.structural_rank) {
            step.x += V.column(k) * (U.column(k).dot(&rhs) / s);
        }
    }
    let open = step.structural_rank..N;
    step.open = open.map(|k| V.column(k).into_owned()).collect();
    let rest = r[(N, N)] * r[(N, N)];
    step.residual = (triangle * step.x - rhs).norm_squared() + rest;
    step.rhs = rhs.norm_squared() + rest;
    step.singular = singular;
    step
}
