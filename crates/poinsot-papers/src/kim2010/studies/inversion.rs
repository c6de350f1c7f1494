//! Infers the record of the paper from Table 2.
//!
//! On one axis `K = sum Q w^T = g k^T` with `g = I n` known. `G` and `k` hold eight unknowns, up to a common scale,
//! which determine every column but one. Gauss-Newton fits them to the 15 other printed numbers.

use crate::kim2010::Sums;
use crate::kim2010::sums::not_finite;
use nalgebra::{SMatrix, SVector};
use poinsot_files::Faults;
use poinsot_spatial::{Matrix3, Vector3};

/// Half a unit of the last printed digit, kg m2.
pub const HALF_DIGIT: f64 = 0.5e-4;
/// Step of the finite differences; the unknowns are of order one.
const STEP: f64 = 1.0e-7;
const ITERATIONS: usize = 20;

type Unknowns = SVector<f64, 8>;
type Printed = SVector<f64, 15>;

/// The sums that reproduce the printed numbers.
pub struct Fixed {
    /// In units of `sum s^2`, with `K = g k^T`.
    pub sums: Sums,
    /// Largest difference from the 15 numbers, in half digits.
    pub worst: f64,
}

/// Fits the eight unknowns. `n` is the axis, `g = I n` the momentum direction; `table` is Table 2 in the order batch,
/// conventional, pre-estimate (not used), suggested.
pub fn invert(n: &Vector3, g: &Vector3, table: &[[f64; 6]; 4]) -> Result<Fixed, Faults> {
    let wanted = used(&table[0], &table[1], &table[3]);
    let mut u = Unknowns::zeros();
    for _ in 0..ITERATIONS {
        let rest = wanted - columns(&build(&u, n, g)?)?;
        let mut J = SMatrix::<f64, 15, 8>::zeros();
        for j in 0..8 {
            let mut moved = [u, u];
            moved[0][j] += STEP;
            moved[1][j] -= STEP;
            let [a, b] = [&moved[0], &moved[1]].map(|u| build(u, n, g).and_then(|s| columns(&s)));
            J.set_column(j, &((a? - b?) / (2.0 * STEP)));
        }
        let normal = (J.transpose() * J).cholesky();
        u += normal
            .ok_or_else(not_finite)?
            .solve(&(J.transpose() * rest));
    }
    let sums = build(&u, n, g)?;
    let worst = (wanted - columns(&sums)?).amax() / HALF_DIGIT;
    Ok(Fixed { sums, worst })
}

/// The sums from the eight relative deviations from the noise-free record.
fn build(u: &Unknowns, n: &Vector3, g: &Vector3) -> Result<Sums, Faults> {
    let G = Matrix3::from_fn(|i, j| {
        let at = if i == j { i } else { 2 + i + j };
        // The ridge of a record of 350 s; without it the initial G is singular.
        let ridge = if i == j { 2.7e-3 } else { 0.0 };
        n[i] * n[j] * (1.0 + u[at]) + ridge
    });
    let k = Vector3::new(n.x * (1.0 + u[6]), n.y * (1.0 + u[7]), n.z);
    Sums::at_rest(G, g * k.transpose(), 350)
}

/// The 15 numbers: batch (6), conventional (6), products of suggested (3).
fn used(batch: &[f64; 6], conventional: &[f64; 6], suggested: &[f64; 6]) -> Printed {
    let all = batch.iter().chain(conventional).chain(&suggested[3..]);
    Printed::from_iterator(all.copied())
}

fn columns(sums: &Sums) -> Result<Printed, Faults> {
    let (batch, conventional) = (sums.batch()?.0.printed, sums.conventional()?.printed);
    Ok(used(&batch, &conventional, &sums.suggested()?.printed))
}
