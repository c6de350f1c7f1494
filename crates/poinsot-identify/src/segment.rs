//! One stretch of telemetry, aligned on the gyro's times: what the linear rung needs.

use crate::point_sensor::PointReadings;
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

/// What every sensor really read, each at its own times, on one grid: what maximum likelihood needs.
///
/// The grid holds the times of all sensors and the edges of all firings. Joints and wheels are inputs and
/// have a value at every time; the other arrays hold `None` where that sensor has no sample.
#[derive(Debug, Clone, Default)]
pub struct Observations {
    /// Grid, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// Angular velocity of the base in B, rad/s.
    pub rate: Vec<Option<Vector3>>,
    /// Attitude of the base, R_NB.
    pub attitude: Vec<Option<UnitQuaternion>>,
    /// Velocity of the sensor point in N, m/s.
    pub velocity: Vec<Option<Vector3>>,
    /// Position of the sensor point in N, m, from the place of the base origin at the first sample.
    pub position: Vec<Option<Vector3>>,
    /// Place of the velocity sensor from the base origin, in B, m.
    pub velocity_arm_B: Vector3,
    /// Place of the position sensor from the base origin, in B, m.
    pub position_arm_B: Vector3,
    /// Position and velocity of the reference orbit from the attracting body, in N, m and m/s, at every time;
    /// empty without gravity gradient.
    pub orbit: Vec<(Vector3, Vector3)>,
    /// Accelerometers and velocity increments.
    pub points: Vec<PointReadings>,
    /// Joint positions, rad or m; one row of `dof` per time.
    pub joint_position: Vec<f64>,
    /// Joint rates, rad/s or m/s; one row of `dof` per time.
    pub joint_rate: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s; one row of `wheels` per time.
    pub wheel_speed: Vec<f64>,
    /// How the errors of each joint's position hang together; independent where the list is shorter.
    pub joint_errors: Vec<InputErrors>,
    /// The same for each wheel's speed.
    pub wheel_errors: Vec<InputErrors>,
    /// Joints whose rate at every grid time is the slope of the polynomial through the five nearest positions, all of
    /// them read at grid times; read for itself where the list is shorter.
    pub derived_rates: Vec<bool>,
    /// Whether joints or wheels are read at other times than those of the grid, and interpolated.
    pub between_readings: bool,
}

impl Observations {
    /// Whether there are two times or more and every list has an entry for each.
    pub(crate) fn is_whole(&self, dof: usize, wheels: usize) -> bool {
        let n = self.time_s.len();
        n >= 2
            && [
                self.rate.len(),
                self.attitude.len(),
                self.velocity.len(),
                self.position.len(),
            ]
            .iter()
            .all(|len| *len == n)
            && self.joint_position.len() == n * dof
            && self.joint_rate.len() == n * dof
            && self.wheel_speed.len() == n * wheels
    }
}

/// How the errors of an input's readings hang together along the grid of a segment.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum InputErrors {
    /// Every value errs on its own.
    #[default]
    Independent,
    /// The input is given, not read: a joint without a column.
    None,
    /// One error for the whole segment, and no rate: the reading never changes.
    Locked,
    /// Correlation of the error at each grid time with that at the next: one while a rounded reading stays, between
    /// zero and one on a grid finer than the readings.
    Kept(Vec<f64>),
}

impl InputErrors {
    /// Correlation of the error at grid time k with that at the next.
    pub(crate) fn memory(&self, k: usize) -> f64 {
        match self {
            Self::Independent | Self::None => 0.0,
            Self::Locked => 1.0,
            Self::Kept(all) => all.get(k).copied().unwrap_or(0.0),
        }
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
    /// What to call it in messages: the file name.
    pub label: String,
    /// Aligned samples.
    pub samples: Samples,
    /// Readings of every sensor at its own times.
    pub observations: Observations,
    /// Thruster firings in order of their start.
    pub firings: Vec<Firing>,
    /// Accelerations, where they are measured.
    pub accelerations: Option<Accelerations>,
    /// Samples of every wheel's speed at their own times; without them wheel speeds are given, as in the observations.
    pub tachometers: Vec<Tachometer>,
}

/// Samples of one wheel's speed.
#[derive(Debug, Clone, Default)]
pub struct Tachometer {
    /// Times, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// Speed relative to the host, rad/s.
    pub speed: Vec<f64>,
    /// How their errors hang together, from sample to sample.
    pub errors: InputErrors,
}

/// Declared noise of the measurements that enter the rows, one sample each, and the part of it that
/// is really seen in the data (0 for a noise-free file).
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
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
    /// Correlation time of the noise of gyro, attitude, velocity and position, s; zero where it is white.
    pub correlation_s: [f64; 4],
    /// Seen over declared variance of the gyro.
    pub seen_gyro: f64,
    /// Seen over declared variance of the velocity.
    pub seen_velocity: f64,
    /// Seen over declared variance of the joint rates.
    pub seen_joint_rate: f64,
}
