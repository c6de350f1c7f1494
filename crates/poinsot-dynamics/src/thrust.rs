//! Thruster firings, and the force and torque they put on the vehicle.

use crate::kinematics::Kinematics;
use crate::propellant::Propellant;
use poinsot_spatial::Vector3;

/// One firing of one thruster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Firing {
    /// Index of the thruster.
    pub thruster: usize,
    /// Ignition, s.
    pub on: f64,
    /// Cut-off, s.
    pub off: f64,
    /// Force while on, N.
    pub force: f64,
}

/// Position and direction of a thruster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nozzle {
    /// Index of the host body.
    pub body: usize,
    /// Position from the host's origin, in the host, m.
    pub p_BoT_B: Vector3,
    /// Unit direction of the force on the host, in the host.
    pub direction_B: Vector3,
    /// What it uses up; `None`: nothing.
    pub propellant: Option<Propellant>,
}

impl Firing {
    /// Impulse up to a time, N s.
    pub fn impulse_by(&self, time: f64) -> f64 {
        self.force * (time.min(self.off) - self.on).max(0.0)
    }
}

/// Fills the thrust of every thruster, N, on the smooth interval that holds `within`.
///
/// ```
/// use poinsot_dynamics::{Firing, thrust_levels};
///
/// let firings = [Firing { thruster: 0, on: 1.0, off: 3.0, force: 10.0 }];
/// let mut levels = [0.0; 2];
/// thrust_levels(&firings, 2.0, &mut levels);
/// assert_eq!(levels, [10.0, 0.0]);
/// thrust_levels(&firings, 4.0, &mut levels);
/// assert_eq!(levels, [0.0, 0.0]);
/// ```
#[inline]
pub fn thrust_levels(firings: &[Firing], within: f64, levels: &mut [f64]) {
    levels.fill(0.0);
    for firing in firings {
        let on = firing.on <= within && within < firing.off;
        if let Some(level) = levels.get_mut(firing.thruster).filter(|_| on) {
            *level += firing.force;
        }
    }
}

/// Times closer than this are one, s: round-off of the times of samples and switches.
pub const SAME_TIME: f64 = 1.0e-9;

/// Fills the thrust of every thruster, N, that a table of held values has at a time: a switch at that time is done.
///
/// ```
/// use poinsot_dynamics::{Firing, SAME_TIME, thrust_held, thrust_levels};
///
/// // A switch just after the time, by round-off, counts as done.
/// let firings = [Firing { thruster: 0, on: 1.0 + 0.1 * SAME_TIME, off: 3.0, force: 10.0 }];
/// let mut level = [0.0];
/// thrust_held(&firings, 1.0, &mut level);
/// assert_eq!(level, [10.0]);
/// thrust_levels(&firings, 1.0, &mut level);
/// assert_eq!(level, [0.0]);
/// ```
pub fn thrust_held(firings: &[Firing], time: f64, levels: &mut [f64]) {
    thrust_levels(firings, time + SAME_TIME, levels);
}

/// Force and torque about the base origin of all thrusters, in base axes, N and N m; point and direction
/// turn with the joints.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // A thruster at the end of the arm pushes along y.
/// let nozzle =
///     Nozzle { body: 1, p_BoT_B: Vector3::x(), direction_B: Vector3::y(), propellant: None };
/// let (force, torque) = thrust_wrench(&[nozzle], &kinematics, &[10.0]);
/// assert_eq!((force, torque), (Vector3::y() * 10.0, Vector3::z() * 20.0));
/// ```
#[inline]
pub fn thrust_wrench(
    nozzles: &[Nozzle],
    kinematics: &Kinematics,
    levels: &[f64],
) -> (Vector3, Vector3) {
    let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
    for (nozzle, level) in nozzles.iter().zip(levels) {
        if *level != 0.0 {
            let (R, p) = (&kinematics.R[nozzle.body], &kinematics.p[nozzle.body]);
            let f = R * nozzle.direction_B * *level;
            force += f;
            torque += (p + R * nozzle.p_BoT_B).cross(&f);
        }
    }
    (force, torque)
}
