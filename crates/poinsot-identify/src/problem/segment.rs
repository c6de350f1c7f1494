//! One segment of telemetry, aligned on the gyro's times, for the linear method.

use super::error_process::ErrorProcess;
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_model::{SensorKind, SlowError};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

/// Samples of one segment at common times. All arrays have one entry per time unless said otherwise.
#[derive(Debug, Clone, Default)]
pub struct Samples {
    /// Times, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// Attitude of the base.
    pub R_NB: Vec<UnitQuaternion>,
    /// Angular velocity of the base in B, rad/s.
    pub w_NB_B: Vec<Vector3>,
    /// Motion of the base origin; `None` without a translation sensor.
    pub translation: Option<Translation>,
    /// Joint positions, rad or m; one row of `dof` per time.
    pub joint_position: Vec<f64>,
    /// Joint rates, rad/s or m/s; one row of `dof` per time.
    pub joint_rate: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s; one row of `wheels` per time.
    pub wheel_speed: Vec<f64>,
}

impl Samples {
    /// The bodies at the first sample; all joints at zero without samples of them.
    pub(crate) fn first_placement(&self, tree: &Tree) -> Kinematics {
        let q = self.joint_position.get(..tree.dof());
        q.map_or_else(|| Kinematics::new(tree), |q| Kinematics::at(tree, q))
    }
}

/// Motion of the base origin.
#[derive(Debug, Clone, Default)]
pub struct Translation {
    /// Velocity in N, m/s.
    pub v_NBo_N: Vec<Vector3>,
    /// Position in N, m, from the place of the first sample.
    pub p_NoBo_N: Vec<Vector3>,
}

/// One thruster held at one force, `[start, end)` in the time of the segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Firing {
    /// Index of the thruster.
    pub thruster: usize,
    /// Start, s.
    pub start_s: f64,
    /// End, s.
    pub end_s: f64,
    /// Force along the thruster's direction, N.
    pub force: f64,
}

impl Firing {
    /// Impulse up to a time, N s.
    pub(crate) fn impulse_by(&self, time_s: f64) -> f64 {
        self.force * (time_s.min(self.end_s) - self.start_s).max(0.0)
    }
}

/// One measured value, SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorValue {
    /// Three components: of a rate or a specific force in the axes of the sensor's body, of a relative position in those of
    /// the body from which it is seen, of all else in N.
    Vector(Vector3),
    /// Attitude of the sensor's body in N, or in the axes of the body from which it is seen.
    Attitude(UnitQuaternion),
    /// Direction of a vector known in N: as seen, in the axes of the sensor's body, and in N; both of length one.
    Direction {
        /// Measured.
        seen_B: Vector3,
        /// Known.
        reference_N: Vector3,
        /// Normal of the plane in which residuals lie: the measured direction. It stays where `seen_B` is replaced by a
        /// prediction, so that the sensitivities of both have the same axes.
        normal_B: Vector3,
    },
}

impl SensorValue {
    /// Direction of a vector known in N, as measured; both of length one.
    pub fn direction(seen_B: Vector3, reference_N: Vector3) -> Self {
        Self::Direction {
            seen_B,
            reference_N,
            normal_B: seen_B,
        }
    }
}

/// One sample of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorSample {
    /// Grid time at which the interval of an increment begins; `to` for every other sensor.
    pub from: usize,
    /// Grid time of the sample.
    pub to: usize,
    /// Value.
    pub value: SensorValue,
}

impl SensorSample {
    /// A value at one grid time.
    pub fn new(at: usize, value: SensorValue) -> Self {
        Self {
            from: at,
            to: at,
            value,
        }
    }
}

