//! Time and measurement updates.

use crate::check::Invalid;
use crate::configuration::{Configuration, INPUTS, ITERATIONS, of_rate};
use crate::excitation::Excitation;
use crate::health::{Checkpoints, SENSORS, SensorCounts, Tests};
use crate::information::{OfParameters, Rows, back_substitute, copy_triangle, eliminate};
use crate::layout::{Layout, ROTATION, dot, noises};
use crate::motion::{
    Acting, Bend, Columns, Flexing, Interval, Linear, Moving, Over, Scratch, motion_of,
};
use crate::numbers::{AXES, MOUNTING, NUMBERS, Numbers, PARAMETERS};
use crate::placed::Placed;
use crate::posture::InertiaSlopes;
use crate::sample::Sample;
use crate::slopes::Slopes;
use crate::stream::{Course, Stream, Window};
use core::f64::consts::TAU;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use nalgebra::{SMatrix, SVector, SymmetricEigen, UnitQuaternion};
use poinsot_dynamics::propagation::{
    COLUMN, Column, FlexibleMotion, FlexibleState, INTERNAL, PoseMomentum, STATE,
};
use poinsot_spatial::{Matrix3, Vector3, Vector6, angular, elements, linear};

/// Squared normalised innovation of three numbers beyond which a measurement is not used: a false alarm of 3e-7.
pub(crate) const GATE: f64 = 33.0;
/// Share of its sigma by which a parameter moves before the motion is linearised anew.
pub(crate) const MOVED: f64 = 0.1;
/// Samples after a start whose innovations are not tested: they set the state.
const SETTLING: u32 = 3;
/// Most starts in a row that do not go on.
const STARTS: u32 = 5;
/// Prior sigma of the rate of a mode: that which has the energy of the vehicle turning so fast, rad/s.
const SWINGING: f64 = 0.1;
/// Components of momentum in the kernels' state.
const LINEAR: usize = 6;
const ANGULAR: usize = 9;
/// Components of the state in a row that turn and shift the vehicle.
const OF_TURN: usize = AXES;
const OF_SHIFT: usize = 3 * AXES;
/// Share of the largest square of a combination below which it is round-off.
const ROUND_OFF: f64 = 1.0e-12;

type TenByTen = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// The motion that is followed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Running {
    pub time_s: f64,
    state: FlexibleState,
    bias: Vector3,
    /// Angular velocity, in B.
    rate: Vector3,
    /// Inputs as they were read, and the most likely ones.
    read: [f64; INPUTS],
    inputs: [f64; INPUTS],
    force_B: Vector3,
    torque_B: Vector3,
    /// Samples since the start.
    age: u32,
}

impl Running {
    /// What the most likely inputs are above those read.
    fn found(&self) -> [f64; INPUTS] {
        core::array::from_fn(|k| self.inputs[k] - self.read[k])
    }
}

/// The most likely change of the numbers.
pub(crate) struct Change {
    pub by: Numbers,
    /// The largest share of sigma in it, or a bound of it below [`MOVED`].
    pub farthest: f64,
}

/// The last interval.
#[derive(Clone, Copy)]
struct Step {
    from: FlexibleState,
    interval: Interval,
}

/// Recursive estimate of mass properties.
///
/// `N` is the number of columns that it has room for (a configuration that needs more is refused with their number), `WINDOW` the
/// number of samples that are replayed at the beginning.
#[derive(Debug, Clone)]
pub struct Filter<const N: usize, const WINDOW: usize> {
    pub(crate) configuration: Configuration,
    pub(crate) layout: Layout,
    /// Numbers about which the motion is linearised.
    pub(crate) numbers: Numbers,
    pub(crate) rows: Rows<N>,
    work: Rows<N>,
    /// Of the last interval.
    columns: Columns,
    pub(crate) scratch: Scratch,
    pub(crate) gate: f64,
    /// Share of the prior that the motion is loosened by, see [`Self::momentum_noise`].
    pub(crate) looseness: f64,
    /// What of the angular velocity the record has shown.
    pub(crate) shown: Excitation,
    /// What was known of the parameters when the motion began, and how often it began without going on.
    before_start: OfParameters,
    pub(crate) starts: u32,
    /// Up to when the parameters were forgotten, s.
    pub(crate) known_s: Option<f64>,
    /// Prior sigma of each number, zero where it is exact.
    pub(crate) prior_sigma: Numbers,
    /// The largest of mass, first moments and inertia.
    prior_spread: [f64; 3],
    pub(crate) running: Option<Running>,
    pub(crate) window: Window<WINDOW>,
    pub(crate) stream: Stream,
    pub(crate) course: Course,
    pub(crate) tests: Tests,
    pub(crate) checkpoints: Checkpoints,
}

/// Three rows of a measurement.
struct Measurement<const N: usize> {
    sensor: usize,
    rows: [[f64; N]; AXES],
}

/// The motion in hand with what its measurements depend on.
pub(crate) struct Here {
    /// Angular velocity at the inputs in hand.
    rate: Vector3,
    /// That at which columns are taken, and its state.
    pub motion: FlexibleMotion,
    state: FlexibleState,
    R: Matrix3,
}

