//! The pose-momentum equation with its forward sensitivities, on measured joint and wheel motion.
//!
//! State: attitude R_NB, position p_NoBo, linear momentum P, and angular momentum h **about the system's mass
//! centre**, all momenta in N. Velocity follows from momentum, `V = H(q)^-1 (X [P; h] - c - c_w)` (DESIGN
//! section 2); about the mass centre the position does not enter, so its integration error cannot turn into
//! a false rate (`dp x P`), and what no data can show stays exactly unseen. A small change of the state is
//! `[dphi_B, dp_N, dP_N, dh_N]` with `R -> R exp([dphi]x)`.

mod acceleration;
mod input_slopes;
mod inputs;
mod surroundings;

pub(crate) use acceleration::Point;

use crate::parameters::{Gust, UnknownKind};
use crate::segment::{Observations, Segment};
use crate::vehicle::{Vehicle, thrust_by_interval};
use inputs::{InputChange, OutsideChange};
use nalgebra::{Quaternion, SVector};
use poinsot_dynamics::{
    Kinematics, Twist, composite, momentum, momentum_regressor, twist_from_momentum,
    wheel_momentum, wheel_regressor,
};
use poinsot_spatial::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6, skew};

/// A column of the state's sensitivity.
pub(crate) type Column = SVector<f64, 12>;

/// Pose and momentum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State {
    pub R_NB: UnitQuaternion,
    pub p_NoBo_N: Vector3,
    pub P: Vector3,
    pub h_SScm_N: Vector3,
}

/// What drives the vehicle at one instant.
struct Drive<'s> {
    q: &'s [f64],
    rates: &'s [f64],
    wheels: &'s [f64],
    /// Thruster and declared force, N.
    thrust: &'s [(usize, f64)],
    /// What faults of the readings do to the inputs.
    changes: &'s [InputChange],
}

/// Scratch of one propagation.
pub(crate) struct Motion<'a> {
    vehicle: &'a Vehicle<'a>,
    /// Integration steps that may still be made.
    steps_left: f64,
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
    /// Random torque in the interval after each grid time, N, N m; empty where there is none.
    gusts: Vec<Vector3>,
    /// Index of the segment, and grid time of the interval in hand.
    segment: usize,
    now: usize,
    /// Number of sensitivity columns, also while they are borrowed.
    columns_wanted: usize,
    /// Position of the reference orbit, in N, m; where a gravity gradient acts.
    orbit_N: Vector3,
    buffer: Buffers,
}

#[derive(Default)]
struct Buffers {
    q: Vec<f64>,
    rates: Vec<f64>,
    wheels: Vec<f64>,
    /// Second derivatives of joints and slopes of wheel speeds, where faults need them.
    accelerations: Vec<f64>,
    wheel_rates: Vec<f64>,
    changes: Vec<InputChange>,
    stage: [Vec<Column>; 4],
    at: Vec<Column>,
    twist_columns: Vec<Vector6>,
}

/// How much faster than measured a vehicle may turn, on the whole, for its motion to be followed.
const FASTER: f64 = 3.0;

/// Integration steps for a run: some for each interval, and those of a motion faster than the measured one.
fn steps_allowed(o: &Observations) -> f64 {
    let intervals = o.time_s.windows(2).zip(&o.rate);
    let turn: f64 = intervals
        .filter_map(|(t, w)| w.map(|w| w.norm() * (t[1] - t[0])))
        .sum();
    if o.rate.iter().all(Option::is_none) {
        return 1.0e4 * o.time_s.len() as f64;
    }
    // Between the samples of a slow gyro the turn is that of the gap.
    let seen = o.rate.iter().flatten().count().max(1) as f64;
    let share = o.time_s.len() as f64 / seen;
    1000.0 + 6.0 * o.time_s.len() as f64 + FASTER * share * turn / 0.02
}

/// Velocity at an instant with what is needed of it.
pub(crate) struct Instant {
    pub twist: Twist,
    pub inverse_inertia: Matrix6,
    centre: Centre,
}

/// The system's mass centre at an instant, with the momentum in B.
#[derive(Clone, Copy)]
struct Centre {
    c: Vector3,
    l: Vector3,
    h_cm: Vector3,
    mass: f64,
    /// Inertia about it, rotors as if locked.
    I_SScm_B: Matrix3,
}

/// Derivative of the state.
#[derive(Clone, Copy)]
struct Slope {
    R: Quaternion<f64>,
    p: Vector3,
    P: Vector3,
    h: Vector3,
}

