//! D. H. Kim, D.-G. Choi, H.-S. Oh, "Inertia Estimation of Spacecraft Based on Modified Law of
//! Conservation of Angular Momentum", J. Astron. Space Sci. 27(4), 353-357 (2010),
//! doi 10.5140/JASS.2010.27.4.353. Numbers in brackets are the paper's equations.
//!
//! | paper | here | meaning |
//! |---|---|---|
//! | I | `I` | inertia of the spacecraft about its mass centre, wheels locked, kg m2 |
//! | omega | `w_NB_B` | angular velocity, body axes, rad/s |
//! | C, I_rw, omega_rw | [`wheel_momentum`] | allocation matrix (any number of wheels), spin inertia, speed relative to the body |
//! | P | `R_NB` transposed | inertial to body; q1, q2, q3, q4 = q_x, q_y, q_z, q_w (6) |
//! | Q | `Q` | change of wheel momentum relative to the body (8) |
//! | omega_x' omega_y ... | `G` | sums of products of rates |
//! | omega_y' Q_x ... | `K` | sums of products of Q and rates |
//!
//! **Assumed:** one rigid body; no external torque; wheel momentum and attitude known without error; rates
//! zero at the start (here optional, [`StartRate`]); products of inertia small beside the moments.
//!
//! **Cannot identify:** more than `I n` (three of six numbers) if the rates have a constant direction `n`, as in the
//! paper's own manoeuvre. The four estimators still print six numbers. The other three come from the minimum norm, the
//! neglected products, or noise in `G`. None of the four is consistent with noisy rates. See
//! `docs/methods/kim2010.md`.
//!
//! All of them are linear in the same two sums. With `M_k = P(t_k) P(0)^-1` and wheel momentum `h`
//!
//! ```text
//! Q_k = M_k h_0 - h_k                                          (8b)
//! I w_k = Q_k + M_k I w_0                                      (7), (11); w_0 = 0 in the paper
//! E(I) = sum_k (Q_k + M_k I w_0 - I w_k) w_k^T = K + L(I) - I G
//! ```
//!
//! and each estimator sets some elements of the 3 x 3 matrix `E(I)` to zero.

mod identify;
pub mod studies;
mod sums;

pub use identify::identify;
pub use sums::{
    Answer, ELEMENTS, Iterated, Manoeuvre, NAMES, StartRate, Sums, symmetric, wheel_momentum,
};

use crate::method::{Method, Named};

/// The five estimators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Nine elements together, (2)-(4).
    Batch,
    /// Each element separately, (8)-(10), (14).
    Conventional,
    /// Products from the moments and the other product of the row, (15).
    PreEstimate,
    /// Products from the moments only, (14)-(16).
    Suggested,
    /// (14)-(16) iterated: announced in the paper as future work.
    Iterated,
}

impl Named for Variant {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (
            Self::Suggested,
            "suggested",
            "products of inertia from the moments alone, (14)-(16)",
        ),
        (Self::Batch, "batch", "nine elements at once, (2)-(4)"),
        (
            Self::Conventional,
            "conventional",
            "every element alone, (8)-(10), (14)",
        ),
        (
            Self::PreEstimate,
            "pre-estimate",
            "each product with the other one of its row as (15) gives it",
        ),
        (
            Self::Iterated,
            "iterated",
            "(14)-(16) repeated, the paper's future work",
        ),
    ];
}

/// The method.
pub static METHOD: Method = Method {
    name: "kim2010",
    summary: "inertia of one body from the momentum of its wheels, attitude and rates",
    citation: "Kim, Choi, Oh, J. Astron. Space Sci. 27(4), 2010, doi 10.5140/JASS.2010.27.4.353",
    variants: Variant::texts,
    settings: &[],
    reads_accelerations: false,
    codes: &crate::explanations!["E0420", "E0421", "E0422", "E0423", "E0424", "E0425"],
    identify: |problem, variant, _| identify(problem, Variant::named("kim2010", variant)?),
    studies: studies::STUDIES,
};
