//! Dynamics of the recorded trees by Pinocchio and MuJoCo, from `validation/trees/dynamics.jsonl`.
//!
//! The layout of the file is in `validation/trees/README.md`.

use poinsot_testkit::Matrix3;
use poinsot_testkit::trees::{TreeCase, load_trees, trees_path};
use serde::Deserialize;
use std::io;

/// Mass, kg, and inertia about each axis, kg m2, given to massless bodies of the trees.
const FILL: (f64, f64) = (1.0, 0.1);

/// Inputs and results for one tree. Vectors over the whole tree hold the base first (linear before angular part), then
/// the joint coordinates; all in base axes, moments about the base origin.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TreeDynamics {
    /// Force and torque on the base about its origin, N, N m.
    pub wrench_Bo_B: [f64; 6],
    /// Force of each joint, N m or N.
    pub force: Vec<f64>,
    /// Accelerations for inverse dynamics, also the vector multiplied by the mass matrix.
    pub given: Vec<f64>,
    /// Load at the origin of the last body.
    pub load_B: [f64; 6],
    /// Results of Pinocchio.
    pub pinocchio: DynamicsAnswer,
    /// Results of MuJoCo.
    pub mujoco: ForwardAnswer,
}

/// Results of Pinocchio.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DynamicsAnswer {
    /// `aba`: inertial acceleration of the base origin, angular acceleration, joint accelerations, for wrench and
    /// forces.
    pub acceleration: Vec<f64>,
    /// `rnea`: base wrench and joint forces for the given accelerations.
    pub inverse: Vec<f64>,
    /// `crba`.
    pub mass_matrix_times_given: Vec<f64>,
    /// Twist of the origin of the last body, by its Jacobian.
    pub tip_twist: [f64; 6],
    /// Transposed Jacobian times the load.
    pub tip_transpose_load: Vec<f64>,
}

/// Results of MuJoCo.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForwardAnswer {
    /// `mj_forward`.
    pub acceleration: Vec<f64>,
}

/// The recorded trees with their dynamics; every body has mass.
///
/// # Errors
/// A file is missing, or a line is invalid (the message names the line).
pub fn load_tree_dynamics() -> io::Result<Vec<(TreeCase, TreeDynamics)>> {
    let text = std::fs::read_to_string(trees_path().with_file_name("dynamics.jsonl"))?;
    let answers: Vec<TreeDynamics> = text
        .lines()
        .enumerate()
        .map(|(i, line)| {
            serde_json::from_str(line)
                .map_err(|e| io::Error::other(format!("dynamics.jsonl:{}: {e}", i + 1)))
        })
        .collect::<io::Result<_>>()?;
    let mut trees = load_trees()?;
    for body in trees.iter_mut().flat_map(|tree| &mut tree.bodies) {
        if body.mass == 0.0 {
            body.mass = FILL.0;
            body.I_CCcm_C = Matrix3::identity() * FILL.1;
        }
    }
    if trees.len() != answers.len() {
        return Err(io::Error::other("as many lines of dynamics as trees"));
    }
    Ok(trees.into_iter().zip(answers).collect())
}
