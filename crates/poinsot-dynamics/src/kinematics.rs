//! Position, attitude and velocity of every body relative to the base.

use crate::algebra::{M3, Real, V3};
use crate::tree::{Link, Motion, Tree};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

/// Placement and velocity of every body, all in base axes. Scratch: filled by
/// [`Kinematics::place`] and [`Kinematics::set_velocities`].
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// kinematics.place(&tree, &[std::f64::consts::FRAC_PI_2]);
/// assert!((kinematics.R[1] * Vector3::x() - Vector3::y()).norm() < 1.0e-15);
/// // The base turns at 1 rad/s and the joint at 2 rad/s.
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::z(), &[2.0]);
/// assert_eq!(kinematics.v[1], Vector3::y());
/// assert!((kinematics.w[1] - Vector3::z() * 3.0).norm() < 1.0e-15);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Kinematics<T = f64> {
    /// `R_BBi`: from body i to the base.
    pub R: Vec<Matrix3<T>>,
    /// `p_BoBio_B`: origin of body i from the base's origin, m.
    pub p: Vec<Vector3<T>>,
    /// `v_NBio_B`: inertial velocity of body i's origin, in base axes, m/s.
    pub v: Vec<Vector3<T>>,
    /// `w_NBi_B`: inertial angular velocity of body i, in base axes, rad/s.
    pub w: Vec<Vector3<T>>,
}

impl Kinematics {
    /// Scratch for a tree, placed at joint positions zero and at rest.
    pub fn new(tree: &Tree) -> Self {
        Self::at(tree, &vec![0.0; tree.dof()])
    }

    /// Every body at joint positions `q` (rad or m, one per coordinate of the tree), at rest.
    pub fn at(tree: &Tree, q: &[f64]) -> Self {
        let mut kinematics = Self::over(tree, 0.0);
        kinematics.place(tree, q);
        kinematics
    }
}

impl<T: Real> Kinematics<T> {
    /// Scratch for a tree over the numbers of `zero`; only the base is placed.
    #[inline(always)]
    pub(crate) fn over(tree: &Tree, zero: T) -> Self {
        let n = tree.bodies();
        let one = M3::diagonal(zero.all(1.0)).stored();
        let nothing = V3::all(zero).stored();
        Self {
            R: vec![one; n],
            p: vec![nothing; n],
            v: vec![nothing; n],
            w: vec![nothing; n],
        }
    }

    /// Places every body for joint positions `q` (rad or m, one per coordinate of the tree).
    #[inline(always)]
    pub fn place(&mut self, tree: &Tree, q: &[T]) {
        for (i, link) in tree.links.iter().enumerate().skip(1) {
            self.place_body(i, link, q);
        }
    }

    /// Places body `i`, whose parent is placed.
    #[inline(always)]
    pub(crate) fn place_body(&mut self, i: usize, link: &Link, q: &[T]) {
        let R_BP = M3::of(&self.R[link.parent]);
        let p_PoCo_P = V3::of(&link.p_PoCo_P);
        let p_PoCo_B = match link.motion {
            Motion::Prismatic(k) => {
                let slide = V3::of(&link.axis_P).spread(q[k]) * q[k];
                R_BP.times(&(p_PoCo_P.spread(q[k]) + slide))
            }
            _ => R_BP.times(&p_PoCo_P),
        };
        self.p[i] = (V3::of(&self.p[link.parent]) + p_PoCo_B).stored();
        self.R[i] = match link.motion {
            Motion::Revolute(k) => link.turned(&R_BP, q[k]).stored(),
            _ => R_BP.product(&M3::of(&link.R_PC_zero)).stored(),
        };
    }

    /// Velocities of every body for the base twist (`v_NBo_B` m/s, `w_NB_B` rad/s) and joint rates
    /// (rad/s or m/s), at the placement of the last [`Self::place`].
    #[inline(always)]
    pub fn set_velocities(&mut self, tree: &Tree, v: &Vector3<T>, w: &Vector3<T>, rates: &[T]) {
        self.v[0] = V3::of(v).stored();
        self.w[0] = V3::of(w).stored();
        for (i, link) in tree.links.iter().enumerate().skip(1) {
            self.move_body(i, link, rates);
        }
    }

    /// Velocities of body `i`, which is placed, from those of its parent.
    #[inline(always)]
    pub(crate) fn move_body(&mut self, i: usize, link: &Link, rates: &[T]) {
        let parent = link.parent;
        let w_P = V3::of(&self.w[parent]);
        let p_PoCo = V3::of(&self.p[i]) - V3::of(&self.p[parent]);
        let mut v_C = V3::of(&self.v[parent]) + w_P.cross(&p_PoCo);
        let mut w_C = w_P;
        if let Motion::Revolute(k) | Motion::Prismatic(k) = link.motion {
            let moved = link.axis_in_base(&M3::of(&self.R[i])) * rates[k];
            match link.motion {
                Motion::Revolute(_) => w_C += moved,
                _ => v_C += moved,
            }
        }
        self.v[i] = v_C.stored();
        self.w[i] = w_C.stored();
    }
}
