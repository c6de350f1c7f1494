//! Six rows of the linearised equations.

use super::locked::BaseMotion;
use super::state::PoseMomentum;
use super::{Column, HALF, STATE};
use crate::algebra::{M3, Real, V3, parts, stack};
use crate::quaternion;
use core::ops::Mul;
use nalgebra::{Matrix3, SMatrix, Vector3, Vector6};

/// Six rows over a change of the state, position included.
pub type Matrix6x12 = SMatrix<f64, HALF, STATE>;

/// Numbers of a change of the state before the momenta, and of the attitude.
const MOMENTUM: usize = 6;
const ATTITUDE: usize = 3;

/// Six rows over a change of the state. The position enters nowhere, so its three columns are left out.
#[derive(Debug, Clone, Copy, Default)]
pub struct StateRows<T = f64> {
    pub(super) attitude: [[T; HALF]; ATTITUDE],
    pub(super) momentum: [[T; HALF]; HALF],
    /// Whether a momentum enters.
    pub(super) coupled: bool,
}

impl<R: Copy> StateRows<R> {
    #[inline(always)]
    pub(super) fn attitude_times<T: Real + Mul<R, Output = T>>(
        &self,
        phi: &[T; ATTITUDE],
    ) -> [T; HALF] {
        let mut sum = scaled(&self.attitude[0], phi[0]);
        add(&mut sum, &self.attitude[1], phi[1]);
        add(&mut sum, &self.attitude[2], phi[2]);
        sum
    }

    #[inline(always)]
    pub(super) fn momentum_times<T: Real + Mul<R, Output = T>>(
        &self,
        momentum: &[T; HALF],
    ) -> [T; HALF] {
        let mut sum = scaled(&self.momentum[0], momentum[0]);
        for (column, x) in self.momentum.iter().zip(momentum).skip(1) {
            add(&mut sum, column, *x);
        }
        sum
    }
}

#[inline(always)]
fn scaled<R: Copy, T: Real + Mul<R, Output = T>>(x: &[R; HALF], factor: T) -> [T; HALF] {
    let [a, b, c, d, e, f] = *x;
    [
        factor * a,
        factor * b,
        factor * c,
        factor * d,
        factor * e,
        factor * f,
    ]
}

/// `sum += x factor`.
#[inline(always)]
pub(super) fn add<R: Copy, T: Real + Mul<R, Output = T>>(
    sum: &mut [T; HALF],
    x: &[R; HALF],
    factor: T,
) {
    let ([a, b, c, d, e, f], [p, q, r, s, t, u]) = (*x, *sum);
    *sum = [
        p + factor * a,
        q + factor * b,
        r + factor * c,
        s + factor * d,
        t + factor * e,
        u + factor * f,
    ];
}

impl StateRows {
    /// No slope.
    pub const NONE: Self = Self {
        attitude: [[0.0; HALF]; ATTITUDE],
        momentum: [[0.0; HALF]; HALF],
        coupled: false,
    };

    /// The rows of a matrix, of which the three columns of the position are zero.
    pub fn of_matrix(rows: &Matrix6x12) -> Self {
        let columns = &rows.data.0;
        let [x, y, z, .., a, b, c, d, e, f] = *columns;
        let momentum = [a, b, c, d, e, f];
        Self {
            attitude: [x, y, z],
            coupled: momentum != [[0.0; HALF]; HALF],
            momentum,
        }
    }

    /// Change of the momentum's rate `[dP'; dh']` with the state where a force (N) and a torque about the system's mass centre
    /// (N m) turn with the base: the lower half of `A`.
    #[inline(always)]
    pub fn of_wrench(
        state: &PoseMomentum,
        force_B: &Vector3<f64>,
        torque_B: &Vector3<f64>,
    ) -> Self {
        let R = quaternion::rotation(&quaternion::numbers(&state.R_NB));
        let (F, T) = (V3::of(force_B), V3::of(torque_B));
        let axes = M3::diagonal(1.0).0;
        let mut rows = Self::NONE;
        for (j, axis) in axes.iter().enumerate() {
            rows.attitude[j] = stack(&R.times(&axis.cross(&F)), &R.times(&axis.cross(&T)));
        }
        rows
    }

