//! The ten parameters of the base with their covariance and identifiability.

use super::both::NoisySolution;
use super::solution::Directions;
use nalgebra::{SMatrix, SVector};
use poinsot_identify::Number;
use poinsot_spatial::{MassProperties, Vector3, tensor};

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
    pub(super) inflation: f64,
}

impl Ten {
    pub(super) fn new(solved: &NoisySolution, inflation: f64, rejected: bool) -> Self {
        let x = &solved.x;
        let m = solved.arm_mass / x[0];
        let mut value = [0.0; 10];
        value[..4].copy_from_slice(&[m, x[1], x[2], x[3]]);
        // Map from directions to u, by columns.
        let effect = &solved.influence;
        let mut map = SMatrix::<f64, 10, 10>::zeros();
        let d = SVector::<f64, 4>::new(-m / x[0], 1.0, 1.0, 1.0);
        let bias_x = solved
            .linear
            .in_units(&solved.linear.along(&effect.linear.bias));
        let mut bias = SVector::<f64, 10>::zeros();
        for i in 0..4 {
            bias[i] = d[i] * bias_x[i];
            for j in 0..4 {
                map[(i, j)] = d[i] * solved.linear.natural[i] * solved.linear.V[(i, j)];
            }
        }
        let mut open = [true; 10];
        mask(&solved.linear, &mut open[..4]);
        if let Some((y, directions)) = &solved.angular {
            mask(directions, &mut open[4..]);
            let rhs = effect.angular.bias + effect.coupling * bias_x;
            let bias_y = directions.in_units(&directions.along(&rhs));
            for i in 0..6 {
                value[4 + i] = y[i];
                bias[4 + i] = bias_y[i];
                for j in 0..6 {
                    map[(4 + i, 4 + j)] = directions.natural[i] * directions.V[(i, j)];
                }
            }
        }
        let covariance = map * effect.covariance.fixed_view::<10, 10>(0, 0) * map.transpose();
        let broken = rejected || x[0] <= 0.0;
        Self {
            value,
            covariance,
            bias,
            open: open.map(|o| o || broken),
            inflation,
        }
    }

    /// Mean product of the errors of two of the ten numbers: covariance and bias, equal both ways to the last bit.
    pub(super) fn mean_square(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i.max(j), i.min(j))] + self.bias[i] * self.bias[j]
    }

    /// A function of the ten numbers; undetermined if it depends on an undetermined one.
    pub(super) fn number(&self, nominal: f64, f: impl Fn(&[f64; 10]) -> f64) -> Number {
        let mut gradient = SVector::<f64, 10>::zeros();
        for k in 0..10 {
            let h = 1.0e-5 * (self.value[k].abs() + 1.0e-3 * self.value[0].abs().max(1.0));
            let (mut a, mut b) = (self.value, self.value);
            a[k] += h;
            b[k] -= h;
            gradient[k] = (f(&a) - f(&b)) / (2.0 * h);
        }
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
        let touch: f64 = (0..N)
            .filter(|&j| !d.usable[j])
            .map(|j| d.V[(i, j)] * d.V[(i, j)])
            .sum();
        *o = touch.sqrt() > TOUCH;
    }
}

pub(super) fn properties(u: &[f64; 10]) -> MassProperties {
    let y = [u[4], u[5], u[6], u[7], u[8], u[9]];
    MassProperties {
        mass: u[0],
        p_BoBcm_B: Vector3::new(u[1], u[2], u[3]),
        I_BBcm_B: tensor(y),
    }
}

pub(super) fn unit(k: usize) -> &'static str {
    match k {
        0 => "kg",
        1..=3 => "m",
        _ => "kg m2",
    }
}
