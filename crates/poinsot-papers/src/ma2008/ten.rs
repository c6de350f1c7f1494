//! The ten parameters of the base with their covariance and identifiability.

use super::both::NoisySolution;
use super::solve::Directions;
use nalgebra::{SMatrix, SVector};
use poinsot_identify::Number;

/// Chi-square per degree of freedom above which the declared noise is inconsistent.
pub(super) const MISFIT: f64 = 1.5;
/// Largest component along undetermined directions of a number that is reported.
const TOUCH: f64 = 1.0e-4;

/// The ten numbers `u = [m, com, elements of I]` with covariance and undetermined elements.
pub(super) struct Ten {
    pub(super) value: [f64; 10],
    pub(super) covariance: SMatrix<f64, 10, 10>,
    pub(super) bias: SVector<f64, 10>,
    pub(super) open: [bool; 10],
    /// Factor of sigmas for residuals above the declared noise.
    pub(super) inflation: f64,
    pub(super) rejected: bool,
}

impl Ten {
    pub(super) fn new(solved: &NoisySolution, rejected: bool) -> Self {
        let (x, effect) = (&solved.x, &solved.influence);
        let m = solved.arm_mass / x[0];
        // Map from directions to u, by columns.
        let mut map = SMatrix::<f64, 10, 10>::zeros();
        let mut ten = Self {
            value: [0.0; 10],
            covariance: map,
            bias: SVector::zeros(),
            open: [true; 10],
            inflation: solved.chi2.sqrt().max(1.0),
            rejected,
        };
        let d = [-m / x[0], 1.0, 1.0, 1.0];
        let bias_x = solved.linear.along(&effect.linear.bias);
        let bias_x = solved.linear.in_units(&bias_x);
        ten.value[..4].copy_from_slice(&[m, x[1], x[2], x[3]]);
        for i in 0..4 {
            ten.bias[i] = d[i] * bias_x[i];
            for j in 0..4 {
                map[(i, j)] = d[i] * solved.linear.natural[i] * solved.linear.V[(i, j)];
            }
        }
        mask(&solved.linear, &mut ten.open[..4]);
        if let Some((y, directions)) = &solved.angular {
            mask(directions, &mut ten.open[4..]);
            let rhs = effect.angular.bias + effect.coupling * bias_x;
            let bias_y = directions.in_units(&directions.along(&rhs));
            for i in 0..6 {
                ten.value[4 + i] = y[i];
                ten.bias[4 + i] = bias_y[i];
                for j in 0..6 {
                    map[(4 + i, 4 + j)] = directions.natural[i] * directions.V[(i, j)];
                }
            }
        }
        ten.covariance = map * effect.covariance.fixed_view::<10, 10>(0, 0) * map.transpose();
        let broken = rejected || x[0] <= 0.0;
        ten.open = ten.open.map(|o| o || broken);
        ten
    }

    /// Mean product of the errors of two of the ten numbers: covariance and bias, equal both ways to the last bit.
    pub(super) fn mean_square(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i.max(j), i.min(j))] + self.bias[i] * self.bias[j]
    }

    /// A function of the ten numbers; undetermined if it depends on an undetermined one.
    pub(super) fn number(&self, nominal: f64, f: impl Fn(&[f64; 10]) -> f64) -> Number {
        let gradient = SVector::<f64, 10>::from_fn(|k, _| {
            let h = 1.0e-5 * (self.value[k].abs() + 1.0e-3 * self.value[0].abs().max(1.0));
            let (mut a, mut b) = (self.value, self.value);
            a[k] += h;
            b[k] -= h;
            (f(&a) - f(&b)) / (2.0 * h)
        });
        let value = f(&self.value);
        let open = (0..10).any(|k| self.open[k] && gradient[k] != 0.0);
        if open || !value.is_finite() {
            return Number::undetermined(nominal);
        }
        let variance = (self.covariance * gradient).dot(&gradient).max(0.0);
        let bias = self.bias.dot(&gradient);
        let sigma = self.inflation * (variance + bias * bias).sqrt();
        Number::data(value, sigma, nominal)
    }
}

fn mask<const N: usize>(d: &Directions<N>, open: &mut [bool]) {
    for (i, o) in open.iter_mut().enumerate() {
        let unusable = (0..N).filter(|&j| !d.usable[j]);
        let touch: f64 = unusable.map(|j| d.V[(i, j)] * d.V[(i, j)]).sum();
        *o = touch.sqrt() > TOUCH;
    }
}
