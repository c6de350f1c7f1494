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

use crate::kinematics::Kinematics;
use crate::momentum::Composite;
use crate::symmetric::Symmetric;
use crate::tree::{Motion, Tree};
use alloc::vec;
use alloc::vec::Vec;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3};

/// Input of a joint at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointInput {
    /// Total force along the axis: N m (revolute) or N (prismatic), on the child.
    Force(f64),
    /// Prescribed acceleration, rad/s2 or m/s2, with the force that it needs.
    Acceleration(f64),
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
struct Node {
    /// Own inertia in base axes about Co: mass, first moment, tensor.
    mass: f64,
    mc: Vector3,
    I: Symmetric,
    /// Inertia of this body with all it carries, and their momentum while the base is at rest.
    mass_S: f64,
    mc_S: Vector3,
    I_S: Symmetric,
    l: Vector3,
    h: Vector3,
    /// Contribution of the children to inertia and bias.
    carried: Articulated,
    /// Joint axis, and position from the parent's origin.
    axis: Vector3,
    r: Vector3,
    /// Projection of the joint; zero where it is not free.
    U_l: Vector3,
    U_a: Vector3,
    D_inverse: f64,
    u: f64,
    /// Acceleration; first the part without the base.
    a: Vector3,
    alpha: Vector3,
    /// The remaining part.
    da: Vector3,
    dalpha: Vector3,
    /// Bias force and torque about Co; before the solution minus the wrench from outside.
    F: Vector3,
    N: Vector3,
}

/// Articulated inertia `[[M, C], [C^T, J]]` and bias `[F; N]` about the body's origin.
#[derive(Debug, Clone, Copy)]
struct Articulated {
    M: Symmetric,
    C: Matrix3,
    J: Symmetric,
    F: Vector3,
    N: Vector3,
}

/// Workspace of the articulated-body algorithm. No call allocates.
#[derive(Debug, Clone)]
pub struct ForwardDynamics {
    nodes: Vec<Node>,
}

impl ForwardDynamics {
    /// Scratch for a tree.
    pub fn new(tree: &Tree) -> Self {
        let zero = Vector3::zeros();
        let node = Node {
            mass: 0.0,
            mc: zero,
            I: Symmetric::default(),
            mass_S: 0.0,
            mc_S: zero,
            I_S: Symmetric::default(),
            l: zero,
            h: zero,
            carried: Articulated::NOTHING,
            axis: zero,
            r: zero,
            U_l: zero,
            U_a: zero,
            D_inverse: 0.0,
            u: 0.0,
            a: zero,
            alpha: zero,
            da: zero,
            dalpha: zero,
            F: zero,
            N: zero,
        };
        Self {
            nodes: vec![node; tree.bodies()],
        }
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
        let bodies = tree.links.iter().zip(parameters);
        for (i, (node, (link, body))) in self.nodes.iter_mut().zip(bodies).enumerate() {
            let R = &kinematics.R[i];
            node.mass = body.mass;
            node.mc = R * body.mc_B;
            node.I = Symmetric::of(&body.I_BBo_B).turned(R);
            node.r = kinematics.p[i] - kinematics.p[link.parent];
            node.axis = link.axis_B(R);
            node.F = Vector3::zeros();
            node.N = Vector3::zeros();
        }
    }

    /// Adds a force and a torque about the origin of body `i`, both from outside the tree or from a wheel, in
    /// base axes, N and N m.
    #[inline]
    pub fn add_wrench(&mut self, i: usize, force_B: &Vector3, torque_Co_B: &Vector3) {
        if let Some(node) = self.nodes.get_mut(i) {
            node.F -= force_B;
            node.N -= torque_Co_B;
        }
    }

