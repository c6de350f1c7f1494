//! Propagation of joint and wheel noise through the equation of motion.
//!
//! Joint and wheel samples are inputs of the prediction, so their errors enter it. With `e` the errors of the inputs at
//! a grid time, `x = [dphi_B, dp_N, dP_N, dh_N]` the error of the predicted state and `L e` the part of it that follows
//! a joint directly (a joint error rotates the base back), `s = x - L e` changes slowly:
//!
//! ```text
//! s' = A s + (A L + D - L') e,        dV = V_x x + V_u e
//! ```
//!
//! `A` and `D` are the slopes of the equation of motion over state and inputs, `V_x` and `V_u` those of the twist.
//! An error stays with its reading (`e_k+1 = a e_k + w`, see [`InputErrors`]). The pair `(s, e)` is the state of a
//! Kalman filter (Kalman 1960) whose readings are the residuals; what it leaves of them, the innovations, is white
//! (Kailath 1968), and so are the sensitivities that went through the same filter: maximum likelihood with errors
//! in the inputs at a cost linear in the samples.
//!
//! An accelerometer depends on how the speed of a wheel changes, so on its errors at neighbouring grid times: with one, the filter's
//! state has the errors of a window of grid times, including later ones. The acceleration of a joint has an error of its own. A
//! velocity increment depends on two instants: the errors at the earlier one are kept until the later one.
//!
//! What lasts over samples of the errors of a sensor is part of the state too: see [`SlowError`].
//!
//! Inputs along which a fit goes may be smoothed by all samples instead of measured: then their errors have the expected values
//! that [`Observations::expected_errors`] holds, and [`InputNoise::smoothed`] gives what the samples make of them.
//!
//! A random torque about the mass centre is part of the state and drives the momentum ([`random_torque`]).

mod filter;
mod points;
mod random_torque;
mod smoother;
mod sparse;

pub(crate) use points::{approximate, increments};

use crate::motion::{Column, Input, Instant, Matrix6x12, Motion, State, matrix, pose_change};
use crate::problem::Problem;
use crate::problem::error_process::ErrorProcess;
use crate::problem::segment::{InputChannel, InputErrors, Observations, Segment, SensorRecord};
use filter::Filter;
use nalgebra::{DMatrix, Matrix3 as Square, Vector3 as Errors};
use poinsot_dynamics::propagation::{FlexibleChange, INTERNAL, ModeRows, STATE};
use poinsot_dynamics::{JointSlopes, SlowError};
use poinsot_model::{RandomTorque, SensorKind};
use poinsot_spatial::{Matrix3, Vector3, Vector6};
use smoother::KnownError;
use sparse::SparseRows;

/// Pose of a column.
fn pose_of(x: &Column) -> Vector6 {
    x.fixed_rows::<6>(0).into()
}

/// Adds what the internal state of `x` does to the rates, and what its pose does to that of the internal state.
fn add_internal(modes: &ModeRows, x: &Column, out: &mut Column) {
    for (column, size) in x.iter().enumerate().filter(|(_, size)| **size != 0.0) {
        for (row, sum) in out.iter_mut().enumerate() {
            *sum += modes.slope(row, column) * size;
        }
    }
}

/// How the errors of inputs go on from grid time to grid time.
#[derive(Debug)]
enum Memory {
    /// By itself.
    Alone(InputErrors),
    /// Together with those that follow.
    Process(ErrorProcess),
    /// One of these.
    Follows,
}

impl Memory {
    /// What stays of an error by itself until the next grid time.
    fn alone(&self, k: usize) -> f64 {
        match self {
            Self::Alone(errors) => errors.memory(k),
            Self::Process(_) | Self::Follows => 0.0,
        }
    }

    fn process(&self) -> Option<&ErrorProcess> {
        match self {
            Self::Process(process) => Some(process),
            _ => None,
        }
    }
}

/// An error of an input.
struct NoisyInput {
    /// In a process a joint's rate and its acceleration follow its position, and the slope of a wheel's speed follows the speed.
    of: Input,
    /// Variance of the error; a process has its own.
    variance: f64,
    memory: Memory,
    /// Share of the error in its input at every grid time; one where the list is empty.
    shares: Vec<f64>,
}

impl NoisyInput {
    /// Share at grid time k.
    fn share(&self, k: usize) -> f64 {
        self.shares.get(k).copied().unwrap_or(1.0)
    }
}

