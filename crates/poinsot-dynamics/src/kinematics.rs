//! Position, attitude and velocity of every body relative to the base.

use crate::tree::{Motion, Tree, product};
use alloc::vec;
use alloc::vec::Vec;
use poinsot_spatial::{Matrix3, Vector3};

/// Placement and velocity of every body, all in base axes. Scratch: filled by
/// [`Kinematics::place`] and [`Kinematics::set_velocities`].
#[derive(Debug, Clone)]
pub struct Kinematics {
    /// `R_BBi`: from body i to the base.
    pub R: Vec<Matrix3>,
    /// `p_BoBio_B`: origin of body i from the base's origin, m.
    pub p: Vec<Vector3>,
    /// `v_NBio_B`: inertial velocity of body i's origin, in base axes, m/s.
    pub v: Vec<Vector3>,
    /// `w_NBi_B`: inertial angular velocity of body i, in base axes, rad/s.
    pub w: Vec<Vector3>,
}

impl Kinematics {
    /// Scratch for a tree, placed at joint positions zero and at rest.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.bodies();
        let mut kinematics = Self {
            R: vec![Matrix3::identity(); n],
            p: vec![Vector3::zeros(); n],
            v: vec![Vector3::zeros(); n],
            w: vec![Vector3::zeros(); n],
        };
        kinematics.place(tree, &vec![0.0; tree.dof()]);
        kinematics
    }

    /// Places every body for joint positions `q` (rad or m, one per coordinate of the tree).
    #[inline]
    pub fn place(&mut self, tree: &Tree, q: &[f64]) {
        for (i, link) in tree.links.iter().enumerate().skip(1) {
            let (R_BP, p_BoPo) = (&self.R[link.parent], &self.p[link.parent]);
            let (R_BC, p_PoCo_P) = match link.motion {
                Motion::Revolute(k) => (link.turned(R_BP, q[k]), link.p_PoCo_P),
                Motion::Prismatic(k) => (
                    product(R_BP, &link.R_PC_zero),
                    link.p_PoCo_P + link.axis_P * q[k],
                ),
                Motion::Fixed | Motion::Free => (product(R_BP, &link.R_PC_zero), link.p_PoCo_P),
            };
            self.p[i] = p_BoPo + R_BP * p_PoCo_P;
            self.R[i] = R_BC;
        }
    }

    /// Velocities of every body for the base twist (`v_NBo_B` m/s, `w_NB_B` rad/s) and joint rates
    /// (rad/s or m/s), at the placement of the last [`Self::place`].
    #[inline]
    pub fn set_velocities(&mut self, tree: &Tree, v: &Vector3, w: &Vector3, rates: &[f64]) {
        self.v[0] = *v;
        self.w[0] = *w;
        for (i, link) in tree.links.iter().enumerate().skip(1) {
            let parent = link.parent;
            let w_P = self.w[parent];
            let mut v_C = self.v[parent] + w_P.cross(&(self.p[i] - self.p[parent]));
            let mut w_C = w_P;
            match link.motion {
                Motion::Revolute(k) => w_C += link.axis_B(&self.R[i]) * rates[k],
                Motion::Prismatic(k) => v_C += link.axis_B(&self.R[i]) * rates[k],
                Motion::Fixed | Motion::Free => {}
            }
            self.v[i] = v_C;
            self.w[i] = w_C;
        }
    }
}
