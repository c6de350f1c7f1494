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

use super::inputs::thruster_at;
use super::vehicle::{Thrust, parabola_slope, wheel_slope};
use super::virtual_joints::{JOINT_STEP, moved_trees};
use super::{Instant, Motion, State};
use crate::problem::parameters::UnknownKind;
use crate::problem::segment::Observations;
use nalgebra::SMatrix;
use poinsot_dynamics::{
    Accelerations, Kinematics, Tree, Twist, composite, momentum_rate_column, wheel_rate,
};
use poinsot_spatial::{Matrix3, Vector3, Vector6};

/// A point fixed in a body: index of the body, place from its origin in its axes, m.
pub(crate) type BodyPoint = (usize, Vector3);

/// Specific force at a point in the axes of its body, m/s2.
pub(crate) struct PointForce {
    pub value: Vector3,
    /// Its change with every sensitivity column.
    pub columns: Vec<Vector3>,
}

/// Inputs at an instant, with second derivatives.
#[derive(Clone)]
struct Inputs {
    q: Vec<f64>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
    wheels: Vec<f64>,
    wheel_rates: Vec<f64>,
    thrust: Vec<Thrust>,
}

/// Scratch: placement and accelerations together.
struct Moving {
    kinematics: Kinematics,
    body: Accelerations,
}

/// Slopes over the components of `w`.
struct RateSlopes {
    /// Of `b`.
    balance: SMatrix<f64, 6, 3>,
    /// Of the force at each point, in B.
    force_B: Vec<Matrix3>,
}

