//! Whitening of correlated (Gauss-Markov) noise.
//!
//! A Gauss-Markov error with correlation time T is whitened exactly by `(e_k - a e_{k-1}) / sqrt(1 - a^2)`,
//! `a = exp(-dt/T)` (Bryson and Henrikson 1968 for measurements); sensitivities pass through the same.

use poinsot_spatial::Vector3;

/// The whitening of one channel.
#[derive(Debug, Default)]
pub(super) struct NoiseWhitener {
    correlation_s: f64,
    /// Time and block (sensitivities and residual) of the reading before.
    before: Option<(f64, Vec<Vector3>)>,
    /// Memory for the next one.
    own: Vec<Vector3>,
}

impl NoiseWhitener {
    pub fn new(correlation_s: f64) -> Self {
        Self {
            correlation_s,
            ..Self::default()
        }
    }

    /// Subtracts the correlation with the previous sample, and says how much of the error stayed from there.
    pub fn take(&mut self, t: f64, block: &mut [Vector3]) -> Stayed {
        let mut own = std::mem::take(&mut self.own);
        own.clear();
        own.extend_from_slice(block);
        let mut stayed = Stayed::default();
        if let Some((earlier, before)) = &self.before {
            let a = (-(t - earlier) / self.correlation_s).exp();
            stayed = Stayed {
                share: a,
                new: 1.0 - a * a,
            };
            for (x, y) in block.iter_mut().zip(before) {
                *x = (*x - y * a) / stayed.new.sqrt();
            }
        }
        if let Some((_, old)) = self.before.replace((t, own)) {
            self.own = old;
        }
        stayed
    }
}

/// What is left in a correlated error of the one at the reading before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stayed {
    /// Its share.
    pub share: f64,
    /// Share of the variance that is new: the logarithm is the log-determinant of the innovation, per axis.
    pub new: f64,
}

impl Default for Stayed {
    fn default() -> Self {
        Self {
            share: 0.0,
            new: 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// The whitened squares are those of the full covariance `exp(-|t_i - t_j|/T)`, determinant included.
    #[test]
    fn exact_whitening_is_that_of_the_full_covariance() {
        let t = [0.0, 0.1, 0.25, 0.3, 0.7];
        let e = [0.3, -1.2, 0.8, 2.0, -0.4];
        let full = DMatrix::from_fn(5, 5, |i, j| (-f64::abs(t[i] - t[j]) / 0.2).exp());
        let right = nalgebra::DVector::from_column_slice(&e);
        let wanted = right.dot(&full.clone().lu().solve(&right).unwrap_or_default());
        let mut whitener = NoiseWhitener::new(0.2);
        let (mut sum, mut log_det) = (0.0, 0.0);
        for (t, e) in t.iter().zip(e) {
            let mut block = [Vector3::new(e, 0.0, 0.0)];
            log_det += whitener.take(*t, &mut block).new.ln();
            sum += block[0].norm_squared();
        }
        assert!((sum - wanted).abs() < 1.0e-12);
        assert!((log_det - full.determinant().ln()).abs() < 1.0e-12);
    }
}
