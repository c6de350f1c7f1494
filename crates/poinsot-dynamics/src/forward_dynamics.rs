//! Forward dynamics of the free-floating tree: the articulated-body algorithm (Featherstone 2008, ch. 7
//! and 9.4), in base axes, every body about its own origin `Co`.
//!
//! With `a`, `alpha` the inertial accelerations of body C (of its origin; angular) and `F`, `N` the force
//! and torque about `Co` that the joint puts on it,
//!
//! ```text
//! [F; N] = IA [a; alpha] + bias,      IA = [[M, C], [C^T, J]]  symmetric,
//! a_C = a_P + alpha_P x r + s q'',    alpha_C = alpha_P + s q''      (r = p_PoCo; s slides or turns)
//! s . [F; N] = tau   =>   q'' = (tau - s . bias - U . a) / D,   U = IA s,   D = s . U
//! ```
//!
//! and the inertia passed to the parent is `IA - U U^T / D`, moved from `Co` to `Po`. Accelerations are split into the
//! part that velocities and prescribed joints cause while the base does not accelerate, which enters the bias of each
//! body, and the rest, which is linear in the unknowns: no product `IA c` is formed, and the linear velocity of the
//! base does not appear at all. No wheel, no spring, no gravity in here: they are forces
//! ([`ForwardDynamics::add_wrench`]).

use crate::algebra::{M3, Real, V3};
use crate::articulated::{Articulated, round_off};
use crate::inertial::Inertial;
use crate::kinematics::Kinematics;
use crate::tree::{Link, Motion, Tree};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;
use poinsot_spatial::InertialParameters;

/// Input of a joint at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointInput<T = f64> {
    /// Total force along the axis: N m (revolute) or N (prismatic), on the child.
    Force(T),
    /// Prescribed acceleration, rad/s2 or m/s2, with the force that it needs.
    Acceleration(T),
}

/// Why there is no unique acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Singular {
    /// A joint has no outboard inertia.
    #[error(
        "joint coordinate {0} has no inertia: its outboard bodies have no mass or inertia about it"
    )]
    Joint(usize),
    /// The vehicle has no mass or no inertia.
    #[error("the vehicle has no mass, or no inertia about some axis")]
    Base,
}

/// Scratch of one body.
#[derive(Debug, Clone, Copy)]
struct Node<T> {
    /// In base axes about Co: first of this body alone, then with all outboard bodies. Before the solution the bias is
    /// minus the wrench from outside.
    inertia: Articulated<T>,
    /// Joint axis, and position from the parent's origin.
    axis: V3<T>,
    r: V3<T>,
    /// Projection of the joint; zero where it is not free.
    U_l: V3<T>,
    U_a: V3<T>,
    D_inverse: T,
    u: T,
    /// Acceleration while the base does not accelerate.
    a: V3<T>,
    alpha: V3<T>,
    /// The remaining part.
    da: V3<T>,
    dalpha: V3<T>,
}

/// Workspace of the articulated-body algorithm. No call allocates.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // At rest, with 1 N m of motor torque.
/// let mut dynamics = ForwardDynamics::new(&tree);
/// dynamics.set_bodies(&tree, &bodies, &kinematics);
/// let mut acceleration = [0.0];
/// dynamics.solve(&tree, &kinematics, &[0.0], &[JointInput::Force(1.0)], &mut acceleration)?;
/// // No momentum: the base turns back by 0.44 of the joint's acceleration.
/// let (_, alpha) = dynamics.acceleration(0);
/// assert!((alpha.z + 0.44 * acceleration[0]).abs() < 1.0e-12);
/// # Ok::<(), Singular>(())
/// ```
#[derive(Debug, Clone)]
pub struct ForwardDynamics<T = f64> {
    nodes: Vec<Node<T>>,
}

impl ForwardDynamics {
    /// Scratch for a tree.
    pub fn new(tree: &Tree) -> Self {
        Self::over(tree, 0.0)
    }

    /// Sets the kinematics and inertial parameters of the bodies, and clears all wrenches. First call of each
    /// evaluation, after [`Kinematics::place`].
    #[inline]
    pub fn set_bodies(
        &mut self,
        tree: &Tree,
        parameters: &[InertialParameters],
        kinematics: &Kinematics,
    ) {
        self.set_inertias(tree, parameters.iter().map(Inertial::of), kinematics);
    }
}