impl Motion<'_> {
    /// Specific force at points of the bodies at grid time k, just after switching there. Requires the instant that
    /// [`Motion::velocity`] gave for the same time. N falls freely, so the specific force is the inertial acceleration.
    pub fn specific_force(
        &mut self,
        state: &State,
        k: usize,
        instant: &Instant,
        points: &[BodyPoint],
    ) -> Vec<PointForce> {
        let v = self.vehicle;
        let inputs = self.second_order_inputs(k);
        let mut moving = Moving {
            kinematics: Kinematics::new(v.tree),
            body: Accelerations::new(v.tree),
        };
        let wrench = self.wrench(state, &inputs.thrust, instant);
        let free = self.rate_without_base(&mut moving, (v.tree, &inputs), &instant.twist);
        let base = instant.inverse_inertia * (wrench - free);
        moving
            .body
            .add_base(&moving.kinematics, &upper(&base), &lower(&base));
        let mut forces: Vec<PointForce> = points
            .iter()
            .map(|(body, p)| PointForce {
                value: moving.body.at_point(&moving.kinematics, *body, p),
                columns: Vec::new(),
            })
            .collect();
        if !self.columns.is_empty() {
            let slopes = self.rate_slopes(&inputs, &instant.twist, points);
            for j in 0..self.columns.len() {
                let change = self.base_change(state, j, &inputs, instant, &slopes, &moving);
                let dw = lower(&self.twist_columns[j]);
                for ((force, (body, p)), slope) in
                    forces.iter_mut().zip(points).zip(&slopes.force_B)
                {
                    let R = moving.kinematics.R[*body];
                    let r = moving.kinematics.p[*body] + R * p;
                    let in_B = upper(&change) + lower(&change).cross(&r) + slope * dw;
                    force.columns.push(R.transpose() * in_B);
                }
            }
            self.add_input_changes(&inputs, state, instant, (&base, points), &mut forces);
        }
        forces
    }

    /// Whether a thruster fires up to grid time k and the record ends there: its continuation is unknown.
    pub fn thrust_after_unknown(&self, k: usize) -> bool {
        let ends = k + 1 == self.observations.time_s.len();
        ends && k
            .checked_sub(1)
            .is_some_and(|b| !self.thrust.at(b).is_empty())
    }

    fn second_order_inputs(&self, k: usize) -> Inputs {
        let (o, v) = (self.observations, self.vehicle);
        let dof = v.tree.dof();
        let wheels = v.tree.rotors.len();
        let last = o.time_s.len().saturating_sub(1);
        Inputs {
            q: self.input_state.q.clone(),
            rates: self.input_state.rates.clone(),
            accelerations: (0..dof)
                .map(|j| match v.noisy_joints.get(j) {
                    // A second difference of noisy positions is noise.
                    Some(true) => parabola_slope(&o.time_s, |i| o.joint_rate[i * dof + j], k),
                    _ => joint_acceleration(o, dof, j, k),
                })
                .collect(),
            wheels: self.input_state.wheels.clone(),
            wheel_rates: (0..wheels)
                .map(|j| match o.is_smooth(j, v.wheels_smooth) {
                    true => wheel_slope(o, wheels, j, k),
                    // A torque constant from here on.
                    false => {
                        let i = k.min(last.saturating_sub(1));
                        let speed = |i: usize| o.wheel_speed[i * wheels + j];
                        (speed(i + 1) - speed(i)) / (o.time_s[i + 1] - o.time_s[i])
                    }
                })
                .collect(),
            thrust: self.thrust.at(k).to_vec(),
        }
    }

    /// Force and torque about Bo of thrusters and surroundings, in B.
    fn wrench(&self, state: &State, thrust: &[Thrust], instant: &Instant) -> Vector6 {
        let mut force = Vector3::zeros();
        let mut torque = self.environment_torque(state, &instant.twist.w, &instant.centre);
        for f in self.forces(thrust, &instant.centre) {
            force += f.F_B;
            torque += (f.arm_B + instant.centre.c).cross(&f.F_B);
        }
        stack(&force, &torque)
    }

    /// `b`: places and moves `moving` at the twist given, the base not accelerating.
    fn rate_without_base(
        &self,
        moving: &mut Moving,
        (tree, inputs): (&Tree, &Inputs),
        twist: &Twist,
    ) -> Vector6 {
        let v = self.vehicle;
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
        let (force, mut torque) = moving
            .body
            .momentum_rate(&self.input_state.bodies, &moving.kinematics);
        torque += wheel_rate(
            tree,
            &moving.kinematics,
            &v.spin,
            &inputs.wheels,
            &inputs.wheel_rates,
        );
        stack(&force, &torque)
    }

    fn rate_slopes(&self, inputs: &Inputs, twist: &Twist, points: &[BodyPoint]) -> RateSlopes {
        let tree = self.vehicle.tree;
        let mut moving = Moving {
            kinematics: Kinematics::new(tree),
            body: Accelerations::new(tree),
        };
        let mut slopes = RateSlopes {
            balance: SMatrix::zeros(),
            force_B: vec![Matrix3::zeros(); points.len()],
        };
        for axis in 0..3 {
            for half in [0.5_f64, -0.5] {
                let mut turned = *twist;
                turned.w[axis] += half.signum();
                let b = self.rate_without_base(&mut moving, (tree, inputs), &turned) * half;
                let sum = slopes.balance.column(axis) + b;
                slopes.balance.set_column(axis, &sum);
                for ((body, p), slope) in points.iter().zip(&mut slopes.force_B) {
                    let R = moving.kinematics.R[*body];
                    let f = R * moving.body.at_point(&moving.kinematics, *body, p) * half;
                    let sum = slope.column(axis) + f;
                    slope.set_column(axis, &sum);
                }
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
            (&instant.twist.w, &lower(twist)),
            &dphi,
            j.checked_sub(self.initial_columns),
        );
        let mut wrench = stack(&Vector3::zeros(), &torque);
        if let Some(kind) = kind.filter(|k| k.thruster().is_some()) {
            for f in self.forces(&inputs.thrust, &instant.centre) {
                let (dF, dT) = f.change(kind);
                wrench += stack(&dF, &(dT + instant.centre.c.cross(&dF)));
            }
        }
        let mut own = slopes.balance * lower(twist);
        if let Some(u) = j.checked_sub(self.initial_columns) {
            let factor = self.slope_factor(u);
            for (at, slope) in &v.slopes[u] {
                let (body, k) = (at / 10, at % 10);
                let column = momentum_rate_column(&moving.body, &moving.kinematics, body, k);
                own += column * (*slope * factor);
            }
            if let UnknownKind::SpinInertia(w) = &v.kinds[u] {
                let mut unit = vec![0.0; v.spin.len()];
                unit[*w] = 1.0;
                let rate = wheel_rate(
                    v.tree,
                    &moving.kinematics,
                    &unit,
                    &inputs.wheels,
                    &inputs.wheel_rates,
                );
                own += stack(&Vector3::zeros(), &rate);
            }
            if let UnknownKind::WheelTilt(w, _) = &v.kinds[u] {
                let host = v.tree.rotors[*w].body;
                let d = moving.kinematics.R[host] * v.tilt_slopes[u];
                let rate = d * inputs.wheel_rates[*w]
                    + moving.kinematics.w[host].cross(&d) * inputs.wheels[*w];
                own += stack(&Vector3::zeros(), &(rate * v.spin[*w]));
            }
        }
        instant.inverse_inertia * (wrench - own)
    }

    /// Direct effect of input errors; the effect through their twist is included already. The joints' accelerations are
    /// not shifted in time.
    fn add_input_changes(
        &self,
        inputs: &Inputs,
        state: &State,
        instant: &Instant,
        (base, points): (&Vector6, &[BodyPoint]),
        forces: &mut [PointForce],
    ) {
        for change in &self.input_state.changes {
            let real = |joint: usize| joint < self.vehicle.tree.dof();
            let mut there = [inputs.clone(), inputs.clone()];
            // Quadratic in rates and speeds, so that a step of one is exact; a small one over positions.
            let mut weigh = Vec::new();
            if let Some((joint, dq, drate)) = change.joint.filter(|c| real(c.0)) {
                weigh.push((dq, JOINT_STEP, Some(joint), None, None));
                weigh.push((drate, 1.0, None, Some(joint), None));
            }
            if let Some((wheel, dspeed)) = change.wheel {
                weigh.push((dspeed, 1.0, None, None, Some(wheel)));
            }
            for (share, step, position, rate, wheel) in weigh {
                if share == 0.0 {
                    continue;
                }
                for (end, sign) in there.iter_mut().zip([1.0, -1.0]) {
                    *end = inputs.clone();
                    if let Some(j) = position {
                        end.q[j] += sign * step;
                    }
                    if let Some(j) = rate {
                        end.rates[j] += sign * step;
                    }
                    if let Some(w) = wheel {
                        end.wheels[w] += sign * step;
                    }
                }
                let ends = there.each_ref().map(|inputs| (self.vehicle.tree, inputs));
                self.add_change(
                    (change.unknown, share),
                    (state, instant),
                    (ends, step),
                    (base, points),
                    forces,
                );
            }
        }
        for (unknown, kind) in self.vehicle.kinds.iter().enumerate() {
            let Some(trees) = moved_trees(self.vehicle.tree, kind) else {
                continue;
            };
            let ends = trees.each_ref().map(|tree| (tree, inputs));
            self.add_change(
                (unknown, 1.0),
                (state, instant),
                (ends, JOINT_STEP),
                (base, points),
                forces,
            );
        }
    }

    /// Adds the direct effect of one unknown: a share of the slope between two ends.
    fn add_change(
        &self,
        (unknown, share): (usize, f64),
        (state, instant): (&State, &Instant),
        (ends, step): ([(&Tree, &Inputs); 2], f64),
        (base, points): (&Vector6, &[BodyPoint]),
        forces: &mut [PointForce],
    ) {
        let (balance, own) = self.input_slopes(state, ends, step, instant, base, points);
        let shift = instant.inverse_inertia * balance;
        for ((force, (body, p)), own) in forces.iter_mut().zip(points).zip(&own) {
            let R = self.input_state.kinematics.R[*body];
            let r = self.input_state.kinematics.p[*body] + R * p;
            let in_B = upper(&shift) + lower(&shift).cross(&r);
            force.columns[self.initial_columns + unknown] += (own - R.transpose() * in_B) * share;
        }
    }

    /// Slope of `H A + b - W`, and of the force at each point in its body, between two sets of inputs two
    /// steps apart, twist and acceleration of the base held.
    fn input_slopes(
        &self,
        state: &State,
        ends: [(&Tree, &Inputs); 2],
        step: f64,
        instant: &Instant,
        base: &Vector6,
        points: &[BodyPoint],
    ) -> (Vector6, Vec<Vector3>) {
        let v = self.vehicle;
        let mut moving = Moving {
            kinematics: Kinematics::new(v.tree),
            body: Accelerations::new(v.tree),
        };
        let mut balance = Vector6::zeros();
        let mut own = vec![Vector3::zeros(); points.len()];
        for ((tree, there), weight) in ends.into_iter().zip([0.5 / step, -0.5 / step]) {
            self.rate_without_base(&mut moving, (tree, there), &instant.twist);
            moving
                .body
                .add_base(&moving.kinematics, &upper(base), &lower(base));
            let (force, mut torque) = moving
                .body
                .momentum_rate(&self.input_state.bodies, &moving.kinematics);
            torque += wheel_rate(
                tree,
                &moving.kinematics,
                &v.spin,
                &there.wheels,
                &there.wheel_rates,
            );
            let outside = self.outside(state, &moving.kinematics, there, instant);
            balance += (stack(&force, &torque) - outside) * weight;
            for ((body, p), own) in points.iter().zip(&mut own) {
                *own += moving.body.at_point(&moving.kinematics, *body, p) * weight;
            }
        }
        (balance, own)
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
        there.c = whole.p_BoScm_B();
        there.I_SScm_B = whole.I_SScm_B();
        let torque = self.environment_torque(state, &instant.twist.w, &there);
        let mut sum = stack(&Vector3::zeros(), &torque);
        for thrust in &inputs.thrust {
            let origin = Vector3::zeros();
            let (F, arm) = thruster_at(self.vehicle, kinematics, thrust, &origin);
            sum += stack(&F, &arm.cross(&F));
        }
        sum
    }
}

