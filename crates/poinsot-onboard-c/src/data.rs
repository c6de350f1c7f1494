//! Structs of the header.

use poinsot_onboard::{JOINTS, SensorCounts, WHEELS};

/// Bits of [`Sample::measured`].
pub const MEASURED_GYRO: u32 = 1;
/// Bit of a measured attitude.
pub const MEASURED_ATTITUDE: u32 = 2;
/// Bit of a measured position.
pub const MEASURED_POSITION: u32 = 4;

/// A sample, see [`poinsot_onboard::Sample`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Sample {
    /// Time, s.
    pub time_s: f64,
    /// Angular velocity in B, rad/s.
    pub gyro: [f64; 3],
    /// Attitude `R_NB` as a quaternion x, y, z, w.
    pub attitude: [f64; 4],
    /// Position of `Bo` in N, m.
    pub position: [f64; 3],
    /// Wheel speeds relative to the base, rad/s.
    pub wheel_speed: [f64; WHEELS],
    /// Positions of the joints, rad or m.
    pub joint_position: [f64; JOINTS],
    /// Their rates, rad/s or m/s.
    pub joint_rate: [f64; JOINTS],
    /// Force of the thrusters until the next sample, in B, N.
    pub force_B: [f64; 3],
    /// Their torque about `Bo`, in B, N m.
    pub torque_B: [f64; 3],
    /// Which of gyro, attitude and position this sample has: a sum of `MEASURED` bits.
    pub measured: u32,
    /// Not read.
    pub reserved: u32,
}

impl From<Sample> for poinsot_onboard::Sample {
    fn from(sample: Sample) -> Self {
        let has = |bit| sample.measured & bit != 0;
        Self {
            time_s: sample.time_s,
            gyro: has(MEASURED_GYRO).then_some(sample.gyro),
            attitude: has(MEASURED_ATTITUDE).then_some(sample.attitude),
            position: has(MEASURED_POSITION).then_some(sample.position),
            wheel_speed: sample.wheel_speed,
            joint_position: sample.joint_position,
            joint_rate: sample.joint_rate,
            force_B: sample.force_B,
            torque_B: sample.torque_B,
        }
    }
}

/// What a filter knows, see [`poinsot_onboard::Answer`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Answer {
    /// The ten parameters about `Bo`: m, mc (x, y, z), I (xx, xy, yy, xz, yz, zz); kg, kg m, kg m2.
    pub value: [f64; 10],
    /// One sigma of each, zero where it is known.
    pub sigma: [f64; 10],
    /// Covariance of the unknown ones, in the same order, in the first rows and columns.
    pub covariance: [[f64; 10]; 10],
    /// Used measurements of gyro, attitude and position.
    pub accepted: [u64; 3],
    /// Those left out.
    pub gated: [u64; 3],
    /// [`poinsot_onboard::Health`] as a number.
    pub health: u32,
    /// Bit k: the k-th parameter is determined.
    pub determined: u32,
    /// Number of unknown parameters.
    pub unknowns: u32,
    /// Zero.
    pub reserved: u32,
}

impl Answer {
    pub(crate) fn new(answer: &poinsot_onboard::Answer, counts: &[SensorCounts; 3]) -> Self {
        let determined = answer.numbers.iter().rev();
        let determined = determined.fold(0, |bits, n| (bits << 1) | u32::from(n.determined));
        Self {
            value: answer.numbers.map(|n| n.value),
            sigma: answer.numbers.map(|n| n.sigma),
            covariance: answer.covariance,
            accepted: counts.map(|c| c.accepted),
            gated: counts.map(|c| c.gated),
            health: u32::from(answer.health as u8),
            determined,
            // At most ten.
            unknowns: u32::try_from(answer.unknowns).unwrap_or(u32::MAX),
            reserved: 0,
        }
    }
}
