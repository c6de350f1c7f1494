//! The Kalman filter of the errors: their covariance, and what samples tell of them.
//!
//! Rows of the covariance and of the means are padded with zeros to whole vectors, and the loops over them are compiled for
//! the vector instructions of the machine. The order of every sum is that of plain loops: the bits do not depend on it.

use super::smoother::Trace;
use super::sparse::SparseRows;
use poinsot_dynamics::vectorised;
use poinsot_spatial::{Matrix3, Vector3};

/// Numbers in a whole vector: those of the widest registers.
const LANES: usize = 8;
type Lanes = [f64; LANES];

/// A matrix whose rows are padded to whole vectors.
#[derive(Default)]
struct PaddedRows {
    /// Vectors in a row.
    width: usize,
    lanes: Vec<Lanes>,
}

impl PaddedRows {
    fn new(rows: usize, columns: usize) -> Self {
        let width = columns.div_ceil(LANES);
        Self {
            width,
            lanes: vec![[0.0; LANES]; rows * width],
        }
    }

    #[inline(always)]
    fn row(&self, i: usize) -> &[Lanes] {
        &self.lanes[i * self.width..(i + 1) * self.width]
    }

    #[inline(always)]
    fn row_mut(&mut self, i: usize) -> &mut [Lanes] {
        &mut self.lanes[i * self.width..(i + 1) * self.width]
    }

    #[inline(always)]
    fn at(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.row_mut(i).as_flattened_mut()[j]
    }

    /// An element and its mirror image.
    #[inline(always)]
    fn set_both(&mut self, i: usize, j: usize, value: f64) {
        *self.at(i, j) = value;
        *self.at(j, i) = value;
    }

    /// Row `i` becomes the sum of rows of another matrix by their factors.
    #[inline(always)]
    fn combine(
        &mut self,
        i: usize,
        from: &Self,
        factors: impl Iterator<Item = (usize, f64)> + Clone,
    ) {
        for (c, out) in self.row_mut(i).iter_mut().enumerate() {
            let mut sum = [0.0; LANES];
            for (k, f) in factors.clone() {
                add_scaled(&mut sum, &from.row(k)[c], f);
            }
            *out = sum;
        }
    }
}

/// Covariance of the errors, and their mean for every sequence.
#[derive(Default)]
pub(super) struct Filter {
    pub(super) size: usize,
    covariance: PaddedRows,
    /// One row for each error, with its mean for every sequence.
    means: PaddedRows,
    followed: usize,
    /// `F P`.
    product: PaddedRows,
    /// New means.
    next: PaddedRows,
    /// The sample in hand, axis by axis: correlation of the errors with it, and gains.
    correlation: Vec<[Lanes; 3]>,
    gain_axes: Vec<[Lanes; 3]>,
    /// The gains error by error.
    gains: Vec<Vector3>,
    /// What was done, where a backward pass follows.
    pub(super) trace: Option<Trace>,
}

/// `to += from * factor`, element by element.
#[inline(always)]
fn add_scaled(to: &mut Lanes, from: &Lanes, factor: f64) {
    for (t, f) in to.iter_mut().zip(from) {
        *t += f * factor;
    }
}

impl Filter {
    pub(super) fn new(size: usize, followed: usize, records: bool) -> Self {
        let covariance = PaddedRows::new(size, size);
        let axes = vec![[[0.0; LANES]; 3]; covariance.width];
        Self {
            size,
            followed,
            correlation: axes.clone(),
            gain_axes: axes,
            gains: vec![Vector3::zeros(); size],
            covariance,
            means: PaddedRows::new(size, followed),
            product: PaddedRows::new(size, size),
            next: PaddedRows::new(size, followed),
            trace: records.then(Trace::default),
        }
    }

    /// Mean of an error for the last sequence.
    pub(super) fn mean(&self, i: usize) -> f64 {
        let last = self.followed.saturating_sub(1);
        self.means.row(i).as_flattened()[last]
    }

    /// Adds to that mean.
    pub(super) fn add_mean(&mut self, i: usize, more: f64) {
        let last = self.followed.saturating_sub(1);
        *self.means.at(i, last) += more;
    }

    pub(super) fn covariance_row(&self, i: usize) -> &[f64] {
        &self.covariance.row(i).as_flattened()[..self.size]
    }

