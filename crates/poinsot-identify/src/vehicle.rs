//! The vehicle at one value of the unknowns, and what drives it between the readings.

use crate::parameters::{Parameters, UnknownKind};
use crate::segment::{Observations, Segment};
use poinsot_dynamics::Tree;
use poinsot_model::Thruster;
use poinsot_spatial::{InertialParameters, Vector3};

/// The vehicle at one value of the unknowns.
pub(crate) struct Vehicle<'a> {
    pub tree: &'a Tree,
    pub thrusters: &'a [Thruster],
    pub bodies: Vec<InertialParameters>,
    pub spin: Vec<f64>,
    /// Factor on each thruster's declared force.
    pub thrust_factor: Vec<f64>,
    /// How unknowns move the barycentric parameters.
    pub slopes: Vec<Vec<(usize, f64)>>,
    pub kinds: Vec<UnknownKind>,
    /// Constant torque in body axes, N m.
    pub torque_B: Vector3,
    /// Coefficients of the drag torque `-c |w| w`, kg m2.
    pub drag: Vector3,
    /// Whether wheel speeds run smoothly between the readings, or straight (torque held between them).
    pub wheels_smooth: bool,
}

impl<'a> Vehicle<'a> {
    pub fn new(
        tree: &'a Tree,
        thrusters: &'a [Thruster],
        parameters: &Parameters,
        nominal_spin: &[f64],
        x: &[f64],
    ) -> Self {
        let mut spin = nominal_spin.to_vec();
        let mut thrust_factor = vec![1.0; thrusters.len()];
        let (mut torque_B, mut drag) = (Vector3::zeros(), Vector3::zeros());
        for (unknown, value) in parameters.unknowns.iter().zip(x) {
            match unknown.kind {
                UnknownKind::SpinInertia(k) => spin[k] = *value,
                UnknownKind::ThrusterScale(k) => thrust_factor[k] = 1.0 + value,
                UnknownKind::DisturbanceTorque(k) => torque_B[k] = *value,
                UnknownKind::DragTorque(k) => drag[k] = *value,
                _ => {}
            }
        }
        Self {
            tree,
            thrusters,
            bodies: parameters.bodies(x),
            spin,
            thrust_factor,
            slopes: parameters.slopes(x),
            kinds: parameters.unknowns.iter().map(|u| u.kind.clone()).collect(),
            torque_B,
            drag,
            wheels_smooth: false,
        }
    }

    /// Torque of the surroundings on the base in B, N m.
    pub fn torque(&self, w: &Vector3) -> Vector3 {
        self.torque_B - self.drag.component_mul(w) * w.norm()
    }

    /// Change of that torque with the rate and with one unknown.
    pub fn torque_change(
        &self,
        w: &Vector3,
        dw: &Vector3,
        unknown: Option<&UnknownKind>,
    ) -> Vector3 {
        let size = w.norm();
        let mut change = Vector3::zeros();
        if self.drag != Vector3::zeros() && size > 0.0 {
            change -= self
                .drag
                .component_mul(&(dw * size + w * (w.dot(dw) / size)));
        }
        match unknown {
            Some(UnknownKind::DisturbanceTorque(k)) => change[*k] += 1.0,
            Some(UnknownKind::DragTorque(k)) => change[*k] -= size * w[*k],
            _ => {}
        }
        change
    }
}

/// Slope of a wheel's speed at grid time i, rad/s2: that of the parabola through its neighbours, of the
/// straight line at the ends.
pub(crate) fn wheel_slope(o: &Observations, wheels: usize, wheel: usize, i: usize) -> f64 {
    let speed = |i: usize| o.wheel_speed[i * wheels + wheel];
    let secant = |i: usize| (speed(i + 1) - speed(i)) / (o.time_s[i + 1] - o.time_s[i]);
    let last = o.time_s.len() - 1;
    match i {
        0 => secant(0),
        i if i == last => secant(last - 1),
        i => {
            let left = o.time_s[i] - o.time_s[i - 1];
            let right = o.time_s[i + 1] - o.time_s[i];
            (secant(i - 1) * right + secant(i) * left) / (left + right)
        }
    }
}

/// Thrusters that fire in the interval after each grid time (the grid holds all edges of firings).
pub(crate) fn thrust_by_interval(segment: &Segment) -> Vec<Vec<(usize, f64)>> {
    let t = &segment.observations.time_s;
    (0..t.len())
        .map(|k| {
            let Some(end) = t.get(k + 1) else {
                return Vec::new();
            };
            let middle = 0.5 * (t[k] + end);
            segment
                .firings
                .iter()
                .filter(|f| f.start_s <= middle && middle < f.end_s && f.force != 0.0)
                .map(|f| (f.thruster, f.force))
                .collect()
        })
        .collect()
}
