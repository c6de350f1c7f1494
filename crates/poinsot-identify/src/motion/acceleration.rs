//! Acceleration of the base, and the specific force at points of the bodies, with their sensitivities.
//!
//! The momentum equation differentiated: at a base acceleration `A = [a_NBo_B; alpha_NB_B]` the momentum of
//! the bodies changes by `H A + b`, where `b` holds velocities, joint accelerations and wheels. It equals the
//! wrench W of what acts from outside, so
//!
//! ```text
//! A = H^-1 (W - b)          dA = H^-1 (dW - (db/dw) dw - Y_A dpi)
//! ```
//!
//! with `Y_A` the regressor of the momentum's rate. `b` is quadratic in `w` and free of `v` (N is inertial), so
//! a central difference with a step of one is its slope to round-off.

mod input_errors;

use super::joint_scales::rate_parts;
use super::vehicle::{Thrust, Vehicle, parabola_slope, wheel_slope};
use super::virtual_joints::{JOINT_STEP, moved_trees};
use super::{Instant, Motion, State};
use crate::problem::parameters::UnknownKind;
use nalgebra::{Matrix4, SMatrix, Vector4};
use poinsot_dynamics::{
    Accelerations, Kinematics, Tree, Twist, composite, momentum_rate_column, wheel_rate,
};
use poinsot_spatial::{Matrix3, Vector3, Vector6, angular, linear, stacked};
use std::cell::RefMut;

/// A point fixed in a body: index of the body, place from its origin in its axes, m.
pub(crate) type BodyPoint = (usize, Vector3);

/// Inputs at an instant, with second derivatives.
#[derive(Default)]
struct Inputs {
    q: Vec<f64>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
    wheels: Vec<f64>,
    wheel_rates: Vec<f64>,
    thrust: Vec<Thrust>,
    /// Effect of unknowns on the accelerations: unknown, joint and slope.
    acceleration_changes: Vec<(usize, usize, f64)>,
}

impl Inputs {
    /// The same values in the memory at hand.
    fn copy(&mut self, from: &Self) {
        self.q.clone_from(&from.q);
        self.rates.clone_from(&from.rates);
        self.accelerations.clone_from(&from.accelerations);
        self.wheels.clone_from(&from.wheels);
        self.wheel_rates.clone_from(&from.wheel_rates);
        self.thrust.clone_from(&from.thrust);
    }
}

/// Placement and accelerations together.
struct Moving {
    kinematics: Kinematics,
    body: Accelerations,
}

impl Moving {
    fn new(tree: &Tree) -> Self {
        Self {
            kinematics: Kinematics::new(tree),
            body: Accelerations::new(tree),
        }
    }
}

/// What one sample computes and the next one overwrites.
pub(crate) struct ForceScratch {
    inputs: Inputs,
    /// Where the bodies are, and where they are at other inputs.
    here: Moving,
    there: Moving,
    ends: [Inputs; 2],
    /// The trees at both ends of every unknown that displaces a joint.
    trees: Vec<(usize, [Tree; 2])>,
}

impl ForceScratch {
    pub fn new(vehicle: &Vehicle) -> Self {
        let kinds = vehicle.kinds.iter().enumerate();
        let trees = kinds.filter_map(|(u, kind)| Some((u, moved_trees(vehicle.tree, kind)?)));
        Self {
            inputs: Inputs::default(),
            here: Moving::new(vehicle.tree),
            there: Moving::new(vehicle.tree),
            ends: Default::default(),
            trees: trees.collect(),
        }
    }
}

/// The instant and the point of a slope.
struct Around {
    state: State,
    instant: Instant,
    /// Acceleration of the base.
    base: Vector6,
    point: BodyPoint,
}

/// An input of the motion: of a joint, or the speed of a wheel and its slope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Input {
    Position(usize),
    Rate(usize),
    Acceleration(usize),
    Wheel(usize),
    WheelRate(usize),
    /// The slope of a wheel's speed that runs straight: its error moves that of the speed, and nothing else depends on it.
    Step,
}

impl Input {
    /// Step of a difference: the equations are quadratic over all but a position, and a step of one is exact.
    fn step(self) -> f64 {
        match self {
            Self::Position(_) => JOINT_STEP,
            _ => 1.0,
        }
    }

