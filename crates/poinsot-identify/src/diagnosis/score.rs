//! How much of a residual columns explain beyond all that was fitted.

use super::projected::{SHOWN, units};
use super::suspects::Scored;
use super::types::{FaultKind, Suspect};
use crate::fit::experiment::Experiment;
use crate::motion::Column;
use nalgebra::{DMatrix, DVector};

/// Rows of one segment in an orthonormal basis of all that was fitted, and the residual clear of it.
#[derive(Default)]
pub(super) struct ProjectedRows {
    pub basis: Vec<DVector<f64>>,
    pub residual: Vec<f64>,
}

/// Products of columns.
pub(super) struct Products {
    /// With themselves, with the basis of all that was fitted, and with the residual.
    pub square: DMatrix<f64>,
    onto: DMatrix<f64>,
    pub toward: DVector<f64>,
}

impl Products {
    pub fn new(columns: usize, clear: &ProjectedRows) -> Self {
        let basis = clear.basis.first().map_or(0, DVector::len);
        Self {
            square: DMatrix::zeros(columns, columns),
            onto: DMatrix::zeros(basis, columns),
            toward: DVector::zeros(columns),
        }
    }

    /// Adds a row of the columns, the i-th of the segment.
    pub fn add(&mut self, row: &DVector<f64>, clear: &ProjectedRows, i: usize) {
        for (j, x) in row.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            self.square.column_mut(j).axpy(*x, row, 1.0);
            self.onto.column_mut(j).axpy(*x, &clear.basis[i], 1.0);
            self.toward[j] += x * clear.residual[i];
        }
    }

    /// The columns with themselves, clear of the basis.
    pub fn left(&self) -> DMatrix<f64> {
        &self.square - self.onto.tr_mul(&self.onto)
    }
}

pub(super) struct Score {
    pub decrease: f64,
    pub numbers: usize,
    /// Value of each number.
    pub values: DVector<f64>,
}

/// The record of a time in words; arrays have no name.
pub(super) fn of_record(label: &str) -> String {
    let named = (!label.is_empty()).then(|| format!(" of {label}"));
    named.unwrap_or_default()
}

/// The best of the places within a record that were tried, and how many these are.
#[derive(Default)]
pub(super) struct Best<P> {
    pub found: Option<(Score, P)>,
    tried: usize,
}

impl<P> Best<P> {
    /// Counts a place that was tried, and keeps the best.
    pub fn take(&mut self, score: Score, place: P) {
        self.tried += 1;
        let best = self.found.as_ref();
        if best.is_none_or(|(best, _)| score.decrease > best.decrease) {
            self.found = Some((score, place));
        }
    }

    /// The suspect; `name` tells it with its place.
    pub fn suspect(
        &self,
        fault: FaultKind,
        name: impl FnOnce(&Score, &P) -> String,
    ) -> Option<Scored> {
        let (score, place) = self.found.as_ref()?;
        let name = name(score, place);
        Some(Scored::alone(Suspect {
            numbers: score.numbers,
            times: self.tried,
            ..Suspect::new(name, fault, score.decrease, Vec::new())
        }))
    }
}

/// Changes of the start that change the momentum at a time and no pose; one column for each component.
pub(super) fn momentum_jump(
    start: &[Column],
    experiment: &Experiment,
    segment: usize,
) -> Option<DMatrix<f64>> {
    let parts = experiment.unknown[segment].parts();
    let places: Vec<usize> = (0..12).filter(|k| parts[k / 3]).collect();
    let state = DMatrix::from_fn(places.len(), start.len(), |i, j| start[j][places[i]]);
    let momenta: Vec<usize> = (0..places.len()).filter(|k| places[*k] >= 6).collect();
    let mut wanted = DMatrix::zeros(places.len(), momenta.len());
    for (j, k) in momenta.iter().enumerate() {
        wanted[(*k, j)] = 1.0;
    }
    (!momenta.is_empty() && state.is_square()).then(|| state.lu().solve(&wanted))?
}

/// `g^T M^-1 g` over the observable part, in units of the columns.
pub(super) fn explained(
    left: &DMatrix<f64>,
    square: &DMatrix<f64>,
    toward: &DVector<f64>,
) -> Score {
    let m = toward.len();
    let unit = units(square);
    let scaled = DMatrix::from_fn(m, m, |i, j| left[(i, j)] * unit[i] * unit[j]);
    let rhs = toward.component_mul(&unit);
    let eigen = scaled.symmetric_eigen();
    let mut score = Score {
        decrease: 0.0,
        numbers: 0,
        values: DVector::zeros(m),
    };
    for (value, vector) in eigen
        .eigenvalues
        .iter()
        .zip(eigen.eigenvectors.column_iter())
    {
        if *value > SHOWN {
            let along = vector.dot(&rhs);
            score.decrease += along.powi(2) / value;
            score.numbers += 1;
            score.values += vector * (along / value);
        }
    }
    score.values.component_mul_assign(&unit);
    score
}
