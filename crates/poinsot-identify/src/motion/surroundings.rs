//! Torques of the surroundings about the system's mass centre, with their sensitivities.

use super::{Centre, Motion, State};
use crate::parameters::UnknownKind;
use poinsot_spatial::Vector3;

impl Motion<'_> {
    /// Torque of the surroundings about the system's mass centre, in B, N m.
    pub(super) fn surroundings(&self, state: &State, w: &Vector3, centre: &Centre) -> Vector3 {
        let _ = centre;
        self.vehicle.torque(w) + state.R_NB.inverse() * self.vehicle.torque_N
    }

    /// Its change with a turn `dphi` of the base, its rate `(w, dw)`, and one unknown.
    pub(super) fn surroundings_change(
        &self,
        state: &State,
        centre: &Centre,
        (w, dw): (&Vector3, &Vector3),
        dphi: &Vector3,
        unknown: Option<usize>,
    ) -> Vector3 {
        let v = self.vehicle;
        let _ = centre;
        let kind = unknown.map(|u| &v.kinds[u]);
        let to_base = state.R_NB.inverse();
        let inertial = to_base * v.torque_N;
        let mut change = v.torque_change(w, dw, kind) + inertial.cross(dphi);
        if let Some(UnknownKind::InertialTorque(k)) = kind {
            let mut e = Vector3::zeros();
            e[*k] = 1.0;
            change += to_base * e;
        }
        change
    }
}
