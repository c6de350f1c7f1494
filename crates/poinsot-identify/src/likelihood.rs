//! Whitened residuals of one segment and their sensitivities.

mod carried_columns;
pub(crate) mod impulse;
mod initial_state;
mod parallel;
pub(crate) mod rows;
mod sensor_rows;

use carried_columns::CarriedColumns;
pub(crate) use carried_columns::{KnownColumns, PredictionSlopes};
pub(crate) use initial_state::{InitialState, InitialStateColumns};

use crate::motion::input_curves::InputCurves;
use crate::motion::input_noise::InputNoise;
use crate::motion::{Column, Fineness, Grid, Motion, State, Vehicle, impulse_before, tilted};
use crate::problem::Problem;
use crate::problem::alternative::BetweenSamples;
use crate::problem::loss::Loss;
use crate::problem::parameters::Parameters;
use crate::problem::segment::Segment;
use crate::sensors::{IdealSeries, SpareVectors};
use nalgebra::Cholesky;
use parallel::compare_all;
use poinsot_dynamics::Tree;
use poinsot_model::{SensorKind, Thruster};
use poinsot_solve::{BlockQr, Triangle};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use sensor_rows::SensorCursor;
use std::f64::consts::{PI, TAU};

/// Sigma of modes at the start, in those of a body that turns at the measured rate, rad/s, and of a slower one.
const WIDE: f64 = 30.0;
const SLOW: f64 = 0.01;

/// What stays the same over all evaluations.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub problem: Problem<'a>,
    pub thrusters: &'a [Thruster],
    pub parameters: &'a Parameters,
    pub nominal_spin: &'a [f64],
    pub loss: Loss,
    /// What is assumed of the inputs between their samples.
    pub wheels: BetweenSamples,
    /// Curves along which lags shift the inputs, one per segment; empty where no lag is unknown.
    pub curves: &'a [InputCurves],
    /// Integration steps, one grid per segment, and their refinement.
    pub grids: &'a [Grid],
    pub fineness: Fineness,
    /// Whether every whitened row is kept, and no triangle is made.
    pub keep_rows: bool,
    /// Whether the inputs are smoothed by all samples.
    pub smooth_inputs: bool,
    /// How many of the unknowns were fitted, where those behind them are only candidates: rows that these do not move then have a
    /// narrow triangle of their own.
    pub fitted: Option<usize>,
    /// How the known numbers move the predictions, where that is asked.
    pub known: Option<&'a KnownColumns>,
    /// Whether a second thread may follow the motion while this one compares.
    pub split: bool,
}

impl Setting<'_> {
    /// The vehicle in a segment at one value of the unknowns; `tree` is [`tilted`] there.
    pub fn vehicle<'v>(
        &'v self,
        tree: &'v Tree,
        (index, segment): (usize, &Segment),
        x: &[f64],
    ) -> Vehicle<'v> {
        let thrusters = self.thrusters;
        let mut vehicle = Vehicle::new(tree, thrusters, self.parameters, self.nominal_spin, x);
        vehicle.segment = index;
        if vehicle.loses_mass() {
            vehicle.impulse_before =
                impulse_before(self.problem.segments, segment, thrusters.len());
        }
        vehicle.wheels_smooth = self.wheels == BetweenSamples::Smooth;
        vehicle.curves = self.curves.get(index);
        vehicle.grid = self.grids.get(index);
        vehicle.fineness = self.fineness;
        vehicle
    }
}

/// One sensor in one segment: whitened residuals.
#[derive(Debug, Clone, Default)]
pub(crate) struct ChannelResidual {
    /// Index among the records of the segment.
    pub sensor: usize,
    /// As in its record.
    pub name: String,
    pub unit: &'static str,
    /// Numbers that one reading tells: the first so many of the three are not zero.
    pub numbers: usize,
    pub white: Vec<Vector3>,
    pub square: f64,
}

