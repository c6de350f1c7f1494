//! Least squares over ten unknowns and the preceding momentum, by block triangularisation.

use faer::Mat;
use poinsot_solve::BlockQr;

/// Singular values below this fraction of the largest are round-off.
const ROUND_OFF: f64 = 1.0e-13;

/// Rows of `[momentum | unknowns | right-hand side]`.
pub(super) struct Rows {
    qr: BlockQr,
    pub head: usize,
    pub unknowns: usize,
}

impl Rows {
    pub fn new(head: usize, unknowns: usize) -> Self {
        Self {
            qr: BlockQr::new(head + unknowns + 1),
            head,
            unknowns,
        }
    }

    /// Adds the row `left x = right`; elements of `left` beyond the columns are ignored.
    pub fn push(&mut self, left: &[f64], right: f64) {
        let n = self.head + self.unknowns;
        let value = |_, j: usize| if j < n { left[j] } else { right };
        self.qr.push(1, value);
    }
}

/// A solution with its rank and singular values.
#[derive(Debug, Clone, PartialEq, Default)]
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
    let finite = (0..n).all(|i| {
        r[(h + i, h + n)].is_finite() && (0..inside.ncols()).all(|j| inside[(i, j)].is_finite())
    });
    let mut answer = Answer {
        value: nominal.to_vec(),
        ..Answer::default()
    };
    let Some(svd) = finite.then(|| inside.thin_svd().ok()).flatten() else {
        return answer;
    };
    let singular: Vec<f64> = (0..inside.ncols()).map(|k| svd.S()[k]).collect();
    let floor = ROUND_OFF * singular.first().copied().unwrap_or(0.0);
    answer.rank = singular.iter().filter(|s| **s > floor).count();
    let directions = seen * svd.V();
    let x = &mut answer.value;
    // The second pass removes the round-off of the first.
    for _ in 0..2 {
        let rest = |i: usize| {
            let model: f64 = (0..n).map(|j| r[(h + i, h + j)] * x[j]).sum();
            r[(h + i, h + n)] - model
        };
        let rest: Vec<f64> = (0..n).map(rest).collect();
        for k in 0..answer.rank {
            let along: f64 = (0..n).map(|i| svd.U()[(i, k)] * rest[i]).sum::<f64>() / singular[k];
            for j in 0..n {
                x[j] += natural[j] * directions[(j, k)] * along;
            }
        }
    }
    (answer.singular, answer.finite) = (singular, true);
    answer
}

/// The identifiable and the unobservable directions of rows of arbitrary motion, natural units, one column each.
pub(super) fn shown_and_hidden<const N: usize>(
    rows: &[[f64; N]],
    natural: &[f64],
) -> Option<(Mat<f64>, Mat<f64>)> {
    // Rows of zeros up to a square: fewer rows leave the other directions hidden.
    let element = |i: usize, j: usize| rows.get(i).map_or(0.0, |row| row[j] * natural[j]);
    let matrix = Mat::from_fn(rows.len().max(N), N, element);
    let svd = matrix.thin_svd().ok()?;
    let seen = |&k: &usize| svd.S()[k] > 1.0e-9 * svd.S()[0];
    let k = (0..N).take_while(seen).count();
    let columns =
        |from: usize, to: usize| Mat::from_fn(N, to - from, |i, j| svd.V()[(i, from + j)]);
    Some((columns(0, k), columns(k, N)))
}

/// The identifiable directions of rows of arbitrary motion.
pub(super) fn shown<const N: usize>(rows: &[[f64; N]], natural: &[f64]) -> Option<Mat<f64>> {
    shown_and_hidden(rows, natural).map(|d| d.0)
}
