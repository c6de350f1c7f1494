//! A sensor with its declared errors: plain numbers.

use alloc::string::String;
use alloc::vec::Vec;
use poinsot_spatial::{Matrix3, Vector3};

/// What is known of a number that is not asked for but may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Nuisance {
    /// Taken as exact.
    #[default]
    Known,
    /// Unknown.
    Estimate,
    /// Unknown within a prior sigma, in the unit of the number.
    Prior(f64),
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
    /// Joint position, rad or m.
    JointPosition,
    /// Joint rate, rad/s or m/s.
    JointRate,
    /// Wheel speed relative to the host, rad/s.
    WheelSpeed,
    /// Thrust, N.
    Thrust,
}

impl SensorKind {
    /// Every kind, in the order of the file format.
    pub const ALL: [Self; 10] = [
        Self::Gyro,
        Self::Attitude,
        Self::Position,
        Self::Velocity,
        Self::VelocityIncrement,
        Self::Accelerometer,
        Self::JointPosition,
        Self::JointRate,
        Self::WheelSpeed,
        Self::Thrust,
    ];

    /// The word for this kind in a model file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Gyro => "gyro",
            Self::Attitude => "attitude",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::VelocityIncrement => "velocity_increment",
            Self::Accelerometer => "accelerometer",
            Self::JointPosition => "joint_position",
            Self::JointRate => "joint_rate",
            Self::WheelSpeed => "wheel_speed",
            Self::Thrust => "thrust",
        }
    }

    /// Whether it reads one number per joint, wheel or thruster, and so has no axes.
    pub fn is_scalar(self) -> bool {
        matches!(
            self,
            Self::JointPosition | Self::JointRate | Self::WheelSpeed | Self::Thrust
        )
    }
}

/// A sensor with its declared noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Name, unique among sensors of its kind.
    pub name: String,
    /// Kind.
    pub kind: SensorKind,
    /// Index of the body it sits on.
    pub body: usize,
    /// Covariance of one sample in the sensor's own axes, SI squared. Scalar channels use `[(0, 0)]`.
    /// `None` where the file declares no noise.
    pub noise_covariance: Option<Matrix3>,
    /// Time after which the noise has forgotten itself to 1/e, s; zero where it is white.
    pub correlation_s: f64,
    /// Least significant bit, SI; zero where not quantised.
    pub quantisation: f64,
    /// Bias.
    pub bias: Nuisance,
    /// Scale factor.
    pub scale: Nuisance,
    /// Misalignment.
    pub misalignment: Nuisance,
    /// How far the axes are from square to each other, rad: axis i reads `g_ij` of the rate about axis j and axis j
    /// as much of that about i.
    pub nonorthogonality: Nuisance,
    /// Lag, s.
    pub lag: Nuisance,
    /// Rotation that takes components in the sensor's axes to the body's.
    pub R_BS: Matrix3,
    /// Position of the sensor from the body's origin, in B, m.
    pub p_BoS_B: Vector3,
    /// What a sensor of joints, wheels or thrusters reads: indices of joints, wheels or
    /// thrusters of the vehicle, ascending. Empty for all other kinds.
    pub of: Vec<usize>,
}

impl Sensor {
    /// Whether it measures in axes of its own, which stand somehow on its body.
    pub fn turns(&self) -> bool {
        matches!(
            self.kind,
            SensorKind::Gyro | SensorKind::Attitude | SensorKind::Accelerometer
        )
    }
}
