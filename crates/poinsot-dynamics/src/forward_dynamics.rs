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

use crate::algebra::{Inertial, M3, Real, V3};
use crate::kinematics::Kinematics;
use crate::symmetric::Symmetric;
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

/// Smallest articulated inertia about a joint, relative to that about the other axes: below it, round-off.
const ROUND_OFF: f64 = 1e-13;

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
    /// Acceleration; first the part without the base.
    a: V3<T>,
    alpha: V3<T>,
    /// The remaining part.
    da: V3<T>,
    dalpha: V3<T>,
}

/// A body with all it carries, about its origin, and their momentum while the base is at rest.
#[derive(Debug, Clone, Copy)]
struct Subtree<T> {
    inertia: Inertial<T>,
    l: V3<T>,
    h: V3<T>,
}

/// Articulated inertia `[[M, C], [C^T, J]]` and bias `[F; N]` about the body's origin.
#[derive(Debug, Clone, Copy)]
struct Articulated<T> {
    M: Symmetric<T>,
    C: M3<T>,
    J: Symmetric<T>,
    F: V3<T>,
    N: V3<T>,
}

/// Workspace of the articulated-body algorithm. No call allocates.
#[derive(Debug, Clone)]
pub struct ForwardDynamics<T = f64> {
    nodes: Vec<Node<T>>,
    subtrees: Vec<Subtree<T>>,
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
        let inertia = Inertial {
            mass: zero,
            mc: nothing,
            I: Symmetric::new([zero; 6]),
        };
        let node = Node {
            inertia: Articulated::of(&inertia),
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
            subtrees: Vec::with_capacity(tree.bodies()),
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
            node.inertia = Articulated::of(&Inertial {
                mass: body.mass,
                mc: R.times(&body.mc),
                I: body.I.turned(&R),
            });
            node.r = V3::of(&kinematics.p[i]) - V3::of(&kinematics.p[link.parent]);
            node.axis = link.axis_in_base(&R);
        }
    }

    /// Adds a force and a torque about the origin of body `i`, both from outside the tree or from a wheel, in
    /// base axes, N and N m.
    #[inline(always)]
    pub fn add_wrench(&mut self, i: usize, force_B: &Vector3<T>, torque_Co_B: &Vector3<T>) {
        if let Some(node) = self.nodes.get_mut(i) {
            node.inertia.F -= V3::of(force_B);
            node.inertia.N -= V3::of(torque_Co_B);
        }
    }

    /// The vehicle as one rigid body, and the momentum `l`, `h` about `Bo` in B (N s, N m s) of the joint rates
    /// (rad/s or m/s) while the base is at rest. The same numbers as [`crate::composite`] and
    /// [`crate::momentum`], from one recursion over the bodies as `set_bodies` left them.
    #[cfg(feature = "std")]
    #[inline(always)]
    pub(crate) fn momentum_of_rates(
        &mut self,
        tree: &Tree,
        rates: &[T],
    ) -> (Inertial<T>, V3<T>, V3<T>) {
        self.subtrees.clear();
        for node in &self.nodes {
            let inertia = node.inertia.of_one_body();
            let l = V3::all(inertia.mass.all(0.0));
            self.subtrees.push(Subtree { inertia, l, h: l });
        }
        for i in (1..tree.links.len()).rev() {
            let (link, node) = (&tree.links[i], &self.nodes[i]);
            let mut subtree = self.subtrees[i];
            let Inertial { mass, mc, I } = &subtree.inertia;
            match link.motion {
                Motion::Revolute(k) => {
                    let turn = node.axis * rates[k];
                    subtree.l += turn.cross(mc);
                    subtree.h += I.times(&turn);
                }
                Motion::Prismatic(k) => {
                    let slide = node.axis * rates[k];
                    subtree.l += slide * *mass;
                    subtree.h += mc.cross(&slide);
                }
                Motion::Fixed | Motion::Free => {}
            }
            self.subtrees[link.parent].carry(&subtree, &node.r);
        }
        let base = &self.subtrees[0];
        (base.inertia, base.l, base.h)
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
        (self.nodes[i].a.stored(), self.nodes[i].alpha.stored())
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
        base.a += base.da;
        base.alpha += base.dalpha;
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
            node.a += da;
            node.alpha += dalpha;
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

impl<T: Real> Subtree<T> {
    /// Adds the inertia and momentum of a child with all it carries, moved from `Co` to `Po` over `r = p_PoCo`.
    #[cfg(feature = "std")]
    #[inline(always)]
    fn carry(&mut self, child: &Self, r: &V3<T>) {
        let Inertial { mass, mc, I } = child.inertia;
        let g = mc + *r * mass;
        let d = r.dot(&mc) + r.dot(&g);
        self.inertia.mass = self.inertia.mass + mass;
        self.inertia.mc += g;
        self.inertia.I += I;
        self.inertia.I += Symmetric {
            xx: d - r.x * g.x - mc.x * r.x,
            xy: -r.x * g.y - mc.x * r.y,
            yy: d - r.y * g.y - mc.y * r.y,
            xz: -r.x * g.z - mc.x * r.z,
            yz: -r.y * g.z - mc.y * r.z,
            zz: d - r.z * g.z - mc.z * r.z,
        };
        self.l += child.l;
        self.h += child.h + r.cross(&child.l);
    }
}

impl<T: Real> Articulated<T> {
    /// One body alone, without bias.
    #[inline(always)]
    fn of(body: &Inertial<T>) -> Self {
        let Inertial { mass, mc, I } = *body;
        let zero = mass.all(0.0);
        Self {
            M: Symmetric::new([mass, zero, mass, zero, zero, mass]),
            // C = -[mc]x.
            C: M3([
                V3::new(zero, -mc.z, mc.y),
                V3::new(mc.z, zero, -mc.x),
                V3::new(-mc.y, mc.x, zero),
            ]),
            J: I,
            F: V3::all(zero),
            N: V3::all(zero),
        }
    }

    /// The inverse of [`Self::of`].
    #[inline(always)]
    fn of_one_body(&self) -> Inertial<T> {
        let [x, y, z] = &self.C.0;
        Inertial {
            mass: self.M.xx,
            mc: V3::new(z.y, x.z, y.x),
            I: self.J,
        }
    }

    /// Adds inertia and bias, moved from `Co` to `Po` over `r = p_PoCo`, to the outboard inertia of the parent.
    #[inline(always)]
    fn pass_on(&self, r: &V3<T>, parent: &mut Self) {
        // C_P = C - M [r]x; J_P = J + [r]x C_P + ([r]x C)^T.
        let M = &self.M;
        let Mr = M3([
            V3::new(
                M.xy * r.z - M.xz * r.y,
                M.yy * r.z - M.yz * r.y,
                M.yz * r.z - M.zz * r.y,
            ),
            V3::new(
                M.xz * r.x - M.xx * r.z,
                M.yz * r.x - M.xy * r.z,
                M.zz * r.x - M.xz * r.z,
            ),
            V3::new(
                M.xx * r.y - M.xy * r.x,
                M.xy * r.y - M.yy * r.x,
                M.xz * r.y - M.yz * r.x,
            ),
        ]);
        let C_P = self.C - Mr;
        let ([px, py, pz], [cx, cy, cz]) = (C_P.crossed(r).0, self.C.crossed(r).0);
        parent.J += self.J;
        parent.J += Symmetric {
            xx: px.x + cx.x,
            xy: px.y + cy.x,
            yy: py.y + cy.y,
            xz: px.z + cz.x,
            yz: py.z + cz.y,
            zz: pz.z + cz.z,
        };
        parent.C = parent.C + C_P;
        parent.M += self.M;
        parent.F += self.F;
        parent.N += self.N + r.cross(&self.F);
    }

    /// The acceleration at which no force acts on the base: `IA [a; alpha] = -bias`.
    #[inline(always)]
    fn free_acceleration(&self) -> Option<(V3<T>, V3<T>)> {
        // L D L^T of the whole in two blocks. It is stable where an explicit inverse of M is not: for a light base on
        // a heavy arm that loses two more digits.
        let (M, C, J) = (&self.M, &self.C, &self.J);
        let upper = M.factor();
        let [x, y, z] = &C.0;
        let Y = [upper.forward(x), upper.forward(y), upper.forward(z)];
        let inverse = &upper.inverse;
        let Z = [
            Y[0].times_each(inverse),
            Y[1].times_each(inverse),
            Y[2].times_each(inverse),
        ];
        let rest = Symmetric {
            xx: J.xx - Y[0].dot(&Z[0]),
            xy: J.xy - Y[1].dot(&Z[0]),
            yy: J.yy - Y[1].dot(&Z[1]),
            xz: J.xz - Y[2].dot(&Z[0]),
            yz: J.yz - Y[2].dot(&Z[1]),
            zz: J.zz - Y[2].dot(&Z[2]),
        };
        let lower = rest.factor();
        if !upper.pivots_exceed(round_off(M.trace())) || !lower.pivots_exceed(round_off(J.trace()))
        {
            return None;
        }
        let f = -upper.forward(&self.F);
        let n = -self.N - V3::new(Z[0].dot(&f), Z[1].dot(&f), Z[2].dot(&f));
        let alpha = lower.back(&lower.forward(&n).times_each(&lower.inverse));
        let z = f.times_each(&upper.inverse);
        let a = upper.back(&(z - Z[0] * alpha.x - Z[1] * alpha.y - Z[2] * alpha.z));
        Some((a, alpha))
    }
}

/// The largest inertia that is round-off beside `size`.
#[inline(always)]
fn round_off<T: Real>(size: T) -> T {
    size.magnitude() * ROUND_OFF
}