/// One sensor in one segment, at its own times.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorRecord {
    /// Name in results: the word of the kind, `<kind>.<sensor>` where several sensors share the kind.
    pub name: String,
    /// Index of the sensor in the model; `None` for columns of no declared sensor.
    pub sensor: Option<usize>,
    /// What it measures.
    pub kind: SensorKind,
    /// Index of the body that carries it.
    pub body: usize,
    /// Index of the body from which a relative kind sees it; 0 for all other kinds.
    pub seen_from: usize,
    /// Place from the body's origin, in the body, m. Positions are from the place of the base origin at the first sample.
    pub p_BoS_B: Vector3,
    /// Covariance of one sample, white and slow noise together, SI squared, in the axes of the value (of an attitude: of the body).
    /// Zero: taken as exact.
    pub covariance: Matrix3,
    /// What lasts over samples, in the same axes: its share of the covariance is no white noise.
    pub slow: Vec<SlowError>,
    /// Samples in the order of `to`.
    pub samples: Vec<SensorSample>,
}

impl SensorRecord {
    /// The same sensor with other samples.
    pub(crate) fn with_samples(&self, samples: impl Iterator<Item = SensorSample>) -> Self {
        let samples = samples.collect();
        Self {
            samples,
            ..self.clone()
        }
    }

