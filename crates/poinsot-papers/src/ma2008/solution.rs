//! A solved step in directions of natural units, and the rows of step 2 at the solution.

use super::arm::Reading;
use super::equations::{AngularRows, angular_rows};
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

/// Rows of step 2 at the solution of step 1, and their derivative.
pub(super) struct AtSolution {
    pub(super) arm_mass: f64,
    pub(super) x: SVector<f64, 4>,
    pub(super) y1: SVector<f64, 7>,
}

impl AtSolution {
    pub(super) fn angular(&self, reading: &Reading) -> AngularRows {
        self.angular_at(reading, &self.x)
    }

    fn angular_at(&self, reading: &Reading, x: &SVector<f64, 4>) -> AngularRows {
        angular_rows(
            reading,
            self.arm_mass / x[0],
            &x.fixed_rows::<3>(1).into_owned(),
        )
    }

    /// `C = d(B y + g)/dx` by central differences; nearly exact, because `g` is almost quadratic.
    pub(super) fn slope(&self, reading: &Reading) -> SMatrix<f64, 3, 4> {
        let mut C = SMatrix::<f64, 3, 4>::zeros();
        for j in 0..4 {
            let h = if j == 0 { 1.0e-4 * self.x[0] } else { 1.0e-4 };
            let at = |sign: f64| {
                let mut x = self.x;
                x[j] += sign * h;
                self.angular_at(reading, &x) * self.y1
            };
            C.set_column(j, &((at(1.0) - at(-1.0)) / (2.0 * h)));
        }
        C
    }
}