impl<T: Real> ForwardDynamics<T> {
    /// Scratch for a tree over the numbers of `zero`.
    #[inline(always)]
    pub(crate) fn over(tree: &Tree, zero: T) -> Self {
        let nothing = V3::all(zero);
        let node = Node {
            inertia: Articulated::of(&Inertial::nothing(zero)),
            axis: nothing,
            r: nothing,
            U_l: nothing,
            U_a: nothing,
            D_inverse: zero,
            u: zero,
            a: nothing,
            alpha: nothing,
            da: nothing,
            dalpha: nothing,
        };
        Self {
            nodes: vec![node; tree.bodies()],
        }
    }

    /// [`Self::set_bodies`] over any numbers.
    #[inline(always)]
    pub(crate) fn set_inertias(
        &mut self,
        tree: &Tree,
        bodies: impl Iterator<Item = Inertial<T>>,
        kinematics: &Kinematics<T>,
    ) {
        let links = tree.links.iter().zip(bodies);
        for (i, (node, (link, body))) in self.nodes.iter_mut().zip(links).enumerate() {
            let R = M3::of(&kinematics.R[i]);
            node.inertia = Articulated::of(&body.turned(&R));
            node.r = V3::of(&kinematics.p[i]) - V3::of(&kinematics.p[link.parent]);
            node.axis = link.axis_in_base(&R);
        }
    }

    /// Adds a force and a torque about the origin of body `i`, both from outside the tree or from a wheel, in
    /// base axes, N and N m.
    #[inline(always)]
    pub fn add_wrench(&mut self, i: usize, force_B: &Vector3<T>, torque_Co_B: &Vector3<T>) {
        if let Some(node) = self.nodes.get_mut(i) {
            node.inertia.F += -V3::of(force_B);
            node.inertia.N += -V3::of(torque_Co_B);
        }
    }

    /// Body `i` alone as [`Self::set_inertias`] left it, its joint axis, and its position from the parent's origin.
    #[cfg(feature = "std")]
    #[inline(always)]
    pub(crate) fn body(&self, i: usize) -> (Inertial<T>, V3<T>, V3<T>) {
        let node = &self.nodes[i];
        (node.inertia.of_one_body(), node.axis, node.r)
    }

    /// Joint accelerations (rad/s2 or m/s2, one per coordinate) from what drives the joints; the kinematics
    /// hold the velocities. The accelerations of the bodies follow from [`Self::acceleration`].
    ///
    /// # Errors
    /// A moving body has no inertia.
    #[inline(always)]
    pub fn solve(
        &mut self,
        tree: &Tree,
        kinematics: &Kinematics<T>,
        rates: &[T],
        inputs: &[JointInput<T>],
        joint_accelerations: &mut [T],
    ) -> Result<(), Singular> {
        self.set_bias(tree, kinematics, rates, inputs);
        self.project(tree, inputs)?;
        self.accelerate(tree, inputs, joint_accelerations)
    }

    /// Inertial acceleration of body i's origin, m/s2, and angular acceleration, rad/s2, in base axes, as
    /// [`Self::solve`] left them.
    #[inline(always)]
    pub fn acceleration(&self, i: usize) -> (Vector3<T>, Vector3<T>) {
        let node = &self.nodes[i];
        let (a, alpha) = (node.a + node.da, node.alpha + node.dalpha);
        (a.stored(), alpha.stored())
    }

    /// Accelerations with the base at rest, and the forces that each body alone needs for them.
    #[inline(always)]
    fn set_bias(
        &mut self,
        tree: &Tree,
        kinematics: &Kinematics<T>,
        rates: &[T],
        inputs: &[JointInput<T>],
    ) {
        for (i, link) in tree.links.iter().enumerate() {
            let zero = self.nodes[i].D_inverse.all(0.0);
            let (mut a, mut alpha) = (V3::all(zero), V3::all(zero));
            if i > 0 {
                let (parent, node) = (&self.nodes[link.parent], &self.nodes[i]);
                let w = V3::of(&kinematics.w[link.parent]);
                a = parent.a + parent.alpha.cross(&node.r) + w.cross(&w.cross(&node.r));
                alpha = parent.alpha;
                match link.motion {
                    Motion::Revolute(k) => {
                        alpha += w.cross(&node.axis) * rates[k];
                        if let JointInput::Acceleration(given) = inputs[k] {
                            alpha += node.axis * given;
                        }
                    }
                    Motion::Prismatic(k) => {
                        a += w.cross(&node.axis) * (rates[k] * 2.0);
                        if let JointInput::Acceleration(given) = inputs[k] {
                            a += node.axis * given;
                        }
                    }
                    Motion::Fixed | Motion::Free => {}
                }
            }
            let (node, w) = (&mut self.nodes[i], V3::of(&kinematics.w[i]));
            let Inertial { mass, mc, I } = node.inertia.of_one_body();
            node.inertia.F += a * mass + alpha.cross(&mc) + w.cross(&w.cross(&mc));
            node.inertia.N += I.times(&alpha) + w.cross(&I.times(&w)) + mc.cross(&a);
            node.a = a;
            node.alpha = alpha;
        }
    }