/// One segment at one value of all unknowns.
#[derive(Clone, Default)]
pub(crate) struct Evaluated {
    pub triangle: Option<Triangle>,
    /// Weighted sum of squares; plain for the Gaussian loss.
    pub chi2: f64,
    /// What is minimised: with `ln det` of the readings' covariance over that of the sensors alone, but about smoothed inputs.
    pub cost: f64,
    /// What `cost` leaves out: inputs that are free are maximised over, and a determinant that moves with the unknowns would bias
    /// them.
    pub left_out: f64,
    /// How much of the innovations is noise of the inputs: the sum of the shares of their covariance.
    pub input_share: f64,
    /// The segment about inputs smoothed by all samples, where that is asked.
    pub smoothed: Option<Segment>,
    pub rows: usize,
    pub channels: Vec<ChannelResidual>,
    pub kept: KeptRows,
}

/// Whitened rows, where they are kept.
#[derive(Debug, Clone, Default)]
pub(crate) struct KeptRows {
    pub rows: Vec<KeptRow>,
    /// How the state at grid times moves with the start.
    pub transitions: Vec<Transition>,
}

impl KeptRows {
    /// Those of one sensor; of the priors of the start.
    pub fn of(&self, sensor: Option<usize>) -> impl Iterator<Item = &KeptRow> {
        let rows = self.rows.iter();
        rows.filter(move |r| r.sensor == sensor)
    }
}

/// The state at a grid time.
#[derive(Debug, Clone)]
pub(crate) struct Transition {
    /// Grid time.
    pub at: usize,
    pub R_NB: UnitQuaternion,
    /// Its change with each column of the start.
    pub start: Vec<Column>,
}

/// Three numbers of one measurement.
#[derive(Debug, Clone)]
pub(crate) struct KeptRow {
    /// Index of the sensor's record in the segment; `None` for a prior of the start.
    pub sensor: Option<usize>,
    /// Grid time.
    pub at: usize,
    pub raw: Vector3,
    pub white: Vector3,
    /// Slopes of the prediction, then the residual; all whitened.
    pub rows: Vec<Vec<f64>>,
}

/// Propagates one segment and compares with every sensor. `None` where the parameters are not those of a
/// body with positive mass and inertia.
pub(crate) fn evaluate(
    setting: &Setting,
    (index, segment): (usize, &Segment),
    x: &[f64],
    initial_state: &InitialState,
    unknown: InitialStateColumns,
    with_sensitivities: bool,
) -> Option<Evaluated> {
    // Known numbers do not enter the motion: their columns are given and act on the residuals.
    let whole = setting.parameters;
    let asked = (unknown, with_sensitivities);
    let of = (index, segment);
    if !whole.has_known() {
        return evaluate_driven(setting, of, x, initial_state, asked, None);
    }
    let (reduced, kept) = whole.without_known();
    let driving: Vec<f64> = kept.iter().map(|k| x[*k]).collect();
    let carried = CarriedColumns::new(setting, of, x, kept);
    let setting = Setting {
        parameters: &reduced,
        ..*setting
    };
    evaluate_driven(&setting, of, &driving, initial_state, asked, Some(carried))
}