impl<'a> Motion<'a> {
    /// Scratch; `columns` are the sensitivities at the first grid time, `head` of them before the unknowns.
    pub fn new(
        vehicle: &'a Vehicle<'a>,
        segment: &'a Segment,
        columns: Vec<Column>,
        head: usize,
        index: usize,
    ) -> Self {
        let tree = vehicle.tree;
        let o = &segment.observations;
        Self {
            kinematics: Kinematics::new(tree),
            still: Kinematics::new(tree),
            regressor: vec![[0.0; 6]; 10 * tree.bodies()],
            wheel_columns: vec![[0.0; 6]; tree.rotors.len()],
            thrust: thrust_by_interval(segment),
            steps_left: steps_allowed(o),
            observations: o,
            buffer: Buffers {
                q: vec![0.0; tree.dof()],
                rates: vec![0.0; tree.dof()],
                wheels: vec![0.0; tree.rotors.len()],
                accelerations: Vec::new(),
                wheel_rates: Vec::new(),
                changes: Vec::new(),
                stage: std::array::from_fn(|_| vec![Column::zeros(); columns.len()]),
                at: columns.clone(),
                twist_columns: vec![Vector6::zeros(); columns.len()],
            },
            head,
            gusts: gusts(vehicle, index, o.time_s.len()),
            segment: index,
            now: 0,
            columns_wanted: columns.len(),
            orbit_N: Vector3::zeros(),
            columns,
            vehicle,
        }
    }

    /// Velocity at grid time k and, for each sensitivity column, its change `[dv; dw]`.
    ///
    /// `None` where the parameters have no positive mass or inertia there.
    pub fn velocity(&mut self, state: &State, k: usize) -> Option<(Instant, &[Vector6])> {
        let mut buffer = std::mem::take(&mut self.buffer);
        self.inputs(k, 0.0, &mut buffer);
        let drive = Drive {
            q: &buffer.q,
            rates: &buffer.rates,
            wheels: &buffer.wheels,
            thrust: &[],
            changes: &buffer.changes,
        };
        let columns = std::mem::take(&mut self.columns);
        let instant = self.solve(state, &drive, &columns, &mut buffer.twist_columns);
        self.columns = columns;
        self.buffer = buffer;
        Some((instant?, &self.buffer.twist_columns))
    }

    /// Carries state and sensitivities from grid time k to k + 1: classical Runge-Kutta of fourth order in
    /// steps that turn no more than a fiftieth of a radian.
    pub fn advance(&mut self, state: &State, k: usize) -> Option<State> {
        let t = &self.observations.time_s;
        let h = t[k + 1] - t[k];
        let rate = self.fastest(state, k)?;
        let steps = (h * rate / 0.02).ceil().max(1.0);
        // Values of the unknowns that make it spin far faster than measured are not worth following.
        self.steps_left -= steps;
        if self.steps_left.is_nan() || self.steps_left < 0.0 {
            return None;
        }
        let steps = steps as usize;
        let mut now = self.late_thrust(state, k);
        for i in 0..steps {
            let from = i as f64 / steps as f64;
            let to = (i + 1) as f64 / steps as f64;
            now = self.step(&now, k, from, to, h)?;
        }
        Some(now)
    }

    /// Joint positions, joint rates and wheel speeds that the last evaluation of the velocity used.
    pub fn used(&self) -> (&[f64], &[f64], &[f64]) {
        let b = &self.buffer;
        (&b.q, &b.rates, &b.wheels)
    }