impl Here {
    /// The vehicle as it was placed last.
    pub fn placed<'a>(&'a self, scratch: &'a Scratch) -> Placed<'a> {
        let flexing = scratch.flexing[0].as_ref();
        Placed {
            posture: &scratch.posture,
            motion: &self.motion,
            modes: flexing.map(|f| (&f.flexible, &self.state.internal)),
        }
    }
}

impl<const N: usize, const WINDOW: usize> Filter<N, WINDOW> {
    /// A filter without a vehicle: what static memory begins with, before [`Self::restart`]. All its bits are zero, so neither the
    /// program's image nor its stack has to hold it. No number of it is determined.
    pub const IDLE: Self = Self {
        configuration: Configuration::NONE,
        layout: Layout::NONE,
        numbers: [0.0; NUMBERS],
        rows: [[0.0; N]; N],
        work: [[0.0; N]; N],
        columns: Columns::NONE,
        scratch: Scratch::NONE,
        gate: 0.0,
        looseness: 0.0,
        shown: Excitation::NONE,
        before_start: OfParameters::NONE,
        starts: 0,
        known_s: None,
        prior_sigma: [0.0; NUMBERS],
        prior_spread: [0.0; 3],
        running: None,
        window: Window::NEW,
        stream: Stream::NEW,
        course: Course::NEW,
        tests: Tests::NONE,
        checkpoints: Checkpoints::NONE,
    };

    /// A filter before its first sample.
    ///
    /// # Errors
    /// The configuration is invalid, or needs more columns than `N`.
    pub fn new(configuration: Configuration) -> Result<Self, Invalid> {
        let mut filter = Self::IDLE;
        filter.restart(&configuration)?;
        Ok(filter)
    }

    /// Begins anew with a configuration, in place.
    ///
    /// # Errors
    /// The configuration is invalid, or needs more columns than `N`. The filter is as before.
    ///
    /// ```
    /// use poinsot_onboard::{Configuration, Filter, Health, Invalid, Noise};
    ///
    /// let noise = Noise { gyro: 1e-4, attitude: 1e-4, position: 0.0, bias: 1e-4, bias_walk: 0.0, torque_walk: 0.0 };
    /// let cube = [6.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    /// let mut filter = Filter::<24, 150>::IDLE;
    /// assert_eq!(filter.answer(0.0).health, Health::Inconsistent);
    /// filter.restart(&Configuration::new(cube, noise))?;
    /// assert_eq!(filter.answer(0.0).health, Health::Converging);
    /// # Ok::<(), Invalid>(())
    /// ```
    pub fn restart(&mut self, configuration: &Configuration) -> Result<(), Invalid> {
        configuration.check(N)?;
        self.configuration = *configuration;
        self.layout = Layout::new(configuration);
        self.numbers = configuration.nominal;
        self.gate = GATE;
        self.looseness = 0.0;
        self.shown = Excitation::new();
        self.starts = 0;
        self.window.restart();
        (self.stream, self.course) = (Stream::NEW, Course::NEW);
        self.tests = Tests::new(configuration.forget_s > 0.0);
        let prior = OfParameters::of(configuration.prior);
        self.before_start = prior;
        self.checkpoints.begin(&self.numbers, &prior);
        (self.prior_sigma, self.prior_spread) = ([0.0; NUMBERS], [0.0; 3]);
        let sigma = prior.sigma(self.layout.numbers);
        for (&k, sigma) in self.layout.numbers().iter().zip(&sigma) {
            self.prior_sigma[k] = *sigma;
        }
        for (&k, sigma) in self.layout.unknown().iter().zip(&sigma) {
            let kind = usize::from(k > 0) + usize::from(k > AXES);
            self.prior_spread[kind] = self.prior_spread[kind].max(*sigma);
        }
        self.set_prior();
        for place in &mut self.scratch.flexing {
            *place = (configuration.mode_count > 0).then(Flexing::default);
        }
        Ok(())
    }

    /// What is known of the sensors' innovations, in the order gyro, attitude, position.
    pub fn counts(&self) -> [SensorCounts; SENSORS] {
        self.tests.counts()
    }

    /// Information about the parameters alone, whatever the motion.
    pub(crate) fn of_parameters(&self) -> OfParameters {
        let (first, count) = (self.layout.theta(), self.layout.numbers);
        let mut out = OfParameters::NONE;
        for i in 0..count {
            let row = &self.rows[first + i];
            for j in i..count {
                out.R[(i, j)] = row[first + j];
            }
            out.z[i] = row[N - 1];
        }
        out
    }

    /// The most likely change of the numbers, and the largest share of sigma in it: of the unknown numbers where the known ones are given,
    /// of these beside all others.
    // What is copied of the triangle is not on the stack of what follows, here and in the next functions.
    #[inline(never)]
    pub(crate) fn change(&self) -> Option<Change> {
        let (unknown, numbers) = (self.layout.unknown, self.layout.numbers);
        let info = self.of_parameters();
        let by = info.solution(numbers)?;
        // The norm bounds the shares, without a covariance.
        let norm = info.whitened(&by, unknown).max(info.whitened(&by, numbers));
        let mut farthest = norm.sqrt();
        if farthest > MOVED {
            let mut sigma = info.sigma(numbers);
            sigma[..unknown].copy_from_slice(&info.sigma(unknown)[..unknown]);
            let shares = by.iter().zip(&sigma).take(numbers);
            farthest = shares.fold(0.0, |most: f64, (x, s)| most.max((x / s).abs()));
        }
        Some(Change { by, farthest })
    }