/// The equation of motion around the prediction at one grid time.
#[derive(Default)]
struct DynamicsJacobian {
    /// Upper half of `A`: the pose's.
    pose: Matrix6x12,
    /// The rows of modes and passive joints, where there are any.
    modes: Option<Box<ModeRows>>,
    /// `L` per input: it reaches pose and internal state.
    at_once: Vec<Column>,
    /// Upper half of `A L + D` per input, and its internal part.
    drive: Vec<Column>,
    /// Lower halves of `A` and `D` in the interval that begins here; of `D` nothing where no external force or torque acts.
    push: (Matrix6x12, Vec<Vector6>),
}

/// What one step computes and the next one overwrites.
#[derive(Default)]
struct StepScratch {
    jacobian: Option<Box<DynamicsJacobian>>,
    upper: Vec<f64>,
    fresh: Vec<f64>,
    torque: Vec<f64>,
    rows: SparseRows,
}

/// The filter along one segment.
#[derive(Default)]
pub(crate) struct InputNoise {
    random_torque: Option<RandomTorque>,
    step: Option<random_torque::Step>,
    inputs: Vec<NoisyInput>,
    /// As in [`Observations::expected_errors`].
    expected: Vec<f64>,
    /// Components of `s` that inputs can reach.
    active: Vec<usize>,
    /// Number of these and of the components of the random torque, which follow them.
    lead: usize,
    /// What lasts of the errors of each sensor, with the first of its places; they are the last of all.
    slow: Vec<(Vec<SlowError>, usize)>,
    /// Grid times on each side of the one in hand whose errors are held.
    reach: usize,
    slopes: JointSlopes,
    /// Boxed: it is large and moves at every step.
    before: Option<Box<DynamicsJacobian>>,
    scratch: StepScratch,
    /// The errors as columns of state and twist, for the rows of the sensors: components of `s`, then inputs.
    pub columns: Vec<Column>,
    pub twists: Vec<Vector6>,
    /// Change of the twist with each joint rate.
    rate_gain: Vec<Vector6>,
    filter: Filter,
}

/// The errors of an input: two of readings where it is interpolated, value and slope where it is a process, none where it has no
/// noise.
fn errors_of(input: Input, variance: f64, channel: &InputChannel) -> Vec<NoisyInput> {
    let error = |of: Input, memory: Memory, shares: Vec<f64>| NoisyInput {
        of,
        variance,
        memory,
        shares,
    };
    match &channel.errors {
        InputErrors::Process(process) => {
            let slopes = match input {
                Input::Position(joint) => vec![Input::Rate(joint), Input::Acceleration(joint)],
                Input::Wheel(w) if !channel.acceleration.is_empty() => vec![Input::WheelRate(w)],
                _ => vec![Input::Step; 2],
            };
            let slopes = slopes.into_iter().take(process.width() - 1);
            let slopes = slopes.map(|slope| error(slope, Memory::Follows, Vec::new()));
            let value = error(input, Memory::Process(process.clone()), Vec::new());
            std::iter::once(value).chain(slopes).collect()
        }
        InputErrors::Interpolated(places) if variance > 0.0 => Vec::from([0, 1].map(|slot| {
            let held: Vec<(usize, f64)> = places.iter().map(|p| p.slot(slot)).collect();
            let stays = |w: &[(usize, f64)]| f64::from(u8::from(w[0].0 == w[1].0));
            let mut memory: Vec<f64> = held.windows(2).map(stays).collect();
            memory.push(0.0);
            let shares = held.into_iter().map(|h| h.1).collect();
            error(input, Memory::Alone(InputErrors::Kept(memory)), shares)
        })),
        errors if variance > 0.0 && *errors != InputErrors::None => {
            vec![error(input, Memory::Alone(errors.clone()), Vec::new())]
        }
        _ => Vec::new(),
    }
}

