//! A sensor with its declared errors: plain numbers.

use alloc::string::String;
use alloc::vec::Vec;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use poinsot_spatial::{Matrix3, Vector3};

/// Knowledge of a nuisance parameter.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Nuisance {
    /// Exact.
    #[default]
    Known,
    /// Unknown.
    Estimate,
    /// Unknown within a prior sigma, in the unit of the number.
    Prior(f64),
}

/// A key of the model file that declares errors of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKey {
    /// Constant error.
    Bias,
    /// Relative error of each axis.
    Scale,
    /// Turn of the axes.
    Misalignment,
    /// Axes that are not orthogonal.
    Nonorthogonality,
    /// Delay.
    Lag,
}

impl ErrorKey {
    /// All keys, in the order of the model file's reference.
    pub const ALL: [Self; 5] = [
        Self::Bias,
        Self::Scale,
        Self::Misalignment,
        Self::Nonorthogonality,
        Self::Lag,
    ];

    /// The key as it is written.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Bias => "bias",
            Self::Scale => "scale",
            Self::Misalignment => "misalignment",
            Self::Nonorthogonality => "nonorthogonality",
            Self::Lag => "lag",
        }
    }

    /// How a sensor declares it.
    pub const fn declared(self, sensor: &Sensor) -> Nuisance {
        match self {
            Self::Bias => sensor.bias,
            Self::Scale => sensor.scale,
            Self::Misalignment => sensor.misalignment,
            Self::Nonorthogonality => sensor.nonorthogonality,
            Self::Lag => sensor.lag,
        }
    }
}

/// What a sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SensorKind {
    /// Angular velocity, rad/s.
    Gyro,
    /// Attitude quaternion; noise as a small rotation in body axes, rad.
    Attitude,
    /// Position of a point, m.
    Position,
    /// Velocity of a point, m/s.
    Velocity,
    /// Velocity increment, m/s.
    VelocityIncrement,
    /// Specific force at a point, m/s2.
    Accelerometer,
    /// Direction of a vector known in N, as a unit vector; noise as a small angle across it, rad.
    Direction,
    /// Attitude of a body seen from another one, `R_BrBs`; noise as a small rotation in the axes of the seen body, rad.
    RelativeAttitude,
    /// Position of a point seen from another body, `p_BrS_Br`, m.
    RelativePosition,
    /// Velocity of a point seen from another body, the rate of change of `p_BrS_Br`, m/s.
    RelativeVelocity,
    /// Joint position, rad or m.
    JointPosition,
    /// Joint rate, rad/s or m/s.
    JointRate,
    /// Wheel speed relative to the host, rad/s.
    WheelSpeed,
    /// Thrust, N.
    Thrust,
}

/// In which axes a sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Its own, mounted on its body; its columns are in the body's axes.
    Sensor,
    /// Inertial; of a relative position, those of the body from which it is seen.
    Inertial,
    /// None: one number per joint, wheel or thruster.
    None,
}

/// Properties of a kind of sensor.
#[derive(Clone, Copy)]
struct Facts {
    /// Word in results; in a model file that of [`SensorKind::declared_as`].
    word: &'static str,
    /// What it measures, in a model file.
    about: &'static str,
    /// Unit of its samples as a key suffix, and that of prismatic joints if different.
    units: &'static [&'static str],
    axes: Axes,
    /// Standard names of the columns of a sensor with axes.
    columns: &'static [&'static str],
    /// Degrees of freedom of one sample.
    numbers: usize,
    /// Keys of the errors that can be unknown.
    errors: &'static [ErrorKey],
    /// Whether its noise must be declared.
    noise: bool,
    /// The kind that measures the same in N, if this one sees a body from another one.
    in_inertial: Option<SensorKind>,
}

/// A sensor that measures a vector in its own axes.
const VECTOR: Facts = Facts {
    word: "",
    about: "",
    units: &[],
    axes: Axes::Sensor,
    columns: &[],
    numbers: 3,
    errors: &ErrorKey::ALL,
    noise: false,
    in_inertial: None,
};

