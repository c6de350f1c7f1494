//! The shortest vector subject to positive semidefinite blocks, by a primal-dual interior-point method.
//!
//! It finds the u of least norm for which every block `S(u) = C + sum_j u_j B_j` is positive semidefinite. The problem
//! is convex and its solution unique. At the solution a multiplier Z of each block is positive semidefinite, `Z S = 0`
//! and `2 u_j = sum tr(Z B_j)`. Any Z that is positive semidefinite bounds from below what `|u|^2` can be (its dual):
//!
//! ```text
//! |u|^2 - bound = sum tr(Z S) + sum_j (2 u_j - sum tr(Z B_j))^2 / 4
//! ```
//!
//! Newton steps with predictor and corrector lead both inside to where the right side vanishes, in coordinates in which
//! S and Z of a block are the same diagonal matrix (Nesterov and Todd 1997; Todd, Toh and Tütüncü 1998). What remains of
//! it is returned: round-off ends the steps where multipliers are large.

use nalgebra::{DMatrix, DVector, Dyn, Matrix4, QR, SVector, SymmetricEigen, Vector4};

/// One block `S(u) = C + sum_j u_j B_j`.
pub struct Block {
    /// C, symmetric.
    pub constant: Matrix4<f64>,
    /// B_j, symmetric, one for each component of u.
    pub slopes: Vec<Matrix4<f64>>,
}

/// A vector for which all blocks are positive definite.
#[derive(Debug, PartialEq)]
pub struct Shortest {
    /// The vector.
    pub u: Vec<f64>,
    /// By how much the square of its norm exceeds the least one, at most.
    pub excess: f64,
}

/// Excess at the end, and its share of the square of the norm: costs are chi-squares.
const FINAL: f64 = 1.0e-9;
const FINAL_SHARE: f64 = 1.0e-11;
/// Limit on steps: ten to twenty are usual, thirty where round-off ends them.
const STEPS: usize = 60;
/// Share of the way to the edge.
const INSIDE: f64 = 0.98;
/// Independent elements of a symmetric block.
const ELEMENTS: usize = 10;

/// The shortest vector, from a start strictly inside; `None` if the start is not inside.
///
/// ```
/// use nalgebra::{Matrix4, Vector4};
/// use poinsot_solve::semidefinite::{Block, shortest};
///
/// // diag(u - 1, 1, 1, 1) is positive semidefinite for u >= 1: the shortest u is 1.
/// let block = Block {
///     constant: Matrix4::from_diagonal(&Vector4::new(-1.0, 1.0, 1.0, 1.0)),
///     slopes: vec![Matrix4::from_diagonal(&Vector4::new(1.0, 0.0, 0.0, 0.0))],
/// };
/// let found = shortest(&[block], &[3.0]).unwrap();
/// assert!((found.u[0] - 1.0).abs() < 1.0e-6 && found.excess < 1.0e-6);
/// ```
pub fn shortest(blocks: &[Block], start: &[f64]) -> Option<Shortest> {
    let mut at = Pair::about(blocks, start)?;
    let mut best: Option<Shortest> = None;
    for _ in 0..STEPS {
        let Some(here) = Scaled::at(blocks, &at) else {
            break;
        };
        let excess = here.excess();
        if best.as_ref().is_none_or(|b| excess < b.excess) {
            let u = at.u.as_slice().to_vec();
            best = Some(Shortest { u, excess });
        }
        if excess <= FINAL + FINAL_SHARE * at.u.norm_squared() {
            break;
        }
        let Some(next) = here.advance(&at.u) else {
            break;
        };
        at = next;
    }
    best.filter(|b| b.excess.is_finite())
}

/// A vector and the multipliers of the blocks.
struct Pair {
    u: DVector<f64>,
    multipliers: Vec<Matrix4<f64>>,
}

impl Pair {
    /// The start, with multipliers for which all products with the blocks are the same multiple of the identity.
    fn about(blocks: &[Block], start: &[f64]) -> Option<Self> {
        let u = DVector::from_column_slice(start);
        let mu = u.norm_squared() / (4 * blocks.len()) as f64;
        let inverse = |block: &Block| Some(block.at(&u).cholesky()?.inverse() * mu.max(FINAL));
        let multipliers = blocks.iter().map(inverse).collect::<Option<_>>()?;
        Some(Self { u, multipliers })
    }
}

