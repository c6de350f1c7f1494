//! The drive of one joint: a motor force with a spring and a damper, or a prescribed motion.

use crate::motion::joint_motion::JointMotion;
use crate::motion::piecewise::PiecewisePolynomial;
use crate::spring::SpringDamper;

/// Force of a motor along its joint axis as a function of time: N m (revolute) or N (prismatic).
#[derive(Debug, Clone, PartialEq)]
pub enum ForceProfile {
    /// Polynomials between nodes; held outside. A constant and a table are of this kind.
    Nodes(PiecewisePolynomial),
    /// `amplitude sin(frequency t + phase)` (Xu et al. 2017, Table 13).
    Sine {
        /// N m or N.
        amplitude: f64,
        /// rad/s.
        frequency: f64,
        /// rad.
        phase: f64,
    },
}

impl ForceProfile {
    /// No motor at all.
    pub fn none() -> Self {
        Self::Nodes(PiecewisePolynomial::constant(0.0))
    }

    /// Force at `t` on the smooth interval that holds `within`.
    #[inline]
    pub fn at(&self, t: f64, within: f64) -> f64 {
        match self {
            Self::Nodes(nodes) => nodes.at(t, within).value,
            Self::Sine {
                amplitude,
                frequency,
                phase,
            } => amplitude * (frequency * t + phase).sin(),
        }
    }

    /// The times at which integration restarts, s.
    pub fn breaks(&self) -> &[f64] {
        match self {
            Self::Nodes(nodes) => nodes.nodes(),
            Self::Sine { .. } => &[],
        }
    }
}

/// The drive of one joint.
#[derive(Debug, Clone, PartialEq)]
pub enum JointDrive {
    /// A force, and where the joint starts.
    Force {
        /// Motor.
        motor: ForceProfile,
        /// Passive part.
        spring: SpringDamper,
        /// Position at the start, rad or m.
        initial_position: f64,
        /// Rate at the start, rad/s or m/s.
        initial_rate: f64,
    },
    /// A prescribed motion.
    Motion(JointMotion),
}

impl From<JointMotion> for JointDrive {
    fn from(motion: JointMotion) -> Self {
        Self::Motion(motion)
    }
}

impl JointDrive {
    /// Whether a force moves the joint, so that its position and rate are part of the state.
    pub fn is_free(&self) -> bool {
        matches!(self, Self::Force { .. })
    }

    /// Whether a motor moves the joint.
    pub fn has_motor(&self) -> bool {
        matches!(self, Self::Force { motor, .. } if *motor != ForceProfile::none())
    }

    /// Position at time zero, rad or m.
    pub(crate) fn first_position(&self) -> f64 {
        match self {
            Self::Force {
                initial_position, ..
            } => *initial_position,
            Self::Motion(motion) => motion.at(0.0, 0.0).value,
        }
    }

    /// The times at which integration restarts, s.
    pub fn breaks(&self) -> &[f64] {
        match self {
            Self::Force { motor, .. } => motor.breaks(),
            Self::Motion(motion) => motion.breaks(),
        }
    }
}