    fn blows(&self, gust: &Gust) -> bool {
        gust.segment == self.segment && gust.span.0 <= self.now && self.now <= gust.span.1
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
            self.inputs(k, at, &mut buffer);
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
                h: (a.h + (b.h + c.h) * 2.0 + d.h) / 6.0,
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
            changes: &buffer.changes,
        };
        let instant = self.solve(state, &drive, &columns, &mut twists);
        let slope = instant.map(|instant| {
            let forces = self.forces(&drive, &instant.centre);
            let outside = self.outside_changes(state, &drive, &instant.centre, &instant.twist.w);
            self.column_slopes(
                state,
                &instant,
                (&forces, &outside),
                &columns,
                &twists,
                &mut buffer.stage[stage],
            );
            let Twist { v, w } = instant.twist;
            Slope {
                R: state.R_NB.quaternion() * Quaternion::from_imag(w) * 0.5,
                p: state.R_NB * v,
                P: forces.iter().map(|f| state.R_NB * f.F_B).sum(),
                h: state.R_NB
                    * (forces
                        .iter()
                        .map(|f| f.arm_B.cross(&f.F_B))
                        .sum::<Vector3>()
                        + self.surroundings(state, &w, &instant.centre)),
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
        let inverse = state.R_NB.inverse();
        let (l, h_cm) = (inverse * state.P, inverse * state.h_SScm_N);
        let c = whole.p_BoScm_B();
        let h = h_cm + c.cross(&l);
        let twist = twist_from_momentum(
            &whole,
            &l,
            &h,
            &joints.fixed_rows::<3>(0).into(),
            &(joints.fixed_rows::<3>(3) + wheels),
        )?;
        let inverse_inertia = whole.inverse_locked_inertia()?;
        let centre = Centre {
            c,
            l,
            h_cm,
            mass: whole.mass,
            I_SScm_B: whole.I_SScm_B(),
        };
        let instant = Instant {
            twist,
            inverse_inertia,
            centre,
        };
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
            self.twist_columns(state, &instant, drive, columns, twists);
            self.input_columns(drive, &twist, &centre, &inverse_inertia, twists);
        }
        Some(instant)
    }

    fn twist_columns(
        &self,
        state: &State,
        instant: &Instant,
        drive: &Drive,
        columns: &[Column],
        twists: &mut [Vector6],
    ) {
        let map = self.state_map(state, instant);
        let (centre, inverse_inertia) = (&instant.centre, &instant.inverse_inertia);
        for (j, (column, twist)) in columns.iter().zip(twists.iter_mut()).enumerate() {
            *twist = map * column;
            if let Some(u) = j.checked_sub(self.head) {
                let own = match &self.vehicle.kinds[u] {
                    UnknownKind::SpinInertia(w) => Vector6::from(self.wheel_columns[*w]),
                    UnknownKind::WheelTilt(w, _) => {
                        let rotor = &self.vehicle.tree.rotors[*w];
                        let h = self.kinematics.R[rotor.body]
                            * self.vehicle.tilt_slopes[u]
                            * (self.vehicle.spin[*w] * drive.wheels[*w]);
                        Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z)
                    }
                    kind if kind.is_nuisance() => continue,
                    UnknownKind::ThrusterScale(_) => continue,
                    _ => {
                        let mut sum = Vector6::zeros();
                        for (at, slope) in &self.vehicle.slopes[u] {
                            sum += Vector6::from(self.regressor[*at]) * *slope;
                        }
                        let moved = self.mass_centre_change(u, centre).cross(&centre.l);
                        let angular = sum.fixed_rows::<3>(3) - moved;
                        sum.fixed_rows_mut::<3>(3).copy_from(&angular);
                        sum
                    }
                };
                *twist -= inverse_inertia * own;
            }
        }
    }

    /// Change of the system's mass centre in B with one unknown: `d(mc)/m - c dm/m`.
    fn mass_centre_change(&self, unknown: usize, centre: &Centre) -> Vector3 {
        let mut change = Vector3::zeros();
        for &(at, slope) in &self.vehicle.slopes[unknown] {
            let (body, k) = (at / 10, at % 10);
            let step = match k {
                0 => self.kinematics.p[body] - centre.c,
                1..=3 => self.kinematics.R[body].column(k - 1).into_owned(),
                _ => continue,
            };
            change += step * (slope / centre.mass);
        }
        change
    }

    /// Thrusters with their arms from the system's mass centre.
    fn forces(&self, drive: &Drive, centre: &Centre) -> Vec<Force> {
        drive
            .thrust
            .iter()
            .map(|&(at, declared)| {
                let thruster = &self.vehicle.thrusters[at];
                let R_BT = &self.kinematics.R[thruster.body];
                let unit_B = R_BT * thruster.direction_B * declared;
                let p_BoT_B = self.kinematics.p[thruster.body] + R_BT * thruster.p_BoT_B;
                Force {
                    thruster: at,
                    F_B: unit_B * self.vehicle.thrust_factor[at],
                    per_scale_B: unit_B,
                    arm_B: p_BoT_B - centre.c,
                }
            })
            .collect()
    }

