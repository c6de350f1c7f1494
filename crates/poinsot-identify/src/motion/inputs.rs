//! Corrected joint and wheel motion, and the effect of the sensor errors.

use super::environment::orbit_between;
use super::joint_scales::{cubic, rate_parts};
use super::vehicle::{InputFault, Vehicle, wheel_slope};
use super::{EvaluatedState, InputState, Instant, Motion, State, matrix, pose_change};
use crate::problem::parameters::UnknownKind;
use crate::problem::segment::Observations;
use poinsot_spatial::{Vector3, Vector6};
use std::sync::Arc;

/// Effect of one unknown on the inputs at an instant, per unit of it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct InputChange {
    /// Index of the unknown.
    pub unknown: usize,
    /// Joint coordinate, the virtual ones behind the real ones, with the change of its position and rate.
    pub joint: Option<(usize, f64, f64)>,
    /// Wheel, with the change of its speed.
    pub wheel: Option<(usize, f64)>,
}

impl InputChange {
    fn of_joint(unknown: usize, moved: (usize, f64, f64)) -> Self {
        Self {
            unknown,
            joint: Some(moved),
            wheel: None,
        }
    }

    fn of_wheel(unknown: usize, moved: (usize, f64)) -> Self {
        Self {
            unknown,
            joint: None,
            wheel: Some(moved),
        }
    }
}

/// Effect of an unknown on the external force and torque through a joint's position.
pub(super) struct OutsideChange {
    pub unknown: usize,
    /// Of the force in B, N.
    pub F_B: Vector3,
    /// Of the torque about the system's mass centre in B, N m.
    pub T_B: Vector3,
}

