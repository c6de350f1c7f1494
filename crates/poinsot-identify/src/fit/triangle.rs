//! The triangle of the shared unknowns.

use crate::problem::parameters::{Parameters, Unknown};
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use poinsot_solve::{BlockQr, Triangle};

/// Triangle of the shared unknowns: nuisances of sensors and surroundings first, then mass properties, right-hand side last.
#[derive(Clone)]
pub(crate) struct SharedTriangle {
    pub r: Mat<f64>,
    /// Number of nuisances in front.
    pub nuisances: usize,
    /// Number of mass properties, spin inertias and thruster scales.
    pub mass: usize,
    /// Nuisances that do not move; none where the list is shorter.
    pub(super) held: Vec<bool>,
}

impl SharedTriangle {
    /// Puts the nuisances of a stacked triangle in front: the rest is projected orthogonal to them. In [`Parameters`]
    /// they stand last.
    pub fn new(parameters: &Parameters, stacked: &Triangle) -> Self {
        Self::of_columns(parameters, stacked, 0..parameters.len(), &[])
    }

    /// The same of some of the columns, with others between them and the right-hand side; those that are left out do not move.
    pub fn of_columns(
        parameters: &Parameters,
        stacked: &Triangle,
        columns: impl IntoIterator<Item = usize>,
        behind: &[usize],
    ) -> Self {
        let is_nuisance = |k: &usize| parameters.unknowns[*k].kind.is_nuisance();
        let (front, back): (Vec<usize>, Vec<usize>) = columns.into_iter().partition(is_nuisance);
        let last = stacked.r.ncols() - 1;
        let blocks = front.iter().chain(&back).chain(behind);
        let order: Vec<usize> = blocks.copied().chain([last]).collect();
        let mut permuted = BlockQr::new(order.len());
        permuted.push(stacked.r.nrows(), |i, j| stacked.r[(i, order[j])]);
        Self::of(permuted.finish().r, front.len(), back.len())
    }

    /// A triangle whose nuisances all move.
    pub fn of(r: Mat<f64>, nuisances: usize, mass: usize) -> Self {
        Self {
            r,
            nuisances,
            mass,
            held: Vec::new(),
        }
    }

    /// Holds each nuisance whose sigma, were those behind it known, exceeds the largest value that it can have: it is unobservable, as a
    /// bias of a tachometer beside an unknown momentum is in a vehicle that does not turn.
    pub fn hold(&mut self, largest: &[f64]) {
        let pairs = largest.iter().take(self.nuisances).enumerate();
        let held = pairs.map(|(i, largest)| self.r[(i, i)].abs() * largest < 1.0);
        self.held = held.collect();
    }

    /// Whether a nuisance does not move.
    fn is_held(&self, i: usize) -> bool {
        self.held.get(i).copied().unwrap_or(false)
    }

    /// How much the nuisances that move lower the square of the right-hand side.
    pub fn lowered_by_nuisances(&self) -> f64 {
        let moving = (0..self.nuisances).filter(|i| !self.is_held(*i));
        moving
            .map(|i| self.r[(i, self.nuisances + self.mass)].powi(2))
            .sum()
    }

    /// Triangle of the mass properties.
    pub fn block(&self) -> Mat<f64> {
        let b = self.nuisances;
        Mat::from_fn(self.mass, self.mass, |i, j| self.r[(b + i, b + j)])
    }

    /// Right-hand side of the mass properties.
    pub fn rhs(&self) -> Vec<f64> {
        let n = self.nuisances + self.mass;
        (self.nuisances..n).map(|i| self.r[(i, n)]).collect()
    }

    /// Squared norm of the residual that no unknown reduces.
    pub fn unreachable(&self) -> f64 {
        let n = self.nuisances + self.mass;
        self.r[(n, n)].powi(2)
    }

    /// The nuisances as functions of the mass properties, which are the first of these values.
    pub fn nuisance_estimate(&self, x: &[f64]) -> ConditionalEstimate {
        conditional_estimate(&self.r, self.nuisances, &x[..self.mass])
    }

    /// Nuisances that go with values of the mass properties.
    pub fn nuisances_for(&self, mass: &[f64]) -> Vec<f64> {
        if !self.held.contains(&true) {
            return conditional_estimate(&self.r, self.nuisances, mass).mean;
        }
        let mut r = self.r.clone();
        let held = (0..self.nuisances).filter(|i| self.is_held(*i));
        held.for_each(|i| r[(i, i)] = 0.0);
        conditional_estimate(&r, self.nuisances, mass).mean
    }
}

/// A triangle with a damping of its first columns, in units of which are given: `damping |x / unit|^2` is added.
pub(super) fn damped(r: &Mat<f64>, units: &[f64], damping: f64) -> Mat<f64> {
    let mut more = BlockQr::new(r.ncols());
    more.push(r.nrows(), |i, j| r[(i, j)]);
    let root = damping.sqrt();
    more.push_diagonal(units.len(), |i| root / units[i]);
    more.finish().r
}

/// Lengths of the first columns of a triangle.
pub(super) fn lengths(r: &Mat<f64>, columns: usize) -> Vec<f64> {
    let length = |j: usize| (0..=j).map(|i| r[(i, j)].powi(2)).sum::<f64>().sqrt();
    (0..columns).map(length).collect()
}