    /// Numbers from row to row of a matrix whose rows [`SparseRows::push_dense`] takes.
    pub(super) fn stride(&self) -> usize {
        self.covariance.width * LANES
    }

    /// Adds the outer product of a vector with itself times a variance.
    pub(super) fn add_outer(&mut self, vector: &[f64], variance: f64) {
        for (i, a) in vector.iter().enumerate().filter(|(_, a)| **a != 0.0) {
            let row = self.covariance.row_mut(i).as_flattened_mut();
            row.iter_mut()
                .zip(vector)
                .for_each(|(p, b)| *p += a * b * variance);
        }
    }

    /// Adds the covariance of `width` errors from place `own` on. Each error in `moved` moves as many of the first components, and the
    /// first of them also does so within the interval, with a variance of its own.
    pub(super) fn add_errors(
        &mut self,
        (moved, reached, within): (&[f64], usize, f64),
        (own, width): (usize, usize),
        new: &Matrix3,
    ) {
        for (m, first) in moved.chunks_exact(reached.max(1)).enumerate() {
            for (i, a) in first.iter().enumerate() {
                let row = self.covariance.row_mut(i).as_flattened_mut();
                for (n, second) in moved.chunks_exact(reached).enumerate() {
                    let variance = new[(m, n)] + if m + n == 0 { within } else { 0.0 };
                    let both = row.iter_mut().zip(second);
                    both.for_each(|(p, b)| *p += a * b * variance);
                }
                for j in 0..width {
                    row[own + j] += a * new[(m, j)];
                }
                for j in 0..width {
                    *self.covariance.at(own + j, i) += a * new[(m, j)];
                }
            }
        }
        for (i, j) in (0..width).flat_map(|i| (0..width).map(move |j| (i, j))) {
            *self.covariance.at(own + i, own + j) += new[(i, j)];
        }
    }

    /// More covariance of two components.
    pub(super) fn add(&mut self, (i, j): (usize, usize), covariance: f64) {
        *self.covariance.at(i, j) += covariance;
    }

    /// `P = F P F^T`, and every mean `F m`: `F` row by row in elements that are not zero.
    pub(super) fn map(&mut self, rows: &SparseRows) {
        if let Some(trace) = &mut self.trace {
            trace.carried(rows.clone());
        }
        vectorised(
            #[inline(always)]
            || self.map_rows(rows),
        );
    }

    #[inline(always)]
    fn map_rows(&mut self, rows: &SparseRows) {
        for (i, row) in rows.iter().enumerate() {
            let factors = row.iter().copied();
            self.product.combine(i, &self.covariance, factors.clone());
            self.next.combine(i, &self.means, factors);
        }
        let dot = |row: &[(usize, f64)], x: &[f64]| row.iter().map(|(k, f)| f * x[*k]).sum::<f64>();
        for i in 0..self.size {
            let product = self.product.row(i).as_flattened();
            for (j, row) in rows.iter().enumerate().take(i + 1) {
                self.covariance.set_both(i, j, dot(row, product));
            }
        }
        std::mem::swap(&mut self.means, &mut self.next);
    }

    /// Correlates the errors with a sample, and gives the covariance that they add to it.
    pub(super) fn correlate(&mut self, slopes: &[Vector3]) -> Matrix3 {
        vectorised(
            #[inline(always)]
            || self.correlate_rows(slopes),
        );
        self.correlated(slopes, 0)
    }

    /// What the errors from a place on add to that covariance.
    pub(super) fn correlated(&self, slopes: &[Vector3], first: usize) -> Matrix3 {
        let mut sum = Matrix3::zeros();
        for (i, slope) in slopes.iter().enumerate().take(self.size).skip(first) {
            sum += slope * of_error(&self.correlation, i).transpose();
        }
        sum
    }

    #[inline(always)]
    fn correlate_rows(&mut self, slopes: &[Vector3]) {
        let width = self.covariance.width;
        for (c, out) in self.correlation.iter_mut().enumerate() {
            let [mut x, mut y, mut z] = [[0.0; LANES]; 3];
            // The covariance is symmetric: its rows are its columns.
            let rows = self.covariance.lanes.iter().skip(c).step_by(width);
            for (row, slope) in rows.zip(slopes) {
                add_scaled(&mut x, row, slope.x);
                add_scaled(&mut y, row, slope.y);
                add_scaled(&mut z, row, slope.z);
            }
            *out = [x, y, z];
        }
    }

