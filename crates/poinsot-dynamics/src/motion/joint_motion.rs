//! Prescribed motion of one joint: position, rate and acceleration at any time.

use crate::motion::piecewise::{Jet, NodeError, PiecewisePolynomial};
use std::f64::consts::TAU;

/// A sum of harmonics: `offset + sum_k sine_k sin(2 pi k f t) + cosine_k cos(2 pi k f t)`, k from 1.
///
/// Periodic and infinitely smooth (Swevers et al. 1997).
#[derive(Debug, Clone, PartialEq)]
pub struct Fourier {
    /// Offset, rad or m.
    pub offset: f64,
    /// Base frequency f, Hz.
    pub base_frequency_hz: f64,
    /// Sine coefficients, rad or m.
    pub sine: Vec<f64>,
    /// Cosine coefficients, rad or m.
    pub cosine: Vec<f64>,
}

/// Motion of one joint, rad or m.
#[derive(Debug, Clone, PartialEq)]
pub enum JointMotion {
    /// Polynomials between nodes; held outside.
    Nodes(PiecewisePolynomial),
    /// Harmonics.
    Fourier(Fourier),
}

impl JointMotion {
    /// A joint that stays where it is, rad or m.
    pub fn locked(position: f64) -> Self {
        Self::Nodes(PiecewisePolynomial::constant(position))
    }

    /// Rest-to-rest quintics between knots; holds before the first and after the last.
    ///
    /// # Errors
    /// Nodes that define no profile.
    pub fn quintic_rest(time_s: &[f64], position: &[f64]) -> Result<Self, NodeError> {
        PiecewisePolynomial::quintic_rest(time_s, position).map(Self::Nodes)
    }

    /// Clamped cubic spline through nodes; holds before the first and after the last.
    ///
    /// # Errors
    /// Nodes that define no profile.
    pub fn cubic_clamped(time_s: &[f64], position: &[f64]) -> Result<Self, NodeError> {
        PiecewisePolynomial::cubic_clamped(time_s, position).map(Self::Nodes)
    }

    /// Position, rate and acceleration at `t` on the smooth interval that holds `within`.
    #[inline]
    pub fn at(&self, t: f64, within: f64) -> Jet {
        match self {
            Self::Nodes(p) => p.at(t, within),
            Self::Fourier(f) => f.at(t),
        }
    }

    /// The times at which integration restarts, s.
    pub fn breaks(&self) -> &[f64] {
        match self {
            Self::Nodes(p) => p.nodes(),
            Self::Fourier(_) => &[],
        }
    }
}

impl Fourier {
    /// Position, rate and acceleration at `t`.
    pub fn at(&self, t: f64) -> Jet {
        let mut jet = Jet {
            value: self.offset,
            ..Jet::default()
        };
        let harmonics = self.sine.len().max(self.cosine.len());
        let mut frequency = 0.0;
        for k in 0..harmonics {
            frequency += TAU * self.base_frequency_hz;
            let (sin, cos) = (frequency * t).sin_cos();
            let a = self.sine.get(k).copied().unwrap_or(0.0);
            let b = self.cosine.get(k).copied().unwrap_or(0.0);
            let y = a * sin + b * cos;
            jet.value += y;
            jet.rate += frequency * (a * cos - b * sin);
            jet.acceleration -= frequency * frequency * y;
        }
        jet
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_fourier_derivatives_agree_with_differences() {
        let f = Fourier {
            offset: 0.4,
            base_frequency_hz: 0.1,
            sine: vec![0.3, -0.2],
            cosine: vec![0.0, 0.1, 0.05],
        };
        let (t, h) = (3.3, 1e-4);
        let (a, b, c) = (f.at(t - h), f.at(t), f.at(t + h));
        assert!(((c.value - a.value) / (2.0 * h) - b.rate).abs() < 1e-7);
        assert!(((c.rate - a.rate) / (2.0 * h) - b.acceleration).abs() < 1e-7);
        assert!((f.at(0.0).value - 0.55).abs() < 1e-15);
        assert!((f.at(10.0).value - 0.55).abs() < 1e-14);
    }
}
