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

/// Covariance of unknowns after the data, and how far they would move, were the directions that the fit leaves at nominal values known
/// to a natural unit: those are off by as much, and pull what has a prior with them.
pub(crate) struct Loosened {
    /// One sigma of each direction.
    directions: Vec<Vec<f64>>,
    /// How far the data would move each, sigmas.
    pulls: DVector<f64>,
    conditional: ConditionalEstimate,
    mass: usize,
}

impl Loosened {
    pub fn new(fitted: &Fitted) -> Self {
        let shared = &fitted.shared;
        let loosened = fitted.spectrum.loosened(&shared.block(), &shared.rhs());
        let (directions, pulls): (_, Vec<f64>) = loosened.into_iter().unzip();
        Self {
            directions,
            pulls: pulls.into(),
            conditional: shared.nuisance_estimate(&fitted.at.x),
            mass: shared.mass,
        }
    }

    /// Change of an unknown by a sigma of every direction.
    fn along(&self, at: usize) -> DVector<f64> {
        let of = |direction: &Vec<f64>| match at.checked_sub(self.mass) {
            Some(k) => {
                let slope = self.conditional.slope[k].iter();
                slope.zip(direction).map(|(a, b)| a * b).sum()
            }
            None => direction[at],
        };
        DVector::from_iterator(self.directions.len(), self.directions.iter().map(of))
    }

    /// How far an unknown would move.
    pub fn moved(&self, at: usize) -> f64 {
        self.along(at).dot(&self.pulls)
    }

    /// Covariance of these unknowns.
    pub fn covariance(&self, places: &[usize]) -> DMatrix<f64> {
        let along: Vec<DVector<f64>> = places.iter().map(|at| self.along(*at)).collect();
        let nuisance = |k: usize| places[k].checked_sub(self.mass);
        let own = |i: usize, j: usize| {
            let both = nuisance(i).zip(nuisance(j));
            both.map_or(0.0, |at| self.conditional.covariance[at])
        };
        let count = places.len();
        DMatrix::from_fn(count, count, |i, j| own(i, j) + along[i].dot(&along[j]))
    }
}

/// Number of known numbers determined by the data: their count minus the share of each prior.
fn determined(parameters: &Parameters, fitted: &Fitted) -> f64 {
    let declared = parameters.known_covariance();
    let n = declared.nrows();
    let inverse = declared.cholesky().map(|c| c.inverse());
    let covariance = || Loosened::new(fitted).covariance(&parameters.known_places());
    let held = inverse.map(|inverse| (inverse * covariance()).trace());
    n as f64 - held.unwrap_or(n as f64)
}
