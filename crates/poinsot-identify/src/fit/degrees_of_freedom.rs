//! Number of parameters that the samples determined.

use crate::fit::Fitted;
use crate::fit::experiment::Experiment;
use crate::problem::parameters::Parameters;
use nalgebra::DMatrix;

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

/// Number of known numbers determined by the data: their count minus the share of each prior.
fn determined(parameters: &Parameters, fitted: &Fitted) -> f64 {
    let declared = parameters.known_covariance();
    let n = declared.nrows();
    let inverse = declared.cholesky().map(|c| c.inverse());
    let held = inverse.map(|inverse| (inverse * known_covariance(parameters, fitted)).trace());
    n as f64 - held.unwrap_or(n as f64)
}