    /// The vehicle as one rigid body, and the momentum `l`, `h` about `Bo` in B (N s, N m s) of the joint rates
    /// (rad/s or m/s) while the base is at rest. The same numbers as [`crate::composite`] and
    /// [`crate::momentum`], from one recursion over the bodies as [`Self::set_bodies`] left them.
    #[inline]
    pub fn momentum_of_rates(
        &mut self,
        tree: &Tree,
        rates: &[f64],
    ) -> (Composite, Vector3, Vector3) {
        for node in &mut self.nodes {
            node.mass_S = node.mass;
            node.mc_S = node.mc;
            node.I_S = node.I;
            node.l = Vector3::zeros();
            node.h = Vector3::zeros();
        }
        for i in (1..tree.links.len()).rev() {
            let link = &tree.links[i];
            let (before, rest) = self.nodes.split_at_mut(i);
            let (parent, node) = (&mut before[link.parent], &mut rest[0]);
            match link.motion {
                Motion::Revolute(k) => {
                    let turn = node.axis * rates[k];
                    node.l += turn.cross(&node.mc_S);
                    node.h += node.I_S.times(&turn);
                }
                Motion::Prismatic(k) => {
                    let slide = node.axis * rates[k];
                    node.l += slide * node.mass_S;
                    node.h += node.mc_S.cross(&slide);
                }
                Motion::Fixed | Motion::Free => {}
            }
            parent.carry(node);
        }
        let whole = |base: &Node| Composite {
            mass: base.mass_S,
            mc: base.mc_S,
            I_SBo_B: base.I_S.full(),
        };
        let base = &self.nodes[0];
        (whole(base), base.l, base.h)
    }

    /// Joint accelerations (rad/s2 or m/s2, one per coordinate) from what drives the joints; the kinematics
    /// hold the velocities. The accelerations of the bodies follow from [`Self::acceleration`].
    ///
    /// # Errors
    /// A moving body has no inertia.
    #[inline]
    pub fn solve(
        &mut self,
        tree: &Tree,
        kinematics: &Kinematics,
        rates: &[f64],
        inputs: &[JointInput],
        joint_accelerations: &mut [f64],
    ) -> Result<(), Singular> {
        self.set_bias(tree, kinematics, rates, inputs);
        self.project(tree, inputs)?;
        self.accelerate(tree, inputs, joint_accelerations)
    }

    /// Inertial acceleration of body i's origin, m/s2, and angular acceleration, rad/s2, in base axes, as
    /// [`Self::solve`] left them.
    pub fn acceleration(&self, i: usize) -> (Vector3, Vector3) {
        (self.nodes[i].a, self.nodes[i].alpha)
    }

