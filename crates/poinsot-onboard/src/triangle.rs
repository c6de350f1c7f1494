//! An upper triangle without its zeros.

use crate::numbers::NUMBERS;
use core::ops::{Index, IndexMut};

/// An upper triangle over the numbers that stay, column by column: `R[(i, j)]` with `i <= j`.
///
/// ```
/// let mut R = poinsot_onboard::Triangle::ZERO;
/// R[(3, 5)] = 0.5;
/// assert_eq!((R[(3, 5)], R[(5, 5)]), (0.5, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle(pub [f64; NUMBERS * (NUMBERS + 1) / 2]);

impl Triangle {
    /// All zero.
    pub const ZERO: Self = Self([0.0; NUMBERS * (NUMBERS + 1) / 2]);
}

impl Index<(usize, usize)> for Triangle {
    type Output = f64;

    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.0[j * (j + 1) / 2 + i]
    }
}

impl IndexMut<(usize, usize)> for Triangle {
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.0[j * (j + 1) / 2 + i]
    }
}
