//! The variational equation of state and unknowns.
//!
//! ```text
//! dV = V_x x + V_u        x' = A x + b_u
//! ```
//!
//! for the column `x = [dphi_B, dp_N, dP_N, dh_N]` of unknown u. `A` and `b` are those of the pose by way of the twist,
//! and those of the momentum if an external force or torque acts.

use super::{Column, Instant, MassCentre, Motion, State, matrix};
use crate::problem::parameters::UnknownKind;
use nalgebra::SMatrix;
use poinsot_dynamics::{momentum_regressor, wheel_regressor};
use poinsot_spatial::{Matrix3, Matrix6, Vector3, Vector6, skew};

pub(crate) type Matrix6x12 = SMatrix<f64, 6, 12>;

type Matrix6x3 = SMatrix<f64, 6, 3>;

/// Change of the pose around one instant.
#[derive(Clone, Default)]
pub(crate) struct Variation {
    /// `V_x`.
    pub map: Matrix6x12,
    /// `V_u` per unknown.
    pub(super) twists: Vec<Vector6>,
    pose: JacobianRows,
    /// The upper half of `b`, per unknown.
    pub(super) drive: Vec<Vector6>,
    /// The same per wheel, for a unit of its axial momentum per spin inertia, where wheels run along a chord.
    chord: Vec<Vector6>,
}

/// Forcing of a column in addition to the state.
#[derive(Clone, Copy)]
pub(super) enum ColumnForcing {
    /// An unknown; `None` for a part of the state at the start.
    Unknown(Option<usize>),
    /// A wheel with its share of the chord's unit, at the start, in the middle and at the end of a step.
    Chord([(usize, f64); 3]),
}

impl ColumnForcing {
    fn unknown(self) -> Option<usize> {
        match self {
            Self::Unknown(unknown) => unknown,
            Self::Chord(_) => None,
        }
    }
}

/// Change of the momentum around one instant by external forces and torques.
pub(super) struct MomentumVariation {
    /// `None` without a torque that rotates with the vehicle: unknown torques that are zero.
    momentum: Option<JacobianRows>,
    /// The lower half of `b`, per unknown.
    pub(super) drive: Vec<Vector6>,
}

/// Six rows of `A`: no position enters.
#[derive(Clone, Default)]
struct JacobianRows {
    attitude: Matrix6x3,
    momentum: Matrix6,
    /// Whether any element of `momentum` is not zero.
    coupled: bool,
}

impl MomentumVariation {
    /// Whether the momentum of a column changes.
    fn acts(&self, unknown: Option<usize>) -> bool {
        self.momentum.is_some() || unknown.is_some_and(|u| self.drive[u] != Vector6::zeros())
    }
}

impl JacobianRows {
    fn new(rows: &Matrix6x12) -> Self {
        let momentum: Matrix6 = rows.fixed_view::<6, 6>(0, 6).into();
        Self {
            attitude: rows.fixed_view::<6, 3>(0, 0).into(),
            coupled: momentum != Matrix6::zeros(),
            momentum,
        }
    }

    fn rows(&self) -> Matrix6x12 {
        let mut rows = Matrix6x12::zeros();
        rows.fixed_view_mut::<6, 3>(0, 0).copy_from(&self.attitude);
        rows.fixed_view_mut::<6, 6>(0, 6).copy_from(&self.momentum);
        rows
    }
}

impl Variation {
    /// Change of the twist with a column, that of the given unknown.
    pub fn twist(&self, column: &Column, unknown: Option<usize>) -> Vector6 {
        let (attitude, momentum) = parts(column);
        let mut twist = self.map.fixed_view::<6, 3>(0, 0) * attitude;
        if momentum != Vector6::zeros() {
            twist += self.map.fixed_view::<6, 6>(0, 6) * momentum;
        }
        twist + unknown.map_or_else(Vector6::zeros, |u| self.twists[u])
    }
}

fn parts(x: &Column) -> (Vector3, Vector6) {
    (x.fixed_rows::<3>(0).into(), x.fixed_rows::<6>(6).into())
}

/// The equation at the start, in the middle and at the end of a step.
pub(super) struct StepEquation<'v> {
    pub variation: [&'v Variation; 3],
    /// If an external force or torque acts.
    pub push: Option<[MomentumVariation; 3]>,
}

/// Evaluation and share of the step of each Runge-Kutta stage.
const STAGES: [(usize, f64); 4] = [(0, 0.0), (1, 0.5), (1, 0.5), (2, 1.0)];