/// The same of unknowns that drive the motion or the sensors; `carried_columns` ones act on what is compared alone.
fn evaluate_driven(
    setting: &Setting,
    (index, segment): (usize, &Segment),
    x: &[f64],
    initial_state: &InitialState,
    (unknown, with_sensitivities): (InitialStateColumns, bool),
    carried: Option<CarriedColumns>,
) -> Option<Evaluated> {
    let tree = tilted(setting.problem.tree, setting.parameters, x);
    let vehicle = setting.vehicle(&tree, (index, segment), x);
    let columns = with_sensitivities.then(|| unknown.columns(x.len()));
    let columns = columns.unwrap_or_default();
    let motion = || Motion::new(&vehicle, segment, columns.clone(), unknown.count());
    let asked = (unknown, with_sensitivities);
    let mut compare = SegmentComparison::new(setting, segment, x, asked, carried);
    let forced = !segment.firings.is_empty() || vehicle.has_environment_torque();
    let (followed, records) = (compare.followed(), setting.smooth_inputs);
    compare.inputs = InputNoise::new(&setting.problem, segment, forced, followed, records);
    let late: Vec<bool> = compare.cursors.iter().map(|f| f.late).collect();
    compare.ideal = IdealSeries::new(&vehicle, segment, initial_state, &late)?;
    let samples = segment.observations.time_s.len();
    compare_all(
        &mut compare,
        motion,
        initial_state,
        (samples, setting.split),
    )?;
    // One direction alone does not determine the rotation about itself: a weak prior of an unmeasured initial attitude.
    if unknown.attitude && !segment.observations.reads(SensorKind::Attitude) {
        let from = segment.samples.R_NB.first().copied().unwrap_or_default();
        let turn = (from.inverse() * initial_state.R_NB).scaled_axis();
        compare.weak_start(0, &-turn, &Vector3::repeat(PI));
    }
    compare.weak_modes(initial_state);
    compare.finish()
}

/// Collects the rows of one segment.
struct SegmentComparison<'a> {
    setting: &'a Setting<'a>,
    segment: &'a Segment,
    /// One for each sensor of the segment.
    cursors: Vec<SensorCursor>,
    initial_columns: usize,
    with_sensitivities: bool,
    /// `None` without sensitivities, and where the rows are kept.
    qr: Option<BlockQr>,
    /// Of the rows that candidates do not move, without their columns.
    unmoved: Option<BlockQr>,
    /// What the rows so far make of the result.
    so_far: Evaluated,
    inputs: InputNoise,
    spare: SpareVectors,
    /// `ln det` of the covariance of all readings over that of the sensors alone.
    log_det: f64,
    /// A weak prior of the start.
    prior: f64,
    ideal: IdealSeries,
    /// Grid time in hand.
    now: usize,
    /// Known numbers, where they are unknowns.
    carried: Option<CarriedColumns<'a>>,
}

impl<'a> SegmentComparison<'a> {
    fn new(
        setting: &'a Setting<'a>,
        segment: &'a Segment,
        x: &[f64],
        (unknown, with_sensitivities): (InitialStateColumns, bool),
        carried: Option<CarriedColumns<'a>>,
    ) -> Self {
        let initial_columns = unknown.count();
        let sensors = &segment.observations.sensors;
        let cursors = SensorCursor::all(sensors, setting, x, initial_columns);
        let triangle = with_sensitivities && !setting.keep_rows;
        let of = |unknowns: usize| BlockQr::new(initial_columns + unknowns + 1);
        let known = carried.as_ref().map_or(0, CarriedColumns::len);
        Self {
            setting,
            segment,
            cursors,
            unmoved: setting.fitted.filter(|_| triangle).map(of),
            initial_columns,
            with_sensitivities,
            qr: triangle.then(|| of(x.len() + known)),
            so_far: Evaluated::default(),
            inputs: InputNoise::default(),
            spare: SpareVectors::default(),
            log_det: 0.0,
            prior: 0.0,
            ideal: IdealSeries::default(),
            now: 0,
            carried,
        }
    }

    /// Columns of the triangle: initial state, all unknowns, residual.
    fn width(&self) -> usize {
        let own = self.initial_columns + self.setting.parameters.len() + 1;
        own + self.carried.as_ref().map_or(0, CarriedColumns::len)
    }

    /// Sequences that go through the filter of the inputs: sensitivities and the residual.
    fn followed(&self) -> usize {
        match self.with_sensitivities {
            true => self.initial_columns + self.setting.parameters.len() + 1,
            false => 1,
        }
    }

