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
use poinsot_dynamics::propagation::{StateRows, StepRows};
use poinsot_dynamics::{body_regressor, wheel_regressor};
use poinsot_spatial::{Vector3, Vector6};

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
}

/// Change of the momentum around one instant by external forces and torques.
pub(super) struct MomentumVariation {
    /// `None` without a torque that rotates with the vehicle: unknown torques that are zero.
    momentum: Option<StateRows>,
    /// The lower half of `b`, per unknown.
    pub(super) drive: Vec<Vector6>,
}

impl Variation {
    /// Change of the twist with every column, of which `initial` are parts of the state at the start and the others unknowns.
    pub fn twists(&self, columns: &[Column], initial: usize, out: &mut [Vector6]) {
        let (start, unknowns) = out.split_at_mut(initial);
        start.fill(Vector6::zeros());
        unknowns.copy_from_slice(&self.twists);
        self.map.add_times_columns(columns, out);
    }

    /// Change of the twist with a column, that of the given unknown.
    pub fn twist(&self, column: &Column, unknown: Option<usize>) -> Vector6 {
        self.map.times(column) + unknown.map_or_else(Vector6::zeros, |u| self.twists[u])
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
        rows.carry_columns(start, (None, None), dt);
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
            let pose = self.variation.map(|v| &v.drive[run.clone()]);
            let push = self.push.as_ref();
            let push = push.filter(|_| moves == Moves::PoseAndMomentum);
            let push = push.map(|push| push.each_ref().map(|p| &p.drive[run.clone()]));
            rows.carry_columns(&mut unknowns[run], (Some(pose), push), dt);
        }
    }

    /// Carries the column of a chord over a step of dt; `wheels` are the wheel and its share of the chord's unit at the start, in
    /// the middle and at the end of it.
    pub fn carry_chord(&self, column: &mut Column, wheels: [(usize, f64); 3], dt: f64) {
        let drive = [0, 1, 2].map(|at| {
            let (wheel, share) = wheels[at];
            // At the ends of an interval speeds are measured: no chord.
            let unit = self.variation[at].chord.get(wheel);
            [unit.map_or_else(Vector6::zeros, |unit| unit * share)]
        });
        let drive = Some(drive.each_ref().map(|of| of.as_slice()));
        let column = std::slice::from_mut(column);
        self.rows().carry_columns(column, (drive, None), dt);
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
        input_state
            .kinematics
            .set_velocities(v.tree, &twist.v, &twist.w, &input_state.rates);
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
        out.pose = instant.pose_rows(state, &out.map);
        out.drive.clear();
        let drive = out.twists.iter().map(|twist| pose_change(&R, twist));
        out.drive.extend(drive);
        out.chord.clear();
        let wheels = 0..self.input_state.free.len();
        out.chord
            .extend(wheels.map(|wheel| pose_change(&R, &self.wheel_gain(instant, wheel))));
    }

    /// Slopes of the pose's rate over the state: the upper half of `A`.
    pub fn pose_slopes(&self, state: &State, instant: &Instant) -> Matrix6x12 {
        let here = self.variation(state).map(|variation| variation.pose);
        let rows = here.unwrap_or_else(|| instant.pose_rows(state, &instant.twist_rows(state)));
        rows.matrix()
    }

    /// The equation where the last velocity was taken, if it was at this state.
    pub(super) fn variation(&self, state: &State) -> Option<&Variation> {
        let evaluated = self.evaluated.as_ref().filter(|r| r.state == *state);
        evaluated.and_then(|r| r.variation.as_deref())
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
        let drive = |(u, twist): (usize, &Vector6)| {
            let kind = &self.vehicle.kinds[u];
            let dw: Vector3 = twist.fixed_rows::<3>(3).into();
            let mut dF = Vector3::zeros();
            let mut dT = self.environment_torque_change(state, centre, (w, &dw), &still, Some(u));
            let dc = self.mass_centre_change((u, self.slope_factor(u)), instant);
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
        Some(MomentumVariation {
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
