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
    /// `sum w w^T`, in units of `sum s^2`.
    pub G: Matrix3,
    /// `sum s w`, in the same units.
    pub k: Vector3,
    /// With `K = g k^T`.
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
        let rest = wanted - columns(&build(&u, n, g)?.2)?;
        let mut J = SMatrix::<f64, 15, 8>::zeros();
        for j in 0..8 {
            let mut moved = [u, u];
            moved[0][j] += STEP;
            moved[1][j] -= STEP;
            let [a, b] = [&moved[0], &moved[1]].map(|u| build(u, n, g).and_then(|s| columns(&s.2)));
            J.set_column(j, &((a? - b?) / (2.0 * STEP)));
        }
        let normal = (J.transpose() * J).cholesky();
        u += normal
            .ok_or_else(not_finite)?
            .solve(&(J.transpose() * rest));
    }
    let (G, k, sums) = build(&u, n, g)?;
    let worst = (wanted - columns(&sums)?).amax() / HALF_DIGIT;
    Ok(Fixed { G, k, sums, worst })
}

/// `G`, `k` and the sums from the eight relative deviations from the noise-free record.
fn build(u: &Unknowns, n: &Vector3, g: &Vector3) -> Result<(Matrix3, Vector3, Sums), Faults> {
    let G = Matrix3::from_fn(|i, j| {
        let at = if i == j { i } else { 2 + i + j };
        // The ridge of a record of 350 s; without it the initial G is singular.
        let ridge = if i == j { 2.7e-3 } else { 0.0 };
        n[i] * n[j] * (1.0 + u[at]) + ridge
    });
    let k = Vector3::new(n.x * (1.0 + u[6]), n.y * (1.0 + u[7]), n.z);
    Ok((G, k, Sums::at_rest(G, g * k.transpose(), 350)?))
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

/// Noise inferred from the sums, in units of `sum s^2`.
pub struct Noise {
    /// Mean of the two residual sums of squares across the axis: `N sigma^2`.
    pub mean: f64,
    /// Sums with mean zero and sigma `mean / sqrt(N)`: half the difference of the two squares, and three sums of
    /// products.
    pub scatter: [f64; 4],
    /// Sums of `s` times noise across the axis, each with sigma `sigma / sqrt(sum s^2)`.
    pub across: [f64; 2],
    /// The same along the axis: the common offset of all rates from `Q`.
    pub along: f64,
}

impl Noise {
    /// Subtracts the noise-free motion from the sums.
    pub fn of(fixed: &Fixed, n: &Vector3) -> Self {
        let a = n.cross(&Vector3::z()).normalize();
        let axes = Matrix3::from_columns(&[a, n.cross(&a), *n]);
        let k = axes.transpose() * fixed.k;
        let M = axes.transpose() * fixed.G * axes / k.z;
        let across = [k.x / k.z, k.y / k.z];
        let mean = 0.5 * (M[(0, 0)] + M[(1, 1)]);
        Self {
            mean,
            scatter: [
                0.5 * (M[(0, 0)] - M[(1, 1)]),
                M[(0, 1)],
                M[(0, 2)] - across[0],
                M[(1, 2)] - across[1],
            ],
            across,
            along: M[(2, 2)] - 1.0 - mean,
        }
    }

    /// Length of the record, s: `N sigma^2 = T sigma^2 rate`, `sum s^2 = rate * integral`.
    pub fn length(&self, sigma: f64, integral: f64) -> f64 {
        self.mean * integral / (sigma * sigma)
    }

    /// For a rate, Hz: the sum of the six squared normalised numbers of `scatter` and `across`, and the common offset
    /// in sigmas.
    pub fn at(&self, rate: f64, sigma: f64, integral: f64) -> (f64, f64) {
        let samples = self.length(sigma, integral) * rate;
        let (of_sums, of_shift) = (self.mean / samples.sqrt(), sigma / (integral * rate).sqrt());
        let scatter: f64 = self.scatter.iter().map(|x| (x / of_sums).powi(2)).sum();
        let across: f64 = self.across.iter().map(|x| (x / of_shift).powi(2)).sum();
        let along = self.along / of_shift.hypot(2.0_f64.sqrt() * of_sums);
        (scatter + across, along)
    }
}
