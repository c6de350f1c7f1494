//! What the filter is given.

use crate::configuration::{INPUTS, JOINTS, of_joint, of_rate};
use crate::numbers::{AXES, WHEELS};
use nalgebra::{Quaternion, UnitQuaternion};

/// What is measured at one time, and what acts until the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub time_s: f64,
    /// Angular velocity in B, rad/s.
    pub gyro: Option<[f64; AXES]>,
    /// Attitude `R_NB` as a quaternion x, y, z, w.
    pub attitude: Option<[f64; 4]>,
    /// Position of `Bo` in N, m.
    pub position: Option<[f64; AXES]>,
    /// Wheel speeds relative to the base, rad/s; those beyond the number of wheels do not count.
    pub wheel_speed: [f64; WHEELS],
    /// Positions of the joints, rad or m; those beyond the number of joints do not count.
    pub joint_position: [f64; JOINTS],
    /// Their rates, rad/s or m/s.
    pub joint_rate: [f64; JOINTS],
    /// Force of the thrusters until the next sample, in B, N.
    pub force_B: [f64; AXES],
    /// Their torque about `Bo`, N m.
    pub torque_B: [f64; AXES],
}

impl Sample {
    /// Nothing measured, nothing acting.
    pub const fn at(time_s: f64) -> Self {
        Self {
            time_s,
            gyro: None,
            attitude: None,
            position: None,
            wheel_speed: [0.0; WHEELS],
            joint_position: [0.0; JOINTS],
            joint_rate: [0.0; JOINTS],
            force_B: [0.0; AXES],
            torque_B: [0.0; AXES],
        }
    }

    /// The inputs in one list.
    pub(crate) fn inputs(&self) -> [f64; INPUTS] {
        let mut out = [0.0; INPUTS];
        out[..WHEELS].copy_from_slice(&self.wheel_speed);
        out[of_joint(0)..of_rate(0)].copy_from_slice(&self.joint_position);
        out[of_rate(0)..].copy_from_slice(&self.joint_rate);
        out
    }

    pub(crate) fn rotation(&self) -> Option<UnitQuaternion<f64>> {
        let [x, y, z, w] = self.attitude?;
        Some(UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)))
    }
}
