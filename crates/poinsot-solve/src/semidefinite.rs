//! The shortest vector subject to positive semidefinite blocks, by a barrier method.
//!
//! It finds the u of least norm for which every block `S(u) = C + sum_j u_j B_j` is positive semidefinite. The problem
//! is convex and its solution unique. The barrier makes it smooth:
//!
//! ```text
//! F(u) = |u|^2 - mu sum log det S(u),      mu -> 0
//! ```
//!
//! `F / mu` is self-concordant, so a Newton step damped by its decrement stays inside and lowers F (Boyd and
//! Vandenberghe 2004, sections 9.6 and 11.6). Longer steps are tried first. The suboptimality is mu times the rows of
//! all blocks.

use nalgebra::{DMatrix, DVector, Matrix4, SymmetricEigen};

/// One block `S(u) = C + sum_j u_j B_j`.
pub struct Block {
    /// C, symmetric.
    pub constant: Matrix4<f64>,
    /// B_j, symmetric, one for each component of u.
    pub slopes: Vec<Matrix4<f64>>,
}

/// Final barrier parameter; costs are chi-squares.
const FINAL: f64 = 1.0e-8;
/// Smallest eigenvalue of a block of order one that is above round-off.
const LEAST: f64 = 1.0e-12;
/// Factor of the barrier parameter between stages.
const SHRINK: f64 = 0.1;
/// Decrement below which full steps converge quadratically.
const NEAR: f64 = 0.25;
/// Decrement at convergence.
const SETTLED: f64 = 1.0e-3;
/// Limit on steps: fourteen decades take about eighty with one block, more with many.
const STEPS: usize = 2000;
/// Required fraction of the linearly predicted decrease for a longer step.
const GAIN: f64 = 0.1;
/// Independent elements of a symmetric block.
const ELEMENTS: usize = 10;

/// The shortest vector, from a start strictly inside; `None` if the start is not inside, or without convergence.
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
/// let u = shortest(&[block], &[3.0]).unwrap();
/// assert!((u[0] - 1.0).abs() < 1.0e-6);
/// ```
pub fn shortest(blocks: &[Block], start: &[f64]) -> Option<Vec<f64>> {
    let mut u = DVector::from_column_slice(start);
    let mut here = Whitened::at(blocks, &u)?;
    let mut mu = u.norm_squared().max(FINAL);
    for _ in 0..STEPS {
        let (step, decrement) = here.newton(&u, mu)?;
        let last = mu <= FINAL || here.smallest < LEAST;
        if decrement < if last { SETTLED } else { NEAR } {
            if last {
                return Some(u.as_slice().to_vec());
            }
            mu = FINAL.max(SHRINK * mu);
            continue;
        }
        let Some((next, there)) = here.advance(blocks, &u, &step, decrement, mu) else {
            // Only round-off leads outside: accept the point in the final stage, fail in earlier ones.
            return last.then(|| u.as_slice().to_vec());
        };
        (u, here) = (next, there);
    }
    None
}

/// All blocks at one u, in coordinates in which each is the identity.
struct Whitened {
    /// Ten rows per block, one column per component of u: elements of the whitened slopes. Off-diagonal elements have
    /// the factor sqrt(2), so that products of rows are traces.
    slopes: DMatrix<f64>,
    /// The identity in the same elements.
    identity: DVector<f64>,
    /// Smallest eigenvalue of all blocks.
    smallest: f64,
    /// Sum of `log det S`.
    log_det: f64,
}

impl Whitened {
    fn at(blocks: &[Block], u: &DVector<f64>) -> Option<Self> {
        let rows = ELEMENTS * blocks.len();
        let mut out = Self {
            slopes: DMatrix::zeros(rows, u.len()),
            identity: DVector::zeros(rows),
            smallest: f64::INFINITY,
            log_det: 0.0,
        };
        for (b, block) in blocks.iter().enumerate() {
            let mut S = block.constant;
            for (slope, step) in block.slopes.iter().zip(u.iter()) {
                S += slope * *step;
            }
            if S.iter().any(|x| !x.is_finite()) {
                return None;
            }
            let eigen = SymmetricEigen::new(S);
            let smallest = eigen.eigenvalues.min();
            if smallest <= 0.0 {
                return None;
            }
            out.smallest = out.smallest.min(smallest);
            out.log_det += eigen.eigenvalues.map(f64::ln).sum();
            let root = Matrix4::from_diagonal(&eigen.eigenvalues.map(|x| 1.0 / x.sqrt()))
                * eigen.eigenvectors.transpose();
            let at = ELEMENTS * b;
            for (j, slope) in block.slopes.iter().enumerate() {
                let own = elements(&(root * slope * root.transpose()));
                for (k, x) in own.iter().enumerate() {
                    out.slopes[(at + k, j)] = *x;
                }
            }
            for (k, x) in elements(&Matrix4::identity()).iter().enumerate() {
                out.identity[at + k] = *x;
            }
        }
        Some(out)
    }

    /// The longest of a few steps that lowers `F / mu` enough; the last one tried is the damped step.
    fn advance(
        &self,
        blocks: &[Block],
        u: &DVector<f64>,
        step: &DVector<f64>,
        decrement: f64,
        mu: f64,
    ) -> Option<(DVector<f64>, Self)> {
        let cost = |u: &DVector<f64>, at: &Self| u.norm_squared() / mu - at.log_det;
        let before = cost(u, self);
        let damped = 1.0 / (1.0 + decrement);
        let mut length = 1.0;
        while length > damped {
            let next = u + step * length;
            if let Some(there) = Self::at(blocks, &next)
                && before - cost(&next, &there) >= GAIN * length * decrement * decrement
            {
                return Some((next, there));
            }
            // Round-off hides the decrease of a small step: near the centre the full step is correct.
            if decrement < NEAR {
                break;
            }
            length *= 0.4;
        }
        let length = if decrement < NEAR { 1.0 } else { damped };
        let next = u + step * length;
        Self::at(blocks, &next).map(|there| (next, there))
    }

    /// Newton's step of `F` and its decrement.
    ///
    /// With N the whitened slopes and e the identity, gradient and Hessian of F are `2 u - mu N^T e` and
    /// `2 + mu N^T N`. The step ends at `N^T q` with `(N N^T + 2 / mu) q = e + N u`. The rows of this small system
    /// differ in size as the eigenvalues of the blocks do, which does not harm Cholesky factorisation.
    fn newton(&self, u: &DVector<f64>, mu: f64) -> Option<(DVector<f64>, f64)> {
        let N = &self.slopes;
        let mut normal = N * N.transpose();
        for k in 0..normal.nrows() {
            normal[(k, k)] += 2.0 / mu;
        }
        let q = normal.cholesky()?.solve(&(&self.identity + N * u));
        let step = N.tr_mul(&q) - u;
        let square = 2.0 * step.norm_squared() / mu + (N * &step).norm_squared();
        square.is_finite().then(|| (step, square.sqrt()))
    }
}

/// Elements of a symmetric matrix; off-diagonal ones have the factor sqrt(2).
fn elements(m: &Matrix4<f64>) -> [f64; ELEMENTS] {
    let mut out = [0.0; ELEMENTS];
    let mut k = 0;
    for i in 0..4 {
        for j in 0..=i {
            let weight = if i == j {
                1.0
            } else {
                std::f64::consts::SQRT_2
            };
            out[k] = weight * m[(i, j)];
            k += 1;
        }
    }
    out
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
        let u = shortest(&[block], &[5.0, 3.0]).unwrap();
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
            let Some(u) = shortest(&blocks, &start) else {
                continue;
            };
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
