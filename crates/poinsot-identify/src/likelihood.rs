//! Predicted against measured: whitened residuals of one segment and their sensitivities.

mod base_rows;
mod colour;
mod gyro;
mod head;
mod ideal;
mod point_rows;
mod side_by_side;

pub(crate) use gyro::GyroErrors;
pub(crate) use head::{Head, HeadColumns, Sight, start};
pub(crate) use ideal::translation_lag;
pub(crate) use point_rows::perfect;

use crate::input_curves::InputCurves;
use crate::input_noise::{InputNoise, Processes};
use crate::loss::Loss;
use crate::motion::{Grid, Motion, State};
use crate::parameters::Parameters;
use crate::segment::{InputErrors, Noise, Segment};
use crate::vehicle::{Steps, Vehicle, tilted};
use crate::wheel_process::WheelProcess;
use colour::Colour;
use ideal::Ideal;
use nalgebra::{Cholesky, SMatrix, SVector};
use poinsot_dynamics::Tree;
use poinsot_model::{RandomTorque, Thruster};
use poinsot_solve::{BlockQr, Triangle};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use point_rows::PointCompare;
use side_by_side::compare_all;

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
    /// Random torque of the surroundings, where one is declared.
    pub random_torque: Option<RandomTorque>,
    /// The wheels as processes, one entry a segment; empty where their speeds are given.
    pub wheels: &'a [WheelProcess],
    /// Curves along which lags shift the inputs, one per segment; empty where no lag is unknown.
    pub curves: &'a [InputCurves],
    /// Integration steps, one grid per segment, how many steps for each, and whether wheel speeds bend within an interval.
    pub grids: &'a [Grid],
    pub factor: u32,
    pub bends: bool,
    /// Whether every whitened row is kept beside the triangle.
    pub keep_rows: bool,
    /// Whether a second thread may follow the motion while this one compares.
    pub split: bool,
}

impl Setting<'_> {
    /// How finely a segment is propagated.
    pub fn steps(&self, segment: usize) -> Steps<'_> {
        Steps {
            grid: self.grids.get(segment),
            factor: self.factor,
            bends: self.bends,
        }
    }
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
    pub kept: KeptRows,
}

/// Whitened rows, where they are kept.
#[derive(Debug, Clone, Default)]
pub(crate) struct KeptRows {
    pub rows: Vec<KeptRow>,
    /// Rows of the last measurements, with `ln det` of the noise of each three, until their sensor is known.
    fresh: Vec<(Vec<f64>, f64)>,
}

impl KeptRows {
    /// Those of one kind of sensor; of the priors of the start.
    pub fn of(&self, channel: Option<&'static str>) -> impl Iterator<Item = &KeptRow> {
        self.rows.iter().filter(move |r| r.channel == channel)
    }
}