impl InputNoise {
    /// The filter before the first grid time.
    ///
    /// `forced`: whether external forces or torques act; `followed`: number of sequences that go through it, sensitivities and
    /// residual; `records`: whether a backward pass follows.
    pub fn new(
        problem: &Problem,
        segment: &Segment,
        forced: bool,
        followed: usize,
        records: bool,
    ) -> Self {
        let (o, noise) = (&segment.observations, problem.noise);
        let random_torque = problem.model.environment.random_torque;
        let increments = increments(&o.sensors);
        let translation = o.reads_translation() || increments > 0;
        let joints = noise.joint_position.iter().enumerate();
        let wheels = noise.wheel_speed.iter().enumerate();
        let joints = joints.flat_map(|(k, v)| errors_of(Input::Position(k), *v, o.joint(k)));
        let wheels = wheels.flat_map(|(k, v)| errors_of(Input::Wheel(k), *v, o.wheel(k)));
        let inputs: Vec<NoisyInput> = joints.chain(wheels).collect();
        let torque = random_torque.is_some();
        let lasting: usize = o.sensors.iter().map(|r| r.slow.len()).sum();
        let still = inputs.is_empty() && !torque;
        let silent = still && lasting == 0;
        let mut active: Vec<usize> = match (still, translation, forced || torque) {
            (true, _, _) => Vec::new(),
            (_, false, false) => (0..3).collect(),
            (_, false, true) => (0..3).chain(9..12).collect(),
            (_, true, false) => (0..6).collect(),
            (_, true, true) => (0..12).collect(),
        };
        if !active.is_empty() {
            active.extend(STATE..STATE + 2 * problem.internal_states());
        }
        // The slope of a wheel's speed is that of speeds about it, where it has none of its own.
        let turns = inputs.iter().any(|input| match input.of {
            Input::Wheel(w) => o.wheel(w).acceleration.is_empty(),
            _ => false,
        });
        let reach = usize::from(turns && o.reads(SensorKind::Accelerometer));
        let lead = active.len() + 3 * usize::from(torque);
        let kept = if silent { 0 } else { 3 * increments };
        let mut place = lead + (2 * reach + 1) * inputs.len() + kept;
        let of_sensor = |record: &SensorRecord| {
            let first = place;
            place += 3 * record.slow.len();
            (record.slow.clone(), first)
        };
        let slow: Vec<_> = o.sensors.iter().map(of_sensor).collect();
        let size = if silent { 0 } else { place };
        let mut columns: Vec<Column> = active.iter().map(|at| Column::ith(*at, 1.0)).collect();
        columns.resize(size, Column::zeros());
        Self {
            random_torque,
            lead,
            slow,
            reach,
            expected: o.expected_errors.clone(),
            filter: Filter::new(size, followed, records),
            columns,
            twists: vec![Vector6::zeros(); size],
            rate_gain: vec![Vector6::zeros(); noise.joint_rate.len()],
            inputs,
            active,
            ..Self::default()
        }
    }

    /// Expected value of what is new in an error after grid time k.
    fn newly_expected(&self, input: usize, k: usize) -> f64 {
        let stays = self.inputs[input].memory.alone(k) * self.expected_error(input, k);
        self.expected_error(input, k + 1) - stays
    }

    /// Expected value of an error at grid time k.
    fn expected_error(&self, input: usize, k: usize) -> f64 {
        let row = self.expected.chunks_exact(self.inputs.len().max(1)).nth(k);
        row.map_or(0.0, |row| row[input])
    }

    /// After the samples of a grid time.
    pub fn end_grid_time(&mut self) {
        if let Some(mut trace) = self.filter.trace.take() {
            let known = |c| {
                let at = self.place(c, 0);
                KnownError {
                    mean: self.filter.mean(at),
                    covariance: self.filter.covariance_row(at).to_vec(),
                }
            };
            let errors = (0..self.inputs.len()).map(known).collect();
            trace.known(self.filter.size, errors);
            self.filter.trace = Some(trace);
        }
    }

    /// The errors as all samples, earlier and later ones, have them: one row per grid time.
    pub fn smoothed(&self) -> Option<Vec<f64>> {
        let trace = self.filter.trace.as_ref()?;
        Some(trace.smoothed(self.filter.size))
    }

    /// Adds errors to the inputs of a record, which then expects as much less of them. Those of a process stay: it is integrated
    /// out, and its mean is that of its samples alone.
    pub fn correct(&self, errors: &[f64], o: &mut Observations) {
        let (width, times) = (self.inputs.len(), o.time_s.len());
        if width == 0 || errors.len() != width * times {
            return;
        }
        o.expected_errors.resize(errors.len(), 0.0);
        let (dof, wheels) = (o.joint_position.len() / times, o.wheel_speed.len() / times);
        for (c, input) in self.inputs.iter().enumerate() {
            if !matches!(input.memory, Memory::Alone(_)) {
                continue;
            }
            for k in 0..times {
                let error = errors[k * width + c];
                o.expected_errors[k * width + c] -= error;
                match input.of {
                    Input::Position(j) => o.joint_position[k * dof + j] += error,
                    Input::Wheel(w) => o.wheel_speed[k * wheels + w] += error * input.share(k),
                    _ => {}
                }
            }
        }
    }