    /// All twelve columns.
    pub fn matrix(&self) -> Matrix6x12 {
        let mut rows = Matrix6x12::zeros();
        rows.data.0[..ATTITUDE].copy_from_slice(&self.attitude);
        rows.data.0[MOMENTUM..].copy_from_slice(&self.momentum);
        rows
    }

    /// `rows x` for a change `x` of the state.
    #[inline]
    pub fn times(&self, x: &Column) -> Vector6<f64> {
        let [phi_x, phi_y, phi_z, _, _, _, a, b, c, d, e, f, ..] = &x.data.0[0];
        let momentum = &[*a, *b, *c, *d, *e, *f];
        let mut sum = self.attitude_times(&[*phi_x, *phi_y, *phi_z]);
        if *momentum != [0.0; HALF] {
            add(&mut sum, &self.momentum_times(momentum), 1.0);
        }
        Vector6::from(sum)
    }
}

/// What a change of the twist `[v; w]` does to the rate of the pose, `[dphi_B'; dp_N']`.
///
/// ```
/// use poinsot_dynamics::propagation::pose_change;
/// use poinsot_spatial::{Matrix3, Vector6};
///
/// let twist = Vector6::new(1.0, 2.0, 3.0, 0.1, 0.2, 0.3);
/// let change = pose_change(&Matrix3::identity(), &twist);
/// assert_eq!(change, Vector6::new(0.1, 0.2, 0.3, 1.0, 2.0, 3.0));
/// ```
#[inline]
pub fn pose_change(R_NB: &Matrix3<f64>, twist: &Vector6<f64>) -> Vector6<f64> {
    let (v, w) = parts(&twist.data.0[0]);
    Vector6::from(pose_rate(&M3::of(R_NB), &v, &w))
}

/// The same from the two vectors of the twist.
#[inline(always)]
fn pose_rate(R_NB: &M3<f64>, v: &V3<f64>, w: &V3<f64>) -> [f64; HALF] {
    stack(w, &R_NB.times(v))
}

impl BaseMotion {
    /// Change of the twist `[v; w]` with the state: `V_x`.
    #[inline(always)]
    pub fn twist_rows(&self, state: &PoseMomentum) -> StateRows {
        let centre = &self.centre;
        let axes = M3::diagonal(1.0).0;
        let to_base = quaternion::rotation(&quaternion::numbers(&state.R_NB))
            .transposed()
            .0;
        let (l, h) = (V3::of(&centre.l_B), V3::of(&centre.h_SScm_B));
        let nothing = V3::default();
        let mut rows = StateRows {
            coupled: true,
            ..StateRows::NONE
        };
        for (j, axis) in axes.iter().enumerate() {
            // R^T a moves by a x dphi when the base turns.
            let (v, w) = self.of_central(&l.cross(axis), &h.cross(axis));
            rows.attitude[j] = stack(&v, &w);
            rows.momentum[j] = stack(&(to_base[j] / centre.mass), &nothing);
            let (v, w) = self.of_central(&nothing, &to_base[j]);
            rows.momentum[ATTITUDE + j] = stack(&v, &w);
        }
        rows
    }

    /// Change of the pose's rate `[dphi_B'; dp_N']` with the state, from [`Self::twist_rows`]: the upper half of `A`.
    #[inline(always)]
    pub fn pose_rows(&self, state: &PoseMomentum, twist_rows: &StateRows) -> StateRows {
        let R = quaternion::rotation(&quaternion::numbers(&state.R_NB));
        let axes = M3::diagonal(1.0).0;
        let (v, w) = (V3::of(&self.twist.v), V3::of(&self.twist.w));
        let one_over_mass = 1.0 / self.centre.mass;
        let mut rows = StateRows {
            coupled: true,
            ..StateRows::NONE
        };
        for (j, axis) in axes.iter().enumerate() {
            let (dv, dw) = parts(&twist_rows.attitude[j]);
            let (dv, dw) = (dv - v.cross(axis), dw - w.cross(axis));
            rows.attitude[j] = pose_rate(&R, &dv, &dw);
            // R R^T / m.
            rows.momentum[j] = stack(&V3::default(), &(*axis * one_over_mass));
            let (dv, dw) = parts(&twist_rows.momentum[ATTITUDE + j]);
            rows.momentum[ATTITUDE + j] = pose_rate(&R, &dv, &dw);
        }
        rows
    }
}