/// A sensor of a rotation. A turned mounting is its bias, and it has no scale.
const ROTATION: Facts = Facts {
    errors: &[ErrorKey::Bias, ErrorKey::Lag],
    ..VECTOR
};

/// A sensor of joints, wheels or thrusters.
const SCALAR: Facts = Facts {
    axes: Axes::None,
    errors: &[ErrorKey::Lag],
    ..VECTOR
};

impl SensorKind {
    /// Every kind, in the order of the results.
    pub const ALL: [Self; 14] = [
        Self::Gyro,
        Self::Attitude,
        Self::Velocity,
        Self::Position,
        Self::Accelerometer,
        Self::VelocityIncrement,
        Self::Direction,
        Self::RelativeAttitude,
        Self::RelativePosition,
        Self::RelativeVelocity,
        Self::JointPosition,
        Self::JointRate,
        Self::WheelSpeed,
        Self::Thrust,
    ];

    const fn facts(self) -> Facts {
        match self {
            Self::Gyro => Facts {
                word: "gyro",
                about: "Angular velocity in body axes, rad/s.",
                units: &["rad_s"],
                columns: &["omega_x", "omega_y", "omega_z"],
                ..VECTOR
            },
            Self::Attitude => Facts {
                word: "attitude",
                about: "Attitude, quaternion body to inertial.",
                units: &["rad"],
                columns: &["q_x", "q_y", "q_z", "q_w"],
                ..ROTATION
            },
            Self::Position => Facts {
                word: "position",
                about: "Position of the sensor point in inertial axes, m.",
                units: &["m"],
                axes: Axes::Inertial,
                columns: &["r_x", "r_y", "r_z"],
                ..VECTOR
            },
            Self::Velocity => Facts {
                word: "velocity",
                about: "Velocity of the sensor point in inertial axes, m/s.",
                units: &["m_s"],
                axes: Axes::Inertial,
                columns: &["v_x", "v_y", "v_z"],
                ..VECTOR
            },
            Self::VelocityIncrement => Facts {
                word: "velocity_increment",
                about: "Velocity increment over one sample interval, m/s.",
                units: &["m_s"],
                axes: Axes::Inertial,
                columns: &["dv_x", "dv_y", "dv_z"],
                noise: true,
                ..VECTOR
            },
            Self::Accelerometer => Facts {
                word: "accelerometer",
                about: "Specific force at the sensor point in body axes, m/s2.",
                units: &["m_s2"],
                columns: &["acc_x", "acc_y", "acc_z"],
                noise: true,
                ..VECTOR
            },
            Self::Direction => Facts {
                word: "direction",
                about: "Direction of a vector known in inertial axes (sun, magnetic field), in body axes: a vector of any length.",
                units: &["rad"],
                columns: &["direction_x", "direction_y", "direction_z"],
                // None along itself.
                numbers: 2,
                errors: &[ErrorKey::Bias, ErrorKey::Misalignment, ErrorKey::Lag],
                noise: true,
                ..VECTOR
            },
            Self::RelativeAttitude => Facts {
                word: "relative_attitude",
                units: &["rad"],
                columns: &[
                    "relative_q_x",
                    "relative_q_y",
                    "relative_q_z",
                    "relative_q_w",
                ],
                noise: true,
                in_inertial: Some(SensorKind::Attitude),
                ..ROTATION
            },
            Self::RelativePosition => Facts {
                word: "relative_position",
                units: &["m"],
                axes: Axes::Inertial,
                columns: &["relative_r_x", "relative_r_y", "relative_r_z"],
                noise: true,
                in_inertial: Some(SensorKind::Position),
                ..VECTOR
            },
            Self::RelativeVelocity => Facts {
                word: "relative_velocity",
                units: &["m_s"],
                axes: Axes::Inertial,
                columns: &["relative_v_x", "relative_v_y", "relative_v_z"],
                noise: true,
                in_inertial: Some(SensorKind::Velocity),
                ..VECTOR
            },
            Self::JointPosition => Facts {
                word: "joint_position",
                about: "Joint positions, rad or m.",
                units: &["rad", "m"],
                errors: &[ErrorKey::Bias, ErrorKey::Scale, ErrorKey::Lag],
                ..SCALAR
            },
            Self::JointRate => Facts {
                word: "joint_rate",
                about: "Joint rates, rad/s or m/s.",
                units: &["rad_s", "m_s"],
                errors: &[ErrorKey::Bias, ErrorKey::Scale],
                ..SCALAR
            },
            Self::WheelSpeed => Facts {
                word: "wheel_speed",
                about: "Wheel speeds relative to the host, rad/s.",
                units: &["rad_s"],
                // Only the product of its scale and the spin inertia acts: the spin inertia stands for both.
                errors: &[ErrorKey::Bias, ErrorKey::Lag],
                ..SCALAR
            },
            Self::Thrust => Facts {
                word: "thrust",
                about: "Thrusts, N.",
                units: &["N"],
                ..SCALAR
            },
        }
    }

