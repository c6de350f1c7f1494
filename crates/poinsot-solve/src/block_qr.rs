//! Triangular factor of a tall matrix that is never stored: blocks of rows are added, and `R` is the result.
//!
//! Householder QR of `[R; block]`, block after block (sequential TSQR; Demmel, Grigori, Hoemmen, Langou 2012). Memory
//! does not depend on the number of rows. Normal equations are avoided, because they square the condition number.
//!
//! Three of the six rows of a momentum regressor are linear momentum, which does not depend on inertia. For an arm, 42
//! of their 70 columns are zero. These rows have a separate narrow triangle, which is merged at the end. This saves
//! nearly half of the arithmetic.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor;
use faer::{Mat, MatMut, Par};

/// Rows collected before the triangle is updated: many compared with the columns, few compared with the cache.
const BLOCK_ROWS: usize = 1008;
/// Rows that are filled column by column: few enough that all of them stay in the nearest cache.
const SIDE_BY_SIDE: usize = 16;
/// Householder vectors applied together.
const REFLECTORS: usize = 16;

/// Accumulates the triangular factor of `[A | b]` from blocks of rows.
///
/// ```
/// use poinsot_solve::BlockQr;
///
/// // One column (3, 4), in two blocks: its factor is its length.
/// let mut qr = BlockQr::new(1);
/// qr.push(1, |_, _| 3.0);
/// qr.push(1, |_, _| 4.0);
/// let triangle = qr.finish();
/// assert!((triangle.r[(0, 0)].abs() - 5.0).abs() < 1.0e-14);
/// assert_eq!(triangle.rows, 2);
/// ```
pub struct BlockQr {
    columns: usize,
    wide: Stack,
    linear: Option<Narrow>,
    rows: usize,
}

/// A triangle and, below it, rows not yet included.
struct Stack {
    matrix: Mat<f64>,
    /// Rows of the triangle: none before the first update. Zeros above the other rows would cost two digits:
    /// unobservable directions of an arm's drift gave 1e-13 of the longest column instead of 1e-15.
    triangle: usize,
    pending: usize,
    coefficients: Mat<f64>,
    memory: MemBuffer,
}

/// The linear rows, restricted to their nonzero columns.
struct Narrow {
    /// Whether each column of the whole is included.
    holds: Vec<bool>,
    stack: Stack,
}

impl BlockQr {
    /// An empty factor for rows of this many columns (right-hand side included).
    pub fn new(columns: usize) -> Self {
        Self {
            columns,
            wide: Stack::new(columns),
            linear: None,
            rows: 0,
        }
    }

    /// Adds `rows` rows; `value(i, j)` is called once for every row and column.
    #[inline]
    pub fn push(&mut self, rows: usize, mut value: impl FnMut(usize, usize) -> f64) {
        let mut first = 0;
        while first < rows {
            let (at, some) = self.wide.room_for_some((rows - first).min(SIDE_BY_SIDE));
            for j in 0..self.columns {
                let target = self.wide.matrix.col_as_slice_mut(j);
                for (i, x) in target[at..at + some].iter_mut().enumerate() {
                    *x = value(first + i, j);
                }
            }
            first += some;
        }
        self.rows += rows;
    }

    /// Adds rows of one number each, on the diagonal.
    pub fn push_diagonal(&mut self, rows: usize, value: impl Fn(usize) -> f64) {
        self.push(rows, |i, j| if i == j { value(i) } else { 0.0 });
    }