    /// Whether it is idle: no input noise and no random torque.
    pub fn is_silent(&self) -> bool {
        self.filter.size == 0
    }

    /// Place of the random torque in the filter's state.
    fn torque_at(&self) -> Option<usize> {
        self.random_torque.map(|_| self.active.len())
    }

    /// Place in the filter's state of an input's error, so many grid times after the one in hand.
    fn place(&self, input: usize, after: isize) -> usize {
        let block = self.reach.saturating_add_signed(after);
        self.lead + block * self.inputs.len() + input
    }

    /// Carries the filter to grid time k, where the motion has just given its velocity.
    pub fn propagate_to(
        &mut self,
        motion: &mut Motion,
        state: &State,
        instant: &Instant,
        k: usize,
    ) {
        let joint_slopes = &mut self.slopes;
        motion.joint_slopes(instant, joint_slopes);
        for (gain, slope) in self.rate_gain.iter_mut().zip(&joint_slopes.of) {
            *gain = instant.twist_slope(&slope.rate, &Vector3::zeros());
        }
        if self.is_silent() {
            return;
        }
        let mut now = self.scratch.jacobian.take().unwrap_or_default();
        let map;
        (map, now.pose, now.modes) = motion.slopes(state, instant);
        self.slopes_at(motion, (state, k), instant, &map, &mut now);
        match self.before.take() {
            None => {
                self.begin(&now);
                self.begin_processes(&now);
                self.renew_slow(SlowError::first);
            }
            Some(before) => {
                self.carry(&before, &now, motion.step_s(k), k);
                self.scratch.jacobian = Some(before);
            }
        }
        let turned = |x: &Column| {
            now.modes
                .as_ref()
                .map_or_else(Vector6::zeros, |m| m.twist_times(x))
        };
        for (c, &at) in self.active.iter().enumerate() {
            self.twists[c] = match at < STATE {
                true => map.column(at).into(),
                false => turned(&self.columns[c]),
            };
        }
        for (c, at_once) in now.at_once.iter().enumerate() {
            if !matches!(self.inputs[c].of, Input::Position(_)) {
                continue;
            }
            let at = self.place(c, 0);
            self.columns[at] = *at_once;
            self.twists[at] += map.fixed_view::<6, 6>(0, 0) * pose_of(at_once) + turned(at_once);
        }
        self.before = Some(now);
    }

    /// Slopes at a grid time; the change of the twist with the inputs goes to the end of `twists`.
    fn slopes_at(
        &mut self,
        motion: &Motion,
        (state, k): (&State, usize),
        instant: &Instant,
        map: &Matrix6x12,
        out: &mut DynamicsJacobian,
    ) {
        let R = matrix(&state.R_NB);
        self.twists.fill(Vector6::zeros());
        out.at_once.clear();
        out.drive.clear();
        out.push.1.clear();
        for (c, input) in self.inputs.iter().enumerate() {
            let at = (state, instant);
            let (position, rate) = match input.of {
                Input::Position(j) => {
                    let slope = &self.slopes.of[j];
                    let dc = slope.first_moment / instant.centre.mass;
                    let change = instant.twist_slope(&slope.position, &dc);
                    let rate = &self.rate_gain[j];
                    (
                        motion.followed(at, &change, Some((j, [1.0, 0.0]))),
                        motion.followed(at, rate, Some((j, [0.0, 1.0]))),
                    )
                }
                Input::Wheel(w) => {
                    let gain = motion.wheel_gain(instant, w) * input.share(k);
                    let none = FlexibleChange::of_twist(Vector6::zeros());
                    (motion.followed(at, &gain, None), none)
                }
                Input::WheelRate(_) => {
                    out.at_once.push(Column::zeros());
                    out.drive.extend_from_within(c - 1..c);
                    continue;
                }
                Input::Step | Input::Acceleration(_) | Input::Rate(_) => {
                    // Positions alone drive: an interval's mean rate is that of its ends.
                    out.at_once.push(Column::zeros());
                    out.drive.push(Column::zeros());
                    if let Input::Rate(j) = input.of {
                        let at = self.place(c, 0);
                        self.twists[at] = self.rate_gain[j];
                    }
                    continue;
                }
            };
            let at = self.place(c, 0);
            self.twists[at] = position.twist;
            let column = |change: &FlexibleChange| {
                let mut out = Column::zeros();
                let pose = pose_change(&R, &change.twist);
                out.fixed_rows_mut::<6>(0).copy_from(&pose);
                let internal = motion.mode_rates(instant, change);
                out.fixed_rows_mut::<INTERNAL>(STATE).copy_from(&internal);
                out
            };
            let (once, mut slow) = (column(&rate), column(&position));
            if rate.twist != Vector6::zeros() {
                // Only attitude, place and internal state follow at once.
                let turned = out.pose.fixed_view::<6, 6>(0, 0) * pose_of(&once);
                slow.fixed_rows_mut::<6>(0)
                    .zip_apply(&turned, |a, b| *a += b);
                if let Some(modes) = &out.modes {
                    add_internal(modes, &once, &mut slow);
                }
            }
            out.at_once.push(once);
            out.drive.push(slow);
        }
        if self.active.len() > 6 || self.active.contains(&9) {
            self.push_slopes(motion, (state, k), instant, map, &mut out.push);
        }
    }

