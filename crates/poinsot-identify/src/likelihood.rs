//! Predicted against measured: whitened residuals of one segment and their sensitivities.

mod colour;
mod point_rows;

use crate::block_qr::{BlockQr, Triangle};
use crate::input_noise::InputNoise;
use crate::loss::Loss;
use crate::motion::{Column, Instant, Motion, State, matrix, small_turn};
use crate::parameters::{Parameters, UnknownKind};
use crate::segment::{InputErrors, Noise, Segment};
use crate::vehicle::{Vehicle, parabola_slope, tilted};
use colour::Colour;
use nalgebra::{Cholesky, Matrix6, SMatrix, SVector};
use poinsot_dynamics::Tree;
use poinsot_model::{MomentumKnowledge, Thruster};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3, Vector6, skew};
use point_rows::PointCompare;
pub(crate) use point_rows::perfect;

/// Pose and momentum at the first grid time; angular momentum about the system's mass centre, all in N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Head {
    pub R_NB: UnitQuaternion,
    pub p_NoBo_N: Vector3,
    pub P: Vector3,
    pub h_SScm_N: Vector3,
}

/// Which parts of the head are unknown: a column for each component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct HeadColumns {
    pub attitude: bool,
    pub position: bool,
    pub linear: bool,
    pub angular: bool,
}

impl HeadColumns {
    /// What a segment leaves unknown: a pose that no sensor measures is the choice of the frame.
    ///
    /// One that is taken as exact is known, at its first sample.
    pub fn of(
        segment: &Segment,
        momentum: &poinsot_model::Momentum,
        noise: &Noise,
        sight: Sight,
    ) -> Self {
        let o = &segment.observations;
        let seen = sight == Sight::Translation;
        let noisy = |covariance: &Matrix3| *covariance != Matrix3::zeros();
        Self {
            // Without any attitude, motion in N still says how the base stands in N.
            attitude: if o.attitude.iter().any(Option::is_some) {
                noisy(&noise.attitude)
            } else {
                seen && (o.velocity.iter().any(Option::is_some)
                    || o.position.iter().any(Option::is_some))
            },
            position: seen && noisy(&noise.position) && o.position.iter().any(Option::is_some),
            linear: seen && momentum.linear == MomentumKnowledge::Estimate,
            angular: momentum.angular == MomentumKnowledge::Estimate,
        }
    }

    /// Number of columns.
    pub fn count(&self) -> usize {
        [self.attitude, self.position, self.linear, self.angular]
            .iter()
            .map(|b| 3 * usize::from(*b))
            .sum()
    }

    /// First column of the linear and of the angular momentum.
    pub fn momentum_at(&self) -> (Option<usize>, Option<usize>) {
        let before = 3 * (usize::from(self.attitude) + usize::from(self.position));
        let linear = self.linear.then_some(before);
        let angular = self
            .angular
            .then_some(before + 3 * usize::from(self.linear));
        (linear, angular)
    }
}

/// Whether any translation is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sight {
    /// Position or velocity.
    Translation,
    /// Attitude and rates only.
    Rotation,
}

/// What stays the same over all evaluations.
pub(crate) struct Setting<'a> {
    pub tree: &'a Tree,
    pub thrusters: &'a [Thruster],
    pub parameters: &'a Parameters,
    pub nominal_spin: &'a [f64],
    pub noise: &'a Noise,
    pub loss: Loss,
    /// Whether wheel speeds run smoothly between the readings.
    pub wheels_smooth: bool,
}

/// One kind of sensor in one segment: whitened residuals, three axes a sample.
#[derive(Debug, Clone, Default)]
pub(crate) struct ChannelResidual {
    pub name: &'static str,
    pub unit: &'static str,
    pub white: Vec<Vector3>,
    pub square: f64,
    /// Logarithm of the determinant that the colour of the noise adds.
    pub log_det: f64,
}

/// One segment at one value of all unknowns.
pub(crate) struct Evaluated {
    pub triangle: Option<Triangle>,
    /// Weighted sum of squares; plain for the Gaussian loss.
    pub chi2: f64,
    /// What is minimised.
    pub cost: f64,
    pub rows: usize,
    pub channels: Vec<ChannelResidual>,
}

