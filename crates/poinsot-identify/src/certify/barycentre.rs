//! Parameters that enter the rotation of a tree: augmented inertias and couplings (Wittenburg 1977, chapter 5).
//!
//! With M the mass of the whole, body i has hinges h at r_ih, beyond which lies the mass mu_h:
//!
//! ```text
//! f*_i = f_i + sum mu_h r_ih            b_ih = r_ih - f*_i / M
//! K_i  = I_i + sum mu_h S(r_ih)^T S(r_ih) - S(f*_i)^T S(f*_i) / M
//! D_ij = M b_i,h(j) b_j,h(i)^T
//! 2 T  = sum w_i.K_i w_i - 2 sum_(i<j) D_ij : (w_i x e_p).(w_j x e_q)
//! ```
//!
//! T is the kinetic energy about the mass centre: nothing else of the bodies enters their rotation. Two bodies have the
//! same rate across the axis `a` of their hinge, `w_i x a = w_k x a`, so components along `a` cannot be attributed to
//! one of them. Here they go to the outboard body (couplings) and to the parent (moments across the axis). The maps are
//! linear in K and D with constants of the tree, so the rest is identifiable with enough excitation.

use poinsot_dynamics::{Motion, Tree};
use poinsot_spatial::{InertialParameters, Matrix3, Vector3, skew};

/// Augmented inertia of every body and coupling of every pair, components along joint axes attributed by convention.
#[derive(Debug, Clone, PartialEq)]
pub struct Barycentric {
    /// Inertia about the barycentre, the rest as point masses at the hinges, in the axes of the body, kg m2.
    pub K: Vec<Matrix3>,
    /// Body i, body j, `D_ij` with rows in the axes of i and columns in those of j, kg m2.
    pub D: Vec<(usize, usize, Matrix3)>,
}

/// The way from one body to the next: neighbour, axis of the hinge between in the axes of both, and the turn into those
/// of the neighbour where the two are one body.
struct Next {
    body: usize,
    own: Vector3,
    its: Vector3,
    fixed: Option<Matrix3>,
}

impl Barycentric {
    /// Of the bodies of a tree; `None` with sliding joints, which move the hinges.
    pub fn new(tree: &Tree, bodies: &[InertialParameters]) -> Option<Self> {
        let mut links = tree.links.iter();
        if links.any(|l| matches!(l.motion, Motion::Prismatic(_))) {
            return None;
        }
        let n = bodies.len();
        let mass: f64 = bodies.iter().map(|b| b.mass).sum();
        let mut beyond: Vec<f64> = bodies.iter().map(|b| b.mass).collect();
        for c in (1..n).rev() {
            beyond[tree.links[c].parent] += beyond[c];
        }
        let mut first: Vec<Vector3> = bodies.iter().map(|b| b.mc_B).collect();
        let mut K: Vec<Matrix3> = bodies.iter().map(|b| b.I_BBo_B).collect();
        for (c, link) in tree.links.iter().enumerate().skip(1) {
            first[link.parent] += link.p_PoCo_P * beyond[c];
            K[link.parent] += square(&link.p_PoCo_P) * beyond[c];
        }
        for (K, f) in K.iter_mut().zip(&first) {
            *K -= square(f) / mass;
        }
        let arm = |i: usize, to: usize| {
            let hinge = match tree.links[to].parent == i && to > 0 {
                true => tree.links[to].p_PoCo_P,
                false => Vector3::zeros(),
            };
            hinge - first[i] / mass
        };
        let mut out = Self { K, D: Vec::new() };
        for i in 0..n {
            for j in i + 1..n {
                out.D.push((i, j, Matrix3::zeros()));
            }
        }
        for i in 0..n {
            for j in i + 1..n {
                let b_i = arm(i, next(tree, i, j).body);
                let b_j = arm(j, next(tree, j, i).body);
                out.attribute(tree, i, j, b_i * b_j.transpose() * mass);
            }
        }
        out.moments_across_axes(tree);
        Some(out)
    }

    /// Adds a coupling: components along a hinge's axis belong to the outboard body.
    fn attribute(&mut self, tree: &Tree, i: usize, j: usize, X: Matrix3) {
        if i == j {
            let symmetric = (X + X.transpose()) / 2.0;
            self.K[i] -= (Matrix3::identity() * X.trace() - symmetric) * 2.0;
            return;
        }
        if X == Matrix3::zeros() {
            return;
        }
        let (there, back) = (next(tree, i, j), next(tree, j, i));
        let (kept, moved) = there.split(&X);
        self.attribute(tree, there.body, j, moved);
        let (kept, moved) = back.split(&kept.transpose());
        self.attribute(tree, i, back.body, moved.transpose());
        let (kept, (low, high)) = match i < j {
            true => (kept.transpose(), (i, j)),
            false => (kept, (j, i)),
        };
        let own = self.D.iter_mut().find(|d| (d.0, d.1) == (low, high));
        if let Some(own) = own {
            own.2 += kept;
        }
    }

    /// Moves the mean moment across every hinge's axis to the parent, and all of a body that is fixed to it.
    fn moments_across_axes(&mut self, tree: &Tree) {
        for (c, link) in tree.links.iter().enumerate().skip(1).rev() {
            let K = self.K[c];
            if link.motion == Motion::Fixed {
                let R = link.R_PC_zero;
                self.K[link.parent] += R * K * R.transpose();
                self.K[c] = Matrix3::zeros();
                continue;
            }
            let a = link.axis_C;
            let mean = (K.trace() - a.dot(&(K * a))) / 2.0;
            self.K[c] -= across(&a) * mean;
            self.K[link.parent] += across(&link.axis_P) * mean;
        }
    }
}

impl Next {
    /// Rows of a coupling in the axes of the body: the part that stays, and the part passed on in the axes of the
    /// neighbour.
    fn split(&self, X: &Matrix3) -> (Matrix3, Matrix3) {
        match &self.fixed {
            Some(turn) => (Matrix3::zeros(), turn * X),
            None => (across(&self.own) * X, self.its * (self.own.transpose() * X)),
        }
    }
}

/// The first step from body i to body j.
fn next(tree: &Tree, i: usize, j: usize) -> Next {
    let mut at = j;
    // Parents stand before their children.
    while at > i && tree.links[at].parent != i {
        at = tree.links[at].parent;
    }
    let is_fixed = |link: &poinsot_dynamics::Link| link.motion == Motion::Fixed;
    if at > i {
        let link = &tree.links[at];
        return Next {
            body: at,
            own: link.axis_P,
            its: link.axis_C,
            fixed: is_fixed(link).then(|| link.R_PC_zero.transpose()),
        };
    }
    let link = &tree.links[i];
    Next {
        body: link.parent,
        own: link.axis_C,
        its: link.axis_P,
        fixed: is_fixed(link).then_some(link.R_PC_zero),
    }
}

/// `S(v)^T S(v)`.
fn square(v: &Vector3) -> Matrix3 {
    let S = skew(v);
    S.transpose() * S
}

/// `1 - a a^T`.
fn across(a: &Vector3) -> Matrix3 {
    Matrix3::identity() - a * a.transpose()
}