    /// Remembers what is known where a motion begins.
    #[inline(never)]
    fn remember(&mut self) {
        self.before_start = self.of_parameters();
    }

    /// Knows what it knew there, without a motion.
    #[inline(never)]
    fn begin_again(&mut self) {
        let before = self.before_start;
        self.set_parameters(&before);
    }

    /// The prior at the parameters in hand, without a motion.
    #[inline(never)]
    pub(crate) fn set_prior(&mut self) {
        let configuration = &self.configuration;
        let mut prior = OfParameters::of(configuration.prior);
        let nominal = &configuration.nominal;
        for i in 0..self.layout.numbers {
            let off = self.layout.numbers().iter().enumerate().skip(i);
            prior.z[i] = off
                .map(|(j, &k)| prior.R[(i, j)] * (nominal[k] - self.numbers[k]))
                .sum();
        }
        self.known_s = None;
        self.set_parameters(&prior);
    }

    /// Forgets the motion, and knows this of the parameters.
    pub(crate) fn set_parameters(&mut self, info: &OfParameters) {
        let (first, count) = (self.layout.theta(), self.layout.numbers);
        self.rows = [[0.0; N]; N];
        for i in 0..count {
            let row = &mut self.rows[first + i];
            for j in i..count {
                row[first + j] = info.R[(i, j)];
            }
            row[N - 1] = info.z[i];
        }
        self.running = None;
    }

    /// Follows a motion over an interval, with its columns.
    fn follow(
        &mut self,
        from: &FlexibleState,
        interval: &Interval,
        over: Over,
    ) -> Option<FlexibleState> {
        let moving = Moving::new(&self.configuration, &self.numbers);
        let linear = Linear {
            columns: &mut self.columns,
            shown: &self.shown,
            scratch: &mut self.scratch,
            over,
        };
        moving.follow(from, interval, linear)
    }

    /// Begins to follow a motion at a sample that has all that it takes.
    fn start(&mut self, sample: &Sample) -> Option<()> {
        let R_NB = sample.rotation()? * self.mounting().inverse();
        let w = Vector3::from(sample.gyro?);
        let p_NoBo_N = match self.configuration.translates() {
            true => Vector3::from(sample.position?),
            false => Vector3::zeros(),
        };
        let inputs = sample.inputs();
        let moving = Moving::new(&self.configuration, &self.numbers);
        let posture = moving.posture(&inputs);
        let whole = posture.whole.mass_properties()?;
        let (l, h) = (linear(&posture.momentum), angular(&posture.momentum));
        let h = h + moving.wheel_momentum(&inputs);
        let h_B = whole.I_BBcm_B * w + h - whole.p_BoBcm_B.cross(&l);
        let mut state = FlexibleState::from(PoseMomentum {
            R_NB,
            p_NoBo_N,
            P: Vector3::zeros(),
            h_SScm_N: R_NB * h_B,
        });
        let flexing = &mut self.scratch.flexing[0];
        moving.place(&posture, &Acting::zeros(), flexing)?;
        if let Some(flexing) = flexing {
            state.internal = flexing.flexible.at_rest(&w);
        }
        self.running = Some(Running {
            time_s: sample.time_s,
            state,
            bias: Vector3::zeros(),
            rate: w,
            read: inputs,
            inputs,
            force_B: sample.force_B.into(),
            torque_B: sample.torque_B.into(),
            age: 0,
        });
        self.shown.start();
        self.shown.watch(&self.configuration, sample);
        self.remember();
        let layout = self.layout;
        self.rows[..layout.theta()].fill([0.0; N]);
        for k in 0..layout.inputs().len() {
            self.rows[k][k] = 1.0;
        }
        // An exact gyro has a bias of nothing.
        let of_bias = 1.0 / self.configuration.noise.bias.max(f64::EPSILON);
        for k in layout.bias()..layout.theta() {
            self.rows[k][k] = of_bias;
        }
        let of_rate = 1.0 / (SWINGING * (whole.I_BBcm_B.trace() / 3.0).sqrt());
        for (k, mode) in self.configuration.modes().iter().enumerate() {
            let at = layout.internal() + 2 * k;
            self.rows[at][at] = of_rate * TAU * mode.frequency_Hz;
            self.rows[at + 1][at + 1] = of_rate;
        }
        Some(())
    }

