//! Accelerations of every body from forces, joint motion and wheels: the momentum equation
//! `P' = F`, `H' = T` differentiated in closed form (Newton-Euler recursion; Featherstone 2008, ch. 5).

use crate::algebra::{M3, V3};
use crate::kinematics::Kinematics;
use crate::momentum::Wrench;
use crate::tree::{Motion, Tree};
use alloc::vec;
use alloc::vec::Vec;
use poinsot_spatial::{InertialParameters, Vector3};

/// Inertial acceleration of every body, in base axes. Scratch.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // The base turns at 2 rad/s: an accelerometer at the end of the arm measures w^2 r = 8 m/s2 inward.
/// kinematics.set_velocities(&tree, &Vector3::zeros(), &(Vector3::z() * 2.0), &[0.0]);
/// let mut accelerations = Accelerations::new(&tree);
/// accelerations.set_without_base(&tree, &kinematics, &[0.0], &[0.0]);
/// assert_eq!(accelerations.at_point(&kinematics, 1, &Vector3::x()), Vector3::x() * -8.0);
/// ```
#[derive(Debug, Clone, Default)]
pub struct Accelerations {
    /// Acceleration of body i's origin, m/s2.
    pub a: Vec<Vector3>,
    /// Angular acceleration of body i, rad/s2.
    pub alpha: Vec<Vector3>,
}

impl Accelerations {
    /// Scratch for a tree.
    pub fn new(tree: &Tree) -> Self {
        Self {
            a: vec![Vector3::zeros(); tree.bodies()],
            alpha: vec![Vector3::zeros(); tree.bodies()],
        }
    }

    /// Fills the accelerations that velocities and joint accelerations (rad/s2 or m/s2) cause while the
    /// base itself does not accelerate.
    #[inline(always)]
    pub fn set_without_base(
        &mut self,
        tree: &Tree,
        kinematics: &Kinematics,
        rates: &[f64],
        joint_accelerations: &[f64],
    ) {
        self.a[0] = Vector3::zeros();
        self.alpha[0] = Vector3::zeros();
        for (i, link) in tree.links.iter().enumerate().skip(1) {
            let parent = link.parent;
            let r = V3::of(&kinematics.p[i]) - V3::of(&kinematics.p[parent]);
            let w = V3::of(&kinematics.w[parent]);
            let axis = M3::of(&kinematics.R[parent]).times(&V3::of(&link.axis_P));
            let mut alpha = V3::of(&self.alpha[parent]);
            let mut a = V3::of(&self.a[parent]) + alpha.cross(&r) + w.cross(&w.cross(&r));
            match link.motion {
                Motion::Revolute(k) => {
                    alpha += axis * joint_accelerations[k] + w.cross(&axis) * rates[k];
                }
                Motion::Prismatic(k) => {
                    a += axis * joint_accelerations[k] + w.cross(&axis) * (rates[k] * 2.0);
                }
                Motion::Fixed | Motion::Free => {}
            }
            self.a[i] = a.stored();
            self.alpha[i] = alpha.stored();
        }
    }

    /// Adds the acceleration of the base, `a` of its origin and `alpha`, to every body.
    #[inline(always)]
    pub fn add_base(&mut self, kinematics: &Kinematics, a: &Vector3, alpha: &Vector3) {
        let (a, alpha) = (V3::of(a), V3::of(alpha));
        for (i, p) in kinematics.p.iter().enumerate() {
            let of_base = a + alpha.cross(&V3::of(p));
            self.a[i] = (V3::of(&self.a[i]) + of_base).stored();
            self.alpha[i] = (V3::of(&self.alpha[i]) + alpha).stored();
        }
    }

    /// Inertial acceleration of a point fixed in body i (from its origin, in that body's axes, m), in base axes, m/s2.
    #[inline(always)]
    pub fn of_point(&self, kinematics: &Kinematics, i: usize, p_BoS_B: &Vector3) -> Vector3 {
        let r = M3::of(&kinematics.R[i]).times(&V3::of(p_BoS_B));
        let (w, alpha) = (V3::of(&kinematics.w[i]), V3::of(&self.alpha[i]));
        (V3::of(&self.a[i]) + alpha.cross(&r) + w.cross(&w.cross(&r))).stored()
    }

    /// Rate of change of the momentum of all bodies `[l'; h']` about the base origin's present place,
    /// inertial rate in base axes, N and N m.
    pub fn momentum_rate(
        &self,
        parameters: &[InertialParameters],
        kinematics: &Kinematics,
    ) -> (Vector3, Vector3) {
        let (mut l_rate, mut h_rate) = (Vector3::zeros(), Vector3::zeros());
        for (i, body) in parameters.iter().enumerate() {
            let Wrench { force, torque } = self.body_rate(body, kinematics, i);
            l_rate += force;
            h_rate += torque + kinematics.p[i].cross(&force);
        }
        (l_rate, h_rate)
    }

    /// The same of body i alone, with the parameters given, about its own origin.
    pub(crate) fn body_rate(
        &self,
        body: &InertialParameters,
        kinematics: &Kinematics,
        i: usize,
    ) -> Wrench {
        let (R, w) = (&kinematics.R[i], &kinematics.w[i]);
        let (a, alpha) = (&self.a[i], &self.alpha[i]);
        let mc = R * body.mc_B;
        let inertia = |x: &Vector3| R * (body.I_BBo_B * (R.transpose() * x));
        Wrench {
            force: a * body.mass + alpha.cross(&mc) + w.cross(&w.cross(&mc)),
            torque: inertia(alpha) + w.cross(&inertia(w)) + mc.cross(a),
        }
    }

    /// Specific force at a point fixed in body i (from its origin, in that body), in that body's axes,
    /// m/s2. N falls freely, so it is the inertial acceleration.
    pub fn at_point(&self, kinematics: &Kinematics, i: usize, p_BoS_B: &Vector3) -> Vector3 {
        kinematics.R[i].transpose() * self.of_point(kinematics, i, p_BoS_B)
    }
}