    /// Adds six rows given as columns of six elements, as in a momentum regressor, linear part first. Missing columns
    /// count as zero.
    #[inline]
    pub fn push_six(&mut self, columns: &[[f64; 6]]) {
        let columns = columns.get(..self.columns).unwrap_or(columns);
        let fits = self.linear.as_ref().is_some_and(|n| n.covers(columns));
        if !fits {
            self.widen(columns);
        }
        let at = self.wide.room(3);
        let all = columns.iter().chain(std::iter::repeat(&[0.0; 6]));
        for (j, column) in all.clone().take(self.columns).enumerate() {
            self.wide.set_three(at, j, &column[3..]);
        }
        if let Some(narrow) = &mut self.linear {
            let at = narrow.stack.room(3);
            let held = all.zip(&narrow.holds).filter(|(_, held)| **held);
            for (j, (column, _)) in held.enumerate() {
                narrow.stack.set_three(at, j, &column[..3]);
            }
        }
        self.rows += 6;
    }

    /// Extends the narrow triangle to every nonzero column of these linear rows.
    #[cold]
    fn widen(&mut self, columns: &[[f64; 6]]) {
        let mut holds: Vec<bool> = columns.iter().map(linear_part).collect();
        holds.resize(self.columns, false);
        if let Some(old) = &self.linear {
            for (h, before) in holds.iter_mut().zip(&old.holds) {
                *h |= before;
            }
        }
        self.join();
        let width = holds.iter().filter(|h| **h).count();
        self.linear = Some(Narrow {
            holds,
            stack: Stack::new(width),
        });
    }

    /// Merges the narrow triangle into the wide one.
    fn join(&mut self) {
        let Some(mut narrow) = self.linear.take() else {
            return;
        };
        narrow.stack.fold();
        for i in 0..narrow.stack.matrix.ncols() {
            let at = self.wide.room(1);
            let mut k = 0;
            for (j, held) in narrow.holds.iter().enumerate() {
                self.wide.matrix[(at, j)] = if *held {
                    k += 1;
                    narrow.stack.matrix[(i, k - 1)]
                } else {
                    0.0
                };
            }
        }
    }

    /// Merges another factor of the same columns.
    pub fn merge(&mut self, other: &Triangle) {
        let r = &other.r;
        self.push(r.nrows(), |i, j| r[(i, j)]);
        self.rows = self.rows - r.nrows() + other.rows;
    }

    /// The triangular factor of all rows so far.
    pub fn finish(mut self) -> Triangle {
        self.join();
        self.wide.fold();
        let r = self.wide.matrix.as_ref().subrows(0, self.columns);
        Triangle {
            r: r.to_owned(),
            rows: self.rows,
        }
    }
}

impl Narrow {
    #[inline]
    fn covers(&self, columns: &[[f64; 6]]) -> bool {
        columns
            .iter()
            .zip(&self.holds)
            .all(|(column, held)| *held || !linear_part(column))
    }
}

/// Whether the linear rows of a column are nonzero (NaN counts as nonzero).
#[inline]
fn linear_part(column: &[f64; 6]) -> bool {
    column[..3] != [0.0; 3]
}

impl Stack {
    fn new(columns: usize) -> Self {
        let rows = columns + BLOCK_ROWS;
        let block = REFLECTORS.min(columns.max(1));
        let scratch =
            factor::qr_in_place_scratch::<f64>(rows, columns, block, Par::Seq, Default::default());
        Self {
            matrix: Mat::zeros(rows, columns),
            triangle: 0,
            pending: 0,
            coefficients: Mat::zeros(block, columns),
            memory: MemBuffer::new(scratch),
        }
    }

    /// Index of the next rows, after an update if the block is full.
    #[inline]
    fn room(&mut self, rows: usize) -> usize {
        if self.pending + rows > BLOCK_ROWS {
            self.fold();
        }
        let at = self.triangle + self.pending;
        self.pending += rows;
        at
    }

    /// The same for at least one of so many rows: how many there is room for.
    #[inline]
    fn room_for_some(&mut self, rows: usize) -> (usize, usize) {
        let left = BLOCK_ROWS - self.pending;
        let some = if left == 0 { rows } else { rows.min(left) };
        (self.room(some), some)
    }

