//! The Kalman filter of the errors: their covariance, and what samples tell of them.

use poinsot_spatial::{Matrix3, Vector3};

/// Rows of a matrix by their elements that are not zero, one row behind the other.
#[derive(Default)]
pub(super) struct SparseRows {
    elements: Vec<(usize, f64)>,
    /// Where each row ends.
    ends: Vec<usize>,
}

impl SparseRows {
    pub(super) fn clear(&mut self) {
        self.elements.clear();
        self.ends.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(super) fn push(&mut self, row: impl IntoIterator<Item = (usize, f64)>) {
        self.elements.extend(row);
        self.ends.push(self.elements.len());
    }

    pub(super) fn push_dense(&mut self, row: &[f64]) {
        let pairs = row.iter().copied().enumerate();
        self.push(pairs.filter(|(_, f)| *f != 0.0));
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        let begins = std::iter::once(0).chain(self.ends.iter().copied());
        let places = begins.zip(&self.ends);
        places.map(|(begin, end)| &self.elements[begin..*end])
    }
}

/// Covariance of the errors, and their mean for every sequence.
#[derive(Default)]
pub(super) struct Filter {
    pub(super) size: usize,
    /// Row by row.
    pub(super) covariance: Vec<f64>,
    /// One row for each error, with its mean for every sequence.
    pub(super) means: Vec<f64>,
    pub(super) followed: usize,
    pub(super) scratch: Vec<f64>,
    /// New means.
    pub(super) next: Vec<f64>,
    /// The sample in hand: correlation of the errors with it, gains, and its rows axis by axis.
    pub(super) correlation: Vec<Vector3>,
    pub(super) gains: Vec<Vector3>,
    pub(super) axes: [Vec<f64>; 3],
}

/// `to += from * factor`, element by element.
fn add_scaled(to: &mut [f64], from: &[f64], factor: f64) {
    to.iter_mut().zip(from).for_each(|(t, f)| *t += f * factor);
}

impl Filter {
    pub(super) fn new(size: usize, followed: usize) -> Self {
        Self {
            size,
            followed,
            covariance: vec![0.0; size * size],
            means: vec![0.0; size * followed],
            scratch: vec![0.0; size * size],
            next: vec![0.0; size * followed],
            axes: std::array::from_fn(|_| vec![0.0; followed]),
            ..Self::default()
        }
    }

    pub(super) fn add_outer(&mut self, vector: &[f64], variance: f64) {
        for (row, a) in self.covariance.chunks_exact_mut(self.size).zip(vector) {
            if *a != 0.0 {
                row.iter_mut()
                    .zip(vector)
                    .for_each(|(p, b)| *p += a * b * variance);
            }
        }
    }

    /// More variance of one component.
    pub(super) fn add(&mut self, at: usize, variance: f64) {
        self.covariance[at * self.size + at] += variance;
    }

    /// `P = F P F^T`, and every mean `F m`: the upper rows of `F` are given, below it is diagonal.
    pub(super) fn advance(&mut self, upper: &[f64], faded: &[f64]) {
        let size = self.size;
        let n = size - faded.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let product = &mut self.scratch;
        for (i, out) in product.chunks_exact_mut(size).enumerate().take(n) {
            out.fill(0.0);
            let rows = self.covariance.chunks_exact(size);
            for (f, row) in upper[i * size..(i + 1) * size].iter().zip(rows) {
                out.iter_mut().zip(row).for_each(|(o, p)| *o += f * p);
            }
        }
        for (i, row) in product.chunks_exact(size).enumerate().take(n) {
            for (j, f) in upper.chunks_exact(size).enumerate().take(i + 1) {
                let p = dot(row, f);
                self.covariance[i * size + j] = p;
                self.covariance[j * size + i] = p;
            }
            for (j, a) in faded.iter().enumerate() {
                let p = row[n + j] * a;
                self.covariance[i * size + n + j] = p;
                self.covariance[(n + j) * size + i] = p;
            }
        }
        for (i, a) in faded.iter().enumerate() {
            let own = &mut self.covariance[(n + i) * size + n..(n + i + 1) * size];
            own.iter_mut().zip(faded).for_each(|(p, b)| *p *= a * b);
        }
        let followed = self.followed.max(1);
        let next = self.next.chunks_exact_mut(followed);
        for (out, f) in next.zip(upper.chunks_exact(size)) {
            out.fill(0.0);
            let means = self.means.chunks_exact(followed);
            for (mean, f) in means.zip(f).filter(|(_, f)| **f != 0.0) {
                add_scaled(out, mean, *f);
            }
        }
        let (first, rest) = self.means.split_at_mut(n * self.followed);
        first.copy_from_slice(&self.next[..n * self.followed]);
        for (mean, a) in rest.chunks_exact_mut(followed).zip(faded) {
            mean.iter_mut().for_each(|m| *m *= a);
        }
    }

