//! Number of parameters that the samples determined.

use crate::fit::Fitted;
use crate::fit::experiment::Experiment;
use crate::fit::triangle::ConditionalEstimate;
use crate::problem::parameters::Parameters;
use nalgebra::{DMatrix, DVector};

/// Number of parameters that the samples determined: pose and momentum of every segment, nuisances, and the identified
/// directions of the mass properties.
pub(crate) fn fitted_numbers(experiment: &Experiment, fitted: &Fitted) -> usize {
    let initial_states: usize = experiment.unknown.iter().map(|u| u.count()).sum();
    let known = experiment.parameters.known_places().len();
    let of_known = match known {
        0 => 0.0,
        _ => determined(experiment.parameters, fitted),
    };
    initial_states + fitted.spectrum.rank + fitted.shared.nuisances - known
        + of_known.round() as usize
}

/// Covariance of the known numbers among the unknowns after the data, in their order.
pub(crate) fn known_covariance(parameters: &Parameters, fitted: &Fitted) -> DMatrix<f64> {
    let mass = fitted.shared.mass;
    let conditional = fitted.shared.nuisance_estimate(&fitted.at.x);
    let c = fitted.spectrum.covariance();
    let places: Vec<usize> = parameters.known_places().iter().map(|p| p - mass).collect();
    let count = places.len();
    let slope = DMatrix::from_fn(count, mass, |i, j| conditional.slope[places[i]][j]);
    let c = DMatrix::from_fn(mass, mass, |i, j| c[(i, j)]);
    let own = |i: usize, j: usize| conditional.covariance[(places[i], places[j])];
    &slope * c * slope.transpose() + DMatrix::from_fn(count, count, own)
}

/// Covariance of unknowns after the data, and how far they would move, were the directions that the fit leaves at nominal values known
/// to a natural unit: those are off by as much, and pull what has a prior with them.
pub(crate) struct Loosened {
    directions: Vec<(Vec<f64>, f64)>,
    conditional: ConditionalEstimate,
    mass: usize,
}

impl Loosened {
    pub fn new(fitted: &Fitted) -> Self {
        let shared = &fitted.shared;
        Self {
            directions: fitted.spectrum.loosened(&shared.block(), &shared.rhs()),
            conditional: shared.nuisance_estimate(&fitted.at.x),
            mass: shared.mass,
        }
    }

    /// Change of an unknown by a sigma of every direction.
    fn along(&self, at: usize) -> DVector<f64> {
        let of = |(direction, _): &(Vec<f64>, f64)| match at.checked_sub(self.mass) {
            Some(k) => dot(&self.conditional.slope[k], direction),
            None => direction[at],
        };
        DVector::from_iterator(self.directions.len(), self.directions.iter().map(of))
    }

    /// How far an unknown would move.
    pub fn moved(&self, at: usize) -> f64 {
        let pulls = self.directions.iter().map(|(_, pull)| *pull);
        let along = self.along(at);
        along.iter().zip(pulls).map(|(a, pull)| a * pull).sum()
    }

    /// Covariance of two unknowns.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let both = i.checked_sub(self.mass).zip(j.checked_sub(self.mass));
        let own = both.map_or(0.0, |at| self.conditional.covariance[at]);
        own + self.along(i).dot(&self.along(j))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Number of known numbers determined by the data: their count minus the share of each prior.
fn determined(parameters: &Parameters, fitted: &Fitted) -> f64 {
    let declared = parameters.known_covariance();
    let n = declared.nrows();
    let inverse = declared.cholesky().map(|c| c.inverse());
    let held = inverse.map(|inverse| (inverse * known_covariance(parameters, fitted)).trace());
    n as f64 - held.unwrap_or(n as f64)
}
