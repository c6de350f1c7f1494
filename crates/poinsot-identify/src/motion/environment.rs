//! External torques about the system's mass centre, and delayed thrusters, with their sensitivities.
//!
//! In base axes with `u` the unit vector from the attracting body:
//!
//! ```text
//! T = T_B - c |w| w + R^T T_N + (3 gm / r^3) u x (I u)
//! ```

use super::joint_scales::cubic_between;
use super::{Instant, MassCentre, Motion, State};
use crate::problem::parameters::{GRADIENT, UnknownKind};
use crate::problem::quantity::unit;
use crate::problem::segment::Observations;
use poinsot_dynamics::gravity_gradient_torque;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3};

/// A unit of one of them.
fn symmetric(component: usize) -> Matrix3 {
    let mut unit = Matrix3::zeros();
    match component {
        0 => (unit[(0, 0)], unit[(2, 2)]) = (1.0, -1.0),
        1 => (unit[(1, 1)], unit[(2, 2)]) = (1.0, -1.0),
        k => {
            let (i, j) = [(0, 1), (0, 2), (1, 2)][k % 3];
            (unit[(i, j)], unit[(j, i)]) = (1.0, 1.0);
        }
    }
    unit
}

/// `e_ijk A_jk`: of `u u^T I` it is `u x (I u)`.
fn axial(a: &Matrix3) -> Vector3 {
    Vector3::new(
        a[(1, 2)] - a[(2, 1)],
        a[(2, 0)] - a[(0, 2)],
        a[(0, 1)] - a[(1, 0)],
    )
}

