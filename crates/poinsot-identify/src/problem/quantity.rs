//! Mass, mass centre and central inertia as functions of the unknowns, with their gradients.

use crate::problem::parameters::{Equations, Parameters, TENSOR, UnknownKind};
use poinsot_dynamics::Kinematics;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3};

/// The ten barycentric parameters of a body, or of several taken as one, as linear functions of the
/// unknowns.
#[derive(Debug, Clone)]
pub struct TenParameters {
    /// Values at the answer.
    pub value: [f64; 10],
    /// Gradients over the unknowns.
    pub gradient: Vec<Vec<f64>>,
}

/// A number with its gradient over the unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Value at the answer.
    pub value: f64,
    /// Gradient over the unknowns.
    pub gradient: Vec<f64>,
}

impl Quantity {
    /// One of the unknowns.
    pub fn unknown(at: usize, x: &[f64]) -> Self {
        let mut gradient = vec![0.0; x.len()];
        gradient[at] = 1.0;
        let value = x[at];
        Self { value, gradient }
    }
}

/// A number of a body, by its place among [`poinsot_spatial::MASS_PROPERTY_NAMES`]; `None` where rotation alone is seen and does not
/// depend on it.
pub fn mass_property(
    parameters: &Parameters,
    body: usize,
    number: usize,
    x: &[f64],
) -> Option<Quantity> {
    let kind = match (parameters.equations, number) {
        (Equations::Momentum, k) => {
            return Some(TenParameters::of_body(parameters, body, x).mass_property(k));
        }
        (_, 0) => return None,
        (_, 1..=3) => UnknownKind::MassCentre(number - 1),
        _ => UnknownKind::CentralInertia(number - 4),
    };
    Some(Quantity::unknown(parameters.place(&kind)?, x))
}

impl TenParameters {
    /// Of one body.
    pub fn of_body(parameters: &Parameters, body: usize, x: &[f64]) -> Self {
        let value = parameters.bodies(x)[body].to_array();
        let mut gradient = vec![vec![0.0; parameters.len()]; 10];
        for (unknown, slopes) in parameters.slopes(x).iter().enumerate() {
            for (at, slope) in slopes.iter().filter(|(at, _)| at / 10 == body) {
                gradient[at % 10][unknown] += slope;
            }
        }
        Self { value, gradient }
    }

    /// Of the whole vehicle at the placement given, about the base origin in B.
    pub fn of_system(parameters: &Parameters, kinematics: &Kinematics, x: &[f64]) -> Self {
        let mut sum = Self {
            value: [0.0; 10],
            gradient: vec![vec![0.0; x.len()]; 10],
        };
        for (body, (R, p)) in kinematics.R.iter().zip(&kinematics.p).enumerate() {
            let own = Self::of_body(parameters, body, x);
            for (k, column) in parameters_in_base(R, p).iter().enumerate() {
                for (row, factor) in column.iter().enumerate().filter(|(_, f)| **f != 0.0) {
                    sum.value[row] += factor * own.value[k];
                    for (g, o) in sum.gradient[row].iter_mut().zip(&own.gradient[k]) {
                        *g += factor * o;
                    }
                }
            }
        }
        sum
    }

    /// The body with these numbers.
    pub fn inertial(&self) -> InertialParameters {
        InertialParameters::from_array(&self.value)
    }

    /// Parameter k itself.
    pub fn parameter(&self, k: usize) -> Quantity {
        Quantity {
            value: self.value[k],
            gradient: self.gradient[k].clone(),
        }
    }

    /// A number by its place among [`poinsot_spatial::MASS_PROPERTY_NAMES`].
    pub fn mass_property(&self, k: usize) -> Quantity {
        match k {
            0 => self.parameter(0),
            1..=3 => self.mass_centre(k - 1),
            _ => self.central_inertia(k - 4),
        }
    }

    /// Component of the mass centre, `c = mc / m`.
    pub fn mass_centre(&self, axis: usize) -> Quantity {
        let m = self.value[0];
        let c = self.value[1 + axis] / m;
        let gradient = self.gradient[1 + axis]
            .iter()
            .zip(&self.gradient[0])
            .map(|(dmc, dm)| (dmc - c * dm) / m)
            .collect();
        Quantity { value: c, gradient }
    }

    /// Element k of the central inertia, `I_Bcm = I_Bo - m (c.c 1 - c c^T)` (parallel-axis theorem).
    pub fn central_inertia(&self, k: usize) -> Quantity {
        let (i, j) = TENSOR[k];
        let m = self.value[0];
        let mc = [self.value[1], self.value[2], self.value[3]];
        let square: f64 = mc.iter().map(|x| x * x).sum();
        let diagonal = f64::from(u8::from(i == j));
        let shift = diagonal * square - mc[i] * mc[j];
        let value = self.value[4 + k] - shift / m;
        let mut gradient = self.gradient[4 + k].clone();
        for (u, g) in gradient.iter_mut().enumerate() {
            *g += shift / (m * m) * self.gradient[0][u];
            for (axis, first) in mc.iter().enumerate() {
                let d_square = 2.0 * diagonal * first;
                let d_product =
                    f64::from(u8::from(axis == i)) * mc[j] + f64::from(u8::from(axis == j)) * mc[i];
                *g -= (d_square - d_product) / m * self.gradient[1 + axis][u];
            }
        }
        Quantity { value, gradient }
    }
}

/// Barycentric parameters turned to another frame: the 10 x 10 map from body i (rotation `R`, origin
/// `p` in the base) to the base, in the order of `PARAMETER_NAMES`.
pub fn parameters_in_base(R: &Matrix3, p: &Vector3) -> [[f64; 10]; 10] {
    std::array::from_fn(|k| {
        InertialParameters::from_array(&unit(k))
            .transported(R, p)
            .to_array()
    })
}

/// The ten barycentric parameters with this one alone, of size one.
pub fn unit(k: usize) -> [f64; 10] {
    std::array::from_fn(|i| f64::from(u8::from(i == k)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ten parameters as their own unknowns.
    fn ten(value: [f64; 10]) -> TenParameters {
        let unit = |i: usize| (0..10).map(|k| f64::from(u8::from(i == k))).collect();
        TenParameters {
            value,
            gradient: (0..10).map(unit).collect(),
        }
    }

    #[test]
    fn exact_gradients_of_mass_centre_and_central_inertia_are_their_slopes() {
        let at = [7.0, 0.7, -1.4, 2.1, 3.0, 0.2, 4.0, -0.3, 0.1, 5.0];
        let quantities = |v| {
            let t = ten(v);
            let centre = (0..3).map(|k| t.mass_centre(k));
            let inertia = (0..6).map(|k| t.central_inertia(k));
            centre.chain(inertia).collect::<Vec<_>>()
        };
        let here = quantities(at);
        for k in 0..10 {
            let h = 1e-5;
            let (mut up, mut down) = (at, at);
            up[k] += h;
            down[k] -= h;
            let ends = quantities(up).into_iter().zip(quantities(down));
            for (q, (up, down)) in here.iter().zip(ends) {
                let slope = (up.value - down.value) / (2.0 * h);
                assert!((slope - q.gradient[k]).abs() < 1e-8, "{k}: {q:?}");
            }
        }
    }
}
