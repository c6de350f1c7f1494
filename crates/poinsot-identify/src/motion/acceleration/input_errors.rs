//! Sensitivity of the specific force at a point to errors of state and inputs.

use super::{Around, BodyPoint, ForceScratch, Input, RateSlopes};
use crate::motion::slope_weights;
use crate::motion::{Column, Instant, Motion, State, matrix};
use poinsot_spatial::{Matrix3, Vector3, Vector6, angular, linear, stacked};
use std::cell::RefMut;

/// The equation of the accelerations around one instant.
pub(crate) struct ForceAround<'m, 'a> {
    motion: &'m Motion<'a>,
    around: Around,
    k: usize,
    scratch: RefMut<'m, ForceScratch>,
    slopes: RateSlopes,
    /// Axes of the point's body, and its place in B.
    R: Matrix3,
    r: Vector3,
}

impl<'a> Motion<'a> {
    /// Requires the instant that [`Motion::velocity`] gave for the same time.
    pub fn force_around(
        &self,
        (state, k): (&State, usize),
        instant: &Instant,
        point: &BodyPoint,
    ) -> ForceAround<'_, 'a> {
        let tree = self.vehicle.tree;
        let mut scratch = self.force_scratch();
        let ForceScratch {
            inputs,
            here,
            there,
            ..
        } = &mut *scratch;
        self.set_second_order(k, inputs);
        let wrench = self.wrench(state, &inputs.thrust, instant);
        let free = self.rate_without_base(here, (tree, inputs), &instant.twist);
        let R = here.kinematics.R[point.0];
        ForceAround {
            slopes: self.rate_slopes(inputs, &instant.twist, point, there),
            r: here.kinematics.p[point.0] + R * point.1,
            R,
            motion: self,
            around: Around {
                state: *state,
                instant: *instant,
                base: instant.twist_of(&(wrench - free)),
                point: *point,
            },
            k,
            scratch,
        }
    }
}

impl ForceAround<'_, '_> {
    /// A change of the state with the change of the twist that goes with it, joints and wheels as they are.
    pub fn state(&self, column: &Column, twist: &Vector6) -> Vector3 {
        let dphi: Vector3 = column.fixed_rows::<3>(0).into();
        let dw = angular(twist);
        if dw == Vector3::zeros() && dphi == Vector3::zeros() {
            return Vector3::zeros();
        }
        let Around { state, instant, .. } = &self.around;
        let (centre, w) = (&instant.centre, &instant.twist.w);
        let torque = self
            .motion
            .environment_torque_change(state, centre, (w, &dw), &dphi, None);
        let own = self.slopes.balance * dw;
        let base = instant.twist_of(&(stacked(&Vector3::zeros(), &torque) - own));
        let direct = self.slopes.force_B * dw;
        self.R.transpose() * (linear(&base) + angular(&base).cross(&self.r) + direct)
    }

    /// A torque about an axis of N.
    pub fn outside_torque(&self, axis: usize) -> Vector3 {
        let Around { state, instant, .. } = &self.around;
        let torque: Vector3 = matrix(&state.R_NB).row(axis).transpose();
        let base = instant.twist_of(&stacked(&Vector3::zeros(), &torque));
        self.R.transpose() * (linear(&base) + angular(&base).cross(&self.r))
    }

    /// Grid times and weights of the readings that make up the slope of a wheel's speed.
    pub fn wheel_weights(&self, wheel: usize) -> [(usize, f64); 3] {
        let o = self.motion.observations;
        let t = &o.time_s;
        // Of a process, its own slope has an error.
        if !o.wheel(wheel).acceleration.is_empty() {
            return [(self.k, 0.0); 3];
        }
        if o.turns_evenly(wheel, self.motion.vehicle.wheels_smooth) {
            return slope_weights(t, self.k);
        }
        let i = self.k.min(t.len().saturating_sub(2));
        let over = 1.0 / (t[i + 1] - t[i]);
        [(i, -over), (i + 1, over), (i, 0.0)]
    }

    /// An input, the twist held.
    pub fn input(&mut self, moved: Input) -> Vector3 {
        let (tree, scratch) = (self.motion.vehicle.tree, &mut *self.scratch);
        let ends = moved.both_ways(tree, &scratch.inputs, &mut scratch.ends);
        self.motion
            .input_slope(&self.around, ends, &mut scratch.there)
    }
}
