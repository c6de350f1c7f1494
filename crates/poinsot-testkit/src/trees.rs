//! The recorded trees of `validation/trees` with the results of Pinocchio and MuJoCo.
//!
//! The layout of the file is in `validation/trees/README.md`.

use crate::momentum_sum::{KitBody, KitJoint, KitState};
use crate::{Matrix3, Matrix6, Vector3, Vector6};
use serde::Deserialize;
use std::io;
use std::path::PathBuf;

/// Results of one independent program for a tree.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineAnswer {
    /// Total mass, kg.
    pub mass: f64,
    /// Mass centre of the system in N, m.
    pub com: [f64; 3],
    /// Linear momentum in N, kg m/s.
    pub l: [f64; 3],
    /// Angular momentum about the system's mass centre in N, kg m2/s.
    pub h_com: [f64; 3],
    /// Kinetic energy, J.
    pub kinetic_energy: f64,
    /// Lower triangle, row by row, of the 6 x 6 locked inertia about the base origin in base axes; zero from MuJoCo, which does not
    /// provide it.
    #[serde(default)]
    pub H_lower: [f64; 21],
    /// Momentum `[l; h]` about the base origin in base axes; zero from MuJoCo.
    #[serde(default)]
    pub momentum_Bo_B: [f64; 6],
}

impl EngineAnswer {
    /// The locked inertia about the base origin in base axes, linear part first.
    pub fn locked_inertia(&self) -> Matrix6 {
        Matrix6::from_fn(|r, c| {
            let (r, c) = (r.max(c), r.min(c));
            self.H_lower[r * (r + 1) / 2 + c]
        })
    }

    /// Momentum `[l; h]` about the base origin in base axes.
    pub fn momentum_about_base(&self) -> Vector6 {
        Vector6::from(self.momentum_Bo_B)
    }
}

/// One recorded tree in one state.
#[derive(Debug, Clone, PartialEq)]
pub struct TreeCase {
    /// The bodies, base first, parents before children.
    pub bodies: Vec<KitBody>,
    /// Pose, twist and joints; no wheels.
    pub state: KitState,
    /// Recorded base attitude: Hamilton, scalar last, body to inertial.
    pub q_NB_xyzw: [f64; 4],
    /// Results of Pinocchio.
    pub pinocchio: EngineAnswer,
    /// Results of MuJoCo.
    pub mujoco: EngineAnswer,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyRecord {
    parent: i64,
    kind: KitJoint,
    p_PoCo_P: [f64; 3],
    R_PC_zero: [f64; 9],
    axis_C: [f64; 3],
    mass: f64,
    com: [f64; 3],
    /// xx, xy, yy, xz, yz, zz
    I_com: [f64; 6],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TreeRecord {
    bodies: Vec<BodyRecord>,
    q_NB_xyzw: [f64; 4],
    p_NBo_N: [f64; 3],
    v_NBo_B: [f64; 3],
    w_NB_B: [f64; 3],
    q: Vec<f64>,
    qd: Vec<f64>,
    pinocchio: EngineAnswer,
    mujoco: EngineAnswer,
}

impl BodyRecord {
    fn body(&self) -> KitBody {
        let [xx, xy, yy, xz, yz, zz] = self.I_com;
        KitBody {
            parent: usize::try_from(self.parent).unwrap_or(0),
            joint: self.kind,
            p_PoCo_P: self.p_PoCo_P.into(),
            R_PC_zero: Matrix3::from_row_slice(&self.R_PC_zero),
            axis_C: self.axis_C.into(),
            mass: self.mass,
            p_CoCcm_C: self.com.into(),
            I_CCcm_C: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        }
    }
}

impl TreeRecord {
    fn case(self) -> TreeCase {
        TreeCase {
            bodies: self.bodies.iter().map(BodyRecord::body).collect(),
            state: KitState {
                R_NB: rotation_from_xyzw(self.q_NB_xyzw),
                p_NBo_N: self.p_NBo_N.into(),
                v_NBo_B: self.v_NBo_B.into(),
                w_NB_B: self.w_NB_B.into(),
                q: self.q,
                qd: self.qd,
                wheel_speeds: Vec::new(),
            },
            q_NB_xyzw: self.q_NB_xyzw,
            pinocchio: self.pinocchio,
            mujoco: self.mujoco,
        }
    }
}

/// Rotation matrix of a unit quaternion, Hamilton, scalar last: `R u = u + 2 s (a x u) + 2 a x (a x u)`.
pub fn rotation_from_xyzw([x, y, z, w]: [f64; 4]) -> Matrix3 {
    let a = Vector3::new(x, y, z);
    let turned = |u: Vector3| u + 2.0 * w * a.cross(&u) + 2.0 * a.cross(&a.cross(&u));
    Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(turned))
}

/// Path of the recorded trees.
pub fn trees_path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../validation/trees/trees.jsonl")
}

/// All recorded trees, in the order of the file.
///
/// # Errors
/// The file is missing, or a line is invalid (the message names the line).
pub fn load_trees() -> io::Result<Vec<TreeCase>> {
    let text = std::fs::read_to_string(trees_path())?;
    text.lines()
        .enumerate()
        .map(|(i, line)| {
            serde_json::from_str::<TreeRecord>(line)
                .map(TreeRecord::case)
                .map_err(|e| io::Error::other(format!("trees.jsonl:{}: {e}", i + 1)))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_fixture_is_complete() {
        let trees = load_trees().unwrap();
        assert_eq!(trees.len(), 1000);
        let count = |joint| {
            let of = |t: &TreeCase| t.bodies.iter().filter(|b| b.joint == joint).count();
            trees.iter().map(of).sum::<usize>()
        };
        assert_eq!(count(KitJoint::Base), 1000);
        assert!(count(KitJoint::Revolute) > 3000);
        assert!(count(KitJoint::Prismatic) > 1000);
        assert!(count(KitJoint::Fixed) > 500);
        let hollow = |t: &&TreeCase| t.bodies.iter().any(|b| b.mass == 0.0);
        assert!(trees.iter().filter(hollow).count() > 300);
        for tree in &trees {
            let moving = tree
                .bodies
                .iter()
                .filter(|b| matches!(b.joint, KitJoint::Revolute | KitJoint::Prismatic))
                .count();
            assert_eq!(moving, tree.state.q.len());
            assert_eq!(moving, tree.state.qd.len());
            for (i, body) in tree.bodies.iter().enumerate().skip(1) {
                assert!(body.parent < i);
                let R = body.R_PC_zero;
                assert!((R * R.transpose() - Matrix3::identity()).norm() < 3e-15);
                assert!((body.axis_C.norm() - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn exact_quarter_turn_about_z() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let R = rotation_from_xyzw([0.0, 0.0, half, half]);
        assert!((R * Vector3::x() - Vector3::y()).norm() < 1e-15);
    }
}