    /// The last sequence at a sample, minus its prediction.
    pub(super) fn innovation(&self, slopes: &[Vector3], residual: Vector3) -> Vector3 {
        let mut sum = Vector3::zeros();
        for (i, slope) in slopes.iter().enumerate().take(self.size) {
            sum += slope * self.mean(i);
        }
        residual - sum
    }

    /// Whitens every row's innovation and updates the filter. `inverse_root` is `L^-1` of the covariance `L L^T` of the
    /// readings, noise of the sensor and of the inputs together.
    pub(super) fn take(
        &mut self,
        slopes: &[Vector3],
        inverse_root: &Matrix3,
        rows: &mut [Vector3],
    ) {
        if self.size == 0 {
            rows.iter_mut().for_each(|row| *row = inverse_root * *row);
            return;
        }
        vectorised(
            #[inline(always)]
            || {
                self.set_gains(inverse_root);
                self.take_rows(slopes, inverse_root, rows);
                self.take_covariance();
            },
        );
        if let Some(trace) = &mut self.trace {
            trace.taken((slopes, &self.gains), inverse_root, rows.last());
        }
    }

    #[inline(always)]
    fn take_rows(&mut self, slopes: &[Vector3], L: &Matrix3, rows: &mut [Vector3]) {
        let width = self.means.width;
        for (c, rows) in rows.chunks_mut(LANES).enumerate() {
            let [mut x, mut y, mut z] = [[0.0; LANES]; 3];
            for (l, row) in rows.iter().enumerate() {
                (x[l], y[l], z[l]) = (row.x, row.y, row.z);
            }
            let means = self.means.lanes.iter().skip(c).step_by(width);
            for (mean, slope) in means.zip(slopes) {
                add_scaled(&mut x, mean, -slope.x);
                add_scaled(&mut y, mean, -slope.y);
                add_scaled(&mut z, mean, -slope.z);
            }
            for l in 0..LANES {
                z[l] = L[(2, 0)] * x[l] + L[(2, 1)] * y[l] + L[(2, 2)] * z[l];
                y[l] = L[(1, 0)] * x[l] + L[(1, 1)] * y[l];
                x[l] *= L[(0, 0)];
            }
            for (l, row) in rows.iter_mut().enumerate() {
                *row = Vector3::new(x[l], y[l], z[l]);
            }
            let means = self.means.lanes.iter_mut().skip(c).step_by(width);
            for (mean, gain) in means.zip(&self.gains) {
                for l in 0..LANES {
                    mean[l] += gain.x * x[l] + gain.y * y[l] + gain.z * z[l];
                }
            }
        }
    }

    #[inline(always)]
    fn take_covariance(&mut self) {
        let width = self.covariance.width;
        let rows = self.covariance.lanes.chunks_exact_mut(width);
        for (row, gain) in rows.zip(&self.gains) {
            let axes = self.gain_axes.iter();
            for (p, [x, y, z]) in row.iter_mut().zip(axes) {
                for l in 0..LANES {
                    p[l] -= gain.x * x[l] + gain.y * y[l] + gain.z * z[l];
                }
            }
        }
    }

    /// `L^-1` times the correlation, error by error and axis by axis.
    #[inline(always)]
    fn set_gains(&mut self, L: &Matrix3) {
        let axes = self.gain_axes.iter_mut().zip(&self.correlation);
        for ([a, b, c], [x, y, z]) in axes {
            for l in 0..LANES {
                a[l] = L[(0, 0)] * x[l];
                b[l] = L[(1, 0)] * x[l] + L[(1, 1)] * y[l];
                c[l] = L[(2, 0)] * x[l] + L[(2, 1)] * y[l] + L[(2, 2)] * z[l];
            }
        }
        for (i, gain) in self.gains.iter_mut().enumerate() {
            *gain = of_error(&self.gain_axes, i);
        }
    }
}

/// The three numbers of an error.
#[inline(always)]
fn of_error(axes: &[[Lanes; 3]], i: usize) -> Vector3 {
    let [x, y, z] = &axes[i / LANES];
    let l = i % LANES;
    Vector3::new(x[l], y[l], z[l])
}