    /// The word for this kind in results.
    pub const fn word(self) -> &'static str {
        self.facts().word
    }

    /// What it measures, as the schema of the model file says it; empty for a relative kind.
    pub const fn about(self) -> &'static str {
        self.facts().about
    }

    /// The kind whose word a model file has as `type`. A relative kind is that kind with `seen_from`.
    pub const fn declared_as(self) -> Self {
        match self.facts().in_inertial {
            Some(kind) => kind,
            None => self,
        }
    }

    /// The kinds that a model file names.
    pub fn declared() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|kind| !kind.is_relative())
    }

    /// The kind that measures the same of a body seen from another body; `None` where there is none.
    pub fn seen_from_a_body(self) -> Option<Self> {
        let mut relative = Self::ALL.into_iter().filter(|kind| kind.is_relative());
        relative.find(|kind| kind.declared_as() == self)
    }

    /// Whether it measures a body as seen from another body, which no motion of the base changes.
    pub const fn is_relative(self) -> bool {
        self.facts().in_inertial.is_some()
    }

    /// Keys of the errors that can be unknown: of `bias`, `scale`, `misalignment`, `nonorthogonality` and `lag`.
    pub const fn unknown_errors(self) -> &'static [ErrorKey] {
        self.facts().errors
    }

    /// Whether the noise of a sensor of this kind must be declared. Others may be exact.
    pub const fn needs_noise(self) -> bool {
        self.facts().noise
    }

    /// Whether a sample is a rotation: its errors are small turns, and a turned mounting is its bias.
    pub const fn is_rotation(self) -> bool {
        self.columns().len() == 4
    }

    /// Units of its samples as key suffixes (`rad_s`): of revolute joints first, of prismatic ones last.
    pub const fn units(self) -> &'static [&'static str] {
        self.facts().units
    }

    /// The unit of a sensor of this kind, for prismatic joints or not.
    pub const fn unit(self, slides: bool) -> &'static str {
        let units = self.facts().units;
        units[if slides { units.len() - 1 } else { 0 }]
    }

    /// Degrees of freedom of one sample: a direction has no component along itself.
    pub const fn numbers(self) -> usize {
        self.facts().numbers
    }

    /// In which axes it measures.
    pub const fn axes(self) -> Axes {
        self.facts().axes
    }

    /// Standard names of its columns; none for joint, wheel and thrust sensors.
    pub const fn columns(self) -> &'static [&'static str] {
        self.facts().columns
    }

    /// The kinds with axes.
    pub fn with_axes() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|kind| !kind.is_scalar())
    }

    /// Whether it measures one number per joint, wheel or thruster, without axes.
    pub fn is_scalar(self) -> bool {
        self.axes() == Axes::None
    }
}

