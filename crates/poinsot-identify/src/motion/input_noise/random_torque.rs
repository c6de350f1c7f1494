//! Exact discretisation of a Gauss-Markov torque, the momentum and its integral.
//!
//! ```text
//! g' = -g / T + w,      h' = g,      y' = h
//! ```
//!
//! with `w` white of density `2 sigma^2 / T` (Jazwinski 1970, example 3.19). All three axes of N are alike.

use nalgebra::Matrix3;
use poinsot_model::RandomTorque;

/// Correlation times until an impulse decays to round-off.
const FORGOTTEN: f64 = 36.0;
/// Gauss-Legendre nodes and weights of five points on [-1, 1] (Abramowitz and Stegun 1972, table 25.4).
const GAUSS_5: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// One interval: response to the torque at its start, and innovation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    h_s: f64,
    /// Of a torque of one at the start: torque, momentum and its integral at the end.
    pub kept: Vector3,
    /// Lower factor of the covariance of the innovation, in the same order.
    pub fresh: Matrix3<f64>,
}

type Vector3 = nalgebra::Vector3<f64>;

impl Step {
    pub fn new(torque: &RandomTorque, h_s: f64) -> Self {
        let T = torque.correlation_s;
        let density = 2.0 * torque.sigma_N_m * torque.sigma_N_m / T;
        let covariance = integrated(T, h_s) * density;
        // In units of the torque and the interval: the elements differ by powers of it.
        let unit = Vector3::new(1.0, h_s, h_s * h_s);
        let scaled = Matrix3::from_fn(|i, j| covariance[(i, j)] / (unit[i] * unit[j]));
        let fresh = Matrix3::from_diagonal(&unit) * semidefinite_root(scaled);
        Self {
            h_s,
            kept: response(T, h_s),
            fresh,
        }
    }

    pub fn lasts(&self, h_s: f64) -> bool {
        self.h_s == h_s
    }
}

/// Torque, momentum and its integral at a time after a torque of one.
fn response(T: f64, t: f64) -> Vector3 {
    let x = t / T;
    let momentum = -T * (-x).exp_m1();
    // x - (1 - e^-x), by its series where the two cancel.
    let integral = match x < 1.0e-2 {
        true => x * x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0))),
        false => x + (-x).exp_m1(),
    };
    Vector3::new((-x).exp(), momentum, T * T * integral)
}

/// Integral of `response response^T` over an interval.
fn integrated(T: f64, h: f64) -> Matrix3<f64> {
    let near = h.min(FORGOTTEN * T);
    let pieces = (2.0 * near / T).ceil().max(1.0);
    let step = near / pieces;
    let spans = (0..pieces as usize).map(|i| (i as f64 * step, step));
    // Beyond, momentum is constant and its integral a line: one piece is exact.
    let beyond = (h > near).then_some((near, h - near));
    let mut sum = Matrix3::zeros();
    for (from, length) in spans.chain(beyond) {
        for (node, weight) in GAUSS_5 {
            let r = response(T, from + 0.5 * length * (1.0 + node));
            sum += r * r.transpose() * (0.5 * length * weight);
        }
    }
    sum
}

/// Lower factor of a covariance that may be singular to round-off.
fn semidefinite_root(c: Matrix3<f64>) -> Matrix3<f64> {
    let mut L = Matrix3::zeros();
    for j in 0..3 {
        let left = c[(j, j)] - (0..j).map(|k| L[(j, k)] * L[(j, k)]).sum::<f64>();
        L[(j, j)] = left.max(0.0).sqrt();
        for i in j + 1..3 {
            let rest = c[(i, j)] - (0..j).map(|k| L[(i, k)] * L[(j, k)]).sum::<f64>();
            L[(i, j)] = if L[(j, j)] > 0.0 {
                rest / L[(j, j)]
            } else {
                0.0
            };
        }
    }
    L
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Many short steps and one long one leave the same covariance of torque, momentum and its integral.
    #[test]
    fn exact_one_step_is_a_thousand_short_ones() {
        for (T, h) in [(0.1, 0.1), (0.1, 7.0), (100.0, 0.1), (3.0, 5.0)] {
            let torque = RandomTorque {
                sigma_N_m: 0.7,
                correlation_s: T,
            };
            let whole = Step::new(&torque, h);
            let part = Step::new(&torque, h / 1000.0);
            let d = h / 1000.0;
            let F = Matrix3::new(
                part.kept[0],
                0.0,
                0.0,
                part.kept[1],
                1.0,
                0.0,
                part.kept[2],
                d,
                1.0,
            );
            let Q = part.fresh * part.fresh.transpose();
            let (mut P, mut all) = (Matrix3::zeros(), Matrix3::identity());
            for _ in 0..1000 {
                P = F * P * F.transpose() + Q;
                all = F * all;
            }
            let found = whole.fresh * whole.fresh.transpose();
            for i in 0..3 {
                assert!((all[(i, 0)] - whole.kept[i]).abs() < 1.0e-9 * whole.kept.amax());
                for j in 0..3 {
                    let size = (P[(i, i)] * P[(j, j)]).sqrt();
                    assert!(
                        (P[(i, j)] - found[(i, j)]).abs() < 1.0e-8 * size,
                        "{T} {h} {i} {j}"
                    );
                }
            }
        }
    }
}
