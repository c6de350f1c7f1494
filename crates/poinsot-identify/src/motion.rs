//! The pose-momentum equation with its forward sensitivities, on measured joint and wheel motion.
//!
//! State: attitude R_NB, position p_NoBo, momentum P and H about the inertial origin. Velocity follows from
//! momentum, `V = H(q)^-1 (X(R, p) [P; H] - c - c_w)` (DESIGN section 2). A small change of the state is
//! `[dphi_B, dp_N, dP_N, dH_N]` with `R -> R exp([dphi]x)`.

use crate::parameters::{Parameters, UnknownKind};
use crate::segment::{Observations, Segment};
use nalgebra::{Quaternion, SMatrix, SVector};
use poinsot_dynamics::{
    Kinematics, Tree, Twist, composite, momentum, momentum_regressor, shift_to_body,
    twist_from_momentum, wheel_momentum, wheel_regressor,
};
use poinsot_model::Thruster;
use poinsot_spatial::{
    InertialParameters, Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6, skew,
};

/// A column of the state's sensitivity.
pub(crate) type Column = SVector<f64, 12>;

/// Pose and momentum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State {
    pub R_NB: UnitQuaternion,
    pub p_NoBo_N: Vector3,
    pub P: Vector3,
    pub H: Vector3,
}

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
        }
    }

    /// Torque of the surroundings on the base in B, N m.
    fn torque(&self, w: &Vector3) -> Vector3 {
        self.torque_B - self.drag.component_mul(w) * w.norm()
    }

    /// Change of that torque with the rate and with one unknown.
    fn torque_change(&self, w: &Vector3, dw: &Vector3, unknown: Option<&UnknownKind>) -> Vector3 {
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

/// What drives the vehicle at one instant.
struct Drive<'s> {
    q: &'s [f64],
    rates: &'s [f64],
    wheels: &'s [f64],
    /// Thruster and declared force, N.
    thrust: &'s [(usize, f64)],
}

/// Scratch of one propagation.
pub(crate) struct Motion<'a> {
    vehicle: &'a Vehicle<'a>,
    observations: &'a Observations,
    /// Thrust in the interval after each grid time.
    thrust: Vec<Vec<(usize, f64)>>,
    kinematics: Kinematics,
    still: Kinematics,
    regressor: Vec<[f64; 6]>,
    wheel_columns: Vec<[f64; 6]>,
    /// Sensitivity columns: head first, then unknowns; empty where only the motion is wanted.
    pub columns: Vec<Column>,
    /// Index in `columns` of the first unknown.
    head: usize,
    buffer: Buffers,
}

#[derive(Default)]
struct Buffers {
    q: Vec<f64>,
    rates: Vec<f64>,
    wheels: Vec<f64>,
    stage: [Vec<Column>; 4],
    at: Vec<Column>,
    twist_columns: Vec<Vector6>,
}

/// Velocity at an instant with what is needed of it.
pub(crate) struct Instant {
    pub twist: Twist,
    pub inverse_inertia: Matrix6,
}

/// Derivative of the state.
#[derive(Clone, Copy)]
struct Slope {
    R: Quaternion<f64>,
    p: Vector3,
    P: Vector3,
    H: Vector3,
}

impl<'a> Motion<'a> {
    /// Scratch; `columns` are the sensitivities at the first grid time, `head` of them before the unknowns.
    pub fn new(
        vehicle: &'a Vehicle<'a>,
        segment: &'a Segment,
        columns: Vec<Column>,
        head: usize,
    ) -> Self {
        let tree = vehicle.tree;
        let o = &segment.observations;
        Self {
            kinematics: Kinematics::new(tree),
            still: Kinematics::new(tree),
            regressor: vec![[0.0; 6]; 10 * tree.bodies()],
            wheel_columns: vec![[0.0; 6]; tree.rotors.len()],
            thrust: thrust_by_interval(segment),
            observations: o,
            buffer: Buffers {
                q: vec![0.0; tree.dof()],
                rates: vec![0.0; tree.dof()],
                wheels: vec![0.0; tree.rotors.len()],
                stage: std::array::from_fn(|_| vec![Column::zeros(); columns.len()]),
                at: columns.clone(),
                twist_columns: vec![Vector6::zeros(); columns.len()],
            },
            columns,
            head,
            vehicle,
        }
    }