/// A unit that ends a key, as it is printed: `rad_s` is `rad/s`.
///
/// ```
/// use poinsot_dynamics::printed_unit;
///
/// assert_eq!(printed_unit("rad_s"), "rad/s");
/// assert_eq!(printed_unit("rad"), "rad");
/// ```
pub fn printed_unit(key: &'static str) -> &'static str {
    match key {
        "rad_s" => "rad/s",
        "m_s" => "m/s",
        "m_s2" => "m/s2",
        other => other,
    }
}

/// A part of a sensor's error that lasts over samples: a Gauss-Markov process, or a random walk (Maybeck 1979, section 4.11).
///
/// ```
/// use poinsot_dynamics::SlowError;
/// use poinsot_spatial::Matrix3;
///
/// let drift = SlowError { covariance: Matrix3::identity() * 4.0, correlation_s: 10.0 };
/// let stays = drift.stays(5.0);
/// assert!((stays * stays * 4.0 + drift.fresh(5.0)[(0, 0)] - drift.first()[(0, 0)]).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowError {
    /// Covariance, SI squared, in the axes of the sensor's noise: of the process at any time, or what a walk gains in 1 s.
    pub covariance: Matrix3,
    /// Correlation time, to 1/e, s; infinite for a walk, which begins at zero.
    pub correlation_s: f64,
}

impl SlowError {
    /// A random walk.
    pub fn is_walk(&self) -> bool {
        self.correlation_s == f64::INFINITY
    }

    /// Covariance at the first sample.
    pub fn first(&self) -> Matrix3 {
        match self.is_walk() {
            true => Matrix3::zeros(),
            false => self.covariance,
        }
    }

    /// Share that stays after a time, s.
    pub fn stays(&self, h_s: f64) -> f64 {
        (-h_s / self.correlation_s).exp()
    }

    /// Covariance of what is new after a time, s.
    pub fn fresh(&self, h_s: f64) -> Matrix3 {
        match self.is_walk() {
            true => self.covariance * h_s,
            false => self.covariance * -(-2.0 * h_s / self.correlation_s).exp_m1(),
        }
    }
}

/// A sensor with its declared noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Name, unique among sensors of its kind.
    pub name: String,
    /// Kind.
    pub kind: SensorKind,
    /// Index of its body.
    pub body: usize,
    /// Index of the body from which a relative kind sees [`Self::body`]; 0 for all other kinds.
    pub seen_from: usize,
    /// Covariance of the white noise of one sample in the sensor's own axes, SI squared. Scalar channels use `[(0, 0)]`.
    /// `None` where the file declares none.
    pub noise_covariance: Option<Matrix3>,
    /// What lasts over samples, in the same axes.
    pub slow: Vec<SlowError>,
    /// Least significant bit, SI; zero where not quantised.
    pub quantisation: f64,
    /// Bias.
    pub bias: Nuisance,
    /// Scale factor.
    pub scale: Nuisance,
    /// Misalignment.
    pub misalignment: Nuisance,
    /// Nonorthogonality of the axes, rad: axis i measures `g_ij` of the rate about axis j and axis j as much of that
    /// about i.
    pub nonorthogonality: Nuisance,
    /// Lag, s.
    pub lag: Nuisance,
    /// Rotation that takes components in the sensor's axes to the body's.
    pub R_BS: Matrix3,
    /// Position of the sensor from the body's origin, in B, m.
    pub p_BoS_B: Vector3,
    /// The vector in N whose direction is measured, of length one; `None` where the telemetry gives it, and for all other
    /// kinds.
    pub reference_N: Option<Vector3>,
    /// What a sensor of joints, wheels or thrusters reads: indices of joints, wheels or
    /// thrusters of the vehicle, ascending. Empty for all other kinds.
    pub of: Vec<usize>,
}

impl Sensor {
    /// Covariance of all declared noise of one sample, white and slow, in the sensor's axes, SI squared; a walk, which has
    /// none at its start, is left out. `None` where the file declares no noise.
    pub fn covariance(&self) -> Option<Matrix3> {
        let slow = self.slow.iter().filter(|s| !s.is_walk());
        let parts = self.noise_covariance.into_iter();
        parts.chain(slow.map(SlowError::first)).reduce(|a, b| a + b)
    }

    /// Whether it measures in its own axes, mounted on its body.
    pub fn turns(&self) -> bool {
        self.kind.axes() == Axes::Sensor
    }
}
