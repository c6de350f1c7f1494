//! Propellant: mass that leaves the vehicle through its thrusters.
//!
//! It leaves a place of its body with the velocity `u` of that place; what the nozzle does to it is the thrust. A mass `dm` at `r`
//! takes its momentum along and moves the system's mass centre `c`, and no velocity jumps:
//!
//! ```text
//! dP = -dm u,     dh_Scm = -dm (r - c) x (u - v_Scm),     dc = -dm (r - c) / m
//! ```

use crate::momentum::body_momentum;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3, parallel_axis};

/// What a thruster uses up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Propellant {
    /// Mass used per impulse, kg/(N s): the inverse of the exhaust velocity.
    pub used: f64,
    /// Where it is taken from, in the thruster's host, m.
    pub p_BoF_B: Vector3,
}

impl Propellant {
    /// What the host loses per impulse, per N s.
    pub fn loss(&self) -> InertialParameters {
        InertialParameters::ZERO.with_added(self.used, &point_mass(&self.p_BoF_B))
    }
}

/// One kilogram at a point of a body.
///
/// ```
/// use poinsot_dynamics::point_mass;
/// use poinsot_spatial::{Matrix3, Vector3};
///
/// // 1 kg at x = 2 m has no inertia about x, and 4 kg m2 about y and z.
/// let point = point_mass(&(Vector3::x() * 2.0));
/// assert_eq!(point.mc_B, Vector3::x() * 2.0);
/// assert_eq!(point.I_BBo_B, Matrix3::from_diagonal(&Vector3::new(0.0, 4.0, 4.0)));
/// ```
pub fn point_mass(p_BoF_B: &Vector3) -> InertialParameters {
    InertialParameters {
        mass: 1.0,
        mc_B: *p_BoF_B,
        I_BBo_B: parallel_axis(1.0, p_BoF_B),
    }
}

/// Momentum that leaves with a part of a body, in B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaving {
    /// Linear, N s.
    pub l_B: Vector3,
    /// Angular about the system's mass centre, of which the mass centre's own move is taken off, N m s.
    pub h_Scm_B: Vector3,
    /// First moment of the part about the system's mass centre, kg m.
    pub first_moment_B: Vector3,
}

impl Leaving {
    /// `part` is in the axes of its body; rotation, place and velocities of the body and mass centre `c` and velocity `v_Scm` of the
    /// system are in B.
    pub fn new(
        part: &InertialParameters,
        (R, p): (&Matrix3, &Vector3),
        (v, w): (&Vector3, &Vector3),
        (c, v_Scm): (&Vector3, &Vector3),
    ) -> Self {
        let (l_B, h) = body_momentum(part, R, p, v, w);
        let first_moment_B = R * part.mc_B + (p - c) * part.mass;
        Self {
            l_B,
            h_Scm_B: h - c.cross(&l_B) - first_moment_B.cross(v_Scm),
            first_moment_B,
        }
    }
}
