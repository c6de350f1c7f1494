//! Momentum of the recorded trees, compared with Pinocchio and MuJoCo.

use crate::error::BookError;
use poinsot_dynamics::{Kinematics, Link, Motion, Tree, momentum};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3};
use poinsot_testkit::momentum_sum::{KitJoint, body_motion};
use poinsot_testkit::trees::{TreeCase, load_trees, trees_path};

/// Largest relative differences over all trees.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Worst {
    /// Number of trees.
    pub trees: usize,
    /// Number of bodies of all trees.
    pub bodies: usize,
    /// Pinocchio: linear momentum, and angular momentum about the base origin, relative to the sum of the magnitudes
    /// of their terms.
    pub pinocchio: [f64; 2],
    /// MuJoCo: linear momentum, and angular momentum about the mass centre, relative likewise.
    pub mujoco: [f64; 2],
}

/// Computes the differences.
///
/// # Errors
/// The fixture is missing.
pub fn worst() -> Result<Worst, BookError> {
    let cases = load_trees().map_err(BookError::io(&trees_path()))?;
    let mut worst = Worst::default();
    for case in &cases {
        worst.trees += 1;
        worst.bodies += case.bodies.len();
        let [pinocchio, mujoco] = differences(case);
        for k in 0..2 {
            worst.pinocchio[k] = worst.pinocchio[k].max(pinocchio[k]);
            worst.mujoco[k] = worst.mujoco[k].max(mujoco[k]);
        }
    }
    Ok(worst)
}

fn differences(case: &TreeCase) -> [[f64; 2]; 2] {
    let tree = tree(case);
    let state = &case.state;
    let parameters: Vec<InertialParameters> = case
        .bodies
        .iter()
        .map(|b| {
            MassProperties {
                mass: b.mass,
                p_BoBcm_B: b.p_CoCcm_C,
                I_BBcm_B: b.I_CCcm_C,
            }
            .parameters()
        })
        .collect();
    let mut kinematics = Kinematics::new(&tree);
    kinematics.place(&tree, &state.q);
    kinematics.set_velocities(&tree, &state.v_NBo_B, &state.w_NB_B, &state.qd);
    let ours = momentum(&parameters, &kinematics);
    let [linear, angular] = scale(case);
    let parts = |x: &poinsot_spatial::Vector6| -> [Vector3; 2] {
        [x.fixed_rows::<3>(0).into(), x.fixed_rows::<3>(3).into()]
    };
    let [l, h] = parts(&ours);
    let [their_l, their_h] = parts(&case.pinocchio.momentum_about_base());
    let R: Matrix3 = state.R_NB;
    let l_N = R * l;
    let c_N = Vector3::from(case.mujoco.com) - state.p_NBo_N;
    let h_cm_N = R * h - c_N.cross(&l_N);
    [
        [
            (l - their_l).norm() / linear,
            (h - their_h).norm() / angular,
        ],
        [
            (l_N - Vector3::from(case.mujoco.l)).norm() / linear,
            (h_cm_N - Vector3::from(case.mujoco.h_com)).norm() / angular,
        ],
    ]
}

fn tree(case: &TreeCase) -> Tree {
    let mut coordinates = Vec::new();
    let links = case
        .bodies
        .iter()
        .enumerate()
        .map(|(i, b)| {
            let at = coordinates.len();
            let motion = match b.joint {
                KitJoint::Base => Motion::Free,
                KitJoint::Fixed => Motion::Fixed,
                KitJoint::Revolute => Motion::Revolute(at),
                KitJoint::Prismatic => Motion::Prismatic(at),
            };
            if matches!(b.joint, KitJoint::Revolute | KitJoint::Prismatic) {
                coordinates.push(i.saturating_sub(1));
            }
            Link::new(b.parent, motion, b.p_PoCo_P, b.R_PC_zero, b.axis_C)
        })
        .collect();
    Tree {
        links,
        rotors: Vec::new(),
        coordinates,
    }
}

/// Sums of the magnitudes of the terms of linear and angular momentum.
fn scale(case: &TreeCase) -> [f64; 2] {
    let mut scale = [0.0; 2];
    for (i, body) in case.bodies.iter().enumerate() {
        let m = body_motion(&case.bodies, &case.state, i);
        let arm = (m.p_NCcm_N - case.state.p_NBo_N).norm();
        scale[0] += body.mass * m.v_NCcm_N.norm();
        scale[1] += body.mass * arm * m.v_NCcm_N.norm() + body.I_CCcm_C.norm() * m.w_NC_N.norm();
    }
    scale
}
