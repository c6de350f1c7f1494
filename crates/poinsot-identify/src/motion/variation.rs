//! The variational equation of state and unknowns.
//!
//! ```text
//! dV = V_x x + V_u        x' = A x + b_u
//! ```
//!
//! for the column `x = [dphi_B, dp_N, dP_N, dh_N]` of unknown u. `A` and `b` are those of the pose by way of the twist,
//! and those of the momentum if an external force or torque acts.

use super::{Column, Instant, Matrix6x12, Motion, State, matrix, pose_change};
use crate::problem::parameters::UnknownKind;
use poinsot_dynamics::propagation::{
    BodyChange, ColumnDrives, Flexibility, FlexibleChange, Internal, ModeNumber, ModeRows, OneBody,
    StateRows, StepRows,
};
use poinsot_dynamics::{body_regressor, wheel_regressor};
use poinsot_spatial::{Vector3, Vector6};
use std::borrow::Cow;

/// Change of the pose around one instant.
#[derive(Clone, Default)]
pub(crate) struct Variation {
    /// `V_x`.
    pub map: StateRows,
    /// `V_u` per unknown.
    pub(super) twists: Vec<Vector6>,
    pose: StateRows,
    /// The upper half of `b`, per unknown.
    pub(super) drive: Vec<Vector6>,
    /// The same per wheel, for a unit of its axial momentum per spin inertia, where wheels run along a chord.
    chord: Vec<Vector6>,
    /// The rows of the modes, where there are any, and the rest of `b` for each unknown and wheel.
    pub(super) modes: Option<Box<ModeRows>>,
    pub(super) internal: Vec<Internal>,
    chord_internal: Vec<Internal>,
}

/// Change of the momentum around one instant by external forces and torques.
pub(super) struct MomentumVariation {
    /// `None` without a torque that rotates with the vehicle: unknown torques that are zero.
    momentum: Option<StateRows>,
    /// The lower half of `b`, per unknown.
    pub(super) drive: Vec<Vector6>,
    /// What the change of a force adds to that of the modes, per unknown; empty where there are none.
    internal: Vec<Internal>,
}

impl Variation {
    /// Change of the twist with every column, of which `initial` are parts of the state at the start and the others unknowns.
    pub fn twists(&self, columns: &[Column], initial: usize, out: &mut [Vector6]) {
        let (start, unknowns) = out.split_at_mut(initial);
        start.fill(Vector6::zeros());
        unknowns.copy_from_slice(&self.twists);
        self.map
            .add_times_columns(self.modes.as_deref(), columns, out);
    }

    /// Change of the twist with a column, that of the given unknown.
    pub fn twist(&self, column: &Column, unknown: Option<usize>) -> Vector6 {
        let modes = self.modes.as_deref();
        self.map.times(column)
            + modes.map_or_else(Vector6::zeros, |m| m.twist_times(column))
            + unknown.map_or_else(Vector6::zeros, |u| self.twists[u])
    }
}

/// How an unknown moves the state over a step.
#[derive(PartialEq)]
enum Moves {
    /// Not at all: errors of sensors.
    Nothing,
    Pose,
    PoseAndMomentum,
}

/// The equation at the start, in the middle and at the end of a step.
pub(super) struct StepEquation<'v> {
    pub variation: [&'v Variation; 3],
    /// If an external force or torque acts.
    pub push: Option<[MomentumVariation; 3]>,
}