    /// The inputs one step further, and one less.
    fn both_ways<'e>(
        self,
        tree: &'e Tree,
        inputs: &Inputs,
        ends: &'e mut [Inputs; 2],
    ) -> ([(&'e Tree, &'e Inputs); 2], f64) {
        for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
            end.copy(inputs);
            self.shift(end, sign * self.step());
        }
        (ends.each_ref().map(|inputs| (tree, inputs)), self.step())
    }

    fn shift(self, inputs: &mut Inputs, by: f64) {
        match self {
            Self::Position(j) => inputs.q[j] += by,
            Self::Rate(j) => inputs.rates[j] += by,
            Self::Acceleration(j) => inputs.accelerations[j] += by,
            Self::Wheel(w) => inputs.wheels[w] += by,
            Self::WheelRate(w) => inputs.wheel_rates[w] += by,
            Self::Step => {}
        }
    }
}

/// Slopes over the components of `w`.
struct RateSlopes {
    /// Of `b`.
    balance: SMatrix<f64, 6, 3>,
    /// Of the force at the point, in B.
    force_B: Matrix3,
}

impl Motion<'_> {
    /// Specific force at a point of a body at grid time k, just after switching there, in the axes of the body; its change
    /// with every sensitivity column is added to `columns`. Requires the instant that [`Motion::velocity`] gave for the same
    /// time. N falls freely, so the specific force is the inertial acceleration.
    pub fn specific_force(
        &self,
        (state, k): (&State, usize),
        instant: &Instant,
        point: &BodyPoint,
        columns: &mut Vec<Vector3>,
    ) -> Vector3 {
        let v = self.vehicle;
        let mut scratch = self.force_scratch();
        let ForceScratch {
            inputs,
            here,
            there,
            ends,
            trees,
        } = &mut *scratch;
        self.set_second_order(k, inputs);
        let wrench = self.wrench(state, &inputs.thrust, instant);
        let free = self.rate_without_base(here, (v.tree, inputs), &instant.twist);
        let base = instant.twist_of(&(wrench - free));
        here.body
            .add_base(&here.kinematics, &linear(&base), &angular(&base));
        let (body, p) = point;
        let value = here.body.at_point(&here.kinematics, *body, p);
        if self.columns.is_empty() {
            return value;
        }
        let slopes = self.rate_slopes(inputs, &instant.twist, point, there);
        let R = here.kinematics.R[*body];
        let r = here.kinematics.p[*body] + R * p;
        columns.extend((0..self.columns.len()).map(|j| {
            let change = self.base_change(state, j, inputs, instant, &slopes, here);
            let dw = angular(&self.twist_columns[j]);
            let in_B = linear(&change) + angular(&change).cross(&r) + slopes.force_B * dw;
            R.transpose() * in_B
        }));
        let around = Around {
            state: *state,
            instant: *instant,
            base,
            point: *point,
        };
        self.add_input_changes(&around, (inputs, ends), there, columns);
        for (unknown, trees) in trees {
            let ends = trees.each_ref().map(|tree| (tree, &*inputs));
            self.add_change((*unknown, 1.0), &around, (ends, JOINT_STEP), there, columns);
        }
        value
    }

    /// The scratch of this motion, made at the first use.
    fn force_scratch(&self) -> RefMut<'_, ForceScratch> {
        let scratch = self.force_scratch.borrow_mut();
        RefMut::map(scratch, |s| {
            s.get_or_insert_with(|| Box::new(ForceScratch::new(self.vehicle)))
                .as_mut()
        })
    }

    /// Whether a thruster fires up to grid time k and the record ends there: its continuation is unknown.
    pub fn thrust_after_unknown(&self, k: usize) -> bool {
        let ends = k + 1 == self.observations.time_s.len();
        ends && k
            .checked_sub(1)
            .is_some_and(|b| !self.thrust.at(b).is_empty())
    }

    fn set_second_order(&self, k: usize, inputs: &mut Inputs) {
        let (o, v) = (self.observations, self.vehicle);
        let dof = v.tree.dof();
        let wheels = v.tree.rotors.len();
        let last = o.time_s.len().saturating_sub(1);
        inputs.q.clone_from(&self.input_state.q);
        inputs.rates.clone_from(&self.input_state.rates);
        let q = |j: usize| move |i: usize| o.joint_position[i * dof + j];
        let rate = |j: usize| move |i: usize| o.joint_rate[i * dof + j];
        inputs.accelerations.clear();
        inputs
            .accelerations
            .extend((0..dof).map(|j| match o.joint(j).acceleration.get(k) {
                Some(known) => *known,
                None => joint_acceleration(&o.time_s, q(j), rate(j), k),
            }));
        inputs.acceleration_changes.clear();
        for own in &v.joint_scales {
            let j = own.joint;
            let part = |i: usize| rate_parts(o, (dof, j), (i, 0.0));
            let mut parts = part(k);
            if o.joint(j).acceleration.is_empty() {
                parts.rates[2] =
                    joint_acceleration(&o.time_s, |i| part(i).rates[0], |i| part(i).rates[1], k);
                parts.ones[2] =
                    joint_acceleration(&o.time_s, |i| part(i).ones[0], |i| part(i).ones[1], k);
            }
            let found = own.corrected([0.0, 0.0, inputs.accelerations[j]], &parts);
            inputs.accelerations[j] = found.value[2];
            let each = own.unknowns().into_iter().zip(found.slopes);
            let each = each.filter_map(|(unknown, slopes)| Some((unknown?, j, slopes[2])));
            inputs.acceleration_changes.extend(each);
        }
        inputs.wheels.clone_from(&self.input_state.wheels);
        inputs.wheel_rates.clear();
        inputs.wheel_rates.extend((0..wheels).map(|j| {
            match o.turns_evenly(j, v.wheels_smooth) {
                true => wheel_slope(o, wheels, j, k),
                // A torque constant from here on.
                false => {
                    let i = k.min(last.saturating_sub(1));
                    let speed = |i: usize| o.wheel_speed[i * wheels + j];
                    (speed(i + 1) - speed(i)) / (o.time_s[i + 1] - o.time_s[i])
                }
            }
        }));
        inputs.thrust.clear();
        inputs.thrust.extend_from_slice(self.thrust.at(k));
    }

    /// Force and torque about Bo of thrusters and surroundings, in B.
    fn wrench(&self, state: &State, thrust: &[Thrust], instant: &Instant) -> Vector6 {
        let mut force = Vector3::zeros();
        let mut torque = self.environment_torque(state, &instant.twist.w, &instant.centre);
        for f in self.forces(thrust, instant) {
            force += f.F_B;
            torque += (f.arm_B + instant.centre.p_BoScm_B).cross(&f.F_B);
        }
        stacked(&force, &torque)
    }

    /// `b`: places and moves `moving` at the twist given, the base not accelerating.
    fn rate_without_base(
        &self,
        moving: &mut Moving,
        (tree, inputs): (&Tree, &Inputs),
        twist: &Twist,
    ) -> Vector6 {
        moving.kinematics.place(tree, &inputs.q);
        moving
            .kinematics
            .set_velocities(tree, &twist.v, &twist.w, &inputs.rates);
        moving.body.set_without_base(
            tree,
            &moving.kinematics,
            &inputs.rates,
            &inputs.accelerations,
        );
        self.momentum_rate(moving, (tree, inputs))
    }

    /// Rate of the momentum of bodies and wheels about Bo, in B, of the motion in `moving`.
    fn momentum_rate(&self, moving: &Moving, (tree, inputs): (&Tree, &Inputs)) -> Vector6 {
        let (at, spin) = (&moving.kinematics, &self.vehicle.spin);
        let (force, torque) = moving.body.momentum_rate(&self.input_state.bodies, at);
        let of_wheels = wheel_rate(tree, at, spin, &inputs.wheels, &inputs.wheel_rates);
        stacked(&force, &(torque + of_wheels))
    }

    fn rate_slopes(
        &self,
        inputs: &Inputs,
        twist: &Twist,
        (body, p): &BodyPoint,
        moving: &mut Moving,
    ) -> RateSlopes {
        let tree = self.vehicle.tree;
        let mut slopes = RateSlopes {
            balance: SMatrix::zeros(),
            force_B: Matrix3::zeros(),
        };
        for axis in 0..3 {
            for half in [0.5_f64, -0.5] {
                let mut turned = *twist;
                turned.w[axis] += half.signum();
                let b = self.rate_without_base(moving, (tree, inputs), &turned) * half;
                let sum = slopes.balance.column(axis) + b;
                slopes.balance.set_column(axis, &sum);
                let R = moving.kinematics.R[*body];
                let f = R * moving.body.at_point(&moving.kinematics, *body, p) * half;
                let sum = slopes.force_B.column(axis) + f;
                slopes.force_B.set_column(axis, &sum);
            }
        }
        slopes
    }

    /// `dA` of one sensitivity column.
    fn base_change(
        &self,
        state: &State,
        j: usize,
        inputs: &Inputs,
        instant: &Instant,
        slopes: &RateSlopes,
        moving: &Moving,
    ) -> Vector6 {
        let v = self.vehicle;
        let twist = &self.twist_columns[j];
        let kind = j.checked_sub(self.initial_columns).map(|u| &v.kinds[u]);
        let dphi: Vector3 = self.columns[j].fixed_rows::<3>(0).into();
        let torque = self.environment_torque_change(
            state,
            &instant.centre,
            (&instant.twist.w, &angular(twist)),
            &dphi,
            j.checked_sub(self.initial_columns),
        );
        let mut wrench = stacked(&Vector3::zeros(), &torque);
        if let Some(kind) = kind.filter(|k| k.thruster().is_some()) {
            for f in self.forces(&inputs.thrust, instant) {
                let (dF, dT) = f.change(kind);
                wrench += stacked(&dF, &(dT + instant.centre.p_BoScm_B.cross(&dF)));
            }
        }
        let mut own = slopes.balance * angular(twist);
        if let Some(u) = j.checked_sub(self.initial_columns) {
            let factor = self.slope_factor(u);
            for (at, slope) in &v.slopes[u] {
                let (body, k) = (at / 10, at % 10);
                let column = momentum_rate_column(&moving.body, &moving.kinematics, body, k);
                own += column * (*slope * factor);
            }
            let of_wheel = |w: usize, d: &Vector3| {
                let host = &moving.kinematics.w[v.tree.rotors[w].body];
                let rate = d * inputs.wheel_rates[w] + host.cross(d) * inputs.wheels[w];
                stacked(&Vector3::zeros(), &rate)
            };
            match &v.kinds[u] {
                UnknownKind::SpinInertia(w) => {
                    let rotor = &v.tree.rotors[*w];
                    own += of_wheel(*w, &(moving.kinematics.R[rotor.body] * rotor.axis_B));
                }
                UnknownKind::WheelTilt(w, _) => {
                    let host = v.tree.rotors[*w].body;
                    let d = moving.kinematics.R[host] * v.tilt_slopes[u];
                    own += of_wheel(*w, &d) * v.spin[*w];
                }
                _ => {}
            }
        }
        instant.twist_of(&(wrench - own))
    }

    /// Direct effect of input errors; the effect through their twist is included already. The joints' accelerations are
    /// not shifted in time.
    fn add_input_changes(
        &self,
        around: &Around,
        (inputs, ends): (&Inputs, &mut [Inputs; 2]),
        moving: &mut Moving,
        columns: &mut [Vector3],
    ) {
        let tree = self.vehicle.tree;
        for &(unknown, j, slope) in &inputs.acceleration_changes {
            let both = Input::Acceleration(j).both_ways(tree, inputs, ends);
            self.add_change((unknown, slope), around, both, moving, columns);
        }
        for change in &self.input_state.changes {
            let joint = change.joint.filter(|c| c.0 < tree.dof());
            let position = joint.map(|(j, dq, _)| (dq, Input::Position(j)));
            let rate = joint.map(|(j, _, drate)| (drate, Input::Rate(j)));
            let wheel = change.wheel.map(|(w, speed)| (speed, Input::Wheel(w)));
            let all = [position, rate, wheel].into_iter().flatten();
            for (share, moved) in all.filter(|(share, _)| *share != 0.0) {
                let both = moved.both_ways(tree, inputs, ends);
                let unknown = (change.unknown, share);
                self.add_change(unknown, around, both, moving, columns);
            }
        }
    }

    /// Adds the direct effect of one unknown: a share of the slope between two ends.
    fn add_change(
        &self,
        (unknown, share): (usize, f64),
        around: &Around,
        ends: ([(&Tree, &Inputs); 2], f64),
        moving: &mut Moving,
        columns: &mut [Vector3],
    ) {
        let slope = self.input_slope(around, ends, moving);
        columns[self.initial_columns + unknown] += slope * share;
    }

    /// Slope of the force at the point between two sets of inputs two steps apart, the twist of the base held.
    fn input_slope(
        &self,
        around: &Around,
        (ends, step): ([(&Tree, &Inputs); 2], f64),
        moving: &mut Moving,
    ) -> Vector3 {
        let (instant, base) = (&around.instant, &around.base);
        let (body, p) = &around.point;
        // Of `H A + b - W`, and of the force with the acceleration of the base held.
        let (mut balance, mut own) = (Vector6::zeros(), Vector3::zeros());
        for ((tree, there), weight) in ends.into_iter().zip([0.5 / step, -0.5 / step]) {
            self.rate_without_base(moving, (tree, there), &instant.twist);
            moving
                .body
                .add_base(&moving.kinematics, &linear(base), &angular(base));
            let outside = self.outside(&around.state, &moving.kinematics, there, instant);
            balance += (self.momentum_rate(moving, (tree, there)) - outside) * weight;
            own += moving.body.at_point(&moving.kinematics, *body, p) * weight;
        }
        let shift = instant.twist_of(&balance);
        let R = self.input_state.kinematics.R[*body];
        let r = self.input_state.kinematics.p[*body] + R * p;
        own - R.transpose() * (linear(&shift) + angular(&shift).cross(&r))
    }

    /// Force and torque about Bo from outside at a placement, in B.
    fn outside(
        &self,
        state: &State,
        kinematics: &Kinematics,
        inputs: &Inputs,
        instant: &Instant,
    ) -> Vector6 {
        let whole = composite(&self.input_state.bodies, kinematics);
        let mut there = instant.centre;
        there.p_BoScm_B = whole.p_BoScm_B();
        there.I_SScm_B = whole.I_SScm_B();
        let torque = self.environment_torque(state, &instant.twist.w, &there);
        let mut sum = stacked(&Vector3::zeros(), &torque);
        for thrust in &inputs.thrust {
            let force = self.force(thrust, kinematics, &Vector3::zeros());
            sum += stacked(&force.F_B, &force.arm_B.cross(&force.F_B));
        }
        sum
    }
}

