//! W. Xu, Z. Hu, Y. Zhang, B. Liang, "On-orbit identifying the inertia parameters of space robotic systems
//! using simple equivalent dynamics", Acta Astronautica (2017). Numbers in brackets are the paper's equations.
//!
//! With all joints locked the robot is one rigid body: from thrust, (35) gives its mass, mass centre and inertia. With
//! one joint unlocked it is two bodies: momentum is conserved, and (49) gives one of them. The other follows from the
//! first step by (43)-(46). Repeated for every joint, 1..n or n..1, this gives every body.
//!
//! | paper | here | meaning |
//! |---|---|---|
//! | `M`, `I_eq`, `r_cm` | [`Single`] | mass, central inertia, mass centre of the locked robot, base axes |
//! | `r_s`, `v_s'` | `p_BoS_B`, `a_NS_B` | position of the accelerometer, its measurement |
//! | `r_i`, `f_i` | `T_B`, `F_B` | position and force of the thrusters; here their sums `sum r x f`, `sum f` |
//! | `g`, `h` of (36) | [`SingleRow`] | residuals of (35) |
//! | `B~0`, `B~1` | `inner`, `outer` | base side and tip side of the unlocked joint |
//! | `m~`, `I~`, `a~` | [`poinsot_spatial::InertialParameters`] | of each side, about the origin of its own frame |
//! | `g`, `h` of (50), (51) | [`MomentumRow`] | momentum of both sides |
//! | `X`, `P_i`, `P_g`, `V`, `w`, `c1`, `c2` | [`swarm`] | particle swarm |
//!
//! **Assumptions.** Locked joints stay in one ("normal") configuration; thrust is known; momentum is zero while joints
//! move (the linear solution can also treat it as unknown); no wheels.
//!
//! **What it cannot identify.** The paper claims every number of every body. Motion, momentum and thrust of a tree
//! with n revolute joints determine `10 + 7 n` combinations: 52 of 70 for the paper's robot. Each two-body step leaves
//! three of its ten numbers unobservable: mass on the joint axis, first moment along it, and line inertia on it can be
//! attributed to either side. A search returns an arbitrary point of its range for them. See `docs/methods/xu2017.md`.
//!
//! **Misprints followed in the corrected form:** (29), (30) `r_s` is the thruster's position `r_i`; (34) lacks the
//! sensor's acceleration and has the signs of (35) reversed; (42) is
//! `p0 = (M r_g - m0 A0 a0 - m1 (A0 l0 + A1 a1)) / (m0 + m1)`; (50) is `m0 v0 + m1 v1`; (59) holds Iyy in row 2; (68)
//! omits `m1 = M - m0`, so that `dP/dm0 = v0 - v1`.

mod identify;
mod least_squares;
mod roles;
pub mod sensitivity;
mod sequence;
mod settings;
mod single_body;
pub mod studies;
pub mod swarm;
mod two_body;

pub use identify::identify;
pub use least_squares::Answer;
pub use sequence::{Found, Order, Searched, Solver, StepReport, sequence};
pub use single_body::{
    Form, Part, Push, Single, SingleObjective, SingleRow, accelerations, momenta, solve_single,
};
use swarm::Particle;
pub use two_body::{MomentumRow, Side, TwoBodyObjective, TwoBodyReading, rows};

use crate::method::{Method, Named};
use nalgebra::SMatrix;
use poinsot_spatial::{MassProperties, Vector3};

/// Solver and joint order, as named on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Variant {
    /// Linear solution or particle swarm.
    pub solver: Kind,
    /// Joints from base to tip, or reverse.
    pub order: Order,
}

/// Linear solution or particle swarm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Linear least squares on the residuals of (35) and (49).
    Linear,
    /// The paper's particle swarm for (37) and (52).
    Swarm,
}

impl Variant {
    const fn new(solver: Kind, order: Order) -> Self {
        Self { solver, order }
    }
}

impl Named for Variant {
    const ALL: &'static [(Self, &'static str, &'static str)] = &[
        (
            Self::new(Kind::Swarm, Order::Outward),
            "swarm",
            "particle swarm, joints from base to tip",
        ),
        (
            Self::new(Kind::Linear, Order::Outward),
            "linear",
            "linear least squares, joints from base to tip",
        ),
        (
            Self::new(Kind::Swarm, Order::Inward),
            "swarm-inward",
            "particle swarm, joints from tip to base",
        ),
        (
            Self::new(Kind::Linear, Order::Inward),
            "linear-inward",
            "linear least squares, joints from tip to base",
        ),
    ];
}

/// The method.
pub static METHOD: Method = Method {
    name: "xu2017",
    summary: "every body of an arm, joint after joint, from thrust and conserved momentum",
    citation: "Xu, Hu, Zhang, Liang, Acta Astronautica, 2017",
    variants: Variant::texts,
    settings: settings::SETTINGS,
    reads_accelerations: true,
    codes: &crate::explanations![
        "E0531", "E0532", "E0533", "E0534", "E0535", "E0536", "E0537", "E0538", "E0539", "E0540"
    ],
    identify: |problem, variant, settings| {
        let variant = Variant::named("xu2017", variant)?;
        let solver = settings::solver(variant.solver, settings)?;
        identify(problem, variant, &solver)
    },
    studies: studies::STUDIES,
};

/// `K` with `I w = K y`, `y = [xx, yy, zz, xy, xz, yz]` in the order of (61).
#[inline]
fn tensor_regressor(w: &Vector3) -> SMatrix<f64, 3, 6> {
    let own = poinsot_spatial::tensor_regressor(w);
    SMatrix::from_fn(|i, j| own[(i, ORDER[1 + j] - 4)])
}

/// The paper's order (61), (62) among the ten numbers of a body.
const ORDER: [usize; 10] = [0, 4, 6, 9, 5, 7, 8, 1, 2, 3];

/// The ten numbers of (61), (62): mass, central inertia in the paper's order, mass centre.
///
/// ```
/// use poinsot_papers::xu2017::{particle, properties};
/// use poinsot_spatial::{MassProperties, Matrix3, Vector3};
///
/// let I_BBcm_B = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5));
/// let body = MassProperties { mass: 10.0, p_BoBcm_B: Vector3::x(), I_BBcm_B };
/// assert_eq!(particle(&body), [10.0, 1.0, 2.0, 2.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
/// assert_eq!(properties(&particle(&body)), body);
/// ```
pub fn particle(body: &MassProperties) -> Particle {
    let ten = body.to_array();
    ORDER.map(|k| ten[k])
}

/// The inverse of [`particle`].
///
/// ```
/// use poinsot_papers::xu2017::properties;
///
/// let body = properties(&[10.0, 1.0, 2.0, 2.5, 0.1, 0.2, 0.3, 1.0, 0.0, 0.0]);
/// assert_eq!((body.mass, body.I_BBcm_B[(1, 2)], body.p_BoBcm_B.x), (10.0, 0.3, 1.0));
/// ```
pub fn properties(x: &Particle) -> MassProperties {
    let mut ten = [0.0; 10];
    ORDER.into_iter().zip(x).for_each(|(k, x)| ten[k] = *x);
    MassProperties::from_array(&ten)
}

/// Natural units m, m L, m L^2 of the ten parameters.
fn natural(body: &MassProperties) -> [f64; 10] {
    let (m, L) = (body.mass, body.radius_of_gyration().max(1.0e-3));
    std::array::from_fn(|k| match k {
        0 => m,
        1..=3 => m * L,
        _ => m * L * L,
    })
}
