//! The triangle `R` with `R x = z + white noise`.

use crate::numbers::{NUMBERS, Numbers, PARAMETERS};
use crate::triangle::Triangle;
use core::ops::Range;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
#[cfg(feature = "std")]
use poinsot_dynamics::vectorised;

/// Rows of `[R z]`; `z` is in the last column.
pub type Rows<const N: usize> = [[f64; N]; N];

/// Zeroes columns in the rows that `below` gives of each by Householder reflections of the rows, which have `width` columns and `z`.
pub fn eliminate<const N: usize>(
    rows: &mut Rows<N>,
    pivots: Range<usize>,
    below: impl Fn(usize) -> Range<usize>,
    width: usize,
) {
    vectorised(
        #[inline(always)]
        || {
            for pivot in pivots {
                reflect(rows, pivot, below(pivot), width);
            }
        },
    );
}

#[cfg(not(feature = "std"))]
fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    work()
}

#[inline(always)]
fn reflect<const N: usize>(rows: &mut Rows<N>, pivot: usize, below: Range<usize>, width: usize) {
    let (above, rest) = rows.split_at_mut(below.start);
    let (top, rest) = (&mut above[pivot], &mut rest[..below.len()]);
    let square: f64 = rest.iter().map(|row| row[pivot] * row[pivot]).sum();
    if square == 0.0 {
        return;
    }
    let first = top[pivot];
    let norm = (first * first + square).sqrt();
    let signed = if first > 0.0 { -norm } else { norm };
    let lead = first - signed;
    let scale = -1.0 / (norm * (norm + first.abs()));
    let after = pivot + 1..width;
    let mut sums = [0.0; N];
    add(&mut sums, top, lead, &after);
    for row in &*rest {
        add(&mut sums, row, row[pivot], &after);
    }
    add(top, &sums, lead * scale, &after);
    top[pivot] = signed;
    for row in rest {
        let factor = core::mem::take(&mut row[pivot]);
        add(row, &sums, factor * scale, &after);
    }
}

/// Adds so many times a row to another one, in some columns and `z`.
#[inline(always)]
fn add<const N: usize>(to: &mut [f64; N], row: &[f64; N], factor: f64, columns: &Range<usize>) {
    let of_row = &row[columns.clone()];
    for (to, x) in to[columns.clone()].iter_mut().zip(of_row) {
        *to += factor * x;
    }
    to[N - 1] += factor * row[N - 1];
}

/// Copies the triangle of so many columns, and `z`.
pub fn copy_triangle<const N: usize>(from: &Rows<N>, to: &mut Rows<N>, columns: usize) {
    for (i, (from, to)) in from.iter().zip(to).enumerate().take(columns) {
        to[i..columns].copy_from_slice(&from[i..columns]);
        to[N - 1] = from[N - 1];
    }
}

/// Solves the triangle of columns `range` for `z` less what the columns after them take; `None` where a diagonal number is too
/// small.
pub fn back_substitute<const N: usize>(
    rows: &Rows<N>,
    range: Range<usize>,
    later: &Numbers,
    out: &mut [f64; N],
) -> Option<()> {
    for i in range.clone().rev() {
        let mut sum = rows[i][N - 1];
        for k in i + 1..range.end {
            sum -= rows[i][k] * out[k];
        }
        for (coefficient, x) in rows[i][range.end..N - 1].iter().zip(later) {
            sum -= coefficient * x;
        }
        let diagonal = rows[i][i];
        if diagonal.abs() < f64::MIN_POSITIVE {
            return None;
        }
        out[i] = sum / diagonal;
    }
    out[range].iter().all(|x| x.is_finite()).then_some(())
}

/// A triangle over the numbers that stay, and `z`.
#[derive(Debug, Clone, Copy)]
pub struct OfParameters {
    pub R: Triangle,
    pub z: Numbers,
}

// Sums over a triangle read best by their indices.
#[allow(clippy::needless_range_loop)]
impl OfParameters {
    pub const NONE: Self = Self::of(Triangle::ZERO);

    /// About zero.
    pub const fn of(R: Triangle) -> Self {
        Self {
            R,
            z: [0.0; NUMBERS],
        }
    }

    /// `R^-1 z` of the first `count`.
    pub fn solution(&self, count: usize) -> Option<Numbers> {
        let mut out = [0.0; NUMBERS];
        for i in (0..count).rev() {
            let mut sum = self.z[i];
            for k in i + 1..count {
                sum -= self.R[(i, k)] * out[k];
            }
            out[i] = sum / self.R[(i, i)];
        }
        out.iter().all(|x| x.is_finite()).then_some(out)
    }

    /// Square of `R x` over the first `count`: no number is off by more than its root in sigma.
    pub fn whitened(&self, x: &Numbers, count: usize) -> f64 {
        let row = |i: usize| (i..count).map(|j| self.R[(i, j)] * x[j]).sum::<f64>();
        (0..count).map(row).map(|y| y * y).sum()
    }

    /// Columns of `R^-1`, whose product with its transpose is the covariance.
    pub fn inverse(&self, count: usize) -> impl Iterator<Item = Numbers> {
        (0..count).map(|j| {
            let mut column = [0.0; NUMBERS];
            for i in (0..=j).rev() {
                let mut sum = if i == j { 1.0 } else { 0.0 };
                for k in i + 1..=j {
                    sum -= self.R[(i, k)] * column[k];
                }
                column[i] = sum / self.R[(i, i)];
            }
            column
        })
    }

    /// Covariance of the first `own`.
    pub fn covariance(&self, own: usize, count: usize) -> [[f64; PARAMETERS]; PARAMETERS] {
        let mut out = [[0.0; PARAMETERS]; PARAMETERS];
        for column in self.inverse(count) {
            for (row, a) in out.iter_mut().zip(&column[..own]) {
                for (sum, b) in row.iter_mut().zip(&column[..own]) {
                    *sum += a * b;
                }
            }
        }
        out
    }

    /// Sigma of each of the first `count`.
    pub fn sigma(&self, count: usize) -> Numbers {
        let mut out = [0.0; NUMBERS];
        for column in self.inverse(count) {
            for (sum, x) in out.iter_mut().zip(&column) {
                *sum += x * x;
            }
        }
        out.map(f64::sqrt)
    }
}
