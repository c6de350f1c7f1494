//! What drives a vehicle, and its initial state.

use crate::motion::attitude_control::AttitudeControl;
use crate::motion::joint_drive::JointDrive;
use crate::motion::joint_motion::JointMotion;
use crate::motion::wheel_motion::WheelMotion;
use crate::thrust::Firing;
use crate::vehicle::Vehicle;
use poinsot_spatial::{UnitQuaternion, Vector3};

/// What drives a vehicle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plan {
    /// One per joint coordinate of the tree.
    pub joints: Vec<JointDrive>,
    /// One per wheel.
    pub wheels: Vec<WheelMotion>,
    /// In any order; firings of one thruster add up.
    pub firings: Vec<Firing>,
    /// The law of the controlled wheels.
    pub control: Option<AttitudeControl>,
}

/// Pose and motion at the first instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// `R_NB`.
    pub R_NB: UnitQuaternion,
    /// Position of the base origin, in N, m.
    pub p_NoBo_N: Vector3,
    /// How it moves.
    pub velocity: StartVelocity,
}

/// Initial velocity: of the base, or momentum of the system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StartVelocity {
    /// Twist of the base.
    Twist {
        /// Velocity of the base origin, in N, m/s.
        v_NBo_N: Vector3,
        /// Angular velocity of the base, in B, rad/s.
        w_NB_B: Vector3,
    },
    /// Momentum of the system, joint rates and wheels included.
    Momentum {
        /// Linear momentum in N, N s.
        l_S_N: Vector3,
        /// Angular momentum about the system's mass centre in N, N m s.
        h_SScm_N: Vector3,
    },
}

impl Start {
    /// At the origin of N, axes aligned, without any momentum.
    pub fn at_rest() -> Self {
        Self {
            R_NB: UnitQuaternion::identity(),
            p_NoBo_N: Vector3::zeros(),
            velocity: StartVelocity::Momentum {
                l_S_N: Vector3::zeros(),
                h_SScm_N: Vector3::zeros(),
            },
        }
    }
}

impl Plan {
    /// Joints at their locked positions, wheels at rest relative to their hosts, thrusters off.
    pub fn hold(vehicle: impl Into<Vehicle>) -> Self {
        let vehicle: Vehicle = vehicle.into();
        let locked = vehicle.locked_at.iter();
        Self {
            joints: locked.map(|at| JointMotion::locked(*at).into()).collect(),
            wheels: vec![WheelMotion::constant(0.0); vehicle.spin_inertia.len()],
            ..Self::default()
        }
    }

    /// The times at which some derivative of the motion jumps, s, ascending.
    pub fn breaks(&self) -> Vec<f64> {
        let joints = self.joints.iter().flat_map(|j| j.breaks());
        let wheels = self.wheels.iter().flat_map(|w| w.breaks());
        let firings = self.firings.iter().flat_map(|f| [f.on, f.off]);
        let mut times: Vec<f64> = joints.chain(wheels).copied().chain(firings).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

/// The smooth stretches between breaks.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothIntervals {
    breaks: Vec<f64>,
}

impl SmoothIntervals {
    /// Between ascending breaks.
    pub fn new(breaks: Vec<f64>) -> Self {
        Self { breaks }
    }

    /// A time inside the stretch that begins at or before `t` (the limit from the right at a break), and
    /// where that stretch ends.
    pub fn of(&self, t: f64) -> (f64, f64) {
        let i = self.breaks.partition_point(|b| *b <= t);
        let start = i.checked_sub(1).and_then(|i| self.breaks.get(i));
        match (start, self.breaks.get(i)) {
            (Some(start), Some(end)) => (0.5 * start + 0.5 * end, *end),
            (Some(start), None) => (start + 1.0, f64::INFINITY),
            (None, Some(end)) => (end - 1.0, *end),
            (None, None) => (t, f64::INFINITY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_break_belongs_to_the_stretch_after_it() {
        let s = SmoothIntervals::new(vec![0.0, 2.0, 6.0]);
        assert_eq!(s.of(-3.0), (-1.0, 0.0));
        assert_eq!(s.of(0.0), (1.0, 2.0));
        assert_eq!(s.of(1.9), (1.0, 2.0));
        assert_eq!(s.of(2.0), (4.0, 6.0));
        assert_eq!(s.of(6.0), (7.0, f64::INFINITY));
    }
}
