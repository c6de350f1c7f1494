//! Wanted and predicted sigmas.

use crate::case::Want;
use poinsot_identify::{
    BodyEstimate, Estimate, Source, WantedNumber, WantedTerm, axis_name, tensor_name,
};

/// A wanted number with its predicted sigma.
#[derive(Debug, Clone, PartialEq)]
pub struct Met {
    /// Wanted number.
    pub want: Want,
    /// Predicted sigma; `None` if not identifiable.
    pub sigma: Option<f64>,
}

impl Met {
    /// Whether the predicted sigma reaches the wanted one.
    pub fn is_met(&self) -> bool {
        self.sigma.is_some_and(|s| s <= self.want.sigma)
    }
}

/// Sigma of a wanted number under the covariance of an estimate or bound.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// let numbers = case::estimated_numbers(&model);
/// let sigma = predict::wanted_sigma(&identified.estimate, &numbers[0]).unwrap();
/// let stated = identified.estimate.bodies[0].inertia[0].sigma.unwrap();
/// assert!((sigma / stated - 1.0).abs() < 1.0e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn wanted_sigma(estimate: &Estimate, want: &Want) -> Option<f64> {
    let mut parts: Vec<(usize, f64)> = Vec::new();
    for term in &want.terms {
        let body = estimate.bodies.get(term.body)?;
        if source(body, term.number) == Source::Known {
            continue;
        }
        let name = covariance_name(body, term);
        let at = estimate.covariance_names.iter().position(|n| *n == name)?;
        parts.push((at, term.factor));
    }
    let covariance = &estimate.covariance;
    let row = |(i, a): &(usize, f64)| -> f64 {
        parts.iter().map(|(j, b)| a * b * covariance[*i][*j]).sum()
    };
    let variance: f64 = parts.iter().map(row).sum();
    variance.is_finite().then(|| variance.max(0.0).sqrt())
}

/// Name of a number in the covariance of an estimate: `bus.mass`, `bus.com_x`, `bus.inertia_xx`.
///
/// ```
#[doc = include_str!("../../doc/answer.txt")]
/// use poinsot_identify::{WantedNumber, WantedTerm};
///
/// let term = WantedTerm { body: 0, number: WantedNumber::Inertia(5), factor: 1.0 };
/// let name = predict::covariance_name(&identified.estimate.bodies[0], &term);
/// assert!(name == "bus.inertia_zz" && identified.estimate.covariance_names.contains(&name));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn covariance_name(body: &BodyEstimate, term: &WantedTerm) -> String {
    let own = match term.number {
        WantedNumber::Mass => "mass".to_owned(),
        WantedNumber::MassCentre(k) => format!("com_{}", axis_name(k)),
        WantedNumber::Inertia(k) => format!("inertia_{}", tensor_name(k)),
    };
    format!("{}.{own}", body.name)
}

fn source(body: &BodyEstimate, number: WantedNumber) -> Source {
    match number {
        WantedNumber::Mass => body.mass.source,
        WantedNumber::MassCentre(k) => body.com[k].source,
        WantedNumber::Inertia(k) => body.inertia[k].source,
    }
}