    /// Takes a sample that is in order, and what lies before it; `None` where the numbers do not allow it.
    pub(crate) fn take(&mut self, sample: &Sample, bend: Bend) -> Option<()> {
        if self.configuration.forget_s > 0.0 {
            let before = self.known_s.replace(sample.time_s);
            let elapsed = before.map(|before| sample.time_s - before);
            if let Some(dt) = elapsed.filter(|dt| *dt > 0.0) {
                self.forget(dt);
            }
        }
        if self
            .running
            .is_some_and(|r| sample.time_s - r.time_s > self.configuration.longest_gap_s)
        {
            self.rows[..self.layout.theta()].fill([0.0; N]);
            self.running = None;
        }
        let mut step = None;
        if self.running.is_some() {
            step = Some(self.advance(sample, bend)?);
        } else if self.start(sample).is_none() {
            // Without a start there is nothing to update.
            return Some(());
        }
        self.measure(sample, step)?;
        match self.running {
            Some(_) => self.follow_estimate(),
            None => Some(()),
        }
    }

    /// Follows the motion to the time of a sample.
    fn advance(&mut self, sample: &Sample, bend: Bend) -> Option<Step> {
        let mut running = self.running?;
        let from = running.state;
        let inputs = sample.inputs();
        let interval = Interval {
            read: [running.read, inputs],
            found: [running.found(), [0.0; INPUTS]],
            bend,
            force_B: running.force_B,
            torque_B: running.torque_B,
            dt: sample.time_s - running.time_s,
        };
        self.shown.watch(&self.configuration, sample);
        let layout = self.layout;
        running.state = self.follow(&from, &interval, Over::State(layout.state()))?;
        running.time_s = sample.time_s;
        (running.read, running.inputs) = (inputs, inputs);
        running.force_B = sample.force_B.into();
        running.torque_B = sample.torque_B.into();
        running.age = running.age.saturating_add(1);
        self.running = Some(running);
        self.update_time(&interval)?;
        Some(Step { from, interval })
    }

    /// The triangle over the state at the end of an interval: the old state is replaced, the noises that entered are eliminated.
    fn update_time(&mut self, interval: &Interval) -> Option<()> {
        match self.layout.state().len() {
            ROTATION => self.update_state::<ROTATION>(interval),
            STATE => self.update_state::<STATE>(interval),
            _ => self.update_state::<COLUMN>(interval),
        }
    }

    /// The same with a state of at most `D` components.
    fn update_state<const D: usize>(&mut self, interval: &Interval) -> Option<()> {
        let layout = self.layout;
        let (noise, dt) = (self.configuration.noise, interval.dt);
        let inputs = layout.inputs().len();
        let of_mean = interval.bend.of_mean() * dt;
        let means = if of_mean > 0.0 { layout.wheels() } else { 0 };
        let entered = inputs + noises(&self.configuration);
        let gone = entered + means;
        let here = self.here()?;
        let twists = here.placed(&self.scratch).input_twists(&self.configuration);
        let twists = twists.map(|t| angular(&t));
        let theta = layout.theta();
        let back = self.columns.inverse::<D>(&layout.state)?;
        let walk = dt.abs().sqrt();
        let [turn, shift] = self.momentum_noise(interval);
        let end = theta + layout.numbers;
        for (row, out) in self.rows[..theta].iter().zip(&mut self.work) {
            *out = [0.0; N];
            let state = layout.of_row(row);
            let of_row = SVector::<f64, D>::from_fn(|k, _| state.get(k).copied().unwrap_or(0.0));
            let over = back.tr_mul(&of_row);
            let (start, of_bias) = (gone + layout.pose(), &row[layout.bias()..theta]);
            let part = |first: usize| over.as_slice().get(first..).unwrap_or_default();
            let entering = [
                (true, part(OF_TURN), turn),
                (self.configuration.translates(), part(OF_SHIFT), shift),
                (noise.bias_walk > 0.0, of_bias, noise.bias_walk * walk),
            ];
            let entering = entering.iter().filter(|(counts, ..)| *counts);
            let places = out[inputs..entered].chunks_exact_mut(AXES);
            for (places, (_, slopes, sigma)) in places.zip(entering) {
                for (place, slope) in places.iter_mut().zip(*slopes) {
                    *place = -slope * sigma;
                }
            }
            out[start..start + state.len()].copy_from_slice(&over.as_slice()[..state.len()]);
            out[gone + layout.bias()..gone + end].copy_from_slice(&row[layout.bias()..end]);
            out[N - 1] = row[N - 1];
        }
        for (k, &input) in layout.inputs().iter().enumerate() {
            let [from, to] = [0, 1].map(|at| layout.of_column(&self.columns.inputs[at][input]));
            let twist = twists[input].as_slice();
            for (row, out) in self.rows[..theta].iter().zip(&mut self.work) {
                let state = &out[gone + layout.pose()..gone + layout.bias()];
                let (of_from, of_to) = (dot(state, &from), dot(state, &to));
                let of_turn = dot(state, twist);
                if k < means {
                    out[entered + k] = -of_turn * of_mean;
                }
                (out[k], out[gone + k]) = (row[k] - of_from, -of_to);
            }
        }
        // The noises of unit size: those of the inputs at the end, which stay, and those that go.
        for k in 0..gone {
            let out = &mut self.work[theta + k];
            *out = [0.0; N];
            out[if k < inputs { gone + k } else { k }] = 1.0;
        }
        self.take_out(gone, theta);
        Some(())
    }