    /// The same for any `F`, row by row in elements that are not zero.
    pub(super) fn map(&mut self, rows: &SparseRows) {
        let size = self.size;
        for (row, out) in rows.iter().zip(self.scratch.chunks_exact_mut(size)) {
            out.fill(0.0);
            for (k, f) in row {
                let from = &self.covariance[k * size..(k + 1) * size];
                out.iter_mut().zip(from).for_each(|(o, p)| *o += f * p);
            }
        }
        let dot = |row: &[(usize, f64)], x: &[f64]| row.iter().map(|(k, f)| f * x[*k]).sum::<f64>();
        for (i, product) in self.scratch.chunks_exact(size).enumerate() {
            for (j, row) in rows.iter().enumerate().take(i + 1) {
                let p = dot(row, product);
                self.covariance[i * size + j] = p;
                self.covariance[j * size + i] = p;
            }
        }
        let followed = self.followed.max(1);
        for (out, row) in self.next.chunks_exact_mut(followed).zip(rows.iter()) {
            out.fill(0.0);
            for (k, f) in row {
                add_scaled(out, &self.means[k * followed..(k + 1) * followed], *f);
            }
        }
        std::mem::swap(&mut self.means, &mut self.next);
    }

    /// Correlates the errors with a sample, and gives the covariance that they add to it.
    pub(super) fn correlate(&mut self, slopes: &[Vector3]) -> Matrix3 {
        let rows = self.covariance.chunks_exact(self.size.max(1));
        self.correlation.clear();
        self.correlation
            .extend(rows.map(|row| weighted(row, slopes)));
        let pairs = slopes.iter().zip(&self.correlation);
        pairs.fold(Matrix3::zeros(), |sum, (a, b)| sum + a * b.transpose())
    }

    /// The last sequence at a sample, minus its prediction.
    pub(super) fn innovation(&self, slopes: &[Vector3], residual: Vector3) -> Vector3 {
        let last = self.followed.saturating_sub(1);
        let means = self.means.iter().skip(last).step_by(self.followed.max(1));
        let pairs = means.zip(slopes);
        residual - pairs.fold(Vector3::zeros(), |sum, (m, slope)| sum + slope * *m)
    }

    /// Whitens every row's innovation and updates the filter. `inverse_root` is `L^-1` of the covariance `L L^T` of the
    /// readings, noise of the sensor and of the inputs together.
    pub(super) fn take(
        &mut self,
        slopes: &[Vector3],
        inverse_root: &Matrix3,
        rows: &mut [Vector3],
    ) {
        let n = self.size;
        if n == 0 {
            rows.iter_mut().for_each(|row| *row = inverse_root * *row);
            return;
        }
        let followed = self.followed.max(1);
        self.gains.clear();
        self.gains
            .extend(self.correlation.iter().map(|c| inverse_root * c));
        for (k, axis) in self.axes.iter_mut().enumerate() {
            axis.iter_mut().zip(&*rows).for_each(|(x, row)| *x = row[k]);
            for (mean, slope) in self.means.chunks_exact(followed).zip(slopes) {
                add_scaled(axis, mean, -slope[k]);
            }
        }
        let [x, y, z] = &mut self.axes;
        let axes = x.iter_mut().zip(y.iter_mut()).zip(z.iter_mut());
        for (((x, y), z), row) in axes.zip(&mut *rows) {
            *row = inverse_root * Vector3::new(*x, *y, *z);
            (*x, *y, *z) = (row.x, row.y, row.z);
        }
        for (mean, gain) in self.means.chunks_exact_mut(followed).zip(&self.gains) {
            let axes = x.iter().zip(y.iter()).zip(z.iter());
            for (m, ((x, y), z)) in mean.iter_mut().zip(axes) {
                *m += gain.x * x + gain.y * y + gain.z * z;
            }
        }
        for (row, a) in self.covariance.chunks_exact_mut(n).zip(&self.gains) {
            row.iter_mut()
                .zip(&self.gains)
                .for_each(|(p, b)| *p -= a.dot(b));
        }
    }
}

fn weighted(weights: &[f64], slopes: &[Vector3]) -> Vector3 {
    weights
        .iter()
        .zip(slopes)
        .fold(Vector3::zeros(), |sum, (w, slope)| sum + slope * *w)
}