/// Propagates one segment and compares with every sensor. `None` where the parameters are not those of a
/// body with positive mass and inertia.
pub(crate) fn evaluate(
    setting: &Setting,
    (index, segment): (usize, &Segment),
    x: &[f64],
    head: &Head,
    unknown: HeadColumns,
    with_sensitivities: bool,
) -> Option<Evaluated> {
    let tree = tilted(setting.tree, setting.parameters, x);
    let mut vehicle = Vehicle::new(
        &tree,
        setting.thrusters,
        setting.parameters,
        setting.nominal_spin,
        x,
    );
    vehicle.wheels_smooth = setting.wheels_smooth;
    let joints = setting.noise.joint_position.iter();
    let rates = &setting.noise.joint_rate;
    vehicle.noisy_joints = joints.zip(rates).map(|(q, r)| q + r > 0.0).collect();
    let (mut state, columns) = start(head, unknown, x.len());
    let columns = if with_sensitivities {
        columns
    } else {
        Vec::new()
    };
    let mut motion = Motion::new(&vehicle, segment, columns, unknown.count(), index);
    let mut compare = Compare::new(setting, segment, x, unknown, with_sensitivities);
    let forced = !segment.firings.is_empty() || vehicle.has_surroundings();
    compare.inputs = InputNoise::new(setting.noise, segment, forced, compare.followed());
    if compare.inputs.tracks_rates() {
        compare.joint_rate.fill(0.0);
    }
    compare.ideal = Ideal::new(&vehicle, segment, &state, index)?;
    compare.points.predict(&vehicle, segment, &state)?;
    let samples = segment.observations.time_s.len();
    for k in 0..samples {
        compare.sample(&mut motion, &state, k)?;
        if k + 1 < samples {
            state = motion.advance(&state, k)?;
        }
    }
    if unknown.attitude && segment.observations.attitude.iter().all(Option::is_none) {
        compare.weak_attitude(&head.R_NB);
    }
    compare.finish()
}

/// Motion that a perfect sensor would read at all grid times: a lag needs what comes before and after.
#[derive(Default)]
struct Ideal {
    rate: Vec<Vector3>,
    /// Velocity of the velocity sensor, in N.
    velocity: Vec<Vector3>,
    /// Position of the position sensor, in N.
    position: Vec<Vector3>,
}

impl Ideal {
    /// Empty where no lag is unknown; `None` where the vehicle cannot move.
    fn new(vehicle: &Vehicle, segment: &Segment, start: &State, index: usize) -> Option<Self> {
        let late = |k: &UnknownKind| {
            matches!(
                k,
                UnknownKind::GyroLag
                    | UnknownKind::AttitudeLag
                    | UnknownKind::VelocityLag
                    | UnknownKind::PositionLag
            )
        };
        let mut ideal = Self::default();
        if !vehicle.kinds.iter().any(late) {
            return Some(ideal);
        }
        let o = &segment.observations;
        let mut motion = Motion::new(vehicle, segment, Vec::new(), 0, index);
        let samples = o.time_s.len();
        let mut state = *start;
        for k in 0..samples {
            let twist = motion.velocity(&state, k)?.0.twist;
            ideal.rate.push(twist.w);
            let moving = twist.v + twist.w.cross(&o.velocity_arm_B);
            ideal.velocity.push(state.R_NB * moving);
            let place = state.p_NoBo_N + state.R_NB * o.position_arm_B;
            ideal.position.push(place);
            if k + 1 < samples {
                state = motion.advance(&state, k)?;
            }
        }
        Some(ideal)
    }
}

/// State at the first grid time and its change with every unknown.
pub(crate) fn start(head: &Head, unknown: HeadColumns, unknowns: usize) -> (State, Vec<Column>) {
    let state = State {
        R_NB: head.R_NB,
        p_NoBo_N: head.p_NoBo_N,
        P: head.P,
        h_SScm_N: head.h_SScm_N,
    };
    let mut columns = Vec::with_capacity(unknown.count() + unknowns);
    let parts = [
        unknown.attitude,
        unknown.position,
        unknown.linear,
        unknown.angular,
    ];
    for (part, _) in parts.iter().enumerate().filter(|(_, wanted)| **wanted) {
        for k in 0..3 {
            let mut column = Column::zeros();
            column[3 * part + k] = 1.0;
            columns.push(column);
        }
    }
    columns.resize(unknown.count() + unknowns, Column::zeros());
    (state, columns)
}