impl Block {
    /// What a step adds.
    fn change(&self, step: &DVector<f64>) -> Matrix4<f64> {
        let each = self.slopes.iter().zip(step.iter());
        each.map(|(slope, step)| slope * *step).sum()
    }

    fn at(&self, u: &DVector<f64>) -> Matrix4<f64> {
        self.constant + self.change(u)
    }
}

/// All blocks at a pair, in coordinates in which a block and its multiplier are the same diagonal matrix.
struct Scaled<'a> {
    of: &'a [Block],
    /// The diagonals.
    lambda: Vec<Vector4<f64>>,
    /// What leads from a block to its diagonal, `T S T^T`.
    scaling: Vec<Matrix4<f64>>,
    /// Ten rows per block, one column per component of u: elements of the scaled slopes.
    slopes: DMatrix<f64>,
    /// `2 u_j - sum tr(Z B_j)`.
    residual: DVector<f64>,
}

/// A step of u and those of the blocks and multipliers, scaled.
struct Step {
    u: DVector<f64>,
    blocks: Vec<Matrix4<f64>>,
    multipliers: Vec<Matrix4<f64>>,
}

impl<'a> Scaled<'a> {
    /// `None` where round-off has led outside.
    fn at(blocks: &'a [Block], pair: &Pair) -> Option<Self> {
        let mut out = Self {
            of: blocks,
            lambda: Vec::new(),
            scaling: Vec::new(),
            slopes: DMatrix::zeros(ELEMENTS * blocks.len(), pair.u.len()),
            residual: &pair.u * 2.0,
        };
        for (b, (block, Z)) in blocks.iter().zip(&pair.multipliers).enumerate() {
            let L = block.at(&pair.u).cholesky()?.l();
            let eigen = SymmetricEigen::new(L.transpose() * Z * L);
            if eigen.eigenvalues.iter().any(|e| e.is_nan() || *e <= 0.0) {
                return None;
            }
            let lambda = eigen.eigenvalues.map(f64::sqrt);
            let T = Matrix4::from_diagonal(&lambda.map(f64::sqrt))
                * L.transpose()
                    .solve_upper_triangular(&eigen.eigenvectors)?
                    .transpose();
            for (j, slope) in block.slopes.iter().enumerate() {
                out.residual[j] -= Z.dot(slope);
                let own = elements(&(T * slope * T.transpose()));
                let mut column = out.slopes.column_mut(j);
                column.rows_mut(ELEMENTS * b, ELEMENTS).copy_from(&own);
            }
            out.lambda.push(lambda);
            out.scaling.push(T);
        }
        Some(out)
    }

    /// Sum of `tr(Z S)`.
    fn complementarity(&self) -> f64 {
        self.lambda.iter().map(Vector4::norm_squared).sum()
    }

    fn excess(&self) -> f64 {
        self.complementarity() + self.residual.norm_squared() / 4.0
    }

    /// A step towards the centre as far as one straight to the solution would not lead.
    fn advance(&self, u: &DVector<f64>) -> Option<Pair> {
        let n = u.len();
        let mut A = DMatrix::zeros(n + self.slopes.nrows(), n);
        A.view_mut((0, 0), (n, n))
            .fill_diagonal(std::f64::consts::SQRT_2);
        A.rows_mut(n, self.slopes.nrows()).copy_from(&self.slopes);
        let qr = A.qr();
        let straight = self.lambda.iter().map(|l| -Matrix4::from_diagonal(l));
        let straight = self.step(&qr, straight.collect())?;
        let centring = (1.0 - self.longest(&straight)).powi(3);
        let mu = centring * self.complementarity() / (4 * self.lambda.len()) as f64;
        let second = straight.blocks.iter().zip(&straight.multipliers);
        let corrected = self.lambda.iter().zip(second).map(|(l, (S, Z))| {
            let product = Matrix4::from_diagonal(&l.map(|l| mu - l * l)) - (S * Z + Z * S) * 0.5;
            Matrix4::from_fn(|i, j| 2.0 * product[(i, j)] / (l[i] + l[j]))
        });
        let step = self.step(&qr, corrected.collect())?;
        let length = self.longest(&step);
        let each = self.scaling.iter().zip(&self.lambda);
        let multiplier = |((T, l), Z): ((&Matrix4<f64>, &Vector4<f64>), &Matrix4<f64>)| {
            T.transpose() * (Matrix4::from_diagonal(l) + Z * length) * T
        };
        Some(Pair {
            u: u + step.u * length,
            multipliers: each.zip(&step.multipliers).map(multiplier).collect(),
        })
    }