/// Second derivative of a joint's position at grid time k, rad/s2 or m/s2: of the quintic that meets position
/// and rate here and at both neighbours (error `h^4 q^(6) / 360` at even steps); at an end, of the cubic.
fn joint_acceleration(o: &Observations, dof: usize, joint: usize, k: usize) -> f64 {
    let q = |i: usize| o.joint_position[i * dof + joint];
    let rate = |i: usize| o.joint_rate[i * dof + joint];
    let last = o.time_s.len() - 1;
    if last == 0 {
        return 0.0;
    }
    if k == 0 || k == last {
        let other = if k == 0 { 1 } else { last - 1 };
        let h = o.time_s[other] - o.time_s[k];
        return 6.0 * (q(other) - q(k)) / (h * h) - (4.0 * rate(k) + 2.0 * rate(other)) / h;
    }
    let row = |i: usize| {
        let h = o.time_s[i] - o.time_s[k];
        let u = (q(i) - q(k) - rate(k) * h) / (h * h);
        let w = (rate(i) - rate(k)) / h;
        (h, u, w)
    };
    // q(h) = q + q' h + h^2 (a + b h + c h^2 + e h^3): eliminate e, then c and b from both sides.
    let (h1, u1, w1) = row(k - 1);
    let (h2, u2, w2) = row(k + 1);
    // Each side gives u = a + b h + c h^2 + e h^3 and w = 2 a + 3 b h + 4 c h^2 + 5 e h^3.
    let system = nalgebra::Matrix4::new(
        1.0,
        h1,
        h1 * h1,
        h1.powi(3),
        2.0,
        3.0 * h1,
        4.0 * h1 * h1,
        5.0 * h1.powi(3),
        1.0,
        h2,
        h2 * h2,
        h2.powi(3),
        2.0,
        3.0 * h2,
        4.0 * h2 * h2,
        5.0 * h2.powi(3),
    );
    let scale = 0.5 * (h2 - h1);
    let columns = nalgebra::Matrix4::from_diagonal(&nalgebra::Vector4::new(
        1.0,
        1.0 / scale,
        1.0 / (scale * scale),
        1.0 / scale.powi(3),
    ));
    (system * columns)
        .lu()
        .solve(&nalgebra::Vector4::new(u1, w1, u2, w2))
        .map_or_else(|| parabola_slope(&o.time_s, rate, k), |x| 2.0 * x[0])
}

fn upper(v: &Vector6) -> Vector3 {
    v.fixed_rows::<3>(0).into()
}

fn lower(v: &Vector6) -> Vector3 {
    v.fixed_rows::<3>(3).into()
}

fn stack(force: &Vector3, torque: &Vector3) -> Vector6 {
    Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z)
}