/// Second derivative of a joint's position at grid time k, rad/s2 or m/s2: of the quintic that meets position
/// and rate here and at both neighbours (error `h^4 q^(6) / 360` at even steps); at an end, of the cubic.
fn joint_acceleration(
    t: &[f64],
    q: impl Fn(usize) -> f64,
    rate: impl Fn(usize) -> f64,
    k: usize,
) -> f64 {
    let last = t.len() - 1;
    if last == 0 {
        return 0.0;
    }
    if k == 0 || k == last {
        let other = if k == 0 { 1 } else { last - 1 };
        let h = t[other] - t[k];
        return 6.0 * (q(other) - q(k)) / (h * h) - (4.0 * rate(k) + 2.0 * rate(other)) / h;
    }
    let row = |i: usize| {
        let h = t[i] - t[k];
        let u = (q(i) - q(k) - rate(k) * h) / (h * h);
        let w = (rate(i) - rate(k)) / h;
        (h, u, w)
    };
    // q(h) = q + q' h + h^2 (a + b h + c h^2 + e h^3): eliminate e, then c and b from both sides.
    let (h1, u1, w1) = row(k - 1);
    let (h2, u2, w2) = row(k + 1);
    let powers = |h: f64| [1.0, h, h * h, h.powi(3)];
    // Each side gives u = a + b h + c h^2 + e h^3 and w = 2 a + 3 b h + 4 c h^2 + 5 e h^3.
    let sides = [h1, h2].map(powers);
    let system = Matrix4::from_fn(|i, j| match i % 2 {
        0 => sides[i / 2][j],
        _ => (j + 2) as f64 * sides[i / 2][j],
    });
    let scale = Vector4::from(powers(0.5 * (h2 - h1)).map(f64::recip));
    (system * Matrix4::from_diagonal(&scale))
        .lu()
        .solve(&Vector4::new(u1, w1, u2, w2))
        .map_or_else(|| parabola_slope(t, rate, k), |x| 2.0 * x[0])
}