    fn sample(&mut self, motion: &mut Motion, state: &State, k: usize) -> Option<()> {
        self.now = k;
        let sensors = &self.segment.observations.sensors;
        let mut pairs = self.cursors.iter().zip(sensors);
        let due = pairs.any(|(cursor, record)| cursor.stream.is_due(record, k));
        let errs = !self.inputs.is_silent();
        if !due && !errs {
            return Some(());
        }
        let (instant, _) = motion.velocity(state, k)?;
        if errs {
            self.inputs.propagate_to(motion, state, &instant, k);
        }
        if due && self.setting.keep_rows && self.with_sensitivities {
            let start = motion.columns[..self.initial_columns].to_vec();
            self.so_far.kept.transitions.push(Transition {
                at: k,
                R_NB: state.R_NB,
                start,
            });
        }
        for i in 0..self.cursors.len() {
            self.add_sensor_rows(i, motion, (state, k), &instant);
        }
        self.inputs.end_grid_time();
        Some(())
    }

    /// A reading, sensitivities first and the residual last: the part predicted from earlier samples is subtracted; the
    /// rest is whitened, added to the triangle and kept where that is asked. `None` for a sensor taken as exact, which is left
    /// out.
    ///
    /// `noise` is the covariance of what is new at this time.
    fn take(
        &mut self,
        i: usize,
        slopes: &[Vector3],
        noise: &Matrix3,
        rows: &mut Vec<Vector3>,
    ) -> Option<()> {
        let alone = self.cursors[i].own_root_det?;
        let raw = *rows.last()?;
        let spread = self.inputs.correlate(slopes);
        let mut root = Cholesky::new(noise + spread)?.l();
        self.log_det += 2.0 * (root.diagonal().product() / alone).ln();
        let residual = self.inputs.expected(slopes, raw);
        let white = root.solve_lower_triangular(&residual)?;
        // A smaller weight means more noise, in the filter too.
        let numbers = self.cursors[i].channel.numbers;
        let weight = self.setting.loss.weight(white.norm_squared(), numbers);
        if weight != 1.0 {
            root = Cholesky::new(noise / weight + spread)?.l();
        }
        let inverse_root = root.solve_lower_triangular(&Matrix3::identity())?;
        self.inputs.take(slopes, &inverse_root, rows);
        let by_inputs = spread - self.inputs.of_sensors(slopes);
        self.so_far.input_share += (inverse_root * by_inputs)
            .component_mul(&inverse_root)
            .sum();
        if let Some(carried) = self.carried.as_ref().filter(|_| self.with_sensitivities) {
            let reading = self.cursors[i].channel.white.len();
            let mut wide = self.spare.take();
            let place = (self.initial_columns, weight.sqrt());
            carried.widen(rows, (i, reading), place, &mut wide);
            self.spare.give_back(std::mem::replace(rows, wide));
        }
        self.push(rows);
        self.note(i, raw, white, rows);
        Some(())
    }

    /// A reading that was taken: its residual, plain and white, and its whitened rows.
    fn note(&mut self, i: usize, raw: Vector3, white: Vector3, rows: &[Vector3]) {
        if self.setting.keep_rows {
            // Room for what a diagnosis makes of the columns: a drift of every sensor.
            let room = rows.len() + 3 * self.cursors.len();
            let row = |i: usize| {
                let mut row = Vec::with_capacity(room);
                row.extend(rows.iter().map(|r| r[i]));
                row
            };
            self.so_far.kept.rows.push(KeptRow {
                sensor: Some(i),
                at: self.now,
                raw,
                white,
                rows: (0..3).map(row).collect(),
            });
        }
        let channel = &mut self.cursors[i].channel;
        channel.square += raw.norm_squared();
        channel.white.push(white);
        self.so_far.rows += channel.numbers;
    }

    /// Adds three rows to the triangle.
    fn push(&mut self, rows: &[Vector3]) {
        let last = rows.len() - 1;
        if let Some(fitted) = self.setting.fitted
            && let Some(unmoved) = &mut self.unmoved
        {
            let first = self.initial_columns + fitted;
            if rows[first..last].iter().all(|x| *x == Vector3::zeros()) {
                return unmoved.push(3, |i, j| rows[if j < first { j } else { last }][i]);
            }
        }
        if let Some(qr) = &mut self.qr {
            qr.push(3, |i, j| rows[j][i]);
        }
    }

