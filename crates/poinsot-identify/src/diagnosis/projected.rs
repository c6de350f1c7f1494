//! Score tests (Rao 1948): effect of further unknowns on the residual without a fit.
//!
//! The columns of the candidates are projected clear of everything that was fitted, once. Any group of them
//! is then a small least-squares problem: its decrease of chi-square, its values and their sigma, all to
//! first order.

use crate::fit::Fitted;
use crate::problem::parameters::Parameters;
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use poinsot_solve::{BlockQr, Triangle};

/// Smallest share of a column's length after projection for a new direction.
const NEW: f64 = 1.0e-6;

/// Share of the largest square below which a combination of columns is unobservable.
pub(super) const SHOWN: f64 = 1.0e-8;

/// Candidate columns and residual clear of the fitted unknowns, block by block.
pub(super) struct Projected {
    blocks: Vec<Block>,
    /// Block and column of every number that has one.
    places: Vec<Option<(usize, usize)>>,
}

/// Some of the columns and the residual, one triangle; residual last.
struct Block {
    r: Mat<f64>,
    /// Length of each column before the projection; zero without effect.
    length: Vec<f64>,
}

/// Answer of one group.
#[derive(Debug, Clone)]
pub(super) struct Score {
    pub decrease: f64,
    pub values: Vec<f64>,
    /// Infinite without a new direction.
    pub covariance: DMatrix<f64>,
}

impl Projected {
    /// So many numbers, without columns as yet.
    pub fn new(numbers: usize) -> Self {
        Self {
            blocks: Vec::new(),
            places: vec![None; numbers],
        }
    }

    /// Takes the columns of some numbers from a triangle `[fitted unknowns | numbers | residual]`.
    pub fn add(
        &mut self,
        parameters: &Parameters,
        fitted: &Fitted,
        numbers: &[usize],
        stacked: &Triangle,
    ) {
        for (column, number) in numbers.iter().enumerate() {
            self.places[*number] = Some((self.blocks.len(), column));
        }
        let block = Block::new(stacked, parameters, numbers.len(), fitted);
        self.blocks.push(block);
    }

    /// Products of the columns of two numbers clear of all that was fitted, or with the residual in place of the second; zero without
    /// columns in one block.
    pub fn product(&self, number: usize, other: Option<usize>) -> f64 {
        let place = |k: usize| self.places.get(k).copied().flatten();
        let Some((block, column)) = place(number) else {
            return 0.0;
        };
        let Block { r, length } = &self.blocks[block];
        let (with, unit) = match other.map(place) {
            None => (length.len(), 1.0),
            Some(Some((same, with))) if same == block => (with, length[with]),
            Some(_) => return 0.0,
        };
        let each = (0..r.nrows()).map(|i| r[(i, column)] * r[(i, with)]);
        each.sum::<f64>() * length[column] * unit
    }

    /// Square of the residual of the first block clear of all that was fitted.
    pub fn residual(&self) -> f64 {
        let first = self.blocks.first();
        first.map_or(0.0, |Block { r, length }| {
            let last = length.len();
            (0..r.nrows()).map(|i| r[(i, last)].powi(2)).sum()
        })
    }

    /// A group of candidates at once, each held near zero by a prior sigma where one is given. All are of one block.
    pub fn score(&self, group: &[usize], prior: Option<f64>) -> Score {
        let n = group.len();
        let places: Option<Vec<(usize, usize)>> = group.iter().map(|k| self.places[*k]).collect();
        let places = places.filter(|all| all.windows(2).all(|w| w[0].0 == w[1].0));
        match places.as_deref() {
            Some(places @ [(block, _), ..]) => {
                let columns: Vec<usize> = places.iter().map(|p| p.1).collect();
                self.blocks[*block].score(&columns, prior)
            }
            // Numbers without columns.
            _ => Score {
                decrease: 0.0,
                values: vec![0.0; n],
                covariance: DMatrix::from_diagonal_element(n, n, f64::INFINITY),
            },
        }
    }
}

impl Block {
    /// `stacked` has the columns `[fitted unknowns | candidates | residual]`, `own` of them of candidates.
    fn new(stacked: &Triangle, parameters: &Parameters, own: usize, fitted: &Fitted) -> Self {
        let r = &stacked.r;
        let (base, last) = (parameters.len(), r.ncols() - 1);
        let spectrum = &fitted.spectrum;
        let is_nuisance = |k: &usize| parameters.unknowns[*k].kind.is_nuisance();
        let (nuisance, mass): (Vec<usize>, Vec<usize>) = (0..base).partition(is_nuisance);
        let length: Vec<f64> = (0..own)
            .map(|k| {
                let square = |i: usize| r[(i, base + k)].powi(2);
                (0..r.nrows()).map(square).sum::<f64>().sqrt()
            })
            .collect();
        let clear = spectrum.rank + nuisance.len();
        let mut qr = BlockQr::new(clear + own + 1);
        qr.push(r.nrows(), |i, j| {
            if j < spectrum.rank {
                mass.iter()
                    .enumerate()
                    .map(|(k, at)| r[(i, *at)] * spectrum.natural[k] * spectrum.directions[(k, j)])
                    .sum()
            } else if j < clear {
                r[(i, nuisance[j - spectrum.rank])]
            } else if j < clear + own {
                let k = j - clear;
                scaled(r[(i, base + k)], length[k])
            } else {
                r[(i, last)]
            }
        });
        let t = qr.finish().r;
        Self {
            r: Mat::from_fn(own + 1, own + 1, |i, j| {
                if i <= j && clear + i < t.nrows() {
                    t[(clear + i, clear + j)]
                } else {
                    0.0
                }
            }),
            length,
        }
    }

    fn score(&self, group: &[usize], prior: Option<f64>) -> Score {
        let (n, last) = (group.len(), self.length.len());
        let mut qr = BlockQr::new(n + 1);
        qr.push(last + 1, |i, j| {
            self.r[(i, if j < n { group[j] } else { last })]
        });
        if let Some(sigma) = prior {
            qr.push_diagonal(n, |i| scaled(1.0, sigma * self.length[group[i]]));
        }
        let t = qr.finish().r;
        let blind = |k: usize| t[(k, k)].abs() < NEW;
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let square = DMatrix::from_fn(n, n, |i, j| match blind(i) || blind(j) {
            true => unit(i, j),
            false => t[(i, j)],
        });
        let inverse = square.solve_upper_triangular(&DMatrix::identity(n, n));
        let inverse = inverse.unwrap_or_else(|| DMatrix::zeros(n, n));
        let rhs = DVector::from_fn(n, |k, _| if blind(k) { 0.0 } else { t[(k, n)] });
        let size = |k: usize| self.length[group[k]];
        let (values, whole) = (&inverse * &rhs, &inverse * inverse.transpose());
        Score {
            decrease: rhs.norm_squared(),
            values: (0..n).map(|k| scaled(values[k], size(k))).collect(),
            covariance: DMatrix::from_fn(n, n, |i, j| match blind(i) || blind(j) {
                true if i == j => f64::INFINITY,
                true => 0.0,
                false => whole[(i, j)] / (size(i) * size(j)),
            }),
        }
    }
}

/// One over the lengths of columns of these products; zero of one without length.
pub(super) fn units(square: &DMatrix<f64>) -> DVector<f64> {
    let unit = |s: f64| if s > 0.0 { 1.0 / s.sqrt() } else { 0.0 };
    square.map_diagonal(unit)
}

/// A number over a length; zero over nothing.
fn scaled(value: f64, length: f64) -> f64 {
    if length > 0.0 { value / length } else { 0.0 }
}