impl StepEquation<'_> {
    /// Carries a column over a step of dt: Runge-Kutta of fourth order on an equation that is linear.
    pub fn carry(&self, x: &mut Column, drive: ColumnForcing, dt: f64) {
        let (attitude, momentum) = parts(x);
        let push = self.push.as_ref();
        let acts = |p: &MomentumVariation| p.acts(drive.unknown());
        let change = match push.filter(|push| push.iter().any(acts)) {
            None => self.carry_pose(&attitude, &momentum, drive, dt),
            Some(push) => self.carry_all(push, &attitude, &momentum, drive, dt),
        };
        *x += change * (dt / 6.0);
    }

    /// The upper half of `b` at one of the three points.
    fn drive(&self, at: usize, drive: ColumnForcing) -> Vector6 {
        match drive {
            ColumnForcing::Unknown(unknown) => {
                unknown.map_or_else(Vector6::zeros, |u| self.variation[at].drive[u])
            }
            // At the ends of an interval speeds are measured: no chord.
            ColumnForcing::Chord(wheels) => {
                let (wheel, share) = wheels[at];
                let unit = self.variation[at].chord.get(wheel);
                unit.map_or_else(Vector6::zeros, |unit| unit * share)
            }
        }
    }

    /// The momentum stays: its part of the slope is known beforehand.
    fn carry_pose(
        &self,
        attitude: &Vector3,
        momentum: &Vector6,
        drive: ColumnForcing,
        dt: f64,
    ) -> Column {
        let given = [0, 1, 2].map(|at| {
            let drive = self.drive(at, drive);
            if *momentum == Vector6::zeros() {
                drive
            } else {
                drive + self.variation[at].pose.momentum * momentum
            }
        });
        let mut change = Column::zeros();
        if *attitude == Vector3::zeros() && given.iter().all(|g| *g == Vector6::zeros()) {
            return change;
        }
        let mut slopes = [Vector6::zeros(); 4];
        for (i, (at, share)) in STAGES.into_iter().enumerate() {
            let before = slopes[i.saturating_sub(1)].fixed_rows::<3>(0) * (share * dt);
            slopes[i] = self.variation[at].pose.attitude * (attitude + before) + given[at];
        }
        let [a, b, c, d] = slopes;
        change
            .fixed_rows_mut::<6>(0)
            .copy_from(&(a + (b + c) * 2.0 + d));
        change
    }

    fn carry_all(
        &self,
        push: &[MomentumVariation; 3],
        attitude: &Vector3,
        momentum: &Vector6,
        drive: ColumnForcing,
        dt: f64,
    ) -> Column {
        let mut slopes = [(Vector6::zeros(), Vector6::zeros()); 4];
        for (i, (at, share)) in STAGES.into_iter().enumerate() {
            let (v, p) = (self.variation[at], &push[at]);
            let (pose, force) = slopes[i.saturating_sub(1)];
            let turned = attitude + pose.fixed_rows::<3>(0) * (share * dt);
            let pushed = momentum + force * (share * dt);
            let mut slope = (
                v.pose.attitude * turned + v.pose.momentum * pushed,
                Vector6::zeros(),
            );
            if let Some(outside) = &p.momentum {
                slope.1 = outside.attitude * turned;
                if outside.coupled {
                    slope.1 += outside.momentum * pushed;
                }
            }
            slope.0 += self.drive(at, drive);
            if let Some(u) = drive.unknown() {
                slope.1 += p.drive[u];
            }
            slopes[i] = slope;
        }
        let [a, b, c, d] = slopes;
        let mut change = Column::zeros();
        change
            .fixed_rows_mut::<6>(0)
            .copy_from(&(a.0 + (b.0 + c.0) * 2.0 + d.0));
        change
            .fixed_rows_mut::<6>(6)
            .copy_from(&(a.1 + (b.1 + c.1) * 2.0 + d.1));
        change
    }
}

/// What a change of the twist does to the pose's rate `[dphi_B'; dp_N']`.
pub(crate) fn pose_change(R: &Matrix3, twist: &Vector6) -> Vector6 {
    let v = R * twist.fixed_rows::<3>(0);
    Vector6::new(twist[3], twist[4], twist[5], v.x, v.y, v.z)
}

