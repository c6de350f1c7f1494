//! The known numbers among the unknowns.

use super::{KnownUnknown, Parameters};
use nalgebra::DMatrix;

impl Parameters {
    /// Places of the known numbers among the unknowns.
    pub(crate) fn known_places(&self) -> Vec<usize> {
        let unknowns = self.unknowns.iter().enumerate();
        let known = unknowns.filter(|(_, u)| u.kind.known().is_some());
        known.map(|(k, _)| k).collect()
    }

    /// Declared covariance of the known numbers among the unknowns, in their order.
    pub(crate) fn known_covariance(&self) -> DMatrix<f64> {
        let of = |k: &usize| {
            let unknown = &self.unknowns[*k];
            Some((unknown.kind.known()?, unknown.nominal))
        };
        let all: Vec<_> = self.known_places().iter().filter_map(of).collect();
        let kind = |known: &KnownUnknown| std::mem::discriminant(&known.number);
        DMatrix::from_fn(all.len(), all.len(), |i, j| {
            let ((a, own), (b, other)) = (all[i], all[j]);
            if let (Some((_, row)), Some((at, _))) = (&a.told, &b.told) {
                return row[*at];
            }
            let correlation = match i == j {
                true => 1.0,
                false if kind(a) == kind(b) && own == other => a.correlation,
                false => 0.0,
            };
            correlation * a.sigma * b.sigma
        })
    }
}
