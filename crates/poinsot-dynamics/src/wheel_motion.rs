//! Prescribed motion of one momentum wheel: its speed, or the torque of its motor.

use crate::piecewise::PiecewisePolynomial;

/// The input of a wheel.
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
        }
    }
}