    /// Velocity at grid time k and, for each sensitivity column, its change `[dv; dw]`.
    ///
    /// `None` where the parameters have no positive mass or inertia there.
    pub fn velocity(&mut self, state: &State, k: usize) -> Option<(Instant, &[Vector6])> {
        let mut buffer = std::mem::take(&mut self.buffer);
        fill_inputs(self.observations, self.vehicle.tree, k, 0.0, &mut buffer);
        let drive = Drive {
            q: &buffer.q,
            rates: &buffer.rates,
            wheels: &buffer.wheels,
            thrust: &[],
        };
        let columns = std::mem::take(&mut self.columns);
        let instant = self.solve(state, &drive, &columns, &mut buffer.twist_columns);
        self.columns = columns;
        self.buffer = buffer;
        Some((instant?, &self.buffer.twist_columns))
    }

    /// Carries state and sensitivities from grid time k to k + 1: classical Runge-Kutta of fourth order in
    /// steps that turn no more than a tenth of a radian.
    pub fn advance(&mut self, state: &State, k: usize) -> Option<State> {
        let t = &self.observations.time_s;
        let h = t[k + 1] - t[k];
        let rate = self.fastest(state, k)?;
        let steps = (h * rate / 0.1).ceil().clamp(1.0, 1.0e4) as usize;
        let mut now = *state;
        for i in 0..steps {
            let from = i as f64 / steps as f64;
            let to = (i + 1) as f64 / steps as f64;
            now = self.step(&now, k, from, to, h)?;
        }
        Some(now)
    }

    fn fastest(&mut self, state: &State, k: usize) -> Option<f64> {
        let columns = std::mem::take(&mut self.columns);
        let w = self.velocity(state, k).map(|(i, _)| i.twist.w.norm());
        self.columns = columns;
        let rates = self
            .buffer
            .rates
            .iter()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
        w.map(|w| w + rates)
    }

    fn step(&mut self, state: &State, k: usize, from: f64, to: f64, h: f64) -> Option<State> {
        let dt = (to - from) * h;
        let mut buffer = std::mem::take(&mut self.buffer);
        let mut slopes: [Option<Slope>; 4] = [None; 4];
        let nodes = [
            (from, 0.0),
            (0.5 * (from + to), 0.5),
            (0.5 * (from + to), 0.5),
            (to, 1.0),
        ];
        let mut failed = false;
        for (i, (at, share)) in nodes.into_iter().enumerate() {
            fill_inputs(self.observations, self.vehicle.tree, k, at, &mut buffer);
            let mut stage_state = *state;
            buffer.at.clone_from(&self.columns);
            if let Some(before) = i.checked_sub(1).and_then(|b| slopes[b]) {
                stage_state = moved(state, &before, share * dt);
                for (a, s) in buffer.at.iter_mut().zip(&buffer.stage[i - 1]) {
                    *a += s * (share * dt);
                }
            }
            let thrust = std::mem::take(&mut self.thrust[k]);
            let slope = self.derivative(&stage_state, &thrust, &mut buffer, i);
            self.thrust[k] = thrust;
            if slope.is_none() {
                failed = true;
                break;
            }
            slopes[i] = slope;
        }
        if let ([Some(a), Some(b), Some(c), Some(d)], false) = (slopes, failed) {
            for (j, column) in self.columns.iter_mut().enumerate() {
                let s = &buffer.stage;
                *column += (s[0][j] + (s[1][j] + s[2][j]) * 2.0 + s[3][j]) * (dt / 6.0);
            }
            let sum = Slope {
                R: (a.R + (b.R + c.R) * 2.0 + d.R) / 6.0,
                p: (a.p + (b.p + c.p) * 2.0 + d.p) / 6.0,
                P: (a.P + (b.P + c.P) * 2.0 + d.P) / 6.0,
                H: (a.H + (b.H + c.H) * 2.0 + d.H) / 6.0,
            };
            self.buffer = buffer;
            return Some(moved(state, &sum, dt));
        }
        self.buffer = buffer;
        None
    }