impl Motion<'_> {
    /// Tidal force, or force of a constant acceleration, per unit of one component, in N.
    pub(super) fn tidal_force(
        &self,
        component: usize,
        state: &State,
        centre: &MassCentre,
    ) -> Vector3 {
        let acceleration = match component.checked_sub(GRADIENT) {
            Some(axis) => Vector3::ith(axis, 1.0),
            None => symmetric(component) * (state.p_NoBo_N + state.R_NB * centre.p_BoScm_B),
        };
        acceleration * centre.mass
    }

    /// Whether an external force or torque acts in the interval after grid time k.
    pub(super) fn has_external_wrench(&self, k: usize) -> bool {
        !self.thrust.at(k).is_empty() || self.in_environment()
    }

    /// Whether an external force or torque in the interval after grid time k follows the motion, apart from turning with the base.
    pub(super) fn follows_motion(&self, k: usize) -> bool {
        self.in_environment() || self.loses_mass_at(k)
    }

    /// Whether an external torque acts.
    fn in_environment(&self) -> bool {
        let v = self.vehicle;
        v.has_environment_torque() || v.torque_N != Vector3::zeros()
    }

    /// Force from outside in the interval after grid time k and its torque about the system's mass centre, in B, less the momentum
    /// that leaves.
    pub(super) fn external_wrench(
        &self,
        state: &State,
        instant: &Instant,
        k: usize,
    ) -> (Vector3, Vector3) {
        let mut force = Vector3::zeros();
        let mut torque = self.environment_torque(state, &instant.twist.w, &instant.centre);
        for thrust in self.thrust_now(instant, k) {
            force += thrust.F_B;
            torque += thrust.arm_B.cross(&thrust.F_B);
        }
        let (l_out, h_out) = self.leaving(k, |part| self.leaves(part, instant));
        (force - l_out, torque - h_out)
    }

    /// External torque about the system's mass centre, in B, N m.
    pub(super) fn environment_torque(
        &self,
        state: &State,
        w: &Vector3,
        centre: &MassCentre,
    ) -> Vector3 {
        let to_base = state.R_NB.inverse();
        let mut torque = self.vehicle.torque(w) + to_base * self.vehicle.torque_N;
        if let Some(gm) = self.vehicle.gm {
            let r_B = to_base * self.input_state.orbit_N;
            torque += gravity_gradient_torque(gm, &r_B, &centre.I_SScm_B);
        }
        torque
    }

    /// Its change with a turn `dphi` of the base, its rate `(w, dw)`, and one unknown.
    pub(super) fn environment_torque_change(
        &self,
        state: &State,
        centre: &MassCentre,
        (w, dw): (&Vector3, &Vector3),
        dphi: &Vector3,
        unknown: Option<usize>,
    ) -> Vector3 {
        let v = self.vehicle;
        let kind = unknown.map(|u| &v.kinds[u]);
        if v.unknown_wrenches.is_empty() && !self.in_environment() {
            return Vector3::zeros();
        }
        let to_base = state.R_NB.inverse();
        // R^T a moves by a x dphi when the base turns.
        let inertial = to_base * v.torque_N;
        let mut change = v.torque_change(w, dw, kind) + inertial.cross(dphi);
        if let Some(UnknownKind::InertialTorque(k)) = kind {
            change += to_base * Vector3::ith(*k, 1.0);
        }
        if let Some(UnknownKind::GravityGradient(k)) = kind {
            let growth = if *k < GRADIENT {
                1.0
            } else {
                self.input_state.time_s
            };
            let R = super::matrix(&state.R_NB);
            let gradient = R.transpose() * symmetric(*k % GRADIENT) * R * growth;
            change += axial(&(gradient * centre.I_SScm_B));
        }
        if let Some(gm) = v.gm {
            let distance = self.input_state.orbit_N.norm();
            let u = to_base * self.input_state.orbit_N / distance;
            let du = u.cross(dphi);
            let mut d = du.cross(&(centre.I_SScm_B * u)) + u.cross(&(centre.I_SScm_B * du));
            if let Some(at) = unknown.filter(|at| !v.slopes[*at].is_empty()) {
                d += u.cross(&(self.inertia_change(at, centre) * u));
            }
            change += d * (3.0 * gm / distance.powi(3));
        }
        change
    }

    /// Change of the gravity-gradient torque with the inertia.
    pub(super) fn gradient_change(&self, state: &State, dI: &Matrix3) -> Vector3 {
        let Some(gm) = self.vehicle.gm else {
            return Vector3::zeros();
        };
        let distance = self.input_state.orbit_N.norm();
        let u = state.R_NB.inverse() * self.input_state.orbit_N / distance;
        u.cross(&(dI * u)) * (3.0 * gm / distance.powi(3))
    }

    /// Change of the inertia about the system's mass centre with one unknown:
    /// `dI_Bo - d(m (c.c 1 - c c^T))`, in B.
    fn inertia_change(&self, unknown: usize, centre: &MassCentre) -> Matrix3 {
        let mut sum = Matrix3::zeros();
        let c = &centre.p_BoScm_B;
        let factor = self.slope_factor(unknown);
        for (at, slope) in &self.vehicle.slopes[unknown] {
            let (body, k) = (at / 10, at % 10);
            let (R, p) = (
                &self.input_state.kinematics.R[body],
                &self.input_state.kinematics.p[body],
            );
            // About the mass centre, which stays where it is to first order: shifted by p - c.
            let part = InertialParameters::from_array(&unit(k)).transported(R, &(p - c));
            sum += part.I_BBo_B * (*slope * factor);
        }
        sum
    }

    /// The state after the edge of a delayed firing, which lasts `lag` longer: `P += (F_before - F_after) lag`. Grid
    /// times hold all edges; the placement is that of grid time k.
    pub(super) fn late_thrust(&mut self, state: &State, k: usize) -> State {
        let mut now = *state;
        let late = &self.vehicle.late_thrusters;
        let Some(before) = k.checked_sub(1).filter(|_| !late.is_empty()) else {
            return now;
        };
        let whole =
            poinsot_dynamics::composite(&self.input_state.bodies, &self.input_state.kinematics);
        let c = whole.p_BoScm_B();
        let R = super::matrix(&state.R_NB);
        for (unknown, thrusters, lag) in late {
            let mut jump = (Vector3::zeros(), Vector3::zeros());
            for (interval, sign) in [(before, 1.0), (k, -1.0)] {
                let thrust = self.thrust.at(interval).iter();
                for thrust in thrust.filter(|t| thrusters.contains(&t.thruster)) {
                    let force = self.force(thrust, &self.input_state.kinematics, &c);
                    jump.0 += R * force.F_B * sign;
                    jump.1 += R * force.arm_B.cross(&force.F_B) * sign;
                }
            }
            now.P += jump.0 * *lag;
            now.h_SScm_N += jump.1 * *lag;
            if let Some(column) = self.columns.get_mut(self.initial_columns + unknown) {
                let dP = column.fixed_rows::<3>(6) + jump.0;
                let dh = column.fixed_rows::<3>(9) + jump.1;
                column.fixed_rows_mut::<3>(6).copy_from(&dP);
                column.fixed_rows_mut::<3>(9).copy_from(&dh);
            }
        }
        now
    }
}

/// Position of the reference orbit at a share of the interval after grid time k: the cubic through positions and velocities. Both
/// intervals that share a grid time see one orbit there, to the last bit.
pub(super) fn orbit_between(o: &Observations, k: usize, at: f64) -> Option<Vector3> {
    let (p0, v0) = o.orbit.get(k)?;
    let Some((p1, v1)) = o.orbit.get(k + 1).filter(|_| at > 0.0) else {
        return Some(*p0);
    };
    if at == 1.0 {
        return Some(*p1);
    }
    let h = o.time_s[k + 1] - o.time_s[k];
    Some(p0 + cubic_between(&(p1 - p0), [v0, v1], h, at))
}
