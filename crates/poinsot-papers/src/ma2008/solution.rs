//! A solved step in directions of natural units.

use super::solve::{Step, decompose};
use nalgebra::{SMatrix, SVector};

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