    /// Slope of the state, and of every sensitivity column into `buffer.stage[stage]`.
    fn derivative(
        &mut self,
        state: &State,
        thrust: &[(usize, f64)],
        buffer: &mut Buffers,
        stage: usize,
    ) -> Option<Slope> {
        let columns = std::mem::take(&mut buffer.at);
        let mut twists = std::mem::take(&mut buffer.twist_columns);
        let drive = Drive {
            q: &buffer.q,
            rates: &buffer.rates,
            wheels: &buffer.wheels,
            thrust,
        };
        let instant = self.solve(state, &drive, &columns, &mut twists);
        let slope = instant.map(|instant| {
            let forces = self.forces(state, &drive);
            self.column_slopes(
                state,
                &instant,
                &forces,
                &columns,
                &twists,
                &mut buffer.stage[stage],
            );
            let Twist { v, w } = instant.twist;
            Slope {
                R: state.R_NB.quaternion() * Quaternion::from_imag(w) * 0.5,
                p: state.R_NB * v,
                P: forces.iter().map(|f| f.F_N).sum(),
                H: forces
                    .iter()
                    .map(|f| f.arm_N.cross(&f.F_N))
                    .sum::<Vector3>()
                    + state.R_NB * self.vehicle.torque(&w),
            }
        });
        buffer.at = columns;
        buffer.twist_columns = twists;
        slope
    }

    /// `V` and `dV = H^-1 (d(X [P; H]) - Y(V) dpi)` for every column.
    fn solve(
        &mut self,
        state: &State,
        drive: &Drive,
        columns: &[Column],
        twists: &mut [Vector6],
    ) -> Option<Instant> {
        let v = self.vehicle;
        let zero = Vector3::zeros();
        self.kinematics.place(v.tree, drive.q);
        self.kinematics
            .set_velocities(v.tree, &zero, &zero, drive.rates);
        let joints = momentum(&v.bodies, &self.kinematics);
        let wheels = wheel_momentum(v.tree, &self.kinematics, &v.spin, drive.wheels);
        let whole = composite(&v.bodies, &self.kinematics);
        if whole.mass.is_nan() || whole.mass <= 0.0 {
            return None;
        }
        let (l, h) = shift_to_body(&state.R_NB, &state.p_NoBo_N, &state.P, &state.H);
        let twist = twist_from_momentum(
            &whole,
            &l,
            &h,
            &joints.fixed_rows::<3>(0).into(),
            &(joints.fixed_rows::<3>(3) + wheels),
        )?;
        let inverse_inertia = whole.locked_inertia().cholesky()?.inverse();
        if !columns.is_empty() {
            self.kinematics
                .set_velocities(v.tree, &twist.v, &twist.w, drive.rates);
            momentum_regressor(&self.kinematics, &mut self.regressor);
            wheel_regressor(
                v.tree,
                &self.kinematics,
                drive.wheels,
                &mut self.wheel_columns,
            );
            self.twist_columns(state, &l, &h, &inverse_inertia, columns, twists);
        }
        Some(Instant {
            twist,
            inverse_inertia,
        })
    }

