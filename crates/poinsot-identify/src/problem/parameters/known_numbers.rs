//! The known numbers among the unknowns.

use super::{KnownUnknown, Parameters};
use nalgebra::DMatrix;
use poinsot_model::{KnownNumber, LIKE_WHEELS};

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
            (unknown.kind.known(), unknown.nominal)
        };
        let all: Vec<_> = self.known_places().iter().map(of).collect();
        let spin = |k: Option<&KnownUnknown>| {
            k.is_some_and(|k| matches!(k.number, KnownNumber::SpinInertia(_)))
        };
        DMatrix::from_fn(all.len(), all.len(), |i, j| {
            let ((a, own), (b, other)) = (all[i], all[j]);
            let product = a.map_or(0.0, |k| k.sigma) * b.map_or(0.0, |k| k.sigma);
            match () {
                () if i == j => product,
                () if spin(a) && spin(b) && own == other => LIKE_WHEELS * product,
                () => 0.0,
            }
        })
    }
}
