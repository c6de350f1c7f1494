//! Least squares over ten unknowns and the preceding momentum, by block triangularisation.

use faer::Mat;
use poinsot_solve::BlockQr;

/// Singular values below this fraction of the largest are round-off.
const ROUND_OFF: f64 = 1.0e-13;

/// Rows of `[momentum | unknowns | right-hand side]`.
pub(super) struct Rows {
    qr: BlockQr,
    head: usize,
    unknowns: usize,
    columns: Vec<f64>,
}

impl Rows {
    pub fn new(head: usize, unknowns: usize) -> Self {
        Self {
            qr: BlockQr::new(head + unknowns + 1),
            head,
            unknowns,
            columns: vec![0.0; head + unknowns + 1],
        }
    }

    /// Adds the row `left x = right`; elements of `left` beyond the columns are ignored.
    pub fn push(&mut self, left: &[f64], right: f64) {
        let n = self.head + self.unknowns;
        self.columns[..n].copy_from_slice(&left[..n]);
        self.columns[n] = right;
        let row = &self.columns;
        self.qr.push(1, |_, j| row[j]);
    }
}

/// A solution with its rank and singular values.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer<T> {
    /// The solution.
    pub value: T,
    /// Singular values in natural units, descending.
    pub singular: Vec<f64>,
    /// Number of directions that differ from nominal.
    pub rank: usize,
    /// Whether all numbers in the equations were finite.
    pub finite: bool,
}

impl<T> Answer<T> {
    pub(super) fn map<U>(self, of: impl FnOnce(T) -> U) -> Answer<U> {
        Answer {
            value: of(self.value),
            singular: self.singular,
            rank: self.rank,
            finite: self.finite,
        }
    }
}

/// The solution nearest to nominal, in natural units. The columns of `seen` are the directions that may change.
pub(super) fn answer(
    rows: Rows,
    natural: &[f64],
    nominal: &[f64],
    seen: Option<&Mat<f64>>,
) -> Answer<Vec<f64>> {
    let (h, n) = (rows.head, rows.unknowns);
    let r = rows.qr.finish().r;
    let block = Mat::from_fn(n, n, |i, j| r[(h + i, h + j)] * natural[j]);
    let identity = Mat::<f64>::identity(n, n);
    let seen = seen.unwrap_or(&identity);
    let inside = &block * seen;
    let mut x = nominal.to_vec();
    let finite = (0..n).all(|i| {
        r[(h + i, h + n)].is_finite() && (0..inside.ncols()).all(|j| inside[(i, j)].is_finite())
    });
    let Some(svd) = finite.then(|| inside.thin_svd().ok()).flatten() else {
        return Answer {
            value: x,
            singular: Vec::new(),
            rank: 0,
            finite: false,
        };
    };
    let d = inside.ncols();
    let singular: Vec<f64> = (0..d).map(|k| svd.S()[k]).collect();
    let floor = ROUND_OFF * singular.first().copied().unwrap_or(0.0);
    let rank = singular.iter().filter(|s| **s > floor).count();
    let directions = seen * svd.V();
    // The second pass removes the round-off of the first.
    for _ in 0..2 {
        let left: Vec<f64> = (0..n)
            .map(|i| {
                let model: f64 = (0..n).map(|j| r[(h + i, h + j)] * x[j]).sum();
                r[(h + i, h + n)] - model
            })
            .collect();
        for k in 0..rank {
            let along: f64 = (0..n).map(|i| svd.U()[(i, k)] * left[i]).sum::<f64>() / singular[k];
            for j in 0..n {
                x[j] += natural[j] * directions[(j, k)] * along;
            }
        }
    }
    Answer {
        value: x,
        singular,
        rank,
        finite: true,
    }
}

/// The identifiable and the unobservable directions of rows of arbitrary motion, natural units, one column each.
pub(super) fn shown_and_hidden<const N: usize>(
    rows: &[[f64; N]],
    natural: &[f64],
) -> Option<(Mat<f64>, Mat<f64>)> {
    // Rows of zeros up to a square: fewer rows leave the other directions hidden.
    let element = |i: usize, j: usize| rows.get(i).map_or(0.0, |row| row[j] * natural[j]);
    let svd = Mat::from_fn(rows.len().max(N), N, element)
        .thin_svd()
        .ok()?;
    let k = (0..N)
        .take_while(|&k| svd.S()[k] > 1.0e-9 * svd.S()[0])
        .count();
    let columns =
        |from: usize, to: usize| Mat::from_fn(N, to - from, |i, j| svd.V()[(i, from + j)]);
    Some((columns(0, k), columns(k, N)))
}

/// The identifiable directions of rows of arbitrary motion.
pub(super) fn shown<const N: usize>(rows: &[[f64; N]], natural: &[f64]) -> Option<Mat<f64>> {
    shown_and_hidden(rows, natural).map(|d| d.0)
}

/// Minimum-norm least-squares solution of `A x = b`.
pub(super) fn smallest(A: &Mat<f64>, b: &[f64]) -> Option<Vec<f64>> {
    let svd = A.thin_svd().ok()?;
    let floor = 1.0e-9 * svd.S()[0];
    let mut x = vec![0.0; A.ncols()];
    for k in (0..A.nrows().min(A.ncols())).filter(|&k| svd.S()[k] > floor) {
        let along: f64 = (0..A.nrows()).map(|i| svd.U()[(i, k)] * b[i]).sum::<f64>() / svd.S()[k];
        for (j, x) in x.iter_mut().enumerate() {
            *x += svd.V()[(j, k)] * along;
        }
    }
    Some(x)
}