/// Collects the rows of one segment.
struct Compare<'a> {
    setting: &'a Setting<'a>,
    segment: &'a Segment,
    gyro: GyroErrors,
    attitude_lag: f64,
    head: usize,
    qr: Option<BlockQr>,
    rows: usize,
    channels: Vec<ChannelResidual>,
    inputs: InputNoise,
    /// Colour of gyro, attitude, velocity and position.
    colours: [Colour; 4],
    /// Variance of each joint's rate in this segment.
    joint_rate: Vec<f64>,
    /// `ln det` of the covariance of all readings over that of the sensors alone, and a weak prior of the start.
    log_det: f64,
    /// How late velocity and position read, s.
    translation_lag: [f64; 2],
    ideal: Ideal,
    points: PointCompare,
}

/// What may be wrong with the gyro: it reads `(1 + turn) w(t - lag) + bias`.
#[derive(Default)]
pub(crate) struct GyroErrors {
    bias: Vector3,
    /// Scale errors on the diagonal, misalignment beside it.
    turn: Matrix3,
    lag: f64,
}

impl GyroErrors {
    /// The errors of the gyro, and how late the attitude reads.
    pub fn of(parameters: &Parameters, x: &[f64]) -> (Self, f64) {
        let mut gyro = Self::default();
        let mut attitude_lag = 0.0;
        for (u, value) in parameters.unknowns.iter().zip(x) {
            match u.kind {
                UnknownKind::GyroBias(k) => gyro.bias[k] = *value,
                UnknownKind::GyroScale(k) => gyro.turn[(k, k)] += *value,
                UnknownKind::GyroMisalignment(k) => gyro.turn += skew(&axis(k)) * *value,
                UnknownKind::GyroShear(k) => gyro.turn += shear(k) * *value,
                UnknownKind::GyroLag => gyro.lag = *value,
                UnknownKind::AttitudeLag => attitude_lag = *value,
                _ => {}
            }
        }
        (gyro, attitude_lag)
    }

    /// The rate that a reading stands for, its lag left aside.
    pub fn corrected(&self, reading: &Vector3) -> Vector3 {
        let map = Matrix3::identity() + self.turn;
        let clear = reading - self.bias;
        map.lu().solve(&clear).unwrap_or(clear)
    }

    pub fn reading(&self, w: &Vector3, acceleration: &Vector3) -> Vector3 {
        let then = w - acceleration * self.lag;
        then + self.turn * then + self.bias
    }

    /// Change of the reading with the rate and with one unknown.
    fn change(
        &self,
        w: &Vector3,
        acceleration: &Vector3,
        dw: &Vector3,
        unknown: Option<&UnknownKind>,
    ) -> Vector3 {
        let mut change = dw + self.turn * dw;
        match unknown {
            Some(UnknownKind::GyroBias(k)) => change[*k] += 1.0,
            Some(UnknownKind::GyroScale(k)) => change[*k] += w[*k],
            Some(UnknownKind::GyroMisalignment(k)) => change += axis(*k).cross(w),
            Some(UnknownKind::GyroShear(k)) => change += shear(*k) * w,
            Some(UnknownKind::GyroLag) => change -= acceleration + self.turn * acceleration,
            _ => {}
        }
        change
    }
}

/// Each of the two axes other than `k` reads of the other what it should not.
fn shear(k: usize) -> Matrix3 {
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    let mut both = Matrix3::zeros();
    both[(i, j)] = 1.0;
    both[(j, i)] = 1.0;
    both
}

/// How late velocity and position read, s.
pub(crate) fn translation_lag(parameters: &Parameters, x: &[f64]) -> [f64; 2] {
    let of = |kind: UnknownKind| {
        let mut pairs = parameters.unknowns.iter().zip(x);
        pairs.find(|(u, _)| u.kind == kind).map_or(0.0, |(_, x)| *x)
    };
    [of(UnknownKind::VelocityLag), of(UnknownKind::PositionLag)]
}