    fn twist_columns(
        &self,
        state: &State,
        l: &Vector3,
        h: &Vector3,
        inverse_inertia: &Matrix6,
        columns: &[Column],
        twists: &mut [Vector6],
    ) {
        let R = *state.R_NB.to_rotation_matrix().matrix();
        let Rt = R.transpose();
        // X as a map from the 12 changes of the state to [dl; dh].
        let mut X = SMatrix::<f64, 6, 12>::zeros();
        X.fixed_view_mut::<3, 3>(0, 0).copy_from(&skew(l));
        X.fixed_view_mut::<3, 3>(3, 0).copy_from(&skew(h));
        X.fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&(Rt * skew(&state.P)));
        X.fixed_view_mut::<3, 3>(0, 6).copy_from(&Rt);
        X.fixed_view_mut::<3, 3>(3, 6)
            .copy_from(&(-Rt * skew(&state.p_NoBo_N)));
        X.fixed_view_mut::<3, 3>(3, 9).copy_from(&Rt);
        let map = inverse_inertia * X;
        for (j, (column, twist)) in columns.iter().zip(twists.iter_mut()).enumerate() {
            *twist = map * column;
            if let Some(u) = j.checked_sub(self.head) {
                let own = match &self.vehicle.kinds[u] {
                    UnknownKind::SpinInertia(w) => Vector6::from(self.wheel_columns[*w]),
                    kind if kind.is_nuisance() => continue,
                    UnknownKind::ThrusterScale(_) => continue,
                    _ => {
                        let mut sum = Vector6::zeros();
                        for (at, slope) in &self.vehicle.slopes[u] {
                            sum += Vector6::from(self.regressor[*at]) * *slope;
                        }
                        sum
                    }
                };
                *twist -= inverse_inertia * own;
            }
        }
    }

    fn forces(&self, state: &State, drive: &Drive) -> Vec<Force> {
        drive
            .thrust
            .iter()
            .map(|&(at, declared)| {
                let thruster = &self.vehicle.thrusters[at];
                let R_BT = &self.kinematics.R[thruster.body];
                let unit_B = R_BT * thruster.direction_B * declared;
                let F_B = unit_B * self.vehicle.thrust_factor[at];
                let arm_B = self.kinematics.p[thruster.body] + R_BT * thruster.p_BoT_B;
                Force {
                    thruster: at,
                    F_B,
                    F_N: state.R_NB * F_B,
                    per_scale_N: state.R_NB * unit_B,
                    arm_B,
                    arm_N: state.p_NoBo_N + state.R_NB * arm_B,
                }
            })
            .collect()
    }

    fn column_slopes(
        &self,
        state: &State,
        instant: &Instant,
        forces: &[Force],
        columns: &[Column],
        twists: &[Vector6],
        out: &mut [Column],
    ) {
        let R = *state.R_NB.to_rotation_matrix().matrix();
        let (v, w) = (instant.twist.v, instant.twist.w);
        let (turn, slide) = (-skew(&w), -R * skew(&v));
        let torque = self.vehicle.torque(&w);
        for (j, ((column, twist), slope)) in columns.iter().zip(twists).zip(out).enumerate() {
            let dphi: Vector3 = column.fixed_rows::<3>(0).into();
            let dv: Vector3 = twist.fixed_rows::<3>(0).into();
            let dw: Vector3 = twist.fixed_rows::<3>(3).into();
            slope.fixed_rows_mut::<3>(0).copy_from(&(turn * dphi + dw));
            slope
                .fixed_rows_mut::<3>(3)
                .copy_from(&(slide * dphi + R * dv));
            let (mut dP, mut dH) = (Vector3::zeros(), Vector3::zeros());
            let unknown = j.checked_sub(self.head).map(|u| &self.vehicle.kinds[u]);
            let scaled = match unknown {
                Some(UnknownKind::ThrusterScale(at)) => Some(*at),
                _ => None,
            };
            let change = self.vehicle.torque_change(&w, &dw, unknown);
            dH += R * (dphi.cross(&torque) + change);
            for force in forces {
                let dp: Vector3 = column.fixed_rows::<3>(3).into();
                let mut dF = R * dphi.cross(&force.F_B);
                if scaled == Some(force.thruster) {
                    dF += force.per_scale_N;
                }
                let darm = dp + R * dphi.cross(&force.arm_B);
                dP += dF;
                dH += darm.cross(&force.F_N) + force.arm_N.cross(&dF);
            }
            slope.fixed_rows_mut::<3>(6).copy_from(&dP);
            slope.fixed_rows_mut::<3>(9).copy_from(&dH);
        }
    }

    /// Change of the base twist per unit of each joint rate and wheel speed at the instant given:
    /// `dV/dq' = -H^-1 dc/dq'`. Used to pass their noise on.
    pub fn input_gain(&mut self, instant: &Instant, joint: usize) -> Vector6 {
        let v = self.vehicle;
        let zero = Vector3::zeros();
        let mut unit = vec![0.0; v.tree.dof()];
        unit[joint] = 1.0;
        self.still.R.clone_from(&self.kinematics.R);
        self.still.p.clone_from(&self.kinematics.p);
        self.still.set_velocities(v.tree, &zero, &zero, &unit);
        -(instant.inverse_inertia * momentum(&v.bodies, &self.still))
    }

    /// The same for a wheel: `-H^-1 [0; Js a]`.
    pub fn wheel_gain(&self, instant: &Instant, wheel: usize) -> Vector6 {
        let rotor = &self.vehicle.tree.rotors[wheel];
        let h = self.kinematics.R[rotor.body] * rotor.axis_B * self.vehicle.spin[wheel];
        -(instant.inverse_inertia * Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z))
    }
}