/// Length of the longest column of a mass property over the triangles of all segments, natural units; so many columns of each stand
/// before those of the unknowns.
pub(crate) fn longest_column(parameters: &Parameters, segments: &[(&Triangle, usize)]) -> f64 {
    let length = |(j, unknown): (usize, &Unknown)| {
        let square = |(triangle, head): &(&Triangle, usize)| -> f64 {
            let at = head + j;
            (0..=at).map(|i| triangle.r[(i, at)].powi(2)).sum()
        };
        segments.iter().map(square).sum::<f64>().sqrt() * unknown.natural
    };
    let unknowns = parameters.unknowns.iter();
    let mass = unknowns.filter(|unknown| !unknown.kind.is_nuisance());
    mass.enumerate().map(length).fold(0.0, f64::max)
}

/// How much a step of all columns lowers the square of the first rows of the right-hand side.
pub(super) fn lowered<'s>(
    r: &Mat<f64>,
    rows: usize,
    step: impl Iterator<Item = &'s f64> + Clone,
) -> f64 {
    let of = |i: usize| {
        let moving = step.clone().enumerate().skip(i);
        let moved: f64 = moving.map(|(j, x)| r[(i, j)] * x).sum();
        let d = r[(i, r.ncols() - 1)];
        // d^2 - (d - moved)^2, without the cancellation.
        moved * (2.0 * d - moved)
    };
    (0..rows).map(of).sum()
}

/// Solution of the leading rows of a triangle, `R_hh h + R_hx x = d`, for h given x.
pub(crate) struct ConditionalEstimate {
    /// Values at x.
    pub mean: Vec<f64>,
    /// Slope over x, one row per component.
    pub slope: Vec<Vec<f64>>,
    /// Covariance given x.
    pub covariance: DMatrix<f64>,
}

/// Solves the first `h` rows of a triangle whose columns are `[h | x | rhs]`. A component without any
/// signal gets zero and an infinite variance.
pub(crate) fn conditional_estimate(r: &Mat<f64>, h: usize, x: &[f64]) -> ConditionalEstimate {
    let n = x.len();
    let largest = (0..h).fold(0.0_f64, |a, i| a.max(r[(i, i)].abs()));
    let blind = |i: usize| r[(i, i)].abs() <= 1.0e-14 * largest;
    let square = DMatrix::from_fn(h, h, |i, j| match (blind(i), i == j) {
        (true, true) => f64::MIN_POSITIVE.sqrt(),
        (true, false) => 0.0,
        _ => r[(i, j)],
    });
    let inverse = square
        .solve_upper_triangular(&DMatrix::identity(h, h))
        .unwrap_or_else(|| DMatrix::zeros(h, h));
    let clear = |i: usize, value: f64| if blind(i) { 0.0 } else { value };
    let slope = -&inverse * DMatrix::from_fn(h, n, |i, j| clear(i, r[(i, h + j)]));
    let constant = &inverse * DVector::from_fn(h, |i, _| clear(i, r[(i, h + n)]));
    let mean = constant + &slope * DVector::from_column_slice(x);
    let rows = slope.row_iter().map(|row| row.iter().copied().collect());
    ConditionalEstimate {
        mean: mean.as_slice().to_vec(),
        slope: rows.collect(),
        covariance: &inverse * inverse.transpose(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_solve::Spectrum;

    /// Elimination from the damped problem against its normal equations, solved whole.
    #[test]
    fn exact_a_damped_step_of_nuisances_and_mass_properties_is_that_of_the_normal_equations() {
        let (nuisances, mass) = (3, 4);
        let n = nuisances + mass;
        let element = |i: usize, j: usize| match j < i {
            true => 0.0,
            false => ((7 * i + 3 * j + 1) as f64).sin() + f64::from(u8::from(i == j)) * 2.0,
        };
        let shared = SharedTriangle::of(Mat::from_fn(n + 1, n + 1, element), nuisances, mass);
        let (damping, units, natural) = (0.7, [0.5, 2.0, 0.1], [1.0, 3.0, 0.2, 1.5]);
        let mut held = shared.clone();
        held.r = damped(&shared.r, &units, damping);
        let open = Spectrum::new(&shared.block(), &natural, None, 1.0, 1.0e9).unwrap();
        let spectrum = Spectrum::within(&held.block(), None, &open).unwrap();
        let scaled = spectrum.damped(&held.rhs(), damping);
        let x: Vec<f64> = scaled
            .iter()
            .zip(natural)
            .map(|(z, unit)| z * unit)
            .collect();
        let b = held.nuisances_for(&x);
        let A = DMatrix::from_fn(n, n, element);
        let d = DMatrix::from_fn(n, 1, |i, _| element(i, n));
        let all: Vec<f64> = units.iter().chain(&natural).copied().collect();
        let held_back = DMatrix::from_fn(n, n, |i, j| match i == j {
            true => damping / (all[i] * all[i]),
            false => 0.0,
        });
        let whole = (A.transpose() * &A + held_back)
            .lu()
            .solve(&(A.transpose() * &d))
            .unwrap();
        for (found, expected) in b.iter().chain(&x).zip(whole.iter()) {
            assert!((found - expected).abs() < 1.0e-12, "{found} {expected}");
        }
        let mut holding = shared.clone();
        holding.hold(&[1.0, 1.0e-3, 1.0]);
        let still = holding.nuisances_for(&[0.0; 4]);
        let free = shared.nuisances_for(&[0.0; 4]);
        // The one in the middle stays; the last one has no other before it.
        assert!(still[1] == 0.0 && still[2] == free[2] && still[0] != free[0]);
        let middle = element(1, n).powi(2);
        let fewer = shared.lowered_by_nuisances() - holding.lowered_by_nuisances();
        assert!((fewer - middle).abs() < 1.0e-12);
        let left = (&d - A * whole).norm_squared();
        let lower = lowered(&shared.r, n, b.iter().chain(&x));
        assert!((lower - d.norm_squared() + left).abs() < 1.0e-11);
    }
}