    fn column_slopes(
        &self,
        state: &State,
        instant: &Instant,
        (forces, outside): (&[Force], &[OutsideChange]),
        columns: &[Column],
        twists: &[Vector6],
        out: &mut [Column],
    ) {
        let R = *state.R_NB.to_rotation_matrix().matrix();
        let (v, w) = (instant.twist.v, instant.twist.w);
        let (turn, slide) = (-skew(&w), -R * skew(&v));
        let torque = self.surroundings(state, &w, &instant.centre);
        for (j, ((column, twist), slope)) in columns.iter().zip(twists).zip(out).enumerate() {
            let dphi: Vector3 = column.fixed_rows::<3>(0).into();
            let dv: Vector3 = twist.fixed_rows::<3>(0).into();
            let dw: Vector3 = twist.fixed_rows::<3>(3).into();
            slope.fixed_rows_mut::<3>(0).copy_from(&(turn * dphi + dw));
            slope
                .fixed_rows_mut::<3>(3)
                .copy_from(&(slide * dphi + R * dv));
            let unknown = j.checked_sub(self.head);
            let kind = unknown.map(|u| &self.vehicle.kinds[u]);
            let change =
                self.surroundings_change(state, &instant.centre, (&w, &dw), &dphi, unknown);
            let mut dF = Vector3::zeros();
            let mut dT = dphi.cross(&torque) + change;
            for force in forces {
                dF += dphi.cross(&force.F_B);
                dT += dphi.cross(&force.arm_B.cross(&force.F_B));
                if let Some(u) = unknown {
                    dT -= self
                        .mass_centre_change(u, &instant.centre)
                        .cross(&force.F_B);
                }
                if kind == Some(&UnknownKind::ThrusterScale(force.thruster)) {
                    dF += force.per_scale_B;
                    dT += force.arm_B.cross(&force.per_scale_B);
                }
            }
            for change in outside.iter().filter(|c| Some(c.unknown) == unknown) {
                dF += change.F_B;
                dT += change.T_B;
            }
            let (mut dP, dH) = (R * dF, R * dT);
            if let Some(UnknownKind::InertialForce(k)) = kind {
                dP[*k] += 1.0;
            }
            slope.fixed_rows_mut::<3>(6).copy_from(&dP);
            slope.fixed_rows_mut::<3>(9).copy_from(&dH);
        }
    }

    /// Change of the base twist per unit of each joint rate and wheel speed at the instant given:
    /// `dV/dq' = -H^-1 dc/dq'`. Used to pass their noise on.
    pub fn input_gain(&mut self, instant: &Instant, joint: usize) -> Vector6 {
        self.rate_gain(&instant.inverse_inertia, joint)
    }

    fn rate_gain(&mut self, inverse_inertia: &Matrix6, joint: usize) -> Vector6 {
        let v = self.vehicle;
        let zero = Vector3::zeros();
        let mut unit = vec![0.0; v.tree.dof()];
        unit[joint] = 1.0;
        self.still.R.clone_from(&self.kinematics.R);
        self.still.p.clone_from(&self.kinematics.p);
        self.still.set_velocities(v.tree, &zero, &zero, &unit);
        -(inverse_inertia * momentum(&v.bodies, &self.still))
    }

    /// The same for a wheel: `-H^-1 [0; Js a]`.
    pub fn wheel_gain(&self, instant: &Instant, wheel: usize) -> Vector6 {
        self.speed_gain(&instant.inverse_inertia, wheel)
    }

    fn speed_gain(&self, inverse_inertia: &Matrix6, wheel: usize) -> Vector6 {
        let rotor = &self.vehicle.tree.rotors[wheel];
        let h = self.kinematics.R[rotor.body] * rotor.axis_B * self.vehicle.spin[wheel];
        -(inverse_inertia * Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z))
    }
}

/// One thruster at one instant, in B; the arm is from the system's mass centre.
struct Force {
    thruster: usize,
    F_B: Vector3,
    per_scale_B: Vector3,
    arm_B: Vector3,
}

fn moved(state: &State, slope: &Slope, dt: f64) -> State {
    State {
        R_NB: UnitQuaternion::from_quaternion(state.R_NB.quaternion() + slope.R * dt),
        p_NoBo_N: state.p_NoBo_N + slope.p * dt,
        P: state.P + slope.P * dt,
        h_SScm_N: state.h_SScm_N + slope.h * dt,
    }
}

/// `[a]x` of a small rotation between two attitudes, body axes of the first.
pub(crate) fn small_turn(from: &UnitQuaternion, to: &UnitQuaternion) -> Vector3 {
    (from.inverse() * to).scaled_axis()
}

/// Matrix of a unit quaternion.
pub(crate) fn matrix(R: &UnitQuaternion) -> Matrix3 {
    *R.to_rotation_matrix().matrix()
}

/// Random torque in the interval after each grid time of a segment; empty where there is none.
fn gusts(vehicle: &Vehicle, segment: usize, times: usize) -> Vec<Vector3> {
    let mut all = Vec::new();
    for (gust, value) in vehicle.gusts.iter().filter(|g| g.0.segment == segment) {
        all.resize(times, Vector3::zeros());
        for torque in all.iter_mut().take(gust.span.1 + 1).skip(gust.span.0) {
            torque[gust.axis] += value;
        }
    }
    all
}
