//! What drives a momentum wheel: its speed, the torque of its motor, or a controller.

use crate::motion::attitude_control::{AttitudeControl, WheelDrive};
use crate::motion::piecewise::PiecewisePolynomial;
use crate::motion::reaction_wheel::WheelLimits;

/// The drive of a wheel.
#[derive(Debug, Clone, PartialEq)]
pub enum WheelMotion {
    /// Speed relative to the host as a function of time, rad/s.
    Speed(PiecewisePolynomial),
    /// Motor torque on the rotor as a function of time, N m. The rotor's axial equation is then part of
    /// the state: `h_w = Js (Omega + a . w_host)`, `h_w' = torque` (Hughes 1986, axisymmetric rotor).
    Torque {
        /// Speed relative to the host at the start, rad/s.
        initial_speed: f64,
        /// Motor torque on the rotor, N m.
        torque: PiecewisePolynomial,
    },
    /// The attitude controller of the plan commands it.
    Controlled {
        /// Speed relative to the host at the start, rad/s.
        initial_speed: f64,
        /// Limits and friction.
        limits: WheelLimits,
    },
}

/// What is known of a wheel's axial momentum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Axial {
    /// `Js Omega` is a function of time.
    Given,
    /// `Js Omega` is part of the state: its rate is commanded.
    Relative,
    /// `Js (Omega + a . w_host)` is part of the state: its rate is the torque on the rotor.
    Absolute,
}

impl WheelMotion {
    /// A wheel that keeps its speed relative to the host, rad/s.
    pub fn constant(speed: f64) -> Self {
        Self::Speed(PiecewisePolynomial::constant(speed))
    }

    /// The times at which integration restarts, s.
    pub fn breaks(&self) -> &[f64] {
        match self {
            Self::Speed(profile) => profile.nodes(),
            Self::Torque { torque, .. } => torque.nodes(),
            Self::Controlled { .. } => &[],
        }
    }

    pub(crate) fn axial(&self, law: Option<&AttitudeControl>) -> Axial {
        match self {
            Self::Speed(_) => Axial::Given,
            Self::Controlled { .. } if law.map(|l| l.drive) == Some(WheelDrive::Acceleration) => {
                Axial::Relative
            }
            Self::Torque { .. } | Self::Controlled { .. } => Axial::Absolute,
        }
    }

    /// Speed at the start, rad/s, and limits of a wheel that the controller commands.
    pub(crate) fn controlled(&self) -> Option<(f64, WheelLimits)> {
        match self {
            Self::Controlled {
                initial_speed,
                limits,
            } => Some((*initial_speed, *limits)),
            Self::Speed(_) | Self::Torque { .. } => None,
        }
    }

    /// Torque of the bearing on the rotor at a speed relative to the host, N m.
    pub(crate) fn friction(&self, speed: f64) -> f64 {
        self.controlled()
            .map_or(0.0, |(_, limits)| limits.friction(speed))
    }
}