    /// Effect of thrust and external torque: they rotate with the base, and their arms with the joints.
    fn push_slopes(
        &self,
        motion: &Motion,
        (state, k): (&State, usize),
        instant: &Instant,
        map: &Matrix6x12,
        (slopes, drives): &mut (Matrix6x12, Vec<Vector6>),
    ) {
        let R = matrix(&state.R_NB);
        drives.extend(self.inputs.iter().enumerate().map(|(c, input)| {
            let (mut dF, mut dT) = (Vector3::zeros(), Vector3::zeros());
            if let Input::Position(j) = input.of {
                let first_moment = &self.slopes.of[j].first_moment;
                (dF, dT) = motion.wrench_change(state, instant, k, j, first_moment);
            }
            if matches!(input.of, Input::Position(_) | Input::Wheel(_)) {
                let dw = self.twists[self.place(c, 0)].fixed_rows::<3>(3).into();
                dT += motion.drag_change(state, instant, &dw);
            }
            let (dP, dh) = (R * dF, R * dT);
            Vector6::new(dP.x, dP.y, dP.z, dh.x, dh.y, dh.z)
        }));
        *slopes = motion.wrench_slopes(state, instant, map, k);
    }

    /// At the first grid time the state itself is unknown: `x = 0`, so `s = -L e`.
    fn begin(&mut self, now: &DynamicsJacobian) {
        if let (Some(at), Some(torque)) = (self.torque_at(), &self.random_torque) {
            let variance = torque.sigma_N_m * torque.sigma_N_m;
            (0..3).for_each(|axis| self.filter.add((at + axis, at + axis), variance));
        }
        for (c, input) in self.inputs.iter().enumerate() {
            let Memory::Alone(errors) = &input.memory else {
                continue;
            };
            let mut vector = vec![0.0; self.filter.size];
            for (x, &row) in vector.iter_mut().zip(&self.active) {
                *x = -now.at_once[c][row];
            }
            let mut fresh = input.variance;
            // Each later error is the correlated part of the previous one plus an innovation.
            for first in 0..=self.reach {
                let mut share = 1.0;
                for after in first..=self.reach {
                    vector[self.place(c, after as isize)] = share;
                    share *= errors.memory(after);
                }
                self.filter.add_outer(&vector, fresh);
                vector.fill(0.0);
                fresh = input.variance * (1.0 - errors.memory(first).powi(2));
            }
            for (i, &row) in self.active.iter().enumerate() {
                let at_once = now.at_once[c][row];
                (self.filter).add_mean(i, -at_once * self.expected_error(c, 0));
            }
            for after in 0..=self.reach {
                let at = self.place(c, after as isize);
                self.filter.add_mean(at, self.expected_error(c, after));
            }
        }
    }