    #[inline]
    fn set_three(&mut self, at: usize, column: usize, values: &[f64]) {
        let target = self.matrix.col_as_slice_mut(column);
        if let Some(target) = target.get_mut(at..at + 3) {
            target.copy_from_slice(values);
        }
    }

    fn fold(&mut self) {
        let columns = self.matrix.ncols();
        if self.pending == 0 || columns == 0 {
            self.pending = 0;
            return;
        }
        // With fewer rows than columns, the rest of the first triangle is still zero.
        let rows = (self.triangle + self.pending).max(columns);
        let block: MatMut<f64> = self.matrix.as_mut().subrows_mut(0, rows);
        factor::qr_in_place(
            block,
            self.coefficients.as_mut(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        // Householder vectors are stored below the diagonal: clear them in the triangle. The rows below are
        // overwritten before they are used.
        for j in 0..columns {
            self.matrix.col_as_slice_mut(j)[j + 1..columns].fill(0.0);
        }
        self.triangle = columns;
        self.pending = 0;
    }
}

/// An upper-triangular factor and the number of rows behind it.
#[derive(Debug, Clone)]
pub struct Triangle {
    /// The factor, square.
    pub r: Mat<f64>,
    /// Number of rows of the matrix.
    pub rows: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six-row samples with a deterministic pattern; linear rows only in the chosen columns.
    fn sample(k: usize, columns: usize, linear: impl Fn(usize) -> bool) -> Vec<[f64; 6]> {
        let value = |r: usize, j: usize| ((k * 61 + r * 17 + j * 29 + k * j * 7) as f64).sin();
        (0..columns)
            .map(|j| {
                [0, 1, 2, 3, 4, 5].map(|r| {
                    if r < 3 && !linear(j) {
                        0.0
                    } else {
                        value(r, j)
                    }
                })
            })
            .collect()
    }

    /// `R^T R` must equal the sum of the outer products of the rows.
    fn check(columns: usize, samples: &[Vec<[f64; 6]>]) {
        let mut qr = BlockQr::new(columns);
        for s in samples {
            qr.push_six(s);
        }
        let triangle = qr.finish();
        assert_eq!(triangle.rows, 6 * samples.len());
        for a in 0..columns {
            for b in 0..columns {
                let dot = |s: &Vec<[f64; 6]>| (0..6).map(|r| s[a][r] * s[b][r]).sum::<f64>();
                let want: f64 = samples.iter().map(dot).sum();
                let got: f64 = (0..columns)
                    .map(|i| triangle.r[(i, a)] * triangle.r[(i, b)])
                    .sum();
                let scale = 6.0 * samples.len() as f64;
                assert!(
                    (got - want).abs() < 1.0e-13 * scale,
                    "{a} {b}: {got} {want}"
                );
                assert!(a <= b || triangle.r[(a, b)] == 0.0);
            }
        }
    }

    #[test]
    fn exact_gram_matrix_with_linear_rows_zero_in_some_columns() {
        let samples: Vec<_> = (0..1500).map(|k| sample(k, 13, |j| j % 3 == 0)).collect();
        check(13, &samples);
    }

    #[test]
    fn exact_gram_matrix_without_any_linear_part_or_without_zeros() {
        let none: Vec<_> = (0..700).map(|k| sample(k, 5, |_| false)).collect();
        check(5, &none);
        let full: Vec<_> = (0..700).map(|k| sample(k, 5, |_| true)).collect();
        check(5, &full);
    }

    #[test]
    fn exact_gram_matrix_where_columns_appear_late() {
        let samples: Vec<_> = (0..900).map(|k| sample(k, 9, |j| j < k / 100)).collect();
        check(9, &samples);
    }

    #[test]
    fn exact_nothing_in_is_a_zero_triangle() {
        let triangle = BlockQr::new(4).finish();
        assert!((0..4).all(|j| (0..4).all(|i| triangle.r[(i, j)] == 0.0)));
    }
}