    /// The step for which the changes of each block and its multiplier have these sums, and no residual is left: the
    /// solution of `(2 + N^T N) du = N^T sums - residual`, N the scaled slopes, by least squares.
    fn step(&self, qr: &QR<f64, Dyn, Dyn>, sums: Vec<Matrix4<f64>>) -> Option<Step> {
        let n = self.residual.len();
        let mut rhs = DVector::zeros(n + self.slopes.nrows());
        rhs.rows_mut(0, n)
            .copy_from(&(&self.residual / -std::f64::consts::SQRT_2));
        for (b, sum) in sums.iter().enumerate() {
            rhs.rows_mut(n + ELEMENTS * b, ELEMENTS)
                .copy_from(&elements(sum));
        }
        qr.q_tr_mul(&mut rhs);
        let u = qr
            .r()
            .solve_upper_triangular(&rhs.rows(0, n).into_owned())?;
        let each = self.of.iter().zip(&self.scaling);
        let changes = each.map(|(block, T)| T * block.change(&u) * T.transpose());
        let blocks: Vec<Matrix4<f64>> = changes.collect();
        let multipliers = sums.iter().zip(&blocks).map(|(sum, S)| sum - S).collect();
        Some(Step {
            u,
            blocks,
            multipliers,
        })
    }

    /// Share of a step, at most the whole, that stays inside.
    fn longest(&self, step: &Step) -> f64 {
        let each = self.lambda.iter().chain(&self.lambda);
        let changes = step.blocks.iter().chain(&step.multipliers);
        let outward = |(l, change): (&Vector4<f64>, &Matrix4<f64>)| {
            let root = Matrix4::from_diagonal(&l.map(|l| 1.0 / l.sqrt()));
            -SymmetricEigen::new(root * change * root).eigenvalues.min()
        };
        let most = each.zip(changes).map(outward).fold(INSIDE, f64::max);
        INSIDE / most
    }
}