impl StepEquation<'_> {
    fn rows(&self) -> StepRows<'_> {
        let momentum = match &self.push {
            Some(push) => push.each_ref().map(|p| p.momentum.as_ref()),
            None => [None; 3],
        };
        StepRows {
            pose: self.variation.map(|v| &v.pose),
            momentum,
            modes: self.variation.map(|v| v.modes.as_deref()),
        }
    }

    /// Carries the columns of the state at the start and of the unknowns over a step of dt; `moving` tells which unknowns move
    /// the vehicle.
    pub fn carry(
        &self,
        (start, unknowns): (&mut [Column], &mut [Column]),
        moving: &[bool],
        dt: f64,
    ) {
        let rows = self.rows();
        rows.carry_columns(start, ColumnDrives::default(), dt);
        let internal = self.internal();
        let turned = rows.momentum.iter().any(Option::is_some);
        let of = |u: usize| match &self.push {
            _ if !moving[u] => Moves::Nothing,
            Some(push) if turned || push.iter().any(|p| p.drive[u] != Vector6::zeros()) => {
                Moves::PoseAndMomentum
            }
            _ => Moves::Pose,
        };
        let mut first = 0;
        // One run of unknowns of the same kind after the other.
        while first < unknowns.len() {
            let moves = of(first);
            let same = (first..unknowns.len()).take_while(|u| of(*u) == moves);
            let run = first..first + same.count();
            first = run.end;
            if moves == Moves::Nothing {
                continue;
            }
            let push = self.push.as_ref();
            let push = push.filter(|_| moves == Moves::PoseAndMomentum);
            let drives = ColumnDrives {
                pose: Some(self.variation.map(|v| &v.drive[run.clone()])),
                push: push.map(|push| push.each_ref().map(|p| &p.drive[run.clone()])),
                internal: internal
                    .as_ref()
                    .map(|i| i.each_ref().map(|of| &of[run.clone()])),
            };
            rows.carry_columns(&mut unknowns[run], drives, dt);
        }
    }

    /// `b` of the modes for every unknown, where there are any.
    fn internal(&self) -> Option<[Cow<'_, [Internal]>; 3]> {
        self.variation[0].modes.as_ref()?;
        Some([0, 1, 2].map(|at| {
            let own = self.variation[at].internal.as_slice();
            let Some(push) = self.push.as_ref().map(|p| p[at].internal.as_slice()) else {
                return Cow::Borrowed(own);
            };
            Cow::Owned(own.iter().zip(push).map(|(a, b)| a + b).collect())
        }))
    }

    /// Carries the column of a chord over a step of dt; `wheels` are the wheel and its share of the chord's unit at the start, in
    /// the middle and at the end of it.
    pub fn carry_chord(&self, column: &mut Column, wheels: [(usize, f64); 3], dt: f64) {
        // At the ends of an interval speeds are measured: no chord.
        let drive = [0, 1, 2].map(|at| {
            let (wheel, share) = wheels[at];
            let unit = self.variation[at].chord.get(wheel);
            [unit.map_or_else(Vector6::zeros, |unit| unit * share)]
        });
        let internal = [0, 1, 2].map(|at| {
            let (wheel, share) = wheels[at];
            let unit = self.variation[at].chord_internal.get(wheel);
            [unit.map_or_else(Internal::zeros, |unit| unit * share)]
        });
        let drives = ColumnDrives {
            pose: Some(drive.each_ref().map(|of| of.as_slice())),
            push: None,
            internal: Some(internal.each_ref().map(|of| of.as_slice())),
        };
        let column = std::slice::from_mut(column);
        self.rows().carry_columns(column, drives, dt);
    }
}

