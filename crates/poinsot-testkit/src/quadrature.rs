//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Points per panel: exact for polynomials of degree 31.
const POINTS: usize = 16;

/// Nodes and weights on [-1, 1].
pub(crate) struct GaussLegendre([(f64, f64); POINTS]);

impl GaussLegendre {
    /// The roots of the Legendre polynomial of degree [`POINTS`], by Newton's method.
    pub(crate) fn new() -> Self {
        let n = POINTS as f64;
        let mut rule = [(0.0, 0.0); POINTS];
        for (i, point) in rule.iter_mut().enumerate() {
            let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut p, mut previous) = (1.0, 0.0);
                for k in 0..POINTS {
                    let k = k as f64;
                    (p, previous) = (((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0), p);
                }
                slope = n * (x * p - previous) / (x * x - 1.0);
                x -= p / slope;
            }
            *point = (x, 2.0 / ((1.0 - x * x) * slope * slope));
        }
        Self(rule)
    }

    /// The integral of `f` from `a` to `b` in panels no longer than `longest`.
    pub(crate) fn integrate(&self, f: impl Fn(f64) -> f64, a: f64, b: f64, longest: f64) -> f64 {
        let panels = ((b - a).abs() / longest).ceil().max(1.0);
        let half = 0.5 * (b - a) / panels;
        (0..panels as usize)
            .map(|k| {
                let middle = a + half * (2.0 * k as f64 + 1.0);
                let sum: f64 = self.0.iter().map(|(x, w)| w * f(middle + half * x)).sum();
                half * sum
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_polynomial_and_exponential() {
        let rule = GaussLegendre::new();
        let cube = rule.integrate(|x| 4.0 * x.powi(31), 0.0, 1.0, 2.0);
        assert!((cube - 0.125).abs() < 1e-15);
        let e = rule.integrate(f64::exp, -1.0, 3.0, 0.7);
        assert!((e / (3.0_f64.exp() - (-1.0_f64).exp()) - 1.0).abs() < 1e-15);
    }
}
