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
    /// Triangle of `A`.
    pub triangle: SMatrix<f64, N, N>,
    /// `Q^T b`.
    pub rotated: SVector<f64, N>,
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
        triangle,
        rotated: rhs,
    };
    let Some((singular, V, U)) = decompose(&triangle, &[1.0; N]) else {
        return step;
    };
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
    let rest = r[(N, N)] * r[(N, N)];
    step.residual = (triangle * step.x - rhs).norm_squared() + rest;
    step.rhs = rhs.norm_squared() + rest;
    step.singular = singular;
    step
}

type Decomposed<const N: usize> = ([f64; N], SMatrix<f64, N, N>, SMatrix<f64, N, N>);

/// Singular values, right and left directions of a triangle with scaled columns; `None` if it holds NaN or infinity.
fn decompose<const N: usize>(
    triangle: &SMatrix<f64, N, N>,
    natural: &[f64; N],
) -> Option<Decomposed<N>> {
    if triangle.iter().any(|t| !t.is_finite()) {
        return None;
    }
    let scaled = Mat::from_fn(N, N, |i, j| triangle[(i, j)] * natural[j]);
    let svd = scaled.svd().ok()?;
    let singular = std::array::from_fn(|k| svd.S()[k]);
    let V = SMatrix::from_fn(|i, j| svd.V()[(i, j)]);
    let U = SMatrix::from_fn(|i, j| svd.U()[(i, j)]);
    Some((singular, V, U))
}

/// A solved step in directions of natural units.
#[derive(Debug, Clone)]
pub struct Directions<const N: usize> {
    /// Natural unit of each unknown.
    pub natural: [f64; N],
    /// Singular values, descending.
    pub singular: [f64; N],
    /// Directions, one column each.
    pub V: SMatrix<f64, N, N>,
    /// Left singular vectors: the directions in the rotated right-hand side.
    pub U: SMatrix<f64, N, N>,
    /// Whether each direction may be used.
    pub usable: [bool; N],
}

impl<const N: usize> Directions<N> {
    /// Directions of a step; those below `round_off` are not usable. `None` if numbers overflow.
    pub fn new(step: &Step<N>, natural: [f64; N], round_off: f64) -> Option<Self> {
        let (singular, V, U) = decompose(&step.triangle, &natural)?;
        let floor = (32.0 * N as f64 * f64::EPSILON * singular[0]).max(round_off);
        Some(Self {
            natural,
            usable: singular.map(|s| s > floor),
            singular,
            V,
            U,
        })
    }

    /// Error along each direction for the normal-equation right-hand side `A^T e`.
    pub(super) fn along(&self, normal: &SVector<f64, N>) -> SVector<f64, N> {
        let scaled = SVector::<f64, N>::from_fn(|i, _| normal[i] * self.natural[i]);
        SVector::from_fn(|j, _| {
            if self.usable[j] {
                -self.V.column(j).dot(&scaled) / (self.singular[j] * self.singular[j])
            } else {
                0.0
            }
        })
    }

    /// A step along the directions, in units of the unknowns.
    pub fn in_units(&self, along: &SVector<f64, N>) -> SVector<f64, N> {
        let z = self.V * along;
        SVector::from_fn(|i, _| z[i] * self.natural[i])
    }

    /// Least-squares solution that differs from `nominal` only along usable directions.
    pub fn solve(&self, step: &Step<N>, nominal: &SVector<f64, N>) -> SVector<f64, N> {
        let rest = step.rotated - step.triangle * nominal;
        let along = SVector::<f64, N>::from_fn(|j, _| {
            if self.usable[j] {
                self.U.column(j).dot(&rest) / self.singular[j]
            } else {
                0.0
            }
        });
        nominal + self.in_units(&along)
    }
}

/// Both solved steps, for the noise propagation.
pub struct Solution<'a> {
    /// Step 1.
    pub x: SVector<f64, 4>,
    /// Its directions.
    pub linear: &'a Directions<4>,
    /// Step 2, if step 1 is complete.
    pub angular: Option<(SVector<f64, 6>, &'a Directions<6>)>,
}
