//! Spread of samples, and systems of a few unknowns.

use faer::Mat;

/// Difference between the largest and the smallest number; minus infinity without one.
pub(crate) fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.fold(ends, |(low, high), x| (low.min(x), high.max(x)));
    high - low
}

/// Adds the least-squares solution of `A x = b` of smallest norm to `x`. Singular values below `floor` of the largest
/// count as zero. Returns the rank; `None` if a number is not finite.
pub(crate) fn add_smallest(A: &Mat<f64>, b: &[f64], floor: f64, x: &mut [f64]) -> Option<usize> {
    let svd = A.thin_svd().ok()?;
    let (U, S, V) = (svd.U(), svd.S(), svd.V());
    let most = A.nrows().min(A.ncols());
    let rank = (0..most).take_while(|k| S[*k] > floor * S[0]).count();
    for k in 0..rank {
        let along: f64 = b.iter().enumerate().map(|(i, b)| U[(i, k)] * b).sum();
        for (j, x) in x.iter_mut().enumerate() {
            *x += V[(j, k)] * along / S[k];
        }
    }
    Some(rank)
}