impl Motion<'_> {
    /// Corrected inputs within the interval after grid time k.
    pub(super) fn inputs(&mut self, k: usize, at: f64) {
        let input_state = &mut self.input_state;
        if let Some(p) = orbit_between(self.observations, k, at) {
            input_state.orbit_N = p;
        }
        input_state.interval = k;
        fill_inputs(self.observations, self.vehicle, k, at, input_state);
        input_state.changes.clear();
        let t = time_at(&self.observations.time_s, k, at);
        input_state.time_s = t;
        for &InputFault { unknown, value } in &self.vehicle.input_faults {
            let changes = &mut input_state.changes;
            let mut moved = |j: usize, q: f64, rate: f64| {
                changes.push(InputChange::of_joint(unknown, (j, q, rate)));
            };
            match &self.vehicle.kinds[unknown] {
                UnknownKind::JointOffset(j) => {
                    input_state.q[*j] -= value;
                    moved(*j, -1.0, 0.0);
                }
                UnknownKind::WheelSpeedBias(w) => {
                    input_state.wheels[*w] -= value;
                    changes.push(InputChange::of_wheel(unknown, (*w, -1.0)));
                }
                // The sensor is late: the joint is at its future sample.
                UnknownKind::JointLag(joints) => {
                    let Some(curves) = self.vehicle.curves else {
                        continue;
                    };
                    for &j in joints {
                        let ([dq, drate], [rate, acceleration]) = curves.joint(j, t, value);
                        moved(j, rate, acceleration);
                        input_state.q[j] += dq;
                        input_state.rates[j] += drate;
                    }
                }
                UnknownKind::WheelLag(wheels) => {
                    let Some(curves) = self.vehicle.curves else {
                        continue;
                    };
                    for &w in wheels {
                        let (change, rate) =
                            match curves.runs_straight(w, self.vehicle.wheels_smooth) {
                                true => straight(self.observations, w, (k, t), value),
                                false => curves.wheel(w, t, value),
                            };
                        input_state.wheels[w] += change;
                        changes.push(InputChange::of_wheel(unknown, (w, rate)));
                    }
                }
                UnknownKind::JointPlay(j) => {
                    let (q, rate) = play_between(self.observations, &self.play, *j, (k, at));
                    moved(*j, q, rate);
                }
                _ => {}
            }
        }
        self.take_out_scales(k, at);
        let input_state = &mut self.input_state;
        for (i, joint) in self.vehicle.virtual_joints.iter().enumerate() {
            let (q, rate) = match joint.along {
                Some(k) => (input_state.q[k], input_state.rates[k]),
                None => (1.0, 0.0),
            };
            let moved = (self.vehicle.tree.dof() + i, q, rate);
            let change = InputChange::of_joint(joint.unknown, moved);
            input_state.changes.push(change);
        }
    }

    /// Takes scales of joints and errors of their rates out of the inputs, behind offsets and lags: these are in what a scale multiplies.
    fn take_out_scales(&mut self, k: usize, at: f64) {
        let (dof, now) = (self.vehicle.tree.dof(), &mut self.input_state);
        for own in &self.vehicle.joint_scales {
            let j = own.joint;
            let parts = rate_parts(self.observations, (dof, j), (k, at));
            let found = own.corrected([now.q[j], now.rates[j], 0.0], &parts);
            [now.q[j], now.rates[j], _] = found.value;
            let before = now.changes.iter_mut().filter_map(|c| c.joint.as_mut());
            for (_, q, rate) in before.filter(|(joint, ..)| *joint == j) {
                *q *= own.factor();
                *rate *= own.factor();
            }
            for (unknown, [q, rate, _]) in own.unknowns().into_iter().zip(found.slopes) {
                let change = unknown.map(|unknown| InputChange::of_joint(unknown, (j, q, rate)));
                now.changes.extend(change);
            }
        }
    }

    /// Effect of input errors on the twist, with known slopes: for a joint's position the change of `Y pi - [l; h_cm +
    /// c x l]`, momentum held; for rates and speeds the input gains.
    pub(super) fn input_columns(&self, instant: &Instant, twists: &mut [Vector6]) {
        for change in &self.input_state.changes {
            let twist = &mut twists[change.unknown];
            if let Some((joint, dq, drate)) = change.joint {
                let slope = &self.input_state.joint_slopes.of[joint];
                let own = slope.position * dq + slope.rate * drate;
                let dc = slope.first_moment * (dq / instant.centre.mass);
                *twist += instant.twist_slope(&own, &dc);
            }
            if let Some((wheel, dspeed)) = change.wheel {
                *twist += self.wheel_gain(instant, wheel) * dspeed;
            }
        }
    }

    /// Slopes of the momentum over the joints at the inputs in hand, where faults move a joint.
    pub(super) fn fault_slopes(&mut self, instant: &Instant) {
        if self.input_state.changes.iter().any(|c| c.joint.is_some()) {
            let mut slopes = std::mem::take(&mut self.input_state.joint_slopes);
            self.joint_slopes(instant, &mut slopes);
            for joint in &self.vehicle.virtual_joints {
                let slope = slopes.along(&self.input_state.kinematics, &joint.motion);
                slopes.of.push(slope);
            }
            self.input_state.joint_slopes = slopes;
        }
    }

    /// From the end of an interval to the start of the next one, k: zero errors leave the motion unchanged; only its
    /// sensitivities differ on the two sides.
    pub(super) fn cross_grid_time(&mut self, evaluated: &mut EvaluatedState, k: usize) {
        evaluated.at = (k, 0.0);
        if self.vehicle.input_faults.is_empty() {
            return;
        }
        self.inputs(k, 0.0);
        let Some(variation) = evaluated.variation.as_mut().map(Arc::make_mut) else {
            return;
        };
        let faults = self.vehicle.input_faults.iter();
        for at in faults.clone().map(|f| f.unknown) {
            variation.twists[at] = Vector6::zeros();
        }
        self.input_columns(&evaluated.instant, &mut variation.twists);
        let R = matrix(&evaluated.state.R_NB);
        for at in faults.map(|f| f.unknown) {
            variation.drive[at] = pose_change(&R, &variation.twists[at]);
        }
    }

    /// Effect of joint position errors on the external force and torque.
    pub(super) fn outside_changes(
        &self,
        state: &State,
        instant: &Instant,
        k: usize,
    ) -> Vec<OutsideChange> {
        let calm = self.thrust.at(k).is_empty() && self.vehicle.gm.is_none();
        if calm {
            return Vec::new();
        }
        let of_joint = |change: &InputChange| {
            let (joint, dq, drate) = change.joint?;
            let first_moment = &self.input_state.joint_slopes.of[joint].first_moment;
            let (F_B, T_B) = self.wrench_change(state, instant, k, joint, first_moment);
            let dc = first_moment / instant.centre.mass * dq;
            let loss = self.joint_loss(instant, k, (joint, dq, drate), &dc);
            Some(OutsideChange {
                unknown: change.unknown,
                F_B: F_B * dq - loss.0,
                T_B: T_B * dq - loss.1,
            })
        };
        let changes = self.input_state.changes.iter();
        changes.filter_map(of_joint).collect()
    }
}

/// Change of a wheel's speed over a lag from time t, in the interval after grid time k, along straight lines from reading to
/// reading, and the slope at the end; the outermost lines go on.
fn straight(o: &Observations, wheel: usize, (k, t): (usize, f64), lag_s: f64) -> (f64, f64) {
    let n = o.time_s.len();
    let wheels = o.wheel_speed.len() / n.max(1);
    let Some(last) = n.checked_sub(2) else {
        return (0.0, 0.0);
    };
    let speed = |k: usize| o.wheel_speed[k * wheels + wheel];
    let line = |k: usize, t: f64| {
        let slope = (speed(k + 1) - speed(k)) / (o.time_s[k + 1] - o.time_s[k]);
        (speed(k) + slope * (t - o.time_s[k]), slope)
    };
    let (here, slope) = line(k.min(last), t);
    if lag_s == 0.0 {
        return (0.0, slope);
    }
    let after = o.time_s.partition_point(|x| *x <= t + lag_s);
    let (there, slope) = line(after.saturating_sub(1).min(last), t + lag_s);
    (there - here, slope)
}

