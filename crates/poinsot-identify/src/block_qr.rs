//! Triangular factor of a tall matrix that is never held: blocks of rows go in, `R` comes out.
//!
//! Householder QR of `[R; block]`, block after block (sequential TSQR; Demmel, Grigori, Hoemmen,
//! Langou 2012). Memory does not grow with the number of rows. The normal equations are never formed:
//! they would square the condition number.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor;
use faer::{Mat, MatMut, Par};

/// Rows taken before the triangle is updated: large against the columns, small against the cache.
const BLOCK_ROWS: usize = 504;
/// Householder vectors applied together.
const REFLECTORS: usize = 16;

/// Accumulates the triangular factor of `[A | b]` from blocks of rows.
pub struct BlockQr {
    columns: usize,
    /// The triangle in its first `columns` rows, then the rows still to be folded in.
    stack: Mat<f64>,
    pending: usize,
    coefficients: Mat<f64>,
    memory: MemBuffer,
    rows: usize,
}

impl BlockQr {
    /// An empty factor for rows of this many columns (right-hand side included).
    pub fn new(columns: usize) -> Self {
        let rows = columns + BLOCK_ROWS;
        let block = REFLECTORS.min(columns.max(1));
        let scratch =
            factor::qr_in_place_scratch::<f64>(rows, columns, block, Par::Seq, Default::default());
        Self {
            columns,
            stack: Mat::zeros(rows, columns),
            pending: 0,
            coefficients: Mat::zeros(block, columns),
            memory: MemBuffer::new(scratch),
            rows: 0,
        }
    }

    /// Adds `rows` rows; `value(i, j)` is called once for every row and column.
    pub fn push(&mut self, rows: usize, mut value: impl FnMut(usize, usize) -> f64) {
        for i in 0..rows {
            if self.pending == BLOCK_ROWS {
                self.fold();
            }
            let at = self.columns + self.pending;
            for j in 0..self.columns {
                self.stack[(at, j)] = value(i, j);
            }
            self.pending += 1;
        }
        self.rows += rows;
    }

    /// Adds six rows given as columns of six: the layout of a momentum regressor.
    #[inline]
    pub fn push_six(&mut self, columns: &[[f64; 6]]) {
        if self.pending + 6 > BLOCK_ROWS {
            self.fold();
        }
        let at = self.columns + self.pending;
        for (j, column) in columns.iter().enumerate().take(self.columns) {
            let target = self.stack.col_as_slice_mut(j);
            if let Some(target) = target.get_mut(at..at + 6) {
                target.copy_from_slice(column);
            }
        }
        self.pending += 6;
        self.rows += 6;
    }

    fn fold(&mut self) {
        let rows = self.columns + self.pending;
        let block: MatMut<f64> = self.stack.as_mut().subrows_mut(0, rows);
        factor::qr_in_place(
            block,
            self.coefficients.as_mut(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        // Below the diagonal stand the Householder vectors: clear them, only the triangle goes on.
        for j in 0..self.columns {
            self.stack.col_as_slice_mut(j)[j + 1..].fill(0.0);
        }
        self.pending = 0;
    }

    /// Folds another factor of the same columns in.
    pub fn merge(&mut self, other: &Triangle) {
        let r = &other.r;
        self.push(r.nrows(), |i, j| r[(i, j)]);
        self.rows = self.rows - r.nrows() + other.rows;
    }

    /// The triangular factor of all rows so far.
    pub fn finish(mut self) -> Triangle {
        self.fold();
        Triangle {
            r: self.stack.as_ref().subrows(0, self.columns).to_owned(),
            rows: self.rows,
        }
    }
}

/// An upper-triangular factor and the number of rows it stands for.
#[derive(Debug, Clone)]
pub struct Triangle {
    /// The factor, square.
    pub r: Mat<f64>,
    /// Rows of the matrix it came from.
    pub rows: usize,
}