/// Slope over time of a series at grid time k; zero where there is none.
fn slope(t: &[f64], series: &[Vector3], k: usize) -> Vector3 {
    if series.len() < 2 || series.len() != t.len() {
        return Vector3::zeros();
    }
    Vector3::from_fn(|axis, _| parabola_slope(t, |i| series[i][axis], k))
}

fn axis(k: usize) -> Vector3 {
    let mut e = Vector3::zeros();
    e[k] = 1.0;
    e
}

const GYRO: usize = 0;
const ATTITUDE: usize = 1;
const VELOCITY: usize = 2;
const POSITION: usize = 3;
const ACCELEROMETER: usize = 4;
const INCREMENT: usize = 5;

impl<'a> Compare<'a> {
    fn new(
        setting: &'a Setting<'a>,
        segment: &'a Segment,
        x: &[f64],
        unknown: HeadColumns,
        with_sensitivities: bool,
    ) -> Self {
        let (gyro, attitude_lag) = GyroErrors::of(setting.parameters, x);
        let channel = |name, unit| ChannelResidual {
            name,
            unit,
            ..ChannelResidual::default()
        };
        let width = unknown.count() + x.len() + 1;
        Self {
            setting,
            segment,
            gyro,
            attitude_lag,
            head: unknown.count(),
            qr: with_sensitivities.then(|| BlockQr::new(width)),
            rows: 0,
            channels: vec![
                channel("gyro", "rad/s"),
                channel("attitude", "rad"),
                channel("velocity", "m/s"),
                channel("position", "m"),
                channel("accelerometer", "m/s2"),
                channel("velocity_increment", "m/s"),
            ],
            inputs: InputNoise::default(),
            colours: setting.noise.correlation_s.map(Colour::new),
            joint_rate: joint_rate_noise(setting.noise, segment),
            log_det: 0.0,
            translation_lag: translation_lag(setting.parameters, x),
            ideal: Ideal::default(),
            points: PointCompare::new(setting.parameters, segment, x),
        }
    }

    /// Sequences that go through the filter of the inputs: sensitivities and the residual.
    fn followed(&self) -> usize {
        match self.qr {
            Some(_) => self.head + self.setting.parameters.len() + 1,
            None => 1,
        }
    }

    /// Angular acceleration at grid time k from the predicted rates on both sides, rad/s2.
    fn acceleration(&self, k: usize) -> Vector3 {
        slope(&self.segment.observations.time_s, &self.ideal.rate, k)
    }

    fn sample(&mut self, motion: &mut Motion, state: &State, k: usize) -> Option<()> {
        let o = &self.segment.observations;
        let measured = o.rate[k].is_some() || o.velocity[k].is_some();
        let posed = o.attitude[k].is_some() || o.position[k].is_some();
        let pointed = self.points.wanted(&self.segment.observations.points, k);
        let errs = !self.inputs.is_silent();
        if !measured && !posed && !pointed && !errs {
            return Some(());
        }
        let (instant, twists) = motion.velocity(state, k)?;
        let twists = twists.to_vec();
        if errs || self.joint_rate.iter().any(|v| *v > 0.0) {
            self.inputs.reach(motion, state, &instant, k);
        }
        if measured {
            self.twist_rows(motion, state, &instant, &twists, k);
        }
        self.pose_rows(motion, state, k);
        if pointed {
            self.point_rows(motion, state, &instant, k);
        }
        Some(())
    }

