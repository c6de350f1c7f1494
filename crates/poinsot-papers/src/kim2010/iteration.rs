//! The iteration of (14)-(16) that the paper announces.

use super::sums::{Answer, ROUND_OFF, Sums, averaged, symmetric};
use crate::kim2010::error;
use faer::Mat;
use poinsot_files::Faults;

/// Largest number of sweeps.
const SWEEPS: usize = 100_000;
/// Change of an element in one sweep, relative to the largest, at which the iteration has converged.
const SETTLED: f64 = 1.0e-13;

/// Result of the iteration and its convergence.
#[derive(Debug, Clone, PartialEq)]
pub struct Iterated {
    /// Values after the last sweep.
    pub answer: Answer,
    /// Whether it converged.
    pub converged: bool,
    /// Number of sweeps.
    pub sweeps: usize,
    /// Spectral radius of one sweep: below one it converges from any start.
    pub spectral_radius: f64,
    /// Number of independent directions of fixed points.
    pub free_directions: usize,
    /// The fixed point, if unique.
    pub fixed_point: Option<[f64; 6]>,
}

impl Sums {
    /// One sweep: (14), (15), (16), each with the elements of the previous sweep on the right-hand side. From zero,
    /// the first sweep is [`Self::suggested`].
    fn sweep(&self, x: &[f64; 6]) -> Result<[f64; 6], Faults> {
        let I = self.moments(&symmetric(x))?;
        Ok(averaged(self.products(&I)).printed)
    }

    /// Repeats (14)-(16) from zero to convergence.
    ///
    /// A sweep is affine, `x <- B x + b`: B gives its fixed points and rate.
    ///
    /// # Errors
    /// Not finite.
    pub fn iterated(&self) -> Result<Iterated, Faults> {
        let b = self.sweep(&[0.0; 6])?;
        let mut B = [[0.0; 6]; 6];
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            for (row, (moved, b)) in B.iter_mut().zip(self.sweep(&unit)?.into_iter().zip(b)) {
                row[j] = moved - b;
            }
        }
        let (mut x, mut sweeps, mut converged) = (b, 1, false);
        while sweeps < SWEEPS && !converged {
            let next: [f64; 6] = std::array::from_fn(|i| {
                b[i] + B[i].iter().zip(&x).map(|(a, x)| a * x).sum::<f64>()
            });
            let largest = next.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let change = next
                .iter()
                .zip(&x)
                .fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            if !largest.is_finite() {
                break;
            }
            converged = change <= SETTLED * largest;
            x = next;
            sweeps += 1;
        }
        let matrix = Mat::from_fn(6, 6, |i, j| B[i][j]);
        let eigenvalues = matrix.eigenvalues().map_err(|_| error::not_finite())?;
        let spectral_radius = eigenvalues
            .iter()
            .fold(0.0_f64, |m, z| m.max(z.re.hypot(z.im)));
        let (fixed_point, free_directions) = fixed_point(&B, &b)?;
        let elements = symmetric(&x);
        Ok(Iterated {
            answer: Answer {
                elements,
                printed: x,
            },
            converged,
            sweeps,
            spectral_radius,
            free_directions,
            fixed_point,
        })
    }
}

/// The solution of `x = B x + b`, and the dimension of its solution set.
fn fixed_point(B: &[[f64; 6]; 6], b: &[f64; 6]) -> Result<(Option<[f64; 6]>, usize), Faults> {
    let A = Mat::from_fn(6, 6, |i, j| f64::from(u8::from(i == j)) - B[i][j]);
    let svd = A.svd().map_err(|_| error::not_finite())?;
    let (U, S, V) = (svd.U(), svd.S(), svd.V());
    let rank = (0..6).filter(|k| S[*k] > ROUND_OFF * S[0]).count();
    let point = (rank == 6).then(|| {
        std::array::from_fn(|i| {
            (0..6)
                .map(|k| V[(i, k)] * (0..6).map(|j| U[(j, k)] * b[j]).sum::<f64>() / S[k])
                .sum()
        })
    });
    Ok((point, 6 - rank))
}