    /// The only sensor of its kind, at the origin of the base, with white noise and no samples.
    pub fn of_base(kind: SensorKind, covariance: Matrix3) -> Self {
        Self {
            name: kind.word().to_owned(),
            sensor: None,
            kind,
            body: 0,
            seen_from: 0,
            p_BoS_B: Vector3::zeros(),
            covariance,
            slow: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// The same sensor with one value at every grid time from the first on.
    pub fn at_every_time(mut self, values: impl IntoIterator<Item = SensorValue>) -> Self {
        let samples = values.into_iter().enumerate();
        self.samples = samples
            .map(|(k, value)| SensorSample::new(k, value))
            .collect();
        self
    }

    /// The vector in N whose direction is seen, at the sample nearest to grid time k from there on.
    pub(crate) fn reference_N(&self, k: usize) -> Option<Vector3> {
        let next = self.samples.partition_point(|s| s.to < k);
        match self.samples.get(next).or(self.samples.last())?.value {
            SensorValue::Direction { reference_N, .. } => Some(reference_N),
            _ => None,
        }
    }

    /// Logarithm of the determinant of the covariance of the numbers that one sample tells.
    pub(crate) fn log_det(&self) -> f64 {
        match self.kind.numbers() {
            3 => self.covariance.determinant().ln(),
            // Alike in every sense across the direction.
            n => n as f64 * self.covariance[(0, 0)].ln(),
        }
    }

    /// Covariance of the white noise of one sample.
    pub(crate) fn white(&self) -> Matrix3 {
        let slow = self.slow.iter().map(SlowError::first);
        slow.fold(self.covariance, |c, slow| c - slow)
    }

    /// Grid times and values of its samples that are vectors.
    pub(crate) fn vectors(&self) -> impl Iterator<Item = (usize, Vector3)> {
        self.samples.iter().filter_map(|s| match s.value {
            SensorValue::Vector(v) => Some((s.to, v)),
            _ => None,
        })
    }

    /// The same sensor with this share of all its variances.
    pub(crate) fn scale_noise(&mut self, share: f64) {
        self.covariance *= share;
        self.slow.iter_mut().for_each(|s| s.covariance *= share);
    }

    /// Whether it is taken as exact: its first sample is the start, and no sample is compared.
    pub(crate) fn is_exact(&self) -> bool {
        self.covariance == Matrix3::zeros()
    }
}

/// Samples of every sensor at its own times, on one grid, for maximum likelihood.
///
/// The grid holds the times of all sensors and the edges of all firings. Joints and wheels are inputs and
/// have a value at every time.
#[derive(Debug, Clone, Default)]
pub struct Observations {
    /// Grid, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// Sensors, any number of any kind. Their order decides nothing but the order of the results.
    pub sensors: Vec<SensorRecord>,
    /// Position and velocity of the reference orbit from the attracting body, in N, m and m/s, at every time;
    /// empty without gravity gradient.
    pub orbit: Vec<(Vector3, Vector3)>,
    /// Joint positions, rad or m; one row of `dof` per time.
    pub joint_position: Vec<f64>,
    /// Joint rates, rad/s or m/s; one row of `dof` per time.
    pub joint_rate: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s; one row of `wheels` per time.
    pub wheel_speed: Vec<f64>,
    /// Wheel speeds as a smooth curve through their readings has them, where some are not read at every time; empty
    /// otherwise. `wheel_speed` then runs straight between readings.
    pub smooth_wheel_speed: Vec<f64>,
    /// What is known of each joint as an input; the default where the list is shorter.
    pub joints: Vec<InputChannel>,
    /// The same of each wheel.
    pub wheels: Vec<InputChannel>,
    /// Whether joints or wheels are read at other times than those of the grid, and interpolated.
    pub between_readings: bool,
    /// Where the inputs above are smoothed by the samples of all sensors: what each of their errors is expected to be, the
    /// measured value less the smoothed one, a row per time with the errors in the order of their filter. Empty otherwise.
    pub expected_errors: Vec<f64>,
}

impl Observations {
    /// Whether there are two times or more, inputs at each, and no sample beyond them.
    pub(crate) fn is_whole(&self, dof: usize, wheels: usize) -> bool {
        let n = self.time_s.len();
        let samples = |r: &SensorRecord| {
            let ordered = r.samples.windows(2).all(|w| w[0].to < w[1].to);
            ordered && r.samples.iter().all(|s| s.from <= s.to && s.to < n)
        };
        n >= 2
            && self.sensors.iter().all(samples)
            && self.joint_position.len() == n * dof
            && self.joint_rate.len() == n * dof
            && self.wheel_speed.len() == n * wheels
    }

    /// Whether the inputs are smoothed.
    pub(crate) fn is_smoothed(&self) -> bool {
        !self.expected_errors.is_empty()
    }

    /// Whether the speed of a wheel is smooth at the grid times, where the speeds of wheels are.
    pub(crate) fn is_smooth(&self, wheel: usize, wheels_smooth: bool) -> bool {
        let rate = self.wheel(wheel).rate;
        wheels_smooth && !matches!(rate, InputRate::Straight | InputRate::Random)
    }

    /// Whether its acceleration at a grid time is that of the speeds on both sides.
    pub(crate) fn turns_evenly(&self, wheel: usize, wheels_smooth: bool) -> bool {
        self.is_smooth(wheel, wheels_smooth) || self.wheel(wheel).rate == InputRate::Random
    }

    /// What is known of a joint as an input.
    pub(crate) fn joint(&self, joint: usize) -> &InputChannel {
        self.joints.get(joint).unwrap_or(&PLAIN)
    }

    /// What is known of a wheel as an input.
    pub(crate) fn wheel(&self, wheel: usize) -> &InputChannel {
        self.wheels.get(wheel).unwrap_or(&PLAIN)
    }

    /// Sensors of a kind that have samples.
    pub(crate) fn of_kind(&self, kind: SensorKind) -> impl Iterator<Item = &SensorRecord> {
        let all = self.sensors.iter();
        all.filter(move |r| r.kind == kind && !r.samples.is_empty())
    }

    /// Whether any sensor of a kind has a sample.
    pub(crate) fn reads(&self, kind: SensorKind) -> bool {
        self.of_kind(kind).next().is_some()
    }

    /// Whether any sensor at a point depends directly on the input motion.
    pub(crate) fn reads_points(&self) -> bool {
        self.reads(SensorKind::Accelerometer) || self.reads(SensorKind::VelocityIncrement)
    }

    /// Whether position or velocity of any point in N is measured.
    pub(crate) fn reads_translation(&self) -> bool {
        self.reads(SensorKind::Position) || self.reads(SensorKind::Velocity)
    }

    /// The most informative gyro of the base: samples over variance.
    pub fn best_gyro(&self) -> Option<&SensorRecord> {
        let weight = |r: &SensorRecord| r.samples.len() as f64 / r.covariance.trace();
        let base = self.of_kind(SensorKind::Gyro).filter(|r| r.body == 0);
        base.max_by(|a, b| {
            let order = weight(a).total_cmp(&weight(b));
            order.then_with(|| b.name.cmp(&a.name))
        })
    }

    /// Grid times and attitudes of the base: of the tracker there that has most samples.
    pub(crate) fn attitudes(&self) -> impl Iterator<Item = (usize, UnitQuaternion)> {
        let base = self.of_kind(SensorKind::Attitude).filter(|r| r.body == 0);
        let most = base.max_by_key(|r| r.samples.len());
        let samples = most.into_iter().flat_map(|r| &r.samples);
        samples.filter_map(|s| match s.value {
            SensorValue::Attitude(R) => Some((s.to, R)),
            _ => None,
        })
    }

    /// Grid times and body rates that [`Self::best_gyro`] measured, rad/s.
    pub fn rates(&self) -> impl Iterator<Item = (usize, Vector3)> {
        let gyro = self.best_gyro().into_iter();
        gyro.flat_map(SensorRecord::vectors)
    }

    /// Angle that the base turns in the intervals after these rates, rad.
    pub(crate) fn turned(&self) -> f64 {
        let t = &self.time_s;
        let steps = self
            .rates()
            .filter_map(|(k, w)| Some((w, t.get(k + 1)? - t[k])));
        steps.map(|(w, h)| w.norm() * h).sum()
    }
}

/// What is known of a joint or wheel as an input of a segment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct InputChannel {
    /// Error correlation of its positions or speeds.
    pub errors: InputErrors,
    /// What is known of its rate.
    pub rate: InputRate,
    /// Acceleration of a joint, rad/s2 or m/s2, or slope of a wheel's speed, rad/s2, at every grid time, where it is a process; empty
    /// otherwise.
    pub acceleration: Vec<f64>,
    /// The part of a joint's motion that measured rates make, one row per grid time, where it is a process; empty otherwise.
    pub of_rates: Vec<RateParts>,
}

/// Position, rate and acceleration of a joint that its measured rates make, and what they would make were all of them one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RateParts {
    /// Of the rates as they are.
    pub rates: [f64; 3],
    /// Of ones.
    pub ones: [f64; 3],
}