    /// The same of errors that go on together.
    fn begin_processes(&mut self, now: &DynamicsJacobian) {
        let pairs = self.inputs.iter().enumerate();
        for (c, process) in pairs.filter_map(|(c, input)| Some((c, input.memory.process()?))) {
            let mut fresh = process.initial_root();
            for first in 0..=self.reach {
                for mut error in fresh.into_iter().filter(|e| *e != Errors::zeros()) {
                    let mut vector = vec![0.0; self.filter.size];
                    if first == 0 {
                        let reached = vector.iter_mut().zip(&self.active);
                        reached.for_each(|(x, &row)| *x = -now.at_once[c][row] * error.x);
                    }
                    for after in first..=self.reach {
                        let at = self.place(c, after as isize);
                        let here = vector[at..].iter_mut().zip(&error);
                        here.take(process.width()).for_each(|(v, e)| *v = *e);
                        let step = process.step(after);
                        error = step.map_or_else(Errors::zeros, |s| s.memory * error);
                    }
                    self.filter.add_outer(&vector, 1.0);
                }
                let step = process.step(first);
                fresh = step.map_or([Errors::zeros(); 3], |step| step.root());
            }
        }
    }

    /// Rows by which the errors of the inputs go on from grid time k, from `at` grid times after the one in hand.
    fn memory_rows(&self, rows: &mut SparseRows, k: usize, at: isize) {
        for (c, input) in self.inputs.iter().enumerate() {
            let here = self.place(c, at);
            match &input.memory {
                Memory::Alone(errors) => rows.push([(here, errors.memory(k))]),
                Memory::Follows => {}
                Memory::Process(process) => {
                    let step = process.step(k);
                    let m = step.map_or_else(Square::zeros, |s| s.memory);
                    let n = process.width();
                    (0..n).for_each(|i| rows.push((0..n).map(|j| (here + j, m[(i, j)]))));
                }
            }
        }
    }

    /// From one grid time to the next, k: `s = Phi s + (h/2) (B e + B_next e_next)`, and of slopes `(h^2/12) (B e - B_next e_next)`.
    fn carry(&mut self, before: &DynamicsJacobian, now: &DynamicsJacobian, h: f64, k: usize) {
        let (n, ahead) = (self.lead, self.reach > 0);
        let stride = self.filter.stride();
        let pose = (before.pose + now.pose) * 0.5;
        let (lower, pushed_by) = &before.push;
        let ends = before.modes.as_deref().zip(now.modes.as_deref());
        let A = |row: usize, column: usize| match (row, ends) {
            (6..STATE, Some((begin, _))) if column >= STATE => begin.slope(row, column),
            (_, Some((begin, end))) if row.max(column) >= STATE => {
                0.5 * (begin.slope(row, column) + end.slope(row, column))
            }
            (6.., _) => lower[(row - 6, column)],
            _ => pose[(row, column)],
        };
        let mut upper = std::mem::take(&mut self.scratch.upper);
        let mut fresh = std::mem::take(&mut self.scratch.fresh);
        let mut torque = std::mem::take(&mut self.scratch.torque);
        // Rows of the active components; the errors of the inputs only fade.
        upper.clear();
        upper.resize(n * stride, 0.0);
        fresh.clear();
        match ends {
            None => self.state_rows(&A, h, &mut upper),
            Some(_) => self.swinging_rows(&A, h, &mut upper),
        }
        self.torque_rows(&A, h, &mut upper, &mut torque);
        for (c, input) in self.inputs.iter().enumerate() {
            let slope = matches!(input.of, Input::WheelRate(_));
            if matches!(input.memory, Memory::Follows) && !slope {
                let reached = if ahead { 0 } else { self.active.len() };
                fresh.resize(fresh.len() + reached, 0.0);
                continue;
            }
            // A slope goes on with the speed before it.
            let (first, own, weights) = match slope {
                true => (c - 1, 1, [h * h / 12.0, -h * h / 12.0]),
                false => (c, 0, [0.5 * h; 2]),
            };
            let turn = |row: usize| (now.at_once[c][row] - before.at_once[c][row]) * 0.5;
            let ends = [(before, weights[0]), (now, weights[1])].map(|(s, weight)| {
                let slow = move |row: usize| s.drive[c][row] * weight - turn(row);
                let pushed = pushed_by.get(c).map_or_else(Vector6::zeros, |drive| {
                    (lower.fixed_view::<6, 6>(0, 0) * pose_of(&s.at_once[c]) + drive) * (0.5 * h)
                });
                move |row: usize| match row {
                    6..STATE => pushed[row - 6] + slow(row),
                    _ => slow(row),
                }
            });
            let here = self.place(c, 0);
            let from = self.place(first, 0);
            let process = self.inputs[first].memory.process();
            let process = process.and_then(|p| p.step(k - 1));
            let alone = [input.memory.alone(k - 1), 0.0, 0.0];
            let kept = process.map_or(alone, |s| [0, 1, 2].map(|j| s.memory[(own, j)]));
            for (i, &row) in self.active.iter().enumerate() {
                upper[i * stride + here] += ends[0](row);
                if ahead {
                    upper[i * stride + self.place(c, 1)] = ends[1](row);
                    continue;
                }
                for (j, kept) in kept.iter().enumerate().filter(|(_, kept)| **kept != 0.0) {
                    upper[i * stride + from + j] += kept * ends[1](row);
                }
                fresh.push(ends[1](row));
            }
        }
        self.advance(&upper, h, k - 1 + self.reach);
        self.renew_slow(|slow| slow.fresh(h));
        self.innovate(&fresh, h, k - 1 + self.reach);
        let vectors = torque.chunks_exact(self.filter.size.max(1));
        vectors.for_each(|v| self.filter.add_outer(v, 1.0));
        self.scratch.upper = upper;
        self.scratch.fresh = fresh;
        self.scratch.torque = torque;
    }