/// Three numbers of one measurement.
#[derive(Debug, Clone)]
pub(crate) struct KeptRow {
    /// Kind of sensor; `None` for a prior of the start.
    pub channel: Option<&'static str>,
    /// Grid time.
    pub at: usize,
    pub raw: Vector3,
    pub white: Vector3,
    /// Logarithm of the determinant of its noise.
    pub log_det: f64,
    /// Slopes of the prediction, then the residual; all whitened.
    pub rows: Vec<Vec<f64>>,
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
    vehicle.curves = setting.curves.get(index);
    vehicle.steps = setting.steps(index);
    let joints = setting.noise.joint_position.iter();
    let rates = &setting.noise.joint_rate;
    vehicle.noisy_joints = joints.zip(rates).map(|(q, r)| q + r > 0.0).collect();
    let (state, columns) = start(head, unknown, x.len());
    let columns = if with_sensitivities {
        columns
    } else {
        Vec::new()
    };
    let motion = || Motion::new(&vehicle, segment, columns.clone(), unknown.count());
    let mut compare = Compare::new(setting, segment, x, unknown, with_sensitivities);
    let forced = !segment.firings.is_empty() || vehicle.has_surroundings();
    let processes = Processes {
        random_torque: setting.random_torque,
        wheels: setting.wheels.get(index),
    };
    let noise = (setting.noise, processes);
    compare.inputs = InputNoise::new(noise, segment, forced, compare.followed());
    if compare.inputs.tracks_rates() {
        compare.joint_rate.fill(0.0);
    }
    compare.ideal = Ideal::new(&vehicle, segment, &state)?;
    compare.points.predict(&vehicle, segment, &state)?;
    let samples = segment.observations.time_s.len();
    compare_all(&mut compare, motion, &state, (samples, setting.split))?;
    if unknown.attitude && segment.observations.attitude.iter().all(Option::is_none) {
        compare.weak_attitude(&head.R_NB);
    }
    compare.finish()
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
    inputs: InputNoise<'a>,
    /// Square of the whitened samples of the tachometers, where the wheels are processes.
    tachometers: f64,
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
    kept: KeptRows,
    /// Grid time in hand.
    now: usize,
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
            tachometers: 0.0,
            colours: setting.noise.correlation_s.map(Colour::new),
            joint_rate: joint_rate_noise(setting.noise, segment),
            log_det: 0.0,
            translation_lag: translation_lag(setting.parameters, x),
            ideal: Ideal::default(),
            points: PointCompare::new(setting.parameters, segment, x),
            kept: KeptRows::default(),
            now: 0,
        }
    }

    /// Sequences that go through the filter of the inputs: sensitivities and the residual.
    fn followed(&self) -> usize {
        match self.qr {
            Some(_) => self.head + self.setting.parameters.len() + 1,
            None => 1,
        }
    }

    fn sample(&mut self, motion: &mut Motion, state: &State, k: usize) -> Option<()> {
        self.now = k;
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
            self.tachometer_rows(k);
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

    /// Samples of wheels that are processes: no unknown enters before the filter.
    fn tachometer_rows(&mut self, k: usize) {
        for (slopes, residual, variance) in self.inputs.tachometers(k) {
            let mut rows = vec![SVector::<f64, 1>::zeros(); self.followed()];
            if let Some(last) = rows.last_mut() {
                last[0] = residual;
            }
            let noise = SMatrix::<f64, 1, 1>::new(variance);
            if let Some(white) = self.take(&slopes, &noise, &noise, rows) {
                self.tachometers += white[0] * white[0];
            }
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
        if self.setting.keep_rows {
            let of_three = |i: usize| {
                let own = 3 * (i / 3)..3 * (i / 3) + 3;
                own.map(|j| 2.0 * alone[(j, j)].ln()).sum::<f64>()
            };
            let row = |i: usize| rows.iter().map(|r| r[i]).collect();
            self.kept.fresh = (0..M).map(|i| (row(i), of_three(i))).collect();
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
        if self.setting.keep_rows {
            let row = |i: usize| {
                let mut row = vec![0.0; last + 1];
                (row[i], row[last]) = (1.0 / sigma, residual[i]);
                row
            };
            self.kept.rows.push(KeptRow {
                channel: None,
                at: 0,
                raw: residual * sigma,
                white: residual,
                log_det: 0.0,
                rows: (0..3).map(row).collect(),
            });
        }
    }

    fn note(&mut self, channel: usize, residual: &Vector3, white: Vector3) {
        let c = &mut self.channels[channel];
        c.square += residual.norm_squared();
        c.white.push(white);
        self.rows += 3;
        let fresh = &mut self.kept.fresh;
        if fresh.len() >= 3 {
            let log_det = fresh[0].1;
            self.kept.rows.push(KeptRow {
                channel: Some(c.name),
                at: self.now,
                raw: *residual,
                white,
                log_det,
                rows: fresh.drain(..3).map(|(row, _)| row).collect(),
            });
        }
    }

    fn finish(self) -> Option<Evaluated> {
        let loss = self.setting.loss;
        let (mut chi2, mut cost) = (0.0, self.log_det + self.tachometers);
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
            kept: self.kept,
            channels: self
                .channels
                .into_iter()
                .filter(|c| !c.white.is_empty())
                .collect(),
        })
    }
}

/// Variance of the joint rates in a segment: a locked joint has none.
fn joint_rate_noise(noise: &Noise, segment: &Segment) -> Vec<f64> {
    let errors = &segment.observations.joint_errors;
    let still = |k: usize| matches!(errors.get(k), Some(InputErrors::Locked | InputErrors::None));
    let all = noise.joint_rate.iter().enumerate();
    all.map(|(k, v)| if still(k) { 0.0 } else { *v }).collect()
}
