//! Initial momentum of every segment and the nuisances as numbers of the answer.

use crate::answer::body::QuantityEstimator;
use crate::problem::quantity::Quantity;
use crate::solution::estimate::{MomentumEstimate, NamedNumber, Number};
use crate::solution::solved::{StartOfSegment, VectorQuantity};
use poinsot_model::MomentumKnowledge;

/// Momentum at the first sample of a segment.
pub(crate) fn momentum(estimator: &QuantityEstimator, start: &StartOfSegment) -> MomentumEstimate {
    MomentumEstimate {
        linear: numbers(
            estimator,
            &start.linear,
            start.given.linear,
            !start.translation,
        ),
        angular: numbers(estimator, &start.angular, start.given.angular, false),
    }
}

fn numbers(
    estimator: &QuantityEstimator,
    quantity: &VectorQuantity,
    given: MomentumKnowledge,
    open: bool,
) -> [Number; 3] {
    [0, 1, 2].map(|k| match given {
        _ if open => Number::undetermined(0.0),
        MomentumKnowledge::Known(known) => Number::known(known[k]),
        MomentumKnowledge::Estimate => {
            let sigma = estimator.sigma_with(&quantity.gradient[k], quantity.own[(k, k)]);
            decide(sigma, quantity.value[k], 0.0)
        }
    })
}

/// Spin inertias, thruster scales and biases.
pub(crate) fn nuisances(estimator: &QuantityEstimator) -> Vec<NamedNumber> {
    let solution = estimator.solution;
    let parameters = &solution.parameters;
    let mass = solution.shared.mass;
    let biases = &estimator.nuisances;
    parameters
        .unknowns
        .iter()
        .enumerate()
        .filter(|(_, unknown)| unknown.kind.is_reported())
        .map(|(at, unknown)| {
            let nuisance = unknown.kind.is_nuisance().then(|| at - mass);
            let (own, variance) = match nuisance {
                Some(k) => (biases.slope[k].clone(), biases.covariance[(k, k)]),
                None => (Quantity::unknown(at, &solution.x).gradient, 0.0),
            };
            let sigma = estimator.sigma_with(&own, variance);
            let here = Quantity {
                value: solution.x[at],
                gradient: own,
            };
            let stays = |s: &f64| s.is_finite() && solution.keeps(&here, *s, |x| x[at]);
            let sigma = sigma.filter(stays);
            NamedNumber {
                name: unknown.name.clone(),
                unit: unknown.unit,
                number: decide(sigma, solution.x[at], unknown.nominal),
            }
        })
        .collect()
}

fn decide(sigma: Option<f64>, value: f64, nominal: f64) -> Number {
    match sigma {
        Some(sigma) => Number::data(value, sigma, nominal),
        None => Number::undetermined(nominal),
    }
}