    /// Lets the parameters walk for a time, s.
    fn forget(&mut self, dt: f64) {
        let (theta, count) = (self.layout.theta(), self.layout.unknown);
        let columns = self.layout.columns();
        let prior = OfParameters::of(self.configuration.prior);
        let mut walk = [[0.0; NUMBERS]; PARAMETERS];
        walk.iter_mut()
            .zip(prior.inverse(count))
            .for_each(|(to, column)| *to = column);
        let share = (dt / self.configuration.forget_s).sqrt();
        for k in 0..count {
            self.work[k] = [0.0; N];
            self.work[k][k] = 1.0;
        }
        for (row, out) in self.rows[..columns].iter().zip(&mut self.work[count..]) {
            *out = [0.0; N];
            for k in 0..count {
                let of_noise = (0..=k).map(|j| row[theta + j] * walk[k][j]);
                out[k] = -share * of_noise.sum::<f64>();
            }
            out[count..count + columns].copy_from_slice(&row[..columns]);
            out[N - 1] = row[N - 1];
        }
        self.take_out(count, columns);
    }

    /// Eliminates so many noises, the first columns of `work`, which has a row for each of them beside `rows` others: these become the
    /// first of the triangle.
    fn take_out(&mut self, noises: usize, rows: usize) {
        let columns = self.layout.columns();
        let end = noises + rows;
        let width = noises + columns;
        eliminate(&mut self.work, 0..end, |pivot| pivot + 1..end, width);
        for (i, (row, out)) in self.work[noises..end]
            .iter()
            .zip(&mut self.rows)
            .enumerate()
        {
            out[i..columns].copy_from_slice(&row[noises + i..noises + columns]);
            out[N - 1] = row[N - 1];
        }
    }

    /// Noise of angular and linear momentum that enters over an interval: the declared one, and in the first passes of a replay what
    /// the errors of the parameters do, so that the motion follows the data.
    fn momentum_noise(&self, interval: &Interval) -> [f64; 2] {
        let dt = interval.dt.abs();
        let declared = self.configuration.noise.torque_walk * dt.sqrt();
        let Some(running) = self.running.filter(|_| self.looseness > 0.0) else {
            return [declared, 0.0];
        };
        let moving = Moving::new(&self.configuration, &self.numbers);
        let posture = moving.posture(&running.inputs);
        let force = running.force_B.norm();
        let [mass, moment, inertia] = self.prior_spread;
        let per_mass = force / posture.whole.mass;
        // Rates of joints turn what they carry, and their changes do at once.
        let joints = of_rate(0)..INPUTS;
        let size = |rates: &[f64]| rates.iter().map(|rate| rate * rate).sum::<f64>();
        let [from, to] = interval.read;
        let changes: [f64; INPUTS] = core::array::from_fn(|k| to[k] - from[k]);
        let (turn, jump) = (size(&to[joints.clone()]), size(&changes[joints]));
        let reach = posture.unknown.p.norm();
        let inertia = inertia + reach * (2.0 * moment + reach * mass);
        let torque = inertia * (running.rate.norm_squared() + turn) + moment * per_mass;
        let loose = self.looseness * dt;
        let jump = self.looseness * inertia * jump.sqrt();
        [
            declared.hypot(loose * torque).hypot(jump),
            loose * mass * per_mass,
        ]
    }

    /// The motion in hand.
    pub(crate) fn here(&mut self) -> Option<Here> {
        let running = self.running.as_mut()?;
        let moving = Moving::new(&self.configuration, &self.numbers);
        let scratch = &mut self.scratch;
        let (posture, flexing) = (&mut scratch.posture, &mut scratch.flexing[0]);
        let mut place = |inputs: &[f64; INPUTS]| {
            posture.set(&self.configuration, &self.numbers, inputs);
            let locked = moving.place(posture, &Acting::zeros(), flexing)?;
            let flexible = flexing.as_ref().map(|f| &f.flexible);
            motion_of(&locked, flexible, &running.state)
        };
        let mut motion = place(&running.inputs)?;
        running.rate = motion.twist.w;
        let calm = self.shown.calm(&running.inputs);
        if calm != running.inputs {
            motion = place(&calm)?;
        }
        Some(Here {
            rate: running.rate,
            state: running.state,
            R: running.state.R_NB.to_rotation_matrix().into_inner(),
            motion,
        })
    }

    /// From the attitude sensor to B.
    fn mounting(&self) -> UnitQuaternion<f64> {
        let turn = Vector3::from_fn(|axis, _| self.numbers[MOUNTING + axis]);
        UnitQuaternion::from_scaled_axis(turn)
    }

    fn slopes<'a>(&'a self, here: &'a Here) -> Slopes<'a> {
        let placed = here.placed(&self.scratch);
        Slopes::new(&self.configuration, placed, &self.shown)
    }