/// One of which nothing special is known.
static PLAIN: InputChannel = InputChannel {
    errors: InputErrors::Independent,
    rate: InputRate::Unmeasured,
    acceleration: Vec::new(),
    of_rates: Vec::new(),
};

/// What is known of the rate of a joint, or of the acceleration of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InputRate {
    /// Nothing beside the samples.
    #[default]
    Unmeasured,
    /// The rate of the joint has samples of its own.
    Measured,
    /// The speed of the wheel runs straight from grid time to grid time, since its motor torque was measured.
    Straight,
    /// The torque of the wheel changes all along: its speed is a cubic with the slope of the process at both ends.
    Random,
}

/// Error correlation of an input's samples along the grid of a segment.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum InputErrors {
    /// Independent errors.
    #[default]
    Independent,
    /// The input is given, not measured: a joint without a column.
    None,
    /// One error for the whole segment, and no rate: the reading never changes.
    Locked,
    /// Correlation of the error at each grid time with that at the next: one while a rounded reading stays, between
    /// zero and one on a grid finer than the readings.
    Kept(Vec<f64>),
    /// Of rounded readings, some of which stay over many samples, one row per grid time.
    Rounded(Vec<RoundingError>),
    /// Independent errors of readings, and straight lines between them, one row per grid time.
    Interpolated(Vec<BetweenReadings>),
    /// Of a wheel's speed, or a joint's position with its rate, that are the mean of a process which the readings leave uncertain.
    Process(ErrorProcess),
}

/// Error of a rounded reading at a grid time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundingError {
    /// Correlation with that at the next one, where the quantity moves evenly by a step while its reading stays.
    pub memory: f64,
    /// Whether there is a sample at the grid time.
    pub read: bool,
}

/// Place of a grid time among the readings of an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BetweenReadings {
    /// Number of the last reading.
    pub reading: usize,
    /// Share of the way from it to the next one: zero at the reading, below one.
    pub share: f64,
}

