//! The covariance of all numbers of the answer together: mass properties of the requested bodies, and nuisances.

use crate::problem::quantity::mass_property;
use crate::solution::estimate::{BodyEstimate, NamedNumber, Number, Source};
use crate::solution::solved::Solution;
use nalgebra::DMatrix;
use poinsot_spatial::{MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS};

/// One number that is determined.
pub(crate) struct Row {
    pub name: String,
    pub unit: &'static str,
    /// Slope over the mass properties, spin inertias and thruster scales.
    pub gradient: Vec<f64>,
    /// Index among the nuisances of sensors and surroundings, which have a variance of their own as well.
    pub nuisance: Option<usize>,
}

/// Names, units and slopes of mass, mass centre and central inertia of every requested body and of the nuisances, if
/// determined.
pub(crate) fn covariance_rows(
    solution: &Solution,
    bodies: &[BodyEstimate],
    nuisances: &[NamedNumber],
) -> Vec<Row> {
    let mut rows = Vec::new();
    for (at, body) in bodies.iter().enumerate() {
        body_rows(solution, at, body, &mut rows);
    }
    let mass = solution.shared.mass;
    let slopes = solution.shared.nuisance_estimate(&solution.x).slope;
    let unknowns = solution.parameters.unknowns.iter().enumerate();
    let answered = unknowns.filter(|(_, u)| u.kind.is_reported());
    for ((at, unknown), answer) in answered.zip(nuisances) {
        if !determined(&answer.number) {
            continue;
        }
        let nuisance = at.checked_sub(mass);
        let gradient = match nuisance {
            Some(k) => slopes[k].clone(),
            None => (0..mass).map(|j| f64::from(u8::from(j == at))).collect(),
        };
        rows.push(Row {
            name: unknown.name.clone(),
            unit: unknown.unit,
            gradient,
            nuisance,
        });
    }
    rows
}

fn determined(number: &Number) -> bool {
    matches!(number.source, Source::Data | Source::Prior)
}

fn body_rows(solution: &Solution, at: usize, body: &BodyEstimate, rows: &mut Vec<Row>) {
    let numbers = body.numbers();
    for k in (0..numbers.len()).filter(|k| determined(&numbers[*k])) {
        let quantity = mass_property(&solution.parameters, at, k, &solution.x);
        rows.extend(quantity.map(|quantity| Row {
            name: format!("{}.{}", body.name, MASS_PROPERTY_NAMES[k]),
            unit: MASS_PROPERTY_UNITS[k],
            gradient: quantity.gradient,
            nuisance: None,
        }));
    }
}

/// Their covariance, row by row: propagated from the mass properties, plus the conditional covariance of the nuisances.
pub(crate) fn covariance(solution: &Solution, rows: &[Row], scale: f64) -> Vec<Vec<f64>> {
    let c = solution.spectrum.covariance();
    let m = c.nrows();
    let own = solution.shared.nuisance_estimate(&solution.x).covariance;
    let other = solution.other_wheel_motion();
    let change = |row: &Row| match (other, row.nuisance) {
        (None, _) => 0.0,
        (Some(other), None) => other.change(&row.gradient),
        (Some(other), Some(k)) => other.step[solution.shared.mass + k],
    };
    let changes: Vec<f64> = rows.iter().map(change).collect();
    let nominal = rows
        .iter()
        .map(|row| solution.spectrum.nominal_part(&row.gradient));
    let nominal: Vec<Vec<f64>> = nominal.collect();
    let c = DMatrix::from_fn(m, m, |i, j| c[(i, j)]);
    let slopes = DMatrix::from_fn(rows.len(), m, |i, j| rows[i].gradient[j]);
    let carried = &slopes * c * slopes.transpose();
    let one = |i: usize, j: usize| {
        let own = match (rows[i].nuisance, rows[j].nuisance) {
            (Some(i), Some(j)) => own[(i, j)],
            _ => 0.0,
        };
        let chosen = other.map_or(0.0, |o| o.covariance(changes[i], changes[j]));
        let pairs = nominal[i].iter().zip(&nominal[j]);
        let open: f64 = pairs.map(|(a, b)| a * b).sum();
        scale * (carried[(i, j)] + own + chosen + open)
    };
    // Symmetric to the last bit.
    let row = |i: usize| (0..rows.len()).map(|j| one(i.max(j), i.min(j))).collect();
    (0..rows.len()).map(row).collect()
}