    /// Velocity and rate together: the noise of joints and wheels is common to both.
    fn twist_rows(
        &mut self,
        motion: &Motion,
        state: &State,
        instant: &Instant,
        twists: &[Vector6],
        k: usize,
    ) {
        let o = &self.segment.observations;
        let noise = self.setting.noise;
        let R = matrix(&state.R_NB);
        let arm = o.velocity_arm_B;
        let v_S = instant.twist.v + instant.twist.w.cross(&arm);
        let acceleration = self.acceleration(k);
        let expected = self.gyro.reading(&instant.twist.w, &acceleration);
        let gain_of_v = R.transpose() * slope(&o.time_s, &self.ideal.velocity, k);
        let residual_v =
            o.velocity[k].map(|v| R.transpose() * v - v_S + gain_of_v * self.translation_lag[0]);
        let residual_w = o.rate[k].map(|w| w - expected);
        // In body axes a reading turns with the attitude.
        let v_read = o.velocity[k].map_or(v_S, |v| R.transpose() * v);
        // How a change of state and twist shows in the two readings; nothing where one is missing.
        let seen = |column: &Column, twist: &Vector6, unknown: Option<&UnknownKind>| {
            let mut d = at_sensor(twist, &arm);
            // R (v) measured in N: a turn of the body moves it by -[v]x dphi, in body axes.
            let dphi: Vector3 = column.fixed_rows::<3>(0).into();
            let mut dv = d.fixed_rows::<3>(0) + dphi.cross(&v_read);
            if unknown == Some(&UnknownKind::VelocityLag) {
                dv -= gain_of_v;
            }
            let dw: Vector3 = d.fixed_rows::<3>(3).into();
            let dw = self
                .gyro
                .change(&instant.twist.w, &acceleration, &dw, unknown);
            d.fixed_rows_mut::<3>(0)
                .copy_from(&residual_v.map_or_else(Vector3::zeros, |_| dv));
            d.fixed_rows_mut::<3>(3)
                .copy_from(&residual_w.map_or_else(Vector3::zeros, |_| dw));
            d
        };
        // Velocity is compared in body axes: there its noise and that of the joints add plainly. A missing half
        // is given a variance without information, and is not counted.
        let blind = Matrix3::identity() * (1.0e12 * (noise.velocity + noise.gyro).diagonal().max());
        let velocity_B = residual_v.map_or(blind, |_| R.transpose() * noise.velocity * R);
        let mut sensors = Matrix6::zeros();
        sensors.fixed_view_mut::<3, 3>(0, 0).copy_from(&velocity_B);
        sensors
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&residual_w.map_or(blind, |_| noise.gyro));
        let mut white_noise = sensors;
        for (gain, variance) in self.inputs.rate_gain.iter().zip(&self.joint_rate) {
            if *variance > 0.0 {
                let g = seen(&Column::zeros(), gain, None);
                white_noise += g * g.transpose() * *variance;
            }
        }
        let errors = self.inputs.columns.iter().zip(&self.inputs.twists);
        let mut slopes: Vec<Vector6> = errors.map(|(c, t)| seen(c, t, None)).collect();
        let mut rows: Vec<Vector6> = Vec::with_capacity(twists.len() + 1);
        if self.qr.is_some() {
            let kinds = &self.setting.parameters.unknowns;
            let columns = motion.columns.iter().zip(twists).enumerate();
            rows.extend(columns.map(|(j, (column, twist))| {
                let unknown = j.checked_sub(self.head).map(|u| &kinds[u].kind);
                seen(column, twist, unknown)
            }));
        }
        let (v, w) = (
            residual_v.unwrap_or_default(),
            residual_w.unwrap_or_default(),
        );
        rows.push(Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z));
        let Some(r_v) = residual_v else {
            // The rate alone: half as many rows for the filter.
            let lower = |d: &Vector6| -> Vector3 { d.fixed_rows::<3>(3).into() };
            let mut rows: Vec<Vector3> = rows.iter().map(lower).collect();
            let mut slopes: Vec<Vector3> = slopes.iter().map(lower).collect();
            self.coloured((GYRO, 0, k), &mut rows, &mut slopes);
            let white_noise = white_noise.fixed_view::<3, 3>(3, 3).into();
            if let Some(white) = self.take(&slopes, &white_noise, &noise.gyro, rows) {
                self.note(GYRO, &w, white);
            }
            return;
        };
        self.coloured((VELOCITY, 0, k), &mut rows, &mut slopes);
        if residual_w.is_some() {
            self.coloured((GYRO, 3, k), &mut rows, &mut slopes);
        }
        let Some(white) = self.take(&slopes, &white_noise, &sensors, rows) else {
            return;
        };
        self.note(VELOCITY, &r_v, white.fixed_rows::<3>(0).into());
        if let Some(r) = residual_w {
            self.note(GYRO, &r, white.fixed_rows::<3>(3).into());
        }
    }

    fn pose_rows(&mut self, motion: &Motion, state: &State, k: usize) {
        let o = &self.segment.observations;
        let noise = self.setting.noise;
        if let Some(measured) = o.attitude[k] {
            let late = self.ideal.rate.get(k).copied().unwrap_or_default();
            let residual = small_turn(&state.R_NB, &measured) + late * self.attitude_lag;
            self.pose(
                motion,
                (ATTITUDE, k),
                &noise.attitude,
                &residual,
                |column, unknown| {
                    let own: Vector3 = column.fixed_rows::<3>(0).into();
                    match unknown {
                        Some(UnknownKind::AttitudeLag) => own - late,
                        _ => own,
                    }
                },
            );
        }
        if let Some(measured) = o.position[k] {
            let R = matrix(&state.R_NB);
            let arm = o.position_arm_B;
            let moving = slope(&o.time_s, &self.ideal.position, k);
            let residual = measured - state.p_NoBo_N - R * arm + moving * self.translation_lag[1];
            let seen = |column: &Column, unknown: Option<&UnknownKind>| {
                let dphi: Vector3 = column.fixed_rows::<3>(0).into();
                let own = column.fixed_rows::<3>(3) + R * dphi.cross(&arm);
                match unknown {
                    Some(UnknownKind::PositionLag) => own - moving,
                    _ => own,
                }
            };
            self.pose(motion, (POSITION, k), &noise.position, &residual, seen);
        }
    }

    /// Three rows of a sensor of the pose.
    fn pose(
        &mut self,
        motion: &Motion,
        (channel, k): (usize, usize),
        covariance: &Matrix3,
        residual: &Vector3,
        seen: impl Fn(&Column, Option<&UnknownKind>) -> Vector3,
    ) {
        let errors = self.inputs.columns.iter();
        let mut slopes: Vec<Vector3> = errors.map(|c| seen(c, None)).collect();
        let mut rows: Vec<Vector3> = Vec::with_capacity(motion.columns.len() + 1);
        if self.qr.is_some() {
            let kinds = &self.setting.parameters.unknowns;
            let columns = motion.columns.iter().enumerate();
            rows.extend(
                columns.map(|(j, column)| {
                    seen(column, j.checked_sub(self.head).map(|u| &kinds[u].kind))
                }),
            );
        }
        rows.push(*residual);
        self.coloured((channel, 0, k), &mut rows, &mut slopes);
        if let Some(white) = self.take(&slopes, covariance, covariance, rows) {
            self.note(channel, residual, white);
        }
    }

    /// Takes off what the reading of this channel before says of coloured noise, in rows `at` to `at + 2`. The
    /// white noise that joint rates add is taken as new at every reading.
    fn coloured<const M: usize>(
        &mut self,
        (channel, at, k): (usize, usize, usize),
        rows: &mut [SVector<f64, M>],
        slopes: &mut [SVector<f64, M>],
    ) {
        let colour = &mut self.colours[channel];
        if colour.is_white() {
            return;
        }
        let all = || rows.iter().chain(slopes.iter());
        let mut block: Vec<Vector3> = all()
            .map(|r| Vector3::new(r[at], r[at + 1], r[at + 2]))
            .collect();
        let log_det = colour.take(self.segment.observations.time_s[k], &mut block);
        self.channels[channel].log_det += 3.0 * log_det;
        for (row, new) in rows.iter_mut().chain(slopes.iter_mut()).zip(&block) {
            for axis in 0..3 {
                row[at + axis] = new[axis];
            }
        }
    }

    /// Three rows of an instrument at a point; `slopes` is what errors of the inputs do to its reading.
    fn three(
        &mut self,
        (channel, slopes): (usize, &[Vector3]),
        covariance: &Matrix3,
        residual: &Vector3,
        column: impl Fn(usize) -> Vector3,
    ) {
        let mut rows: Vec<Vector3> = (1..self.followed()).map(|j| column(j - 1)).collect();
        rows.push(*residual);
        if let Some(white) = self.take(slopes, covariance, covariance, rows) {
            self.note(channel, residual, white);
        }
    }

    /// Readings at one time, sensitivities first and the residual last: what earlier readings say of the inputs'
    /// errors is taken off, the rest is whitened and goes into the triangle. Gives the white residual; `None` for
    /// a sensor taken as exact, which is left out.
    ///
    /// `noise` is the covariance of what is new at this time, `sensors` the part of it that no input causes.
    fn take<const M: usize>(
        &mut self,
        slopes: &[SVector<f64, M>],
        noise: &SMatrix<f64, M, M>,
        sensors: &SMatrix<f64, M, M>,
        mut rows: Vec<SVector<f64, M>>,
    ) -> Option<SVector<f64, M>> {
        let alone = Cholesky::new(*sensors)?.l();
        let correlation = self.inputs.correlation(slopes);
        // `M P M^T`.
        let spread = slopes
            .iter()
            .zip(&correlation)
            .fold(SMatrix::zeros(), |sum: SMatrix<f64, M, M>, (a, b)| {
                sum + a * b.transpose()
            });
        let mut root = Cholesky::new(noise + spread)?.l();
        self.log_det += 2.0
            * (0..M)
                .map(|i| (root[(i, i)] / alone[(i, i)]).ln())
                .sum::<f64>();
        let residual = self.inputs.expected(slopes, *rows.last()?);
        let white = root.solve_lower_triangular(&residual)?;
        // A reading with less weight is one with more noise: so the filter does not believe it either.
        let loss = self.setting.loss;
        let weights: [f64; M] = std::array::from_fn(|i| {
            let own = (0..M).filter(|j| j / 3 == i / 3);
            loss.weight(own.map(|j| white[j] * white[j]).sum())
        });
        if weights.iter().any(|w| *w != 1.0) {
            let inflated =
                SMatrix::from_fn(|i, j| noise[(i, j)] / (weights[i] * weights[j]).sqrt());
            root = Cholesky::new(inflated + spread)?.l();
        }
        let identity = SMatrix::<f64, M, M>::identity();
        let inverse_root = root.solve_lower_triangular(&identity)?;
        self.inputs
            .take(slopes, &correlation, &inverse_root, &mut rows);
        if let Some(qr) = &mut self.qr {
            qr.push(M, |i, j| rows[j][i]);
        }
        Some(white)
    }

    /// Keeps an attitude at the start that nobody measured within half a turn of the identity, for motions that
    /// say nothing of it.
    fn weak_attitude(&mut self, R_NB: &UnitQuaternion) {
        let sigma = std::f64::consts::PI;
        let residual = -R_NB.scaled_axis() / sigma;
        self.log_det += residual.norm_squared();
        let last = self.followed() - 1;
        if let Some(qr) = &mut self.qr {
            qr.push(3, |i, j| match j {
                j if j == i => 1.0 / sigma,
                j if j == last => residual[i],
                _ => 0.0,
            });
        }
    }

    fn note(&mut self, channel: usize, residual: &Vector3, white: Vector3) {
        let c = &mut self.channels[channel];
        c.square += residual.norm_squared();
        c.white.push(white);
        self.rows += 3;
    }

    fn finish(self) -> Option<Evaluated> {
        let loss = self.setting.loss;
        let (mut chi2, mut cost) = (0.0, self.log_det);
        for white in self.channels.iter().flat_map(|c| &c.white) {
            let square = white.norm_squared();
            chi2 += loss.weight(square) * square;
            cost += loss.cost(square);
        }
        chi2.is_finite().then(|| Evaluated {
            triangle: self.qr.map(BlockQr::finish),
            chi2,
            cost,
            rows: self.rows,
            channels: self
                .channels
                .into_iter()
                .filter(|c| !c.white.is_empty())
                .collect(),
        })
    }
}

/// A change of the base twist as seen by a velocity sensor at `arm`, and by the gyro.
fn at_sensor(twist: &Vector6, arm: &Vector3) -> Vector6 {
    let w: Vector3 = twist.fixed_rows::<3>(3).into();
    let v: Vector3 = twist.fixed_rows::<3>(0) + w.cross(arm);
    Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
}

/// Variance of the joint rates in a segment: a locked joint has none.
fn joint_rate_noise(noise: &Noise, segment: &Segment) -> Vec<f64> {
    let errors = &segment.observations.joint_errors;
    let still = |k: usize| matches!(errors.get(k), Some(InputErrors::Locked | InputErrors::None));
    let all = noise.joint_rate.iter().enumerate();
    all.map(|(k, v)| if still(k) { 0.0 } else { *v }).collect()
}