impl BetweenReadings {
    /// The reading whose error is in this slot of two, and its weight: neighbours take turns.
    pub(crate) fn slot(&self, slot: usize) -> (usize, f64) {
        match self.reading % 2 == slot {
            true => (self.reading, 1.0 - self.share),
            false => (self.reading + 1, self.share),
        }
    }
}

impl InputErrors {
    /// Correlation of the error at grid time k with that at the next; zero where two errors share a reading.
    pub(crate) fn memory(&self, k: usize) -> f64 {
        match self {
            Self::Independent | Self::None | Self::Interpolated(_) => 0.0,
            Self::Locked => 1.0,
            Self::Process(process) => process.memory(k),
            Self::Kept(all) => all.get(k).copied().unwrap_or(0.0),
            Self::Rounded(all) => all.get(k).map_or(0.0, |e| e.memory),
        }
    }

    /// Whether errors at neighbouring grid times are correlated.
    pub(crate) fn lasts(&self) -> bool {
        matches!(self, Self::Kept(_) | Self::Rounded(_))
    }
}

/// Accelerations at the times of the samples, for methods that take them instead of momentum.
#[derive(Debug, Clone, Default)]
pub struct Accelerations {
    /// Angular acceleration of the base, in B, rad/s2.
    pub dw_NB_B: Vec<Vector3>,
    /// Inertial acceleration of the sensor point, in B, m/s2; `None` without an accelerometer.
    pub a_NS_B: Option<Vec<Vector3>>,
    /// Sensor point from the base origin, in B, m.
    pub p_BoS_B: Vector3,
}

/// One segment: its own initial momentum, the bodies shared with the others.
#[derive(Debug, Clone, Default)]
pub struct Segment {
    /// Name in messages: the file name.
    pub label: String,
    /// Aligned samples.
    pub samples: Samples,
    /// Readings of every sensor at its own times.
    pub observations: Observations,
    /// Thruster firings in order of their start.
    pub firings: Vec<Firing>,
    /// Accelerations, where they are measured.
    pub accelerations: Option<Accelerations>,
}

impl Segment {
    /// The same about the inputs of its beginning.
    pub(crate) fn about_inputs_of(&self, begun: &Self) -> Self {
        let mut whole = self.clone();
        let (o, b) = (&mut whole.observations, &begun.observations);
        let width = b.expected_errors.len() / b.time_s.len().max(1);
        o.expected_errors.resize(width * o.time_s.len(), 0.0);
        let inputs = [
            (&mut o.joint_position, &b.joint_position),
            (&mut o.joint_rate, &b.joint_rate),
            (&mut o.wheel_speed, &b.wheel_speed),
            (&mut o.expected_errors, &b.expected_errors),
        ];
        for (own, begun) in inputs {
            own[..begun.len()].copy_from_slice(begun);
        }
        whole
    }
}

/// Declared noise of what enters the linear rows ([`Samples`]) and of the inputs, one sample each, and its observed
/// share in the data (0 for a noise-free file).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Noise {
    /// Index in the model of the gyro from which the rates of [`Samples`] come.
    pub gyro_sensor: Option<usize>,
    /// Gyro covariance in B, rad2/s2.
    pub gyro: Matrix3,
    /// Attitude covariance as a small rotation in B, rad2; zero where taken as exact.
    pub attitude: Matrix3,
    /// Velocity covariance in N, m2/s2.
    pub velocity: Matrix3,
    /// Position covariance in N, m2.
    pub position: Matrix3,
    /// Variance of each joint position, rad2 or m2.
    pub joint_position: Vec<f64>,
    /// Variance of each joint rate, rad2/s2 or m2/s2.
    pub joint_rate: Vec<f64>,
    /// Variance of each wheel speed, rad2/s2.
    pub wheel_speed: Vec<f64>,
    /// Observed over declared variance of the gyro.
    pub seen_gyro: f64,
    /// Observed over declared variance of the velocity.
    pub seen_velocity: f64,
    /// Observed over declared variance of the joint rates.
    pub seen_joint_rate: f64,
}