/// One thruster at one instant.
struct Force {
    thruster: usize,
    F_B: Vector3,
    F_N: Vector3,
    per_scale_N: Vector3,
    arm_B: Vector3,
    arm_N: Vector3,
}

fn moved(state: &State, slope: &Slope, dt: f64) -> State {
    State {
        R_NB: UnitQuaternion::from_quaternion(state.R_NB.quaternion() + slope.R * dt),
        p_NoBo_N: state.p_NoBo_N + slope.p * dt,
        P: state.P + slope.P * dt,
        H: state.H + slope.H * dt,
    }
}

/// Inputs at a share of the interval after grid time k: joints on the cubic through positions and rates,
/// wheels on the straight line (a motor torque held over the interval).
fn fill_inputs(o: &Observations, tree: &Tree, k: usize, at: f64, buffer: &mut Buffers) {
    let (dof, wheels) = (tree.dof(), tree.rotors.len());
    if at == 0.0 {
        buffer
            .q
            .copy_from_slice(&o.joint_position[k * dof..(k + 1) * dof]);
        buffer
            .rates
            .copy_from_slice(&o.joint_rate[k * dof..(k + 1) * dof]);
        buffer
            .wheels
            .copy_from_slice(&o.wheel_speed[k * wheels..(k + 1) * wheels]);
        return;
    }
    let h = o.time_s[k + 1] - o.time_s[k];
    for j in 0..dof {
        let (a, b) = (k * dof + j, (k + 1) * dof + j);
        let (q0, q1) = (o.joint_position[a], o.joint_position[b]);
        let (d0, d1) = (o.joint_rate[a] * h, o.joint_rate[b] * h);
        let dq = q1 - q0;
        let c2 = 3.0 * dq - 2.0 * d0 - d1;
        let c3 = d0 + d1 - 2.0 * dq;
        buffer.q[j] = q0 + at * (d0 + at * (c2 + at * c3));
        buffer.rates[j] = (d0 + at * (2.0 * c2 + at * 3.0 * c3)) / h;
    }
    for j in 0..wheels {
        let (a, b) = (
            o.wheel_speed[k * wheels + j],
            o.wheel_speed[(k + 1) * wheels + j],
        );
        buffer.wheels[j] = a + at * (b - a);
    }
}

/// Thrusters that fire in the interval after each grid time (the grid holds all edges of firings).
fn thrust_by_interval(segment: &Segment) -> Vec<Vec<(usize, f64)>> {
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

/// `[a]x` of a small rotation between two attitudes, body axes of the first.
pub(crate) fn small_turn(from: &UnitQuaternion, to: &UnitQuaternion) -> Vector3 {
    (from.inverse() * to).scaled_axis()
}

/// Matrix of a unit quaternion.
pub(crate) fn matrix(R: &UnitQuaternion) -> Matrix3 {
    *R.to_rotation_matrix().matrix()
}