    /// Makes of a triangle over momenta and numbers one over rates and numbers; with a sign of -1 back again.
    fn over_rates(&mut self, here: &Here, sign: f64) {
        let layout = self.layout;
        let slopes = Slopes::new(&self.configuration, here.placed(&self.scratch), &self.shown);
        let theta = layout.theta();
        for (j, &k) in layout.numbers().iter().enumerate() {
            // What the number does to the momenta, pose and rates held, as a change of the state.
            let slope = slopes.of(k);
            let (l, h) = (linear(&slope.momentum), angular(&slope.momentum));
            let mut out = Column::zeros();
            out.fixed_rows_mut::<AXES>(LINEAR).copy_from(&(here.R * l));
            out.fixed_rows_mut::<AXES>(ANGULAR).copy_from(&(here.R * h));
            for (mode, momentum) in slope.of_modes.iter().enumerate() {
                out[STATE + 2 * mode + 1] = *momentum;
            }
            let out = layout.of_column(&out);
            for row in &mut self.rows[..theta] {
                row[theta + j] += sign * dot(layout.of_row(row), &out);
            }
        }
    }

    /// All measurements of a sample.
    fn measure(&mut self, sample: &Sample, step: Option<Step>) -> Option<()> {
        let age = self.running?.age;
        let mut consistent = true;
        // Before, not all of the state is known.
        if let Some(gyro) = sample.gyro.filter(|_| age >= SETTLING) {
            self.smooth_inputs(gyro.into())?;
        }
        if let Some(step) = step {
            self.add_numbers(step)?;
        }
        if let Some(gyro) = sample.gyro {
            let measurement = self.gyro(gyro.into())?;
            consistent &= self.update(&measurement, age);
        }
        let running = self.running?;
        if let Some(R_NB) = sample.rotation() {
            let expected = running.state.R_NB * self.mounting();
            let residual = (expected.inverse() * R_NB).scaled_axis();
            let noise = self.configuration.noise.attitude;
            let mut measurement = self.rows_of(1, &residual, noise);
            let layout = self.layout;
            let mountings = layout.mountings();
            for (axis, row) in measurement.rows.iter_mut().enumerate() {
                row[layout.pose() + axis] = 1.0 / noise;
                if let Some(place) = mountings.clone().nth(axis) {
                    row[place] = 1.0 / noise;
                }
            }
            consistent &= self.update(&measurement, running.age);
        }
        if let (Some(position), true) = (sample.position, self.configuration.translates()) {
            let residual = Vector3::from(position) - running.state.p_NoBo_N;
            let noise = self.configuration.noise.position;
            let mut measurement = self.rows_of(2, &residual, noise);
            // After attitude and angular momentum.
            let first = self.layout.pose() + 2 * AXES;
            for (axis, row) in measurement.rows.iter_mut().enumerate() {
                row[first + axis] = 1.0 / noise;
            }
            consistent &= self.update(&measurement, running.age);
        }
        if !consistent && running.age < SETTLING {
            // One of the samples that the motion began with is far off, and there is no telling which: the next one begins, a few
            // times.
            self.begin_again();
            self.starts += 1;
            return (self.starts <= STARTS).then_some(());
        }
        if running.age >= SETTLING {
            self.starts = 0;
        }
        Some(())
    }

    /// Rows without slopes.
    fn rows_of(&self, sensor: usize, residual: &Vector3, noise: f64) -> Measurement<N> {
        let mut rows = [[0.0; N]; AXES];
        for (row, residual) in rows.iter_mut().zip(residual) {
            row[N - 1] = residual / noise;
        }
        Measurement { sensor, rows }
    }

    /// Moves the inputs to the most likely ones that their sensors and the gyro give together.
    ///
    /// The angular velocity at the speeds of tachometers and encoders has their noise, and so has the gyro's innovation about it. Slopes
    /// over the inertia at that velocity are correlated with the innovation, which biases the estimate by a share of its sigma that
    /// grows with the root of the number of samples. At the most likely inputs they are not correlated.
    fn smooth_inputs(&mut self, measured: Vector3) -> Option<()> {
        let inputs = self.layout.inputs().len();
        if inputs == 0 {
            return Some(());
        }
        let measurement = self.gyro(measured)?;
        let mut change = [0.0; N];
        let size = self.weigh(&measurement).norm_squared();
        let (none, state) = ([0.0; NUMBERS], 0..self.layout.theta());
        if size <= self.gate && back_substitute(&self.work, state, &none, &mut change).is_some() {
            self.move_inputs(&change)?;
            for row in &mut self.rows[..inputs] {
                let moved = row.iter().zip(&change).take(inputs);
                row[N - 1] -= moved.map(|(slope, x)| slope * x).sum::<f64>();
            }
        }
        Some(())
    }

    /// Adds what the numbers do over the last interval, linearised about the inputs found at its end.
    fn add_numbers(&mut self, mut step: Step) -> Option<()> {
        step.interval.found[1] = self.running?.found();
        self.follow(&step.from, &step.interval, Over::Numbers)?;
        let (layout, columns) = (self.layout, &self.columns.numbers);
        let theta = layout.theta();
        for (j, &k) in layout.numbers().iter().enumerate() {
            let column = layout.of_column(&columns[k]);
            for row in &mut self.rows[..theta] {
                row[theta + j] -= dot(layout.of_row(row), &column);
            }
        }
        Some(())
    }

