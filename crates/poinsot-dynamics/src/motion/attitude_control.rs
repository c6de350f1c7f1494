//! The law of a closed loop: quaternion feedback with reaction wheels.

use poinsot_spatial::{Matrix3, UnitQuaternion};

/// Share of a control period within which an output time and a control instant are the same.
pub(crate) const SAME: f64 = 1e-9;

/// Target attitude from a time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Time, s.
    pub time: f64,
    /// Attitude.
    pub R_NB: UnitQuaternion,
}

/// What the controller commands of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WheelDrive {
    /// The torque of its motor.
    #[default]
    Torque,
    /// Its acceleration relative to the body, so that the torque on the body is exactly `u`: eq. (1a) of Kim, Choi, Oh,
    /// whose u is `-C I_rw omega_rw'`. It differs from the motor torque by `Js a . w'`.
    Acceleration,
}

/// Quaternion feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct AttitudeControl {
    /// `K_P` on the vector part of the error quaternion, N m.
    pub proportional: Matrix3,
    /// `K_D`, N m s.
    pub derivative: Matrix3,
    /// Targets in order of time; the identity before the first.
    pub targets: Vec<Target>,
    /// Time over which a command is held, s; `None` is a continuous controller.
    pub period: Option<f64>,
    /// What is commanded.
    pub drive: WheelDrive,
}

impl AttitudeControl {
    /// What is wrong with its numbers, if anything.
    pub(crate) fn fault(&self) -> Option<&'static str> {
        let mut gains = self.proportional.iter().chain(&self.derivative);
        let mut times = self.targets.windows(2);
        if !gains.all(|x| x.is_finite()) {
            return Some("a gain of the controller is not finite; write finite numbers");
        }
        if self.period.is_some_and(|p| !p.is_finite() || p <= 0.0) {
            return Some(
                "the control period is not positive; give a positive number, or leave it out",
            );
        }
        let increase = times.all(|w| w[0].time < w[1].time);
        if !increase || !self.targets.iter().all(|x| x.time.is_finite()) {
            return Some("the times of the targets do not increase; sort them");
        }
        None
    }

    /// The target from `t` on.
    pub(crate) fn target(&self, t: f64) -> UnitQuaternion {
        let since = self.targets.partition_point(|x| x.time <= t + SAME);
        let index = since.checked_sub(1);
        let target = index.and_then(|i| self.targets.get(i));
        target.map_or(UnitQuaternion::identity(), |target| target.R_NB)
    }

    /// When the target changes next, s.
    pub(crate) fn next_target(&self, t: f64) -> f64 {
        let mut times = self.targets.iter().map(|target| target.time);
        times.find(|time| *time > t + SAME).unwrap_or(f64::INFINITY)
    }
}