fn pose_slopes(R: &Matrix3, instant: &Instant, map: &Matrix6x12) -> Matrix6x12 {
    let twist = &instant.twist;
    let mut pose = Matrix6x12::zeros();
    for j in (0..3).chain(6..12) {
        pose.set_column(j, &pose_change(R, &map.column(j).into()));
    }
    let mut own = pose.fixed_view_mut::<3, 3>(0, 0);
    own -= skew(&twist.w);
    let mut own = pose.fixed_view_mut::<3, 3>(3, 0);
    own -= R * skew(&twist.v);
    pose
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
        momentum_regressor(&input_state.kinematics, &mut self.regressor);
        wheel_regressor(
            v.tree,
            &input_state.kinematics,
            &input_state.wheels,
            &mut self.wheel_columns,
        );
        let twists = &mut out.twists;
        twists.clear();
        twists.extend(
            (0..v.kinds.len())
                .map(|u| self.twist_change(u, &instant.centre, &instant.inverse_inertia)),
        );
        self.fault_slopes(instant);
        self.input_columns(instant, twists);
        if !self.input_state.free.is_empty() {
            // The axial momentum is given: the host's rotation reduces the speed.
            for change in self.axial_changes() {
                twists[change.unknown] -= self.wheel_gain(instant, change.wheel) * change.turn;
            }
        }

        let map = self.map_at(state, instant);
        let R = matrix(&state.R_NB);
        out.pose = JacobianRows::new(&pose_slopes(&R, instant, &map));
        out.map = map;
        out.drive.clear();
        let drive = out.twists.iter().map(|twist| pose_change(&R, twist));
        out.drive.extend(drive);
        out.chord.clear();
        let wheels = 0..self.input_state.free.len();
        out.chord
            .extend(wheels.map(|wheel| pose_change(&R, &self.wheel_gain(instant, wheel))));
    }

    /// Slopes of the pose's rate over the state: the upper half of `A`; `map` is [`Self::state_map`].
    pub fn pose_slopes(&self, state: &State, instant: &Instant, map: &Matrix6x12) -> Matrix6x12 {
        match self.variation(state) {
            Some(variation) => variation.pose.rows(),
            None => pose_slopes(&matrix(&state.R_NB), instant, map),
        }
    }

    /// The equation where the last velocity was taken, if it was at this state.
    pub(super) fn variation(&self, state: &State) -> Option<&Variation> {
        let evaluated = self.evaluated.as_ref().filter(|r| r.state == *state);
        evaluated.and_then(|r| r.variation.as_deref())
    }

    /// Change of the twist with one unknown, the state held.
    fn twist_change(
        &self,
        unknown: usize,
        centre: &MassCentre,
        inverse_inertia: &Matrix6,
    ) -> Vector6 {
        let v = self.vehicle;
        let own = match &v.kinds[unknown] {
            UnknownKind::SpinInertia(w) => Vector6::from(self.wheel_columns[*w]),
            UnknownKind::WheelTilt(w, _) => {
                let h = self.input_state.kinematics.R[v.tree.rotors[*w].body]
                    * v.tilt_slopes[unknown]
                    * (v.spin[*w] * self.input_state.wheels[*w]);
                Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z)
            }
            _ if v.slopes[unknown].is_empty() => return Vector6::zeros(),
            _ => {
                let mut sum = Vector6::zeros();
                let factor = self.slope_factor(unknown);
                for (at, slope) in &v.slopes[unknown] {
                    sum += Vector6::from(self.regressor[*at]) * (*slope * factor);
                }
                let moved = self.mass_centre_change(unknown, centre).cross(&centre.l);
                let angular = sum.fixed_rows::<3>(3) - moved;
                sum.fixed_rows_mut::<3>(3).copy_from(&angular);
                sum
            }
        };
        -(inverse_inertia * own)
    }

    /// Change of the system's mass centre in B with one unknown: `d(mc)/m - c dm/m`.
    fn mass_centre_change(&self, unknown: usize, centre: &MassCentre) -> Vector3 {
        let mut change = Vector3::zeros();
        let factor = self.slope_factor(unknown);
        for &(at, slope) in &self.vehicle.slopes[unknown] {
            let (body, k) = (at / 10, at % 10);
            let step = match k {
                0 => self.input_state.kinematics.p[body] - centre.c,
                1..=3 => self.input_state.kinematics.R[body]
                    .column(k - 1)
                    .into_owned(),
                _ => continue,
            };
            change += step * (slope * factor / centre.mass);
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
        if !acts && !self.vehicle.has_unknown_wrench {
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
            if !acts && !kind.is_external_wrench() {
                return Vector6::zeros();
            }
            let dw: Vector3 = twist.fixed_rows::<3>(3).into();
            let mut dF = Vector3::zeros();
            let mut dT = self.environment_torque_change(state, centre, (w, &dw), &still, Some(u));
            let dc = self.mass_centre_change(u, centre);
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
        drives.extend(variation.twists.iter().enumerate().map(drive));
        self.spare.forces = forces;
        Some(MomentumVariation {
            drive: drives,
            momentum: acts
                .then(|| JacobianRows::new(&self.wrench_slopes(state, instant, &variation.map, k))),
        })
    }
}