impl Motion<'_> {
    /// The variational equation of the pose at the inputs in hand: with `V = H^-1 (X [P; h] - c - c_w)`,
    /// `dV = H^-1 (d(X [P; h]) - Y(V) dpi)`.
    pub(super) fn linearise(&mut self, state: &State, instant: &Instant, out: &mut Variation) {
        let (v, twist) = (self.vehicle, &instant.twist);
        let input_state = &mut self.input_state;
        for (speed, (axis, still)) in input_state.wheels.iter_mut().zip(&input_state.free) {
            *speed = still - axis.dot(&twist.w);
        }
        input_state.set_velocities(v.tree, &twist.v, &twist.w);
        for body in &v.moved_bodies {
            if let Some(columns) = self.regressor.get_mut(*body) {
                body_regressor(&input_state.kinematics, *body, columns);
            }
        }
        wheel_regressor(
            v.tree,
            &input_state.kinematics,
            &input_state.wheels,
            &mut self.wheel_columns,
        );
        let twists = &mut out.twists;
        twists.clear();
        twists.extend((0..v.kinds.len()).map(|u| self.twist_change(u, instant)));
        self.fault_slopes(instant);
        self.input_columns(instant, twists);
        if !self.input_state.free.is_empty() {
            // The axial momentum is given: the host's rotation reduces the speed.
            for change in self.axial_changes() {
                twists[change.unknown] -= self.wheel_gain(instant, change.wheel) * change.turn;
            }
        }

        let R = matrix(&state.R_NB);
        out.map = instant.twist_rows(state);
        self.follow_modes(state, instant, out);
        out.pose = instant.pose_rows(state, &out.map);
        out.drive.clear();
        let drive = out.twists.iter().map(|twist| pose_change(&R, twist));
        out.drive.extend(drive);
        out.chord.clear();
        let wheels = 0..self.input_state.free.len();
        out.chord_internal.clear();
        for wheel in wheels {
            let gain = self.wheel_gain(instant, wheel);
            let change = self.followed((state, instant), &gain, None);
            out.chord.push(pose_change(&R, &change.twist));
            out.chord_internal.push(self.mode_rates(instant, &change));
        }
    }

    /// The modes follow what the unknowns do to the base.
    fn follow_modes(&self, state: &State, instant: &Instant, out: &mut Variation) {
        out.internal.clear();
        let Some(flexible) = &self.input_state.flexible else {
            return;
        };
        let force = self.force_now(instant);
        let rows = out.modes.get_or_insert_default();
        flexible.rows(instant, &state.rigid, (&mut out.map, rows), &force);
        for (unknown, twist) in out.twists.iter_mut().enumerate() {
            let (mut push, mut lighter) = (None, 0.0);
            let at = (instant, &state.internal);
            let change = match &self.vehicle.kinds[unknown] {
                UnknownKind::Spring(k, number) => {
                    push = Some(flexible.with_spring(at, (*k, *number)));
                    FlexibleChange::of_twist(Vector6::zeros())
                }
                UnknownKind::Mode(k, number) => {
                    let (change, own) = flexible.with_number(at, (*k, *number), &force);
                    push = Some((2 * k + 1, own));
                    change
                }
                _ => {
                    let of = self.body_change(flexible, unknown, instant, &force);
                    lighter = -of.dm / instant.centre.mass;
                    flexible.with_bodies(at, twist, &of)
                }
            };
            *twist = change.twist;
            let mut rate = flexible.rate_change(instant, &change, &(force * lighter));
            if let Some((at, own)) = push {
                rate[at] += own;
            }
            out.internal.push(rate);
        }
    }

    /// What an unknown does to the bodies and joints, at the velocities set last.
    fn body_change(
        &self,
        flexible: &Flexibility,
        unknown: usize,
        instant: &Instant,
        force: &Vector3,
    ) -> BodyChange {
        let (v, now) = (self.vehicle, &self.input_state);
        let factor = self.slope_factor(unknown);
        let mut of = BodyChange {
            dc: self.mass_centre_change((unknown, factor), instant),
            ..BodyChange::default()
        };
        for &(at, slope) in &v.slopes[unknown] {
            let (body, size) = (at / 10, slope * factor);
            let (R, p) = (&now.kinematics.R[body], &now.kinematics.p[body]);
            let (dm, dmc) = match at % 10 {
                0 => (size, p * size),
                axis @ 1..=3 => (0.0, R.column(axis - 1) * size),
                _ => (0.0, Vector3::zeros()),
            };
            of.dm += dm;
            let own = OneBody {
                over: v.passive.over(body),
                momentum: Vector6::from(self.regressor.as_flattened()[at]) * size,
                dm,
                dmc,
            };
            flexible.add_body(instant, (&mut of.held, &own), force);
        }
        for change in now.changes.iter().filter(|c| c.unknown == unknown) {
            let Some((joint, dq, drate)) = change.joint else {
                continue;
            };
            of.dc += now.joint_slopes.of[joint].first_moment * (dq / instant.centre.mass);
            let held = (&mut of.held, &now.hinges[joint]);
            flexible.add_joint(instant, held, [dq, drate], force);
        }
        of
    }

    /// Change of the modes' rates with a change of the motion.
    pub fn mode_rates(&self, instant: &Instant, change: &FlexibleChange) -> Internal {
        let flexible = self.input_state.flexible.as_ref();
        flexible.map_or_else(Internal::zeros, |f| {
            f.rate_change(instant, change, &Vector3::zeros())
        })
    }

    /// Slopes of twist and pose's rate over the state, the upper half of `A`, and the rows of the modes where there are any.
    pub fn slopes(
        &self,
        state: &State,
        instant: &Instant,
    ) -> (Matrix6x12, Matrix6x12, Option<Box<ModeRows>>) {
        let evaluated = self.evaluated.as_ref().filter(|r| r.state == *state);
        if let Some(here) = evaluated.and_then(|r| r.variation.as_deref()) {
            return (here.map.matrix(), here.pose.matrix(), here.modes.clone());
        }
        let mut map = instant.twist_rows(state);
        let modes = self.input_state.flexible.as_ref().map(|flexible| {
            let mut rows = Box::<ModeRows>::default();
            let force = self.force_now(instant);
            flexible.rows(instant, &state.rigid, (&mut map, &mut rows), &force);
            rows
        });
        (map.matrix(), instant.pose_rows(state, &map).matrix(), modes)
    }

    /// The change of a motion with a change of the twist that joints or wheels make; `joint` moves by `[position, rate]`.
    pub fn followed(
        &self,
        (state, instant): (&State, &Instant),
        twist: &Vector6,
        joint: Option<(usize, [f64; 2])>,
    ) -> FlexibleChange {
        let now = &self.input_state;
        let Some(flexible) = &now.flexible else {
            return FlexibleChange::of_twist(*twist);
        };
        let mut of = BodyChange::default();
        if let Some((joint, by)) = joint {
            let held = (&mut of.held, &now.hinges[joint]);
            flexible.add_joint(instant, held, by, &self.force_now(instant));
        }
        flexible.with_bodies((instant, &state.internal), twist, &of)
    }

    /// Change of the twist with one unknown, the state held.
    fn twist_change(&self, unknown: usize, instant: &Instant) -> Vector6 {
        let v = self.vehicle;
        let still = Vector3::zeros();
        match &v.kinds[unknown] {
            UnknownKind::SpinInertia(w) => {
                instant.twist_slope(&Vector6::from(self.wheel_columns[*w]), &still)
            }
            UnknownKind::WheelTilt(w, _) => {
                let h = self.input_state.kinematics.R[v.tree.rotors[*w].body]
                    * v.tilt_slopes[unknown]
                    * (v.spin[*w] * self.input_state.wheels[*w]);
                instant.twist_slope(&Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z), &still)
            }
            _ if v.slopes[unknown].is_empty() => Vector6::zeros(),
            _ => {
                let mut sum = Vector6::zeros();
                let factor = self.slope_factor(unknown);
                for (at, slope) in &v.slopes[unknown] {
                    let column = self.regressor.as_flattened()[*at];
                    sum += Vector6::from(column) * (*slope * factor);
                }
                let dc = self.mass_centre_change((unknown, factor), instant);
                instant.twist_slope(&sum, &dc)
            }
        }
    }

    /// Change of the system's mass centre in B with one unknown: `d(mc)/m - c dm/m`.
    /// The factor is [`Self::slope_factor`].
    fn mass_centre_change(&self, (unknown, factor): (usize, f64), instant: &Instant) -> Vector3 {
        let mut change = Vector3::zeros();
        let kinematics = &self.input_state.kinematics;
        for &(at, slope) in &self.vehicle.slopes[unknown] {
            let (body, parameter) = (at / 10, at % 10);
            // Inertia does not move the mass centre.
            if parameter > 3 {
                continue;
            }
            let (R, p) = (&kinematics.R[body], &kinematics.p[body]);
            change += instant.mass_centre_slope(R, p, parameter) * (slope * factor);
        }
        change
    }

    /// The same for the momentum, in the interval after grid time k; `None` without external force and torque.
    pub(super) fn push(
        &mut self,
        state: &State,
        instant: &Instant,
        variation: &Variation,
        k: usize,
    ) -> Option<MomentumVariation> {
        let acts = self.has_external_wrench(k);
        if !acts && self.vehicle.unknown_wrenches.is_empty() {
            return None;
        }
        let outside = self.outside_changes(state, instant, k);
        let mut forces = std::mem::take(&mut self.spare.forces);
        forces.clear();
        forces.extend(self.thrust_now(instant, k));
        let mut drives = self.spare.drive();
        let (centre, w) = (&instant.centre, &instant.twist.w);
        let (R, still) = (matrix(&state.R_NB), Vector3::zeros());
        let flexible = self.input_state.flexible.as_ref();
        let drive = |(u, twist): (usize, &Vector6)| {
            let kind = &self.vehicle.kinds[u];
            let dw: Vector3 = twist.fixed_rows::<3>(3).into();
            let mut dF = Vector3::zeros();
            let mut dT = self.environment_torque_change(state, centre, (w, &dw), &still, Some(u));
            let mut dc = self.mass_centre_change((u, self.slope_factor(u)), instant);
            if let (Some(f), UnknownKind::Mode(k, ModeNumber::Translation(axis))) = (flexible, kind)
            {
                dc += f.centre_change(&state.internal, *k, *axis);
            }
            for force in &forces {
                dT -= dc.cross(&force.F_B);
                let change = force.change(kind);
                dF += change.0;
                dT += change.1;
            }
            let loss = self.momentum_loss_slope(instant, k, (u, twist), &dc);
            (dF, dT) = (dF - loss.0, dT - loss.1);
            for change in outside.iter().filter(|c| c.unknown == u) {
                dF += change.F_B;
                dT += change.T_B;
            }
            let (mut dP, dh) = (R * dF, R * dT);
            match kind {
                UnknownKind::InertialForce(k) => dP[*k] += 1.0,
                UnknownKind::Tide(k) => dP += self.tidal_force(*k, state, centre),
                _ => {}
            }
            Vector6::new(dP.x, dP.y, dP.z, dh.x, dh.y, dh.z)
        };
        let twists = &variation.twists;
        if acts {
            drives.extend(twists.iter().enumerate().map(drive));
        } else {
            // The others act on what is there.
            drives.resize(twists.len(), Vector6::zeros());
            for &u in &self.vehicle.unknown_wrenches {
                drives[u] = drive((u, &twists[u]));
            }
        }
        self.spare.forces = forces;
        let of_force = |f: &Flexibility, drive: &Vector6| {
            let dF: Vector3 = R.transpose() * drive.fixed_rows::<3>(0);
            f.rate_change(instant, &FlexibleChange::of_twist(Vector6::zeros()), &dF)
        };
        let internal = flexible.into_iter();
        let internal = internal.flat_map(|f| drives.iter().map(move |d| of_force(f, d)));
        Some(MomentumVariation {
            internal: internal.collect(),
            drive: drives,
            momentum: acts.then(|| {
                StateRows::of_matrix(&self.wrench_slopes(
                    state,
                    instant,
                    &variation.map.matrix(),
                    k,
                ))
            }),
        })
    }
}