/// Elements of a symmetric matrix; off-diagonal ones have the factor sqrt(2), so that products of rows are traces.
fn elements(m: &Matrix4<f64>) -> SVector<f64, ELEMENTS> {
    let pairs = (0..4).flat_map(|i| (0..=i).map(move |j| (i, j)));
    SVector::from_iterator(pairs.map(|(i, j)| match i == j {
        true => m[(i, j)],
        false => std::f64::consts::SQRT_2 * m[(i, j)],
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn random(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (*state >> 33) as f64 / 2_f64.powi(31) - 0.5
    }

    fn symmetric(state: &mut u64) -> Matrix4<f64> {
        let m = Matrix4::from_fn(|_, _| random(state));
        m + m.transpose()
    }

    fn value(block: &Block, u: &[f64]) -> Matrix4<f64> {
        let moved = block.slopes.iter().zip(u);
        moved.fold(block.constant, |S, (B, x)| S + B * *x)
    }

    /// Two conditions on a diagonal, solved by hand: `u1 >= 1`, `u2 >= -1`; the shortest is (1, 0).
    #[test]
    fn unit_a_corner() {
        let slope = |k: usize| {
            let mut B = Matrix4::zeros();
            B[(k, k)] = 1.0;
            B
        };
        let mut constant = Matrix4::identity();
        constant[(0, 0)] = -1.0;
        let block = Block {
            constant,
            slopes: vec![slope(0), slope(1)],
        };
        let u = shortest(&[block], &[5.0, 3.0]).unwrap().u;
        assert!((u[0] - 1.0).abs() < 1.0e-8, "{u:?}");
        assert!(u[1].abs() < 1.0e-7, "{u:?}");
    }

    #[test]
    fn unit_a_start_outside_has_no_answer() {
        let block = Block {
            constant: -Matrix4::identity(),
            slopes: vec![Matrix4::identity()],
        };
        assert_eq!(shortest(&[block], &[0.5]), None);
    }

    /// Slopes over eight decades and a shortest vector of thousands, as where readings contradict a body.
    #[test]
    fn regress_a_vector_far_from_zero_is_found_beside_slopes_of_any_size() {
        let mut state = 5;
        for trial in 0..200 {
            let size = |j: usize| 10.0_f64.powf(-4.0 + 8.0 * j as f64 / 9.0);
            let slopes: Vec<_> = (0..10).map(|j| symmetric(&mut state) * size(j)).collect();
            let start: Vec<f64> = (0..10).map(|_| 5.0e3 * random(&mut state)).collect();
            let u = DVector::from_column_slice(&start);
            let moved = slopes.iter().zip(u.iter()).map(|(B, x)| B * *x);
            let constant = Matrix4::identity() - moved.sum::<Matrix4<f64>>();
            let found = shortest(&[Block { constant, slopes }], &start).unwrap();
            let square = found.u.iter().map(|x| x * x).sum::<f64>();
            assert!(square <= u.norm_squared(), "trial {trial}");
            let share = found.excess / square.max(1.0);
            assert!(share < 1.0e-4, "trial {trial}: {share:e}");
        }
    }

    /// Karush-Kuhn-Tucker conditions, sufficient for a convex problem: `2 u_j = sum tr(L_b B_bj)` with positive
    /// semidefinite multipliers `L_b` that vanish where the block does not. They are computed from u alone, by least
    /// squares over the null spaces of the blocks.
    #[test]
    fn exact_no_vector_inside_is_shorter() {
        let mut state = 11;
        let mut pressed = [0; 3];
        for trial in 0..60 {
            let (n, count) = (6, 2);
            let blocks: Vec<Block> = (0..count)
                .map(|_| Block {
                    // Zero is outside by one or two eigenvalues, the start is inside.
                    constant: {
                        let S = symmetric(&mut state);
                        S * 2.0 + Matrix4::identity() * 0.3
                    },
                    slopes: (0..n)
                        .map(|j| match j {
                            0 => Matrix4::identity() + symmetric(&mut state) * 0.3,
                            _ => symmetric(&mut state),
                        })
                        .collect(),
                })
                .collect();
            let mut start = vec![0.0; n];
            start[0] = 100.0;
            let Some(Shortest { u, excess }) = shortest(&blocks, &start) else {
                continue;
            };
            assert!(excess < 1.0e-8, "trial {trial}: {excess:e}");
            // Columns: pairs of null vectors of the blocks.
            let mut columns: Vec<Vec<f64>> = Vec::new();
            let mut sizes = Vec::new();
            for block in &blocks {
                let eigen = SymmetricEigen::new(value(block, &u));
                assert!(eigen.eigenvalues.min() > -1.0e-9, "trial {trial}");
                let null: Vec<usize> = (0..4).filter(|k| eigen.eigenvalues[*k] < 1.0e-5).collect();
                sizes.push(null.len());
                for (a, i) in null.iter().enumerate() {
                    for j in &null[..=a] {
                        let (v, w) = (eigen.eigenvectors.column(*i), eigen.eigenvectors.column(*j));
                        let twice = if i == j { 1.0 } else { 2.0 };
                        columns.push(
                            block
                                .slopes
                                .iter()
                                .map(|B| twice * v.dot(&(B * w)))
                                .collect(),
                        );
                    }
                }
            }
            let target = DVector::from_fn(n, |j, _| 2.0 * u[j]);
            if columns.is_empty() {
                assert!(target.norm() < 1.0e-6, "trial {trial}: {u:?}");
                pressed[0] += 1;
                continue;
            }
            let A = DMatrix::from_fn(n, columns.len(), |j, k| columns[k][j]);
            let normal = (A.transpose() * &A).cholesky().unwrap();
            let L = normal.solve(&(A.transpose() * &target));
            let miss = (&A * &L - &target).norm();
            assert!(
                miss < 1.0e-5 * (1.0 + target.norm()),
                "trial {trial}: {miss:e}"
            );
            let mut at = 0;
            for size in sizes {
                pressed[size.min(2)] += 1;
                let mut multiplier = DMatrix::zeros(size, size);
                for i in 0..size {
                    for j in 0..=i {
                        multiplier[(i, j)] = L[at];
                        multiplier[(j, i)] = L[at];
                        at += 1;
                    }
                }
                if size > 0 {
                    let least = SymmetricEigen::new(multiplier).eigenvalues.min();
                    assert!(least > -1.0e-6, "trial {trial}: {least:e}");
                }
            }
        }
        assert!(pressed.iter().all(|n| *n >= 5), "{pressed:?}");
    }
}
