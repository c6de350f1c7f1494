//! Ou Ma, Hung Dang, Khanh Pham, "On-Orbit Identification of Inertia Properties of Spacecraft Using a
//! Robotic Arm", Journal of Guidance, Control, and Dynamics 31(6), 2008, doi 10.2514/1.35188.
//!
//! An arm of known inertia moves and changes the velocities of the spacecraft body. Conservation of linear momentum
//! gives mass and mass centre; conservation of angular momentum then gives the inertia tensor. Each step is an
//! unweighted linear least-squares problem.
//!
//! | paper | here | meaning |
//! |---|---|---|
//! | `v_S`, `omega_S` | `v_NBo_N`, `w_NB_B` | velocity of the base origin, angular velocity of the base |
//! | `m_R`, `rho_R`, `I_R` | [`Arm`] | mass, mass centre from `Bo`, **central** inertia of the arm |
//! | `p_R`, `h_R` | [`Arm`] | momentum of the arm relative to the base, (27)-(28) |
//! | `m_S`, `rho_S`, `I_S` | [`TwoStep`] | mass, mass centre from `Bo`, central inertia of the base |
//! | `p_C(0)`, `h_C(0)` | [`Known`] | momentum, angular about the system mass centre, **in N** |
//! | `mu` | `mu` | reduced mass `m_S m_R / (m_S + m_R)` |
//! | `x`, `y` | `x`, `y` | `[m_R/m_S, rho_S]`, [`poinsot_spatial::elements`] of `I_S` |
//!
//! **Assumptions.** No external force or torque; base velocities and attitude and the arm's joints are
//! measured; the arm is known; the base is wholly unknown.
//!
//! **Differences from the print** (see `docs/methods/ma2008.md`).
//! - (7)-(9) hold in inertial axes; `rho_S`, `I_S` are constant in body axes. The rows here are the body-axes rows of
//!   (13), (20) with `R_k^T p_C(0)`, rotated to N by `R_k = R_NB`. Least squares is invariant under this rotation, and
//!   the increments of option 2 become exact: `A_k = R_k [a_k, [w_k]x] - R_0 [a_0, [w_0]x]`. (14), (17), (21), (24) as
//!   printed hold in no frame if the base rotates; [`printed`] keeps them for comparison.
//! - (25)-(26) take `I_R` about the origin of `F_S`; (2), (9), (20), (24) need it about the arm's own
//!   mass centre.
//! - Sec. II.B obtains relative velocities by integrating an accelerometer. Without a velocity channel option 2
//!   takes velocity increments or specific force of an instrument of the base, summed from the first sample.
//! - (8)-(9) omit the arm's momentum relative to the base, so they hold for stopped joints only. It is included here,
//!   with `u = p_R/m_R` and `h_R` about the arm's mass centre, so every sample is used.
//!
//! **What it cannot identify.** Without motion, nothing is identifiable. Without rotation of the base only the mass
//! is, and only with known non-zero momentum or moving joints. With stopped joints and no spin the inertia is not
//! identifiable. Sensor biases are not modelled, and noise in the regressor causes a bias.

mod answer;
mod arm;
pub mod bounds;
mod data;
mod equations;
pub mod printed;
mod solve;
pub mod studies;

pub use answer::identify;
pub use arm::{Arm, Raw, Reading, Vehicle};
pub use equations::{
    AngularRows, Given, Known, LinearRows, TwoStep, angular_rows, differences, linear_rows,
    two_step,
};
pub use solve::{Step, solve};

use crate::method::{Method, Named};

/// Option for both steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Option 1 for linear momentum, angular momentum or both, as given in the model.
    KnownMomentum,
    /// Option 2: both momenta are eliminated by differences.
    UnknownMomentum,
}

impl Named for Variant {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (
            Self::UnknownMomentum,
            "unknown-momentum",
            "option 2: increments eliminate the momentum",
        ),
        (
            Self::KnownMomentum,
            "known-momentum",
            "option 1: the model gives linear or angular momentum, or both",
        ),
    ];
}

/// The method.
pub static METHOD: Method = Method {
    name: "ma2008",
    summary: "mass, mass centre and inertia of the base from the motion of a known arm",
    citation: "Ma, Dang, Pham, J. Guidance Control Dynamics 31(6), 2008, doi 10.2514/1.35188",
    variants: Variant::texts,
    settings: &[],
    reads_accelerations: false,
    codes: &crate::explanations![
        "E0521", "E0522", "E0523", "E0524", "E0525", "E0526", "E0527", "E0528", "E0529"
    ],
    identify: |problem, variant, _| identify(problem, Variant::named("ma2008", variant)?),
    studies: studies::STUDIES,
};
