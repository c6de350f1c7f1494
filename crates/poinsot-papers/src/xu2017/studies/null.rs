//! Unobservable part of an error: projection on the unobservable directions, in natural units.

use crate::certified::parameter_names;
use crate::xu2017::natural;
use nalgebra::{DMatrix, DVector};
use poinsot_identify::Estimate;
use poinsot_spatial::{InertialParameters, MassProperties};

/// Orthonormal unobservable directions of all ten parameters of all bodies, natural units.
pub struct Null {
    natural: Vec<f64>,
    directions: DMatrix<f64>,
}

impl Null {
    /// From the undetermined combinations of an estimate from all data; natural units of the true bodies.
    pub fn new(estimate: &Estimate, truth: &[MassProperties]) -> Self {
        let bodies = estimate.bodies.iter();
        let names = bodies.flat_map(|b| parameter_names().map(|name| format!("{}.{name}", b.name)));
        let names: Vec<String> = names.collect();
        let natural: Vec<f64> = truth.iter().flat_map(natural).collect();
        let open = &estimate.identifiability.open;
        let mut directions = DMatrix::zeros(names.len(), open.len());
        for (k, direction) in open.iter().enumerate() {
            for (name, c) in &direction.coefficients {
                if let Some(at) = names.iter().position(|n| n == name) {
                    directions[(at, k)] = c / natural[at];
                }
            }
        }
        Self {
            natural,
            directions: directions.qr().q(),
        }
    }

    /// Number of unobservable directions.
    pub fn count(&self) -> usize {
        self.directions.ncols()
    }

    /// Fraction of the squared scaled error along unobservable directions.
    pub fn share(&self, found: &[InertialParameters], truth: &[InertialParameters]) -> f64 {
        let error = self.error(found, truth);
        self.directions.tr_mul(&error).norm_squared() / error.norm_squared()
    }

    /// RSS of the observable error, natural units.
    pub fn visible(&self, found: &[InertialParameters], truth: &[InertialParameters]) -> f64 {
        let mut error = self.error(found, truth);
        // The second projection removes the round-off of the first.
        for _ in 0..2 {
            error -= &self.directions * self.directions.tr_mul(&error);
        }
        error.norm()
    }

    fn error(&self, found: &[InertialParameters], truth: &[InertialParameters]) -> DVector<f64> {
        let pairs = found.iter().zip(truth);
        let plain = pairs.flat_map(|(a, b)| a.with_added(-1.0, b).to_array());
        let scaled = plain.zip(&self.natural).map(|(e, unit)| e / unit);
        DVector::from_vec(scaled.collect())
    }
}