    /// Moves the inputs by so many sigma.
    fn move_inputs(&mut self, change: &[f64; N]) -> Option<()> {
        let inputs = &mut self.running.as_mut()?.inputs;
        for (&k, x) in self.layout.inputs().iter().zip(change) {
            inputs[k] += self.configuration.input_noise(k) * x;
        }
        Some(())
    }

    fn gyro(&mut self, measured: Vector3) -> Option<Measurement<N>> {
        let here = self.here()?;
        let running = self.running?;
        let (layout, motion) = (self.layout, &here.motion);
        let noise = self.configuration.noise.gyro;
        let residual = measured - here.rate - running.bias;
        let mut out = self.rows_of(0, &residual, noise);
        let mut map = motion.twist_rows(&running.state);
        if let Some(Flexing { flexible, rows, .. }) = &mut self.scratch.flexing[0] {
            flexible.rows(motion, &running.state, (&mut map, rows), &Vector3::zeros());
        }
        let over_state = map.matrix();
        let of_modes = self.scratch.flexing[0].as_ref().map(|f| &f.rows.twist);
        let slope = |row: usize, component: usize| match component.checked_sub(STATE) {
            None => over_state[(row, component)],
            Some(k) => of_modes.map_or(0.0, |twist| twist[k][row]),
        };
        let inputs = here.placed(&self.scratch).input_twists(&self.configuration);
        let inputs = inputs.map(|t| angular(&t));
        let slopes = self.slopes(&here);
        for (j, &k) in layout.numbers().iter().enumerate() {
            let turn = angular(&slopes.of(k).change.twist);
            for (row, turn) in out.rows.iter_mut().zip(&turn) {
                row[layout.theta() + j] = turn / noise;
            }
        }
        for (axis, row) in out.rows.iter_mut().enumerate() {
            for (k, &input) in layout.inputs().iter().enumerate() {
                row[k] = inputs[input][axis] / noise;
            }
            for (k, component) in layout.state().iter().enumerate() {
                row[layout.pose() + k] = slope(AXES + axis, *component) / noise;
            }
            row[layout.bias() + axis] = 1.0 / noise;
        }
        Some(out)
    }

    /// The triangle with the rows of a measurement, in `work`; what no change of the state explains: the whitened innovation.
    fn weigh(&mut self, measurement: &Measurement<N>) -> Vector3 {
        let columns = self.layout.columns();
        copy_triangle(&self.rows, &mut self.work, columns);
        self.work[columns..columns + AXES].copy_from_slice(&measurement.rows);
        let below = |_| columns..columns + AXES;
        eliminate(&mut self.work, 0..columns, below, columns);
        Vector3::from_fn(|axis, _| self.work[columns + axis][N - 1])
    }

    /// Adds the rows of a measurement, unless its innovation is too large to be noise; whether it did.
    fn update(&mut self, measurement: &Measurement<N>, age: u32) -> bool {
        let columns = self.layout.columns();
        let innovation = self.weigh(measurement);
        let accepted = innovation.norm_squared() <= self.gate;
        if accepted {
            copy_triangle(&self.work, &mut self.rows, columns);
        }
        if age >= SETTLING {
            self.tests
                .add(measurement.sensor, innovation.as_ref(), accepted);
        }
        accepted
    }

    /// Moves the motion to the most likely one at the present parameters.
    fn follow_estimate(&mut self) -> Option<()> {
        let none = [0.0; NUMBERS];
        let mut change = [0.0; N];
        // At the beginning not all of the state is known.
        if back_substitute(&self.rows, 0..self.layout.theta(), &none, &mut change).is_none() {
            return Some(());
        }
        let numbers = self.numbers;
        self.shift(&change, numbers)?;
        for row in &mut self.rows[..self.layout.theta()] {
            row[N - 1] = 0.0;
        }
        Some(())
    }

    /// Moves the parameters to their estimate where they moved by more than a tenth of a sigma, and the motion with them.
    pub(crate) fn follow_parameters(&mut self) -> Option<()> {
        let change = self.change()?;
        if change.farthest <= MOVED {
            return Some(());
        }
        let mut numbers = self.numbers;
        for (&k, change) in self.layout.numbers().iter().zip(&change.by) {
            numbers[k] += change;
        }
        let mut of_state = [0.0; N];
        let state = 0..self.layout.theta();
        let known = back_substitute(&self.rows, state, &change.by, &mut of_state);
        // An impossible vehicle has no motion: the last possible one stays the point of linearisation.
        if known.is_none() || !self.configuration.is_possible(&numbers) {
            return Some(());
        }
        self.shift(&of_state, numbers)?;
        let first = self.layout.theta();
        for row in &mut self.rows[first..self.layout.columns()] {
            row[N - 1] = 0.0;
        }
        Some(())
    }

