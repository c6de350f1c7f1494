//! The iteration of (14)-(16) that the paper announces.

use super::sums::{Answer, ROUND_OFF, Sums, averaged, not_finite, symmetric};
use crate::samples::add_smallest;
use crate::study::statistics::largest;
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
            let size = largest(next.iter().map(|x| x.abs()));
            if !size.is_finite() {
                break;
            }
            let change = largest(next.iter().zip(&x).map(|(a, b)| (a - b).abs()));
            converged = change <= SETTLED * size;
            x = next;
            sweeps += 1;
        }
        let matrix = Mat::from_fn(6, 6, |i, j| B[i][j]);
        let eigenvalues = matrix.eigenvalues().map_err(|_| not_finite())?;
        // The solution of `x = B x + b`.
        let A = Mat::from_fn(6, 6, |i, j| f64::from(u8::from(i == j)) - B[i][j]);
        let mut point = [0.0; 6];
        let rank = add_smallest(&A, &b, ROUND_OFF, &mut point).ok_or_else(not_finite)?;
        Ok(Iterated {
            answer: Answer {
                elements: symmetric(&x),
                printed: x,
            },
            converged,
            sweeps,
            spectral_radius: largest(eigenvalues.iter().map(|z| z.re.hypot(z.im))),
            free_directions: 6 - rank,
            fixed_point: (rank == 6).then_some(point),
        })
    }
}
