//! Mass matrix of the free-floating tree by composite bodies (Featherstone 2008, ch. 6 and 9.3), with the blocks
//! `H_b` and `H_bm` of Xu et al. 2017, (13)-(26), taken about `Bo` in base axes.
//!
//! ```text
//! [l; h]        = H_b [v; w] + H_bm q'                  Xu (15), (23): the momentum
//! joint momenta = H_bm^T [v; w] + H_m q'
//! ```

use crate::algebra::{M3, V3};
use crate::inertial::Inertial;
use crate::kinematics::Kinematics;
use crate::momentum::composite;
use crate::tree::{Motion, Tree};
use alloc::vec;
use alloc::vec::Vec;
use poinsot_spatial::{InertialParameters, Matrix6, Vector3, Vector6, stacked};

/// The blocks of the mass matrix, and the scratch to fill them. No call allocates.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let mut mass_matrix = MassMatrix::new(&tree);
/// mass_matrix.set(&tree, &bodies, &kinematics);
/// // About the hinge the arm has 1.5 kg m2; its rate gives 2.5 N m s about Bo.
/// assert_eq!((mass_matrix.H_m[0], mass_matrix.H_bm[0][5]), (1.5, 2.5));
/// assert_eq!(mass_matrix.H_b[(5, 5)], 5.5);
/// ```
#[derive(Debug, Clone)]
pub struct MassMatrix {
    /// Momentum about `Bo` per unit base twist, linear part first.
    pub H_b: Matrix6,
    /// Momentum about `Bo` per unit rate of each joint coordinate, `[l; h]`.
    pub H_bm: Vec<Vector6>,
    /// Symmetric block of the joint coordinates, row by row, `dof x dof`.
    pub H_m: Vec<f64>,
    carried: Vec<Inertial<f64>>,
}

impl MassMatrix {
    /// Scratch for a tree.
    pub fn new(tree: &Tree) -> Self {
        Self {
            H_b: Matrix6::zeros(),
            H_bm: vec![Vector6::zeros(); tree.dof()],
            H_m: vec![0.0; tree.dof() * tree.dof()],
            carried: vec![Inertial::nothing(0.0); tree.bodies()],
        }
    }

    /// Fills the blocks at the placement of the kinematics.
    pub fn set(&mut self, tree: &Tree, parameters: &[InertialParameters], kinematics: &Kinematics) {
        self.set_carried(tree, parameters, kinematics);
        self.H_b = composite(parameters, kinematics).locked_inertia();
        self.H_m.fill(0.0);
        let n = tree.dof();
        for (i, link) in tree.links.iter().enumerate().skip(1) {
            let (Motion::Revolute(k) | Motion::Prismatic(k)) = link.motion else {
                continue;
            };
            let (force, mut torque) = self.of_unit_rate(tree, kinematics, i);
            // Up the tree: coupling of this joint with each joint on the way.
            let mut at = i;
            while at > 0 {
                let above = &tree.links[at];
                let axis = above.axis_B(&kinematics.R[at]);
                match above.motion {
                    Motion::Revolute(j) => self.set_pair(n, j, k, axis.dot(&torque)),
                    Motion::Prismatic(j) => self.set_pair(n, j, k, axis.dot(&force)),
                    Motion::Fixed | Motion::Free => {}
                }
                let r = kinematics.p[at] - kinematics.p[above.parent];
                torque += r.cross(&force);
                at = above.parent;
            }
            self.H_bm[k] = stacked(&force, &torque);
        }
    }

    fn set_pair(&mut self, n: usize, j: usize, k: usize, value: f64) {
        self.H_m[j * n + k] = value;
        self.H_m[k * n + j] = value;
    }

    /// Each body with its subtree, about its own origin, in base axes.
    fn set_carried(
        &mut self,
        tree: &Tree,
        parameters: &[InertialParameters],
        kinematics: &Kinematics,
    ) {
        for (i, body) in parameters.iter().enumerate() {
            self.carried[i] = Inertial::of(body).turned(&M3::of(&kinematics.R[i]));
        }
        for (i, link) in tree.links.iter().enumerate().skip(1).rev() {
            let r = kinematics.p[i] - kinematics.p[link.parent];
            let child = self.carried[i].seen_from(&V3::of(&r));
            self.carried[link.parent] += child;
        }
    }

    /// Momentum `l`, `h` about body i's origin of what it carries, per unit rate of its joint.
    fn of_unit_rate(&self, tree: &Tree, kinematics: &Kinematics, i: usize) -> (Vector3, Vector3) {
        let (link, carried) = (&tree.links[i], &self.carried[i]);
        let axis = link.axis_in_base(&M3::of(&kinematics.R[i]));
        let (l, h) = match link.motion {
            Motion::Prismatic(_) => (axis * carried.mass, carried.mc.cross(&axis)),
            _ => (axis.cross(&carried.mc), carried.I.times(&axis)),
        };
        (l.stored(), h.stored())
    }
}