    /// What stays of the active components after an interval.
    fn state_rows(&self, A: &impl Fn(usize, usize) -> f64, h: f64, upper: &mut [f64]) {
        let stride = self.filter.stride();
        for (i, &row) in self.active.iter().enumerate() {
            for (j, &column) in self.active.iter().enumerate() {
                // Exponential to second order: h is a fraction of a turn.
                let own = if i == j { 1.0 } else { 0.0 };
                let through = self.active.iter().map(|&k| A(row, k) * A(k, column));
                upper[i * stride + j] =
                    own + h * A(row, column) + 0.5 * h * h * through.sum::<f64>();
            }
        }
    }

    /// The same of a vehicle that oscillates within an interval.
    fn swinging_rows(&self, A: &impl Fn(usize, usize) -> f64, h: f64, upper: &mut [f64]) {
        let (n, stride) = (self.active.len(), self.filter.stride());
        let A = DMatrix::from_fn(n, n, |i, j| h * A(self.active[i], self.active[j]));
        let stays = A.exp();
        for (row, out) in stays.row_iter().zip(upper.chunks_exact_mut(stride)) {
            out.iter_mut().zip(&row).for_each(|(out, x)| *out = *x);
        }
    }

    /// Moves the window of errors one grid time on: `upper` holds the rows of `s`, the last errors in hand are those of grid time
    /// `last`, and what is kept stays.
    fn advance(&mut self, upper: &[f64], h: f64, last: usize) {
        let mut rows = std::mem::take(&mut self.scratch.rows);
        rows.clear();
        let dense = upper.chunks_exact(self.filter.stride());
        dense.for_each(|row| rows.push_dense(row));
        let inputs = self.inputs.len();
        for i in rows.len()..self.lead + 2 * self.reach * inputs {
            rows.push([(i + inputs, 1.0)]);
        }
        self.memory_rows(&mut rows, last, self.reach as isize);
        let lasting = self.slow.iter().flat_map(|(slow, _)| slow);
        let first = self.filter.size - 3 * lasting.clone().count();
        for i in rows.len()..first {
            rows.push([(i, 1.0)]);
        }
        for (slow, i) in lasting.zip((first..).step_by(3)) {
            let stays = slow.stays(h);
            (i..i + 3).for_each(|i| rows.push([(i, stays)]));
        }
        self.filter.map(&rows);
        self.scratch.rows = rows;
    }