/// Displacement of each joint at each grid time per unit of its play, where one is an unknown: the link is half the play
/// behind its drive.
pub(super) fn play(vehicle: &Vehicle, o: &Observations) -> Vec<f64> {
    let mut kinds = vehicle.kinds.iter();
    if !kinds.any(|kind| matches!(kind, UnknownKind::JointPlay(_))) {
        return Vec::new();
    }
    let dof = vehicle.tree.dof();
    let mut now = vec![0.0; dof];
    let mut all = Vec::with_capacity(o.joint_rate.len());
    for rates in o.joint_rate.chunks_exact(dof) {
        for (side, rate) in now.iter_mut().zip(rates) {
            // At rest the link stays on the side where it came to rest.
            if *rate != 0.0 {
                *side = -0.5 * rate.signum();
            }
        }
        all.extend_from_slice(&now);
    }
    all
}

/// The same for position and rate at a share of the interval after grid time k, on the cubic of [`fill_inputs`].
fn play_between(o: &Observations, play: &[f64], joint: usize, (k, at): (usize, f64)) -> (f64, f64) {
    let t = &o.time_s;
    let dof = play.len() / t.len().max(1);
    let (a, Some(next)) = (play[k * dof + joint], t.get(k + 1)) else {
        return (play[k * dof + joint], 0.0);
    };
    let change = play[(k + 1) * dof + joint] - a;
    let rate = change * 6.0 * at * (1.0 - at) / (next - t[k]);
    (a + change * at * at * (3.0 - 2.0 * at), rate)
}

/// Time at a share of the interval after grid time k; both intervals that share a grid time see the same.
fn time_at(t: &[f64], k: usize, at: f64) -> f64 {
    match t.get(k + 1) {
        Some(next) if at == 1.0 => *next,
        Some(next) => t[k] + at * (next - t[k]),
        None => t[k],
    }
}

/// Inputs at a share of the interval after grid time k: joints on the cubic through positions and rates, wheels on the
/// straight line (constant motor torque over the interval) or on a smooth curve.
fn fill_inputs(
    o: &Observations,
    vehicle: &Vehicle,
    k: usize,
    at: f64,
    input_state: &mut InputState,
) {
    let tree = vehicle.tree;
    let (dof, wheels) = (tree.dof(), tree.rotors.len());
    // At the end of an interval the readings are those of the next grid time.
    if at == 0.0 || at == 1.0 {
        let k = k + usize::from(at == 1.0);
        let speeds = row(&o.wheel_speed, wheels, k);
        input_state
            .q
            .copy_from_slice(row(&o.joint_position, dof, k));
        input_state
            .rates
            .copy_from_slice(row(&o.joint_rate, dof, k));
        input_state.wheels.copy_from_slice(speeds);
        return;
    }
    let h = o.time_s[k + 1] - o.time_s[k];
    for j in 0..dof {
        let joints = (&*o.joint_position, &*o.joint_rate);
        (input_state.q[j], input_state.rates[j]) =
            joint_between(&o.time_s, joints, (dof, j), (k, at));
    }
    for j in 0..wheels {
        let speed = |k: usize| o.wheel_speed[k * wheels + j];
        let (a, b) = (speed(k), speed(k + 1));
        input_state.wheels[j] = a + at * (b - a);
        if o.turns_evenly(j, vehicle.wheels_smooth) {
            let slope = |k: usize| wheel_slope(o, wheels, j, k);
            let (left, right) = (slope(k), slope(k + 1));
            let (d0, d1) = (left * h - (b - a), right * h - (b - a));
            input_state.wheels[j] += at * (1.0 - at) * ((1.0 - at) * d0 - at * d1);
        }
    }
}

/// The numbers of grid time k, `width` a time.
pub(super) fn row(all: &[f64], width: usize, k: usize) -> &[f64] {
    &all[k * width..(k + 1) * width]
}

/// Position and rate of a joint at a share of the interval after time k, on the cubic through these positions and rates.
pub(crate) fn joint_between(
    t: &[f64],
    (positions, rates): (&[f64], &[f64]),
    (dof, j): (usize, usize),
    (k, at): (usize, f64),
) -> (f64, f64) {
    let (a, b) = (k * dof + j, (k + 1) * dof + j);
    let change = positions[b] - positions[a];
    let (so_far, rate) = cubic(change, [rates[a], rates[b]], t[k + 1] - t[k], at);
    (positions[a] + so_far, rate)
}
