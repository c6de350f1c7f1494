//! Attitude quaternions `[x, y, z, w]` (Hamilton, body to inertial) and rotation vectors in body axes.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Order of the four numbers in the columns `q_x q_y q_z q_w`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// Scalar last, as declared.
    Xyzw,
    /// Scalar first.
    Wxyz,
}

/// What the quaternion rotates. A JPL quaternion has the numbers of the Hamilton quaternion of the inverse sense,
/// so the eight conventions make only four different readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sense {
    /// Body to inertial, Hamilton, as declared; the same numbers as inertial to body, JPL.
    BodyToInertial,
    /// Inertial to body, Hamilton; the same numbers as body to inertial, JPL.
    InertialToBody,
}

/// Signed permutation of the gyro's axes: body axis `i` is `sign[i]` times gyro axis `axis[i]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Axes {
    /// Gyro axis of each body axis, 0..=2.
    pub axis: [usize; 3],
    /// `1` or `-1`.
    pub sign: [i8; 3],
}

impl Axes {
    /// The axes that are read.
    pub const IDENTITY: Self = Self {
        axis: [0, 1, 2],
        sign: [1, 1, 1],
    };
    /// Each of them reversed.
    pub const REVERSED: Self = Self {
        axis: [0, 1, 2],
        sign: [-1, -1, -1],
    };

    /// A vector in these axes.
    pub fn turned(self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from_fn(|i, _| f64::from(self.sign[i]) * v[self.axis[i]])
    }

    /// `1`, and `-1` of axes that are mirrored.
    pub(crate) fn determinant(self) -> i8 {
        let [x, y, _] = self.axis;
        let order = if (x + 1) % 3 == y { 1 } else { -1 };
        self.sign.iter().product::<i8>() * order
    }

    /// The axes that turn these back.
    pub fn inverse(self) -> Self {
        let own = |k: usize| self.axis.iter().position(|axis| *axis == k).unwrap_or(k);
        let axis = [0, 1, 2].map(own);
        let sign = axis.map(|k| self.sign[k]);
        Self { axis, sign }
    }

    /// Every signed permutation.
    pub fn all() -> impl Iterator<Item = Self> {
        const ORDERS: [[usize; 3]; 6] = [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ];
        ORDERS.into_iter().flat_map(|axis| {
            (0..8_u8).map(move |bits| Self {
                axis,
                sign: [0, 1, 2].map(|k| if bits >> k & 1 == 1 { -1 } else { 1 }),
            })
        })
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("(")?;
        for (k, (axis, sign)) in self.axis.iter().zip(self.sign).enumerate() {
            let comma = if k > 0 { ", " } else { "" };
            let minus = if sign < 0 { "-" } else { "" };
            let name = ["x", "y", "z"].get(*axis).copied().unwrap_or("?");
            write!(f, "{comma}{minus}{name}")?;
        }
        f.write_str(")")
    }
}

fn unit([x, y, z, w]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// Shortest rotation vector from attitude `from` to attitude `to`, rad, body axes.
pub(crate) fn turn_between(from: [f64; 4], to: [f64; 4]) -> [f64; 3] {
    (unit(from).inverse() * unit(to)).scaled_axis().into()
}

/// Attitude `from` rotated by a rotation vector in its body axes.
pub(crate) fn turned(from: [f64; 4], phi: [f64; 3]) -> [f64; 4] {
    let q = unit(from) * UnitQuaternion::from_scaled_axis(Vector3::from(phi));
    let q = q.into_inner();
    let norm = q.norm();
    [q.i / norm, q.j / norm, q.k / norm, q.w / norm]
}

/// Rate of the rotation vector `phi` of a body rotating at `omega` (body axes):
/// `phi' = omega + phi x omega / 2 + c phi x (phi x omega)`, `c = (1 - (a/2) cot(a/2)) / a^2`, `a = |phi|` (Bortz
/// 1971, eq. 10).
pub(crate) fn rotation_vector_rate(phi: [f64; 3], omega: [f64; 3]) -> [f64; 3] {
    let (phi, omega) = (Vector3::from(phi), Vector3::from(omega));
    let a2 = phi.norm_squared();
    let c = if a2 < 1e-4 {
        // Series of the closed form, which loses digits here; the next term is below 1e-16.
        1.0 / 12.0 + a2 / 720.0 + a2 * a2 / 30240.0
    } else {
        let half = 0.5 * a2.sqrt();
        (1.0 - half / half.tan()) / a2
    };
    let once = phi.cross(&omega);
    (omega + 0.5 * once + c * phi.cross(&once)).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_turns_undo_each_other() {
        let q = [0.1, -0.2, 0.3, (1.0_f64 - 0.14).sqrt()];
        let phi = [0.4, -1.1, 0.7];
        let back = turn_between(q, turned(q, phi));
        assert!(phi.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-15));
    }

    #[test]
    fn exact_rate_of_the_rotation_vector_matches_a_difference() {
        for scale in [1e-3, 0.2, 2.0] {
            let (q, phi) = ([0.0, 0.0, 0.0, 1.0], [0.4, -1.1, 0.7].map(|c| c * scale));
            let omega = [0.3, 0.2, -0.5];
            let h = 1e-5;
            let step = |s: f64| turn_between(q, turned(turned(q, phi), omega.map(|c| c * s * h)));
            let (plus, minus) = (step(1.0), step(-1.0));
            let rate = rotation_vector_rate(phi, omega);
            for k in 0..3 {
                assert!((rate[k] - (plus[k] - minus[k]) / (2.0 * h)).abs() < 1e-9);
            }
        }
    }
}