    /// Adds a covariance of each slow error of the sensors.
    fn renew_slow(&mut self, covariance: impl Fn(&SlowError) -> Matrix3) {
        for (all, first) in &self.slow {
            for (slow, at) in all.iter().zip((*first..).step_by(3)) {
                let new = covariance(slow);
                for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                    self.filter.add((at + i, at + j), new[(i, j)]);
                }
            }
        }
    }

    /// Places of the slow errors of a sensor in the filter's state, three to each.
    pub fn slow_errors(&self, sensor: usize) -> std::ops::Range<usize> {
        match self.slow.get(sensor) {
            Some((slow, first)) => *first..first + 3 * slow.len(),
            None => 0..0,
        }
    }

    /// Adds what is new in every error after grid time k, with what it does to the state at once: nothing where it is of a later
    /// time.
    fn innovate(&mut self, fresh: &[f64], h: f64, k: usize) {
        let reached = self.active.len();
        for (c, input) in self.inputs.iter().enumerate() {
            let own = self.place(c, self.reach as isize);
            let next = self.inputs.get(c + 1);
            let slope = next.is_some_and(|next| matches!(next.of, Input::WheelRate(_)));
            let of = |count: usize| fresh.get(c * reached..(c + count) * reached);
            let at_once = of(1 + usize::from(slope)).unwrap_or(&[]);
            let (width, new, within) = match &input.memory {
                Memory::Follows => continue,
                Memory::Process(process) => {
                    let step = process.step(k);
                    let (new, within) = step.map_or_else(Default::default, |s| (s.fresh, s.within));
                    // What is new moves the state by half an interval.
                    (process.width(), new, within * 4.0 / (h * h))
                }
                Memory::Alone(errors) => {
                    let new = input.variance * (1.0 - errors.memory(k).powi(2));
                    let expected = self.newly_expected(c, k);
                    if expected != 0.0 {
                        let reaches = at_once.iter().enumerate();
                        reaches.for_each(|(i, once)| self.filter.add_mean(i, once * expected));
                        self.filter.add_mean(own, expected);
                    }
                    (1, Square::from_diagonal_element(new), 0.0)
                }
            };
            if new != Square::zeros() {
                let at_once = (at_once, reached, within);
                self.filter.add_errors(at_once, (own, width), &new);
            }
        }
    }

    /// Fills the columns of the random torque, and lists its innovations, one vector behind the other.
    fn torque_rows(
        &mut self,
        A: &impl Fn(usize, usize) -> f64,
        h: f64,
        upper: &mut [f64],
        fresh: &mut Vec<f64>,
    ) {
        fresh.clear();
        let (Some(at), Some(torque)) = (self.torque_at(), &self.random_torque) else {
            return;
        };
        let (size, stride) = (self.filter.size, self.filter.stride());
        let step = self.step.filter(|s| s.lasts(h));
        let step = step.unwrap_or_else(|| random_torque::Step::new(torque, h));
        self.step = Some(step);
        for axis in 0..3 {
            // Torque, momentum and its integral in the state: the integral turns the base.
            let on = |row: usize, x: &Vector3| {
                let own = if row == 9 + axis { x[1] } else { 0.0 };
                own + A(row, 9 + axis) * x[2]
            };
            for (i, &row) in self.active.iter().enumerate() {
                upper[i * stride + at + axis] = on(row, &step.kept);
            }
            upper[(at + axis) * stride + at + axis] = step.kept[0];
            for c in 0..3 {
                let (begin, x) = (fresh.len(), step.fresh.column(c).into());
                fresh.resize(begin + size, 0.0);
                let vector = &mut fresh[begin..];
                for (to, &row) in vector.iter_mut().zip(&self.active) {
                    *to = on(row, &x);
                }
                vector[at + axis] = x[0];
            }
        }
    }

    /// Covariance `M P M^T` that the current errors add to a sample with these slopes. [`InputNoise::take`] uses what it finds.
    pub fn correlate(&mut self, slopes: &[Vector3]) -> Matrix3 {
        self.filter.correlate(slopes)
    }

    /// The part of that which the slow errors of sensors add.
    pub fn of_sensors(&self, slopes: &[Vector3]) -> Matrix3 {
        let lasting = self.slow.iter().map(|(slow, _)| 3 * slow.len());
        let first = self.filter.size - lasting.sum::<usize>();
        self.filter.correlated(slopes, first)
    }

    /// A residual minus its prediction from earlier samples.
    pub fn expected(&self, slopes: &[Vector3], residual: Vector3) -> Vector3 {
        self.filter.innovation(slopes, residual)
    }

    /// Takes the readings of one sensor: see [`Filter::take`].
    pub fn take(&mut self, slopes: &[Vector3], inverse_root: &Matrix3, rows: &mut [Vector3]) {
        self.filter.take(slopes, inverse_root, rows);
    }
}
