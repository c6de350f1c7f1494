//! Ten free coordinates of a physical body: log-Cholesky (Rucker and Wensing 2022).

use crate::inertial::{InertialParameters, pseudo_inertia};
use crate::{Matrix3, Vector3};
use nalgebra::Matrix4;

/// Log-Cholesky coordinates `(alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3)` of a body whose pseudo-inertia is
/// positive definite (Rucker and Wensing 2022, eq. 12):
///
/// ```text
/// J = U U^T        U = e^alpha [ e^d1  s12   s13   t1 ]
///                              [ 0     e^d2  s23   t2 ]
///                              [ 0     0     e^d3  t3 ]
///                              [ 0     0     0     1  ]
/// ```
///
/// The mass is `e^(2 alpha)`, t the mass centre, and `S S^T` with the upper left block S the second moment about it
/// per mass. Every value of the ten is a body of positive mass density, and every such body has one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogCholesky {
    /// The ten coordinates in the order above; lengths in m.
    pub theta: [f64; 10],
}

impl LogCholesky {
    /// The coordinates of a body; `None` where its pseudo-inertia is not positive definite.
    pub fn from_parameters(body: &InertialParameters) -> Option<Self> {
        let m = body.mass;
        if m.is_nan() || m <= 0.0 {
            return None;
        }
        let t = body.mc_B / m;
        let J = pseudo_inertia(body);
        let about_origin: Matrix3 = J.fixed_view::<3, 3>(0, 0).into();
        let a = about_origin / m - t * t.transpose();
        // From the last row up: the factor is upper triangular.
        let root = |x: f64| (x > 0.0 && x.is_finite()).then(|| x.sqrt());
        let s33 = root(a[(2, 2)])?;
        let (s23, s13) = (a[(1, 2)] / s33, a[(0, 2)] / s33);
        let s22 = root(a[(1, 1)] - s23 * s23)?;
        let s12 = (a[(0, 1)] - s13 * s23) / s22;
        let s11 = root(a[(0, 0)] - s12 * s12 - s13 * s13)?;
        Some(Self {
            theta: [
                0.5 * m.ln(),
                s11.ln(),
                s22.ln(),
                s33.ln(),
                s12,
                s23,
                s13,
                t.x,
                t.y,
                t.z,
            ],
        })
    }

    /// The factor `U`.
    fn factor(&self) -> Matrix4<f64> {
        let [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] = self.theta;
        Matrix4::new(
            d1.exp(),
            s12,
            s13,
            t1, //
            0.0,
            d2.exp(),
            s23,
            t2, //
            0.0,
            0.0,
            d3.exp(),
            t3, //
            0.0,
            0.0,
            0.0,
            1.0,
        ) * alpha.exp()
    }

    /// The body.
    pub fn parameters(&self) -> InertialParameters {
        let U = self.factor();
        from_pseudo_inertia(&(U * U.transpose()))
    }

    /// Slope of the ten parameters over the coordinates: row i of entry k is that of parameter i over coordinate k.
    pub fn jacobian(&self) -> [[f64; 10]; 10] {
        let U = self.factor();
        let scale = self.theta[0].exp();
        // Where a coordinate stands in U.
        const PLACE: [(usize, usize); 10] = [
            (3, 3),
            (0, 0),
            (1, 1),
            (2, 2),
            (0, 1),
            (1, 2),
            (0, 2),
            (0, 3),
            (1, 3),
            (2, 3),
        ];
        std::array::from_fn(|k| {
            let dU = match k {
                0 => U,
                _ => {
                    let mut dU = Matrix4::zeros();
                    let at = PLACE[k];
                    dU[at] = if k <= 3 { U[at] } else { scale };
                    dU
                }
            };
            let half = dU * U.transpose();
            from_pseudo_inertia(&(half + half.transpose())).to_array()
        })
    }
}

/// The ten parameters of a pseudo-inertia: linear in it.
fn from_pseudo_inertia(J: &Matrix4<f64>) -> InertialParameters {
    let sigma: Matrix3 = J.fixed_view::<3, 3>(0, 0).into();
    let mc_B: Vector3 = J.fixed_view::<3, 1>(0, 3).into();
    InertialParameters {
        mass: J[(3, 3)],
        mc_B,
        I_BBo_B: Matrix3::identity() * sigma.trace() - sigma,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: LogCholesky = LogCholesky {
        theta: [1.3, -0.7, -1.2, -0.4, 0.2, -0.15, 0.3, 0.4, -0.2, 0.1],
    };

    #[test]
    fn exact_coordinates_return() {
        let back = LogCholesky::from_parameters(&SOME.parameters()).unwrap();
        for (a, b) in SOME.theta.iter().zip(&back.theta) {
            assert!((a - b).abs() < 1.0e-13);
        }
        let m = SOME.parameters();
        assert!((m.mass - 2.6_f64.exp()).abs() < 1.0e-12);
        assert!((m.mc_B / m.mass - Vector3::new(0.4, -0.2, 0.1)).norm() < 1.0e-14);
    }

    #[test]
    fn exact_jacobian_is_the_slope() {
        let jacobian = SOME.jacobian();
        let step = 1.0e-6;
        for (k, row) in jacobian.iter().enumerate() {
            let ends = [step, -step].map(|d| {
                let mut moved = SOME;
                moved.theta[k] += d;
                moved.parameters().to_array()
            });
            for (i, entry) in row.iter().enumerate() {
                let slope = (ends[0][i] - ends[1][i]) / (2.0 * step);
                let gap = (slope - entry).abs();
                assert!(gap < 1.0e-8, "parameter {i} over {k}: {gap:e}");
            }
        }
    }

    #[test]
    fn prop_every_value_is_a_physical_body() {
        // A linear congruential sequence is random enough.
        let mut state = 7_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            6.0 * ((state >> 33) as f64 / 2_f64.powi(31) - 0.5)
        };
        for _ in 0..200 {
            let body = LogCholesky {
                theta: std::array::from_fn(|_| next()),
            };
            assert!(body.parameters().mass > 0.0);
            assert!(pseudo_inertia(&body.parameters()).cholesky().is_some());
        }
    }

    #[test]
    fn unit_an_impossible_body_has_none() {
        let mut body = SOME.parameters();
        body.I_BBo_B[(0, 0)] += 10.0 * body.I_BBo_B.trace();
        assert_eq!(LogCholesky::from_parameters(&body), None);
        body.mass = 0.0;
        assert_eq!(LogCholesky::from_parameters(&body), None);
    }
}