    /// Accelerations with the base at rest, and the forces that each body alone needs for them.
    #[inline]
    fn set_bias(
        &mut self,
        tree: &Tree,
        kinematics: &Kinematics,
        rates: &[f64],
        inputs: &[JointInput],
    ) {
        for (i, link) in tree.links.iter().enumerate() {
            let (mut a, mut alpha) = (Vector3::zeros(), Vector3::zeros());
            if i > 0 {
                let (parent, node) = (&self.nodes[link.parent], &self.nodes[i]);
                let w = &kinematics.w[link.parent];
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
                        a += w.cross(&node.axis) * (2.0 * rates[k]);
                        if let JointInput::Acceleration(given) = inputs[k] {
                            a += node.axis * given;
                        }
                    }
                    Motion::Fixed | Motion::Free => {}
                }
            }
            let (node, w) = (&mut self.nodes[i], &kinematics.w[i]);
            node.F += a * node.mass + alpha.cross(&node.mc) + w.cross(&w.cross(&node.mc));
            node.N += node.I.times(&alpha) + w.cross(&node.I.times(w)) + node.mc.cross(&a);
            node.a = a;
            node.alpha = alpha;
            node.carried = Articulated::NOTHING;
        }
    }

    /// From the leaves to the base: articulated inertia and bias outboard of each joint.
    #[inline]
    fn project(&mut self, tree: &Tree, inputs: &[JointInput]) -> Result<(), Singular> {
        for i in (1..tree.links.len()).rev() {
            let link = &tree.links[i];
            let (before, rest) = self.nodes.split_at_mut(i);
            let (parent, node) = (&mut before[link.parent], &mut rest[0]);
            let mut whole = node.articulated();
            match link.motion {
                Motion::Revolute(k) => {
                    if let JointInput::Force(tau) = inputs[k] {
                        let U = (whole.C * node.axis, whole.J.times(&node.axis));
                        let D = node.axis.dot(&U.1);
                        let size = whole.J.xx + whole.J.yy + whole.J.zz;
                        let u = tau - node.axis.dot(&whole.N);
                        node.free(&mut whole, U, D, size, u)
                            .ok_or(Singular::Joint(k))?;
                    }
                }
                Motion::Prismatic(k) => {
                    if let JointInput::Force(tau) = inputs[k] {
                        let U = (whole.M.times(&node.axis), whole.C.tr_mul(&node.axis));
                        let D = node.axis.dot(&U.0);
                        let size = whole.M.xx + whole.M.yy + whole.M.zz;
                        let u = tau - node.axis.dot(&whole.F);
                        node.free(&mut whole, U, D, size, u)
                            .ok_or(Singular::Joint(k))?;
                    }
                }
                Motion::Fixed | Motion::Free => {}
            }
            whole.pass_on(&node.r, &mut parent.carried);
        }
        Ok(())
    }

    /// The base, then from it to the leaves: the remaining accelerations.
    #[inline]
    fn accelerate(
        &mut self,
        tree: &Tree,
        inputs: &[JointInput],
        joint_accelerations: &mut [f64],
    ) -> Result<(), Singular> {
        let base = self.nodes.first_mut().ok_or(Singular::Base)?;
        (base.da, base.dalpha) = base
            .articulated()
            .free_acceleration()
            .ok_or(Singular::Base)?;
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

impl Node {
    /// This body with the contribution of its children.
    #[inline]
    fn articulated(&self) -> Articulated {
        let (carried, mc) = (&self.carried, &self.mc);
        let mut whole = *carried;
        whole.M.xx += self.mass;
        whole.M.yy += self.mass;
        whole.M.zz += self.mass;
        // C = -[mc]x.
        whole.C.m12 += mc.z;
        whole.C.m13 -= mc.y;
        whole.C.m21 -= mc.z;
        whole.C.m23 += mc.x;
        whole.C.m31 += mc.y;
        whole.C.m32 -= mc.x;
        whole.J += self.I;
        whole.F += self.F;
        whole.N += self.N;
        whole
    }

    /// A free joint with `u`, its force minus the bias: stores its projection, and removes from `whole` the part not
    /// passed to the parent. `None` without outboard inertia.
    #[inline]
    fn free(
        &mut self,
        whole: &mut Articulated,
        U: (Vector3, Vector3),
        D: f64,
        size: f64,
        u: f64,
    ) -> Option<()> {
        if !resists(D, size) {
            return None;
        }
        let s = 1.0 / D;
        (self.U_l, self.U_a) = U;
        self.D_inverse = s;
        self.u = u;
        let (V_l, V_a) = (U.0 * s, U.1 * s);
        whole.M.subtract_outer(&V_l, &U.0);
        whole.J.subtract_outer(&V_a, &U.1);
        whole.C -= U.0 * V_a.transpose();
        whole.F += V_l * u;
        whole.N += V_a * u;
        Some(())
    }

    /// Adds the inertia and momentum of a child with all it carries, moved from `Co` to `Po`.
    #[inline]
    fn carry(&mut self, child: &Self) {
        let (r, mc) = (&child.r, &child.mc_S);
        let g = mc + r * child.mass_S;
        let d = r.dot(mc) + r.dot(&g);
        self.mass_S += child.mass_S;
        self.mc_S += g;
        self.I_S += child.I_S;
        self.I_S += Symmetric {
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

impl Articulated {
    const NOTHING: Self = Self {
        M: Symmetric::ZERO,
        C: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        J: Symmetric::ZERO,
        F: Vector3::new(0.0, 0.0, 0.0),
        N: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Adds inertia and bias, moved from `Co` to `Po` over `r = p_PoCo`, to the outboard inertia of the parent.
    #[inline]
    fn pass_on(&self, r: &Vector3, parent: &mut Self) {
        // C_P = C - M [r]x; J_P = J + [r]x C_P + ([r]x C)^T.
        let M = &self.M;
        let Mr = Matrix3::new(
            M.xy * r.z - M.xz * r.y,
            M.xz * r.x - M.xx * r.z,
            M.xx * r.y - M.xy * r.x,
            M.yy * r.z - M.yz * r.y,
            M.yz * r.x - M.xy * r.z,
            M.xy * r.y - M.yy * r.x,
            M.yz * r.z - M.zz * r.y,
            M.zz * r.x - M.xz * r.z,
            M.xz * r.y - M.yz * r.x,
        );
        let C = &self.C;
        let C_P = C - Mr;
        let cross = |X: &Matrix3, i: usize, j: usize| match i {
            0 => r.y * X[(2, j)] - r.z * X[(1, j)],
            1 => r.z * X[(0, j)] - r.x * X[(2, j)],
            _ => r.x * X[(1, j)] - r.y * X[(0, j)],
        };
        parent.J += self.J;
        parent.J += Symmetric {
            xx: cross(&C_P, 0, 0) + cross(C, 0, 0),
            xy: cross(&C_P, 1, 0) + cross(C, 0, 1),
            yy: cross(&C_P, 1, 1) + cross(C, 1, 1),
            xz: cross(&C_P, 2, 0) + cross(C, 0, 2),
            yz: cross(&C_P, 2, 1) + cross(C, 1, 2),
            zz: cross(&C_P, 2, 2) + cross(C, 2, 2),
        };
        parent.C += C_P;
        parent.M += self.M;
        parent.F += self.F;
        parent.N += self.N + r.cross(&self.F);
    }

    /// The acceleration at which no force acts on the base: `IA [a; alpha] = -bias`.
    #[inline]
    fn free_acceleration(&self) -> Option<(Vector3, Vector3)> {
        // L D L^T of the whole in two blocks. It is stable where an explicit inverse of M is not: for a light base on
        // a heavy arm that loses two more digits.
        let (M, C, J) = (&self.M, &self.C, &self.J);
        let upper = M.factor();
        let column = |j| upper.forward(&Vector3::new(C[(0, j)], C[(1, j)], C[(2, j)]));
        let Y = [column(0), column(1), column(2)];
        let Z = Y.map(|y| y.component_mul(&upper.inverse));
        let rest = Symmetric {
            xx: J.xx - Y[0].dot(&Z[0]),
            xy: J.xy - Y[1].dot(&Z[0]),
            yy: J.yy - Y[1].dot(&Z[1]),
            xz: J.xz - Y[2].dot(&Z[0]),
            yz: J.yz - Y[2].dot(&Z[1]),
            zz: J.zz - Y[2].dot(&Z[2]),
        };
        let lower = rest.factor();
        let all = |pivots: Vector3, size| pivots.iter().all(|d| resists(*d, size));
        if !all(upper.pivots, M.xx + M.yy + M.zz) || !all(lower.pivots, J.xx + J.yy + J.zz) {
            return None;
        }
        let f = -upper.forward(&self.F);
        let n = -self.N - Vector3::new(Z[0].dot(&f), Z[1].dot(&f), Z[2].dot(&f));
        let alpha = lower.back(&lower.forward(&n).component_mul(&lower.inverse));
        let z = f.component_mul(&upper.inverse);
        let a = upper.back(&(z - Z[0] * alpha.x - Z[1] * alpha.y - Z[2] * alpha.z));
        Some((a, alpha))
    }
}

/// Whether an inertia is more than round-off relative to another; never for NaN.
#[inline]
fn resists(inertia: f64, size: f64) -> bool {
    inertia > ROUND_OFF * size.abs()
}