    /// The triangle of all rows.
    fn triangle(&mut self) -> Option<Triangle> {
        let (last, mut qr) = (self.width() - 1, self.qr.take()?);
        if let Some(unmoved) = self.unmoved.take() {
            let r = unmoved.finish().r;
            let first = r.ncols() - 1;
            qr.push(r.nrows(), |i, j| match j {
                j if j == last => r[(i, first)],
                j if j < first => r[(i, j)],
                _ => 0.0,
            });
        }
        Some(qr.finish())
    }

    /// A wide prior of what modes that no sensor sees are at the start.
    fn weak_modes(&mut self, start: &InitialState) {
        let setting = self.setting;
        let inertia = setting.parameters.nominal.iter();
        let inertia: f64 = inertia.map(|body| body.I_BBo_B.trace()).sum();
        let rate = self
            .segment
            .samples
            .w_NB_B
            .first()
            .map_or(0.0, Vector3::norm);
        let momentum = WIDE * inertia.sqrt() * (rate + SLOW);
        let modes = setting.parameters.modes.iter();
        let modes = modes.map(|m| [momentum / (TAU * m.frequency_Hz), momentum]);
        // A passive joint is anywhere, and swings some times as fast as the vehicle turns.
        let joints = setting.parameters.passive.joints().iter();
        let swings = [PI, momentum * inertia.sqrt()];
        let all: Vec<[f64; 2]> = modes.chain(joints.map(|_| swings)).collect();
        let own = self.initial_columns - 2 * all.len();
        for (k, [amplitude, momentum]) in all.into_iter().enumerate() {
            let state = Vector3::new(start.internal[2 * k], start.internal[2 * k + 1], 0.0);
            let sigma = Vector3::new(amplitude, momentum, f64::INFINITY);
            self.weak_start(own + 2 * k, &-state, &sigma);
        }
    }

    /// A prior of up to three numbers of the start from a column on; those of infinite sigma have none.
    fn weak_start(&mut self, first: usize, residual: &Vector3, sigma: &Vector3) {
        let white = residual.component_div(sigma);
        self.prior += white.norm_squared();
        let last = self.width() - 1;
        if let Some(qr) = &mut self.qr {
            qr.push(3, |i, j| match j {
                j if j == last => white[i],
                j if j == first + i && j < last => 1.0 / sigma[i],
                _ => 0.0,
            });
        }
        if self.setting.keep_rows {
            let row = |i: usize| {
                let mut row = vec![0.0; last + 1];
                (row[(first + i).min(last)], row[last]) = (1.0 / sigma[i], white[i]);
                row
            };
            self.so_far.kept.rows.push(KeptRow {
                sensor: None,
                at: 0,
                raw: *residual,
                white,
                rows: (0..3).map(row).collect(),
            });
        }
    }

    fn finish(mut self) -> Option<Evaluated> {
        let triangle = self.triangle();
        let loss = self.setting.loss;
        let observations = &self.segment.observations;
        let (counted, left_out) = match observations.is_smoothed() {
            true => (0.0, self.log_det),
            false => (self.log_det, 0.0),
        };
        let smoothed = self.inputs.smoothed().map(|errors| {
            let mut segment = self.segment.clone();
            self.inputs.correct(&errors, &mut segment.observations);
            segment
        });
        let (mut chi2, mut cost) = (0.0, counted + self.prior);
        let channels: Vec<ChannelResidual> = self
            .cursors
            .into_iter()
            .map(|f| f.channel)
            .filter(|c| !c.white.is_empty())
            .collect();
        for channel in &channels {
            for white in &channel.white {
                let square = white.norm_squared();
                chi2 += loss.weight(square, channel.numbers) * square;
                cost += loss.cost(square, channel.numbers);
            }
        }
        chi2.is_finite().then(|| Evaluated {
            triangle,
            chi2,
            cost,
            left_out,
            smoothed,
            channels,
            ..self.so_far
        })
    }
}