    /// From the leaves to the base: articulated inertia and bias outboard of each joint.
    #[inline(always)]
    fn project(&mut self, tree: &Tree, inputs: &[JointInput<T>]) -> Result<(), Singular> {
        for i in (1..tree.links.len()).rev() {
            let link = &tree.links[i];
            let (before, rest) = self.nodes.split_at_mut(i);
            let (parent, node) = (&mut before[link.parent], &mut rest[0]);
            let mut whole = node.inertia;
            if let Motion::Revolute(k) | Motion::Prismatic(k) = link.motion
                && let JointInput::Force(force) = inputs[k]
            {
                node.free(&mut whole, link, force)
                    .ok_or(Singular::Joint(k))?;
            }
            whole.pass_on(&node.r, &mut parent.inertia);
        }
        Ok(())
    }

    /// The base, then from it to the leaves: the remaining accelerations.
    #[inline(always)]
    fn accelerate(
        &mut self,
        tree: &Tree,
        inputs: &[JointInput<T>],
        joint_accelerations: &mut [T],
    ) -> Result<(), Singular> {
        let base = self.nodes.first_mut().ok_or(Singular::Base)?;
        (base.da, base.dalpha) = base.inertia.free_acceleration().ok_or(Singular::Base)?;
        for i in 1..tree.links.len() {
            let link = &tree.links[i];
            let (before, rest) = self.nodes.split_at_mut(i);
            let (parent, node) = (&before[link.parent], &mut rest[0]);
            let mut da = parent.da + parent.dalpha.cross(&node.r);
            let mut dalpha = parent.dalpha;
            if let Motion::Revolute(k) | Motion::Prismatic(k) = link.motion {
                joint_accelerations[k] = match inputs[k] {
                    JointInput::Acceleration(given) => given,
                    JointInput::Force(_) => {
                        let rest = node.u - node.U_l.dot(&da) - node.U_a.dot(&dalpha);
                        let found = rest * node.D_inverse;
                        match link.motion {
                            Motion::Revolute(_) => dalpha += node.axis * found,
                            _ => da += node.axis * found,
                        }
                        found
                    }
                };
            }
            node.da = da;
            node.dalpha = dalpha;
        }
        Ok(())
    }
}

impl<T: Real> Node<T> {
    /// The joint under a force: stores its projection, and removes from `whole` the part not passed to the parent.
    /// `None` without outboard inertia.
    #[inline(always)]
    fn free(&mut self, whole: &mut Articulated<T>, link: &Link, force: T) -> Option<()> {
        let axis = self.axis;
        let (U_l, U_a, D, size, bias) = match link.motion {
            Motion::Prismatic(_) => {
                let U_l = whole.M.times(&axis);
                let U_a = whole.C.transpose_times(&axis);
                let size = whole.M.trace();
                (U_l, U_a, axis.dot(&U_l), size, axis.dot(&whole.F))
            }
            _ => {
                let U_l = whole.C.times(&axis);
                let U_a = whole.J.times(&axis);
                let size = whole.J.trace();
                (U_l, U_a, axis.dot(&U_a), size, axis.dot(&whole.N))
            }
        };
        if !D.exceeds(round_off(size)) {
            return None;
        }
        let u = force - bias;
        let s = D.all(1.0) / D;
        (self.U_l, self.U_a) = (U_l, U_a);
        self.D_inverse = s;
        self.u = u;
        let (V_l, V_a) = (U_l * s, U_a * s);
        whole.M.subtract_outer(&V_l, &U_l);
        whole.J.subtract_outer(&V_a, &U_a);
        whole.C = whole.C - M3([U_l * V_a.x, U_l * V_a.y, U_l * V_a.z]);
        whole.F += V_l * u;
        whole.N += V_a * u;
        Some(())
    }
}