    /// Moves the point of linearisation, and the triangle with it.
    ///
    /// What is known of a momentum came from rates: `h = I(theta) w + ...` is linear in the parameters at a known rate. So the
    /// triangle is the same over rates and parameters before and after, not over momentum and parameters. With it directions
    /// of which the data know nothing keep their prior, however often the point moves: a common factor of inertia and momentum in
    /// free rotation, of mass and momentum without a force.
    fn shift(&mut self, change: &[f64; N], numbers: Numbers) -> Option<()> {
        // An error of an input is white: what is known of the momentum does not follow it.
        self.move_inputs(change)?;
        let here = self.here()?;
        self.over_rates(&here, 1.0);
        let moved: Numbers = core::array::from_fn(|k| numbers[k] - self.numbers[k]);
        let moves = moved != [0.0; NUMBERS];
        let before = moves.then(|| self.scratch.posture.inertia_slopes(&here.motion));
        let layout = self.layout;
        let running = self.running.as_mut()?;
        let mut state = Column::zeros();
        for (component, x) in layout.state().iter().zip(layout.of_row(change)) {
            state[*component] = *x;
        }
        let part = |first: usize| Vector3::new(state[first], state[first + 1], state[first + 2]);
        let of_state = &mut running.state;
        of_state.R_NB *= UnitQuaternion::from_scaled_axis(part(0));
        of_state.R_NB.renormalize_fast();
        of_state.p_NoBo_N += part(AXES);
        of_state.P += part(LINEAR);
        of_state.h_SScm_N += part(ANGULAR);
        of_state.internal += state.fixed_rows::<INTERNAL>(STATE);
        for axis in 0..AXES {
            running.bias[axis] += change[layout.bias() + axis];
        }
        self.numbers = numbers;
        let there = self.here()?;
        self.shown
            .add(&self.configuration, &there.placed(&self.scratch));
        let Some(before) = before else {
            self.over_rates(&there, -1.0);
            return Some(());
        };
        let carried = self.carried(&moved, (&here, &before), &there)?;
        // A common factor of inertia and wheels may be what does not show.
        let mut shares = [0.0; PARAMETERS];
        let (I, R) = (
            &there.motion.centre.I_SScm_B,
            &self.scratch.posture.unknown.R,
        );
        shares[AXES + 1..].copy_from_slice(&self.shown.shares(I, R));
        let theta = layout.theta();
        for row in &mut self.rows[..layout.columns()] {
            let mut body = SVector::<f64, PARAMETERS>::zeros();
            let mut of_wheels = 0.0;
            for (&k, slope) in layout.numbers().iter().zip(&row[theta..]) {
                match k {
                    0..PARAMETERS => body[k] = *slope,
                    MOUNTING.. => {}
                    _ => of_wheels += slope * moved[k],
                }
            }
            let change = carried.tr_mul(&body);
            for (&k, slope) in layout.unknown().iter().zip(&mut row[theta..]) {
                *slope += change[k] - of_wheels * shares[k];
            }
        }
        self.over_rates(&there, -1.0);
        // The parameters' own rows are no triangle any more.
        let end = layout.columns();
        eliminate(&mut self.rows, theta..end, |pivot| pivot + 1..end, end);
        Some(())
    }

    /// What becomes of rows over rates and parameters where the parameters move, less the rows themselves.
    ///
    /// In free rotation the parameters show in the inertia about the mass centre alone, of which they are no linear function, and a common
    /// factor of it does not show. Rows that follow from such an inertia follow from the new one. Where the position is measured, so
    /// that all parameters show, common factors of inertia and of mass and first moments stay as they are.
    // Its matrices are not on the stack of every sample.
    #[inline(never)]
    fn carried(
        &self,
        moved: &Numbers,
        (here, old): (&Here, &InertiaSlopes),
        there: &Here,
    ) -> Option<TenByTen> {
        let I = &there.motion.centre.I_SScm_B;
        let posture = &self.scratch.posture;
        let R = &posture.unknown.R;
        if self.configuration.translates() {
            let mut scales = [0.0; PARAMETERS];
            scales[0] = 1.0 / self.numbers[0];
            scales[AXES + 1..].copy_from_slice(&self.shown.shares(I, R));
            return Some(TenByTen::from_fn(|k, l| match (k > AXES) == (l > AXES) {
                true => -moved[k] * scales[l],
                false => 0.0,
            }));
        }
        let new = posture.inertia_slopes(&there.motion);
        let sigma = SVector::<f64, PARAMETERS>::from_fn(|k, _| self.prior_sigma[k]);
        let scaled = old * TenByTen::from_diagonal(&sigma);
        let eigen = SymmetricEigen::try_new(scaled * scaled.transpose(), f64::EPSILON, ITERATIONS)?;
        let smallest = ROUND_OFF * eigen.eigenvalues.max();
        let inverse = eigen
            .eigenvalues
            .map(|x| if x > smallest { 1.0 / x } else { 0.0 });
        let inverse = eigen.eigenvectors
            * SMatrix::<f64, 6, 6>::from_diagonal(&inverse)
            * eigen.eigenvectors.transpose();
        let back = TenByTen::from_diagonal(&sigma) * scaled.transpose() * inverse;
        let by = Vector6::from(elements(&(I - here.motion.centre.I_SScm_B)));
        let shares = Vector6::from(self.shown.shares(I, &Matrix3::identity()));
        Some(back * (new - old - by * (shares.transpose() * new)))
    }
}
