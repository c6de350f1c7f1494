//! Inverse dynamics of the free-floating tree: the forces for given accelerations (Newton-Euler recursion; Luh, Walker,
//! Paul 1980; Featherstone 2008, ch. 5).

use crate::acceleration::Accelerations;
use crate::kinematics::Kinematics;
use crate::momentum::Wrench;
use crate::tree::{Motion, Tree};
use alloc::vec;
use alloc::vec::Vec;
use poinsot_spatial::InertialParameters;

/// Workspace of the Newton-Euler recursion. No call allocates.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // The joint accelerates at 1 rad/s2 with the base at rest.
/// let mut accelerations = Accelerations::new(&tree);
/// accelerations.set_without_base(&tree, &kinematics, &[0.0], &[1.0]);
/// let mut torque = [0.0];
/// let mut inverse = InverseDynamics::new(&tree);
/// let on_base = inverse.solve(&tree, &bodies, &kinematics, &accelerations, &[], &mut torque);
/// // The arm's 1.5 kg m2 about its hinge; the base must be held with the force on its mass centre.
/// assert_eq!((torque[0], on_base.force), (1.5, Vector3::y()));
/// ```
#[derive(Debug, Clone)]
pub struct InverseDynamics {
    /// What the joint of each body transmits to it, about that body's origin, in base axes; for the base the external
    /// wrench.
    pub transmitted: Vec<Wrench>,
}

impl InverseDynamics {
    /// Scratch for a tree.
    pub fn new(tree: &Tree) -> Self {
        Self {
            transmitted: vec![Wrench::ZERO; tree.bodies()],
        }
    }

    /// Forces along the joints (N m or N, one per coordinate) and, returned, the wrench on the base about
    /// `Bo`, that give the bodies the accelerations given while the wrenches `outside` (about each body's
    /// origin, in base axes; may be empty) act on them.
    pub fn solve(
        &mut self,
        tree: &Tree,
        parameters: &[InertialParameters],
        kinematics: &Kinematics,
        accelerations: &Accelerations,
        outside: &[Wrench],
        joint_forces: &mut [f64],
    ) -> Wrench {
        for (i, body) in parameters.iter().enumerate() {
            let own = &mut self.transmitted[i];
            *own = accelerations.body_rate(body, kinematics, i);
            let given = outside.get(i).unwrap_or(&Wrench::ZERO);
            own.force -= given.force;
            own.torque -= given.torque;
        }
        for (i, link) in tree.links.iter().enumerate().skip(1).rev() {
            let Wrench { force, torque } = self.transmitted[i];
            match link.motion {
                Motion::Revolute(k) => joint_forces[k] = link.axis_B(&kinematics.R[i]).dot(&torque),
                Motion::Prismatic(k) => joint_forces[k] = link.axis_B(&kinematics.R[i]).dot(&force),
                Motion::Fixed | Motion::Free => {}
            }
            let r = kinematics.p[i] - kinematics.p[link.parent];
            let parent = &mut self.transmitted[link.parent];
            parent.force += force;
            parent.torque += torque + r.cross(&force);
        }
        self.transmitted.first().copied().unwrap_or(Wrench::ZERO)
    }
}
