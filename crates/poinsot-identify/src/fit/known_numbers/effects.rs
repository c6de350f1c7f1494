//! Effect of the known numbers on an answer: its sigma without them, and its change with each.

use crate::fit::Fitted;
use crate::fit::degrees_of_freedom::Loosened;
use crate::fit::experiment::Experiment;
use crate::fit::triangle::SharedTriangle;
use nalgebra::DMatrix;
use poinsot_solve::{Spectrum, Triangle};

/// Share of its declared sigma below which a known number counts as estimated.
const ESTIMATED: f64 = 0.7;

/// Sensitivity of the answer to the known numbers.
pub(crate) struct Effects {
    /// What the data determine where every known number is exact.
    pub exact: Spectrum,
    /// Places of the known numbers among the unknowns.
    pub places: Vec<usize>,
    /// How the mass properties move with each known number, the others and the readings held: one row a number.
    pub shift: Vec<Vec<f64>>,
    /// Covariance of the known numbers after the data.
    pub covariance: DMatrix<f64>,
    /// Declared sigma of each.
    pub declared: Vec<f64>,
}

impl Effects {
    /// `None` where no known number is among the unknowns, or the triangle holds NaN or infinity.
    pub fn new(experiment: &Experiment, fitted: &Fitted) -> Option<Self> {
        let parameters = experiment.parameters;
        let places = parameters.known_places();
        if places.is_empty() {
            return None;
        }
        let stacked = experiment.stack(&fitted.at, &fitted.evaluated, true);
        let (exact, shift) = shifts(experiment, fitted, &stacked, &places)?;
        let declared = parameters.known_covariance();
        Some(Self {
            shift,
            covariance: Loosened::new(fitted).covariance(&places),
            declared: (0..places.len()).map(|k| declared[(k, k)].sqrt()).collect(),
            exact,
            places,
        })
    }

    /// Sigma of the k-th after the data.
    pub fn sigma(&self, k: usize) -> f64 {
        self.covariance[(k, k)].max(0.0).sqrt()
    }

    /// Whether the data say enough of the unknown at this place for it to count as estimated.
    pub fn shrunk(&self, place: usize) -> bool {
        let k = self.places.iter().position(|p| *p == place);
        k.is_some_and(|k| self.sigma(k) < ESTIMATED * self.declared[k])
    }
}

/// What the data determine where the numbers at these places of a stacked triangle are exact, and how the mass properties move
/// with each of them: one row a number. The others are those of the fit. `None` where the triangle holds NaN or infinity.
pub(crate) fn shifts(
    experiment: &Experiment,
    fitted: &Fitted,
    stacked: &Triangle,
    places: &[usize],
) -> Option<(Spectrum, Vec<Vec<f64>>)> {
    let parameters = experiment.parameters;
    let asked = (0..parameters.len()).filter(|k| !places.contains(k));
    let shared = SharedTriangle::of_columns(parameters, stacked, asked, places);
    let exact = experiment.spectrum(&shared, &fitted.evaluated).ok()?;
    let exact = exact.judged(experiment.problem.largest_sigma());
    let (b, m) = (shared.nuisances, shared.mass);
    let shift = |k: usize| {
        let column: Vec<f64> = (0..m).map(|i| -shared.r[(b + i, b + m + k)]).collect();
        let step = exact.solve(&column);
        let units = step.iter().zip(&exact.natural);
        units.map(|(z, unit)| z * unit).collect()
    };
    let shift = (0..places.len()).map(shift).collect();
    Some((exact, shift))
}
