//! Unobservable part of an error: projection on the unobservable directions, in natural units.

use crate::xu2017::natural;
use poinsot_identify::{Estimate, tensor_name};
use poinsot_spatial::{InertialParameters, MassProperties, PARAMETER_NAMES};

/// Orthonormal unobservable directions of all ten parameters of all bodies, natural units.
pub struct Null {
    natural: Vec<f64>,
    directions: Vec<Vec<f64>>,
}

impl Null {
    /// From the undetermined combinations of an estimate from all data; natural units of the true bodies.
    pub fn new(estimate: &Estimate, truth: &[MassProperties]) -> Self {
        let names: Vec<String> = estimate
            .bodies
            .iter()
            .flat_map(|b| {
                (0..10).map(|k| match k {
                    0 => format!("{}.m", b.name),
                    1..=3 => format!("{}.{}", b.name, PARAMETER_NAMES[k]),
                    _ => format!("{}.I_BBo_{}", b.name, tensor_name(k - 4)),
                })
            })
            .collect();
        let natural: Vec<f64> = truth.iter().flat_map(natural).collect();
        let mut directions: Vec<Vec<f64>> = Vec::new();
        for open in &estimate.identifiability.open {
            let mut d = vec![0.0; names.len()];
            for (name, c) in &open.coefficients {
                if let Some(at) = names.iter().position(|n| n == name) {
                    d[at] = c / natural[at];
                }
            }
            // Gram-Schmidt, twice against round-off.
            for _ in 0..2 {
                for before in &directions {
                    let share = dot(&d, before);
                    d.iter_mut().zip(before).for_each(|(x, b)| *x -= share * b);
                }
                let length = dot(&d, &d).sqrt();
                d.iter_mut().for_each(|x| *x /= length);
            }
            directions.push(d);
        }
        Self {
            natural,
            directions,
        }
    }

    /// Number of unobservable directions.
    pub fn count(&self) -> usize {
        self.directions.len()
    }

    /// Squared scaled error, and its fraction along unobservable directions.
    pub fn share(&self, found: &[InertialParameters], truth: &[InertialParameters]) -> (f64, f64) {
        let error = self.error(found, truth);
        let whole = dot(&error, &error);
        let inside: f64 = self.directions.iter().map(|d| dot(&error, d).powi(2)).sum();
        (whole, inside / whole)
    }

    /// RSS of the observable error, natural units.
    pub fn visible(&self, found: &[InertialParameters], truth: &[InertialParameters]) -> f64 {
        let mut error = self.error(found, truth);
        for d in self.directions.iter().chain(&self.directions) {
            let share = dot(&error, d);
            error.iter_mut().zip(d).for_each(|(e, x)| *e -= share * x);
        }
        dot(&error, &error).sqrt()
    }

    fn error(&self, found: &[InertialParameters], truth: &[InertialParameters]) -> Vec<f64> {
        let pairs = found.iter().zip(truth);
        let plain = pairs.flat_map(|(a, b)| {
            let (a, b) = (a.to_array(), b.to_array());
            (0..10).map(move |k| a[k] - b[k])
        });
        plain.zip(&self.natural).map(|(e, unit)| e / unit).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
