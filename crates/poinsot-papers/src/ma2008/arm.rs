//! The arm as one body, Sec. II.C: mass centre, inertia and momentum from joint positions and rates.
//!
//! (25)-(28) with the corrections of the method's page; the recursions (26), (28) over the tree are
//! `Kinematics::place` and `Kinematics::set_velocities`. They allow any branching and, beyond the paper, prismatic
//! joints.

use poinsot_dynamics::{Kinematics, Tree, wheel_momentum};
use poinsot_model::Model;
use poinsot_spatial::{MassProperties, Matrix3, UnitQuaternion, Vector3, parallel_axis};

/// The arm at one instant, relative to the base, in base axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm {
    /// Mass m_R, kg.
    pub mass: f64,
    /// Mass centre from the base origin, m.
    pub rho_R: Vector3,
    /// Inertia about the arm's own mass centre, kg m2.
    pub I_R: Matrix3,
    /// Velocity of the arm's mass centre relative to the base, m/s.
    pub u: Vector3,
    /// Angular momentum of the motion relative to the base, about the arm's mass centre, including all wheels of the
    /// vehicle, N m s.
    pub h_R: Vector3,
}

/// One sample: base motion and arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Rotation from base axes to N.
    pub R_NB: Matrix3,
    /// Velocity of the base origin, in **base** axes, m/s.
    pub v_NBo_B: Vector3,
    /// Angular velocity of the base, in base axes, rad/s.
    pub w_NB_B: Vector3,
    /// The arm.
    pub arm: Arm,
}

/// One sample of the sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct Raw {
    /// Attitude of the base.
    pub R_NB: UnitQuaternion,
    /// Velocity of the base origin, in N, m/s.
    pub v_NBo_N: Vector3,
    /// Angular velocity of the base, in B, rad/s.
    pub w_NB_B: Vector3,
    /// Joint positions, rad or m.
    pub q: Vec<f64>,
    /// Joint rates, rad/s or m/s.
    pub rates: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s.
    pub wheel_speed: Vec<f64>,
}

/// Known data of the vehicle: kinematics and all bodies except the base.
#[derive(Debug, Clone)]
pub struct Vehicle<'a> {
    tree: &'a Tree,
    links: Vec<MassProperties>,
    spin_inertia: Vec<f64>,
    kinematics: Kinematics,
}

impl<'a> Vehicle<'a> {
    /// Creates the arm of a model; the numbers of the base are not used.
    pub fn new(model: &Model, tree: &'a Tree) -> Self {
        Self {
            links: model.bodies.iter().map(|b| b.nominal).collect(),
            spin_inertia: model.wheels.iter().map(|w| w.spin_inertia).collect(),
            kinematics: Kinematics::new(tree),
            tree,
        }
    }

    /// Mass of the arm, kg.
    pub fn arm_mass(&self) -> f64 {
        self.links.iter().skip(1).map(|b| b.mass).sum()
    }

    /// The arm at joint positions `q` and rates.
    pub fn arm(&mut self, q: &[f64], rates: &[f64], wheel_speed: &[f64]) -> Arm {
        let zero = Vector3::zeros();
        self.kinematics.place(self.tree, q);
        self.kinematics
            .set_velocities(self.tree, &zero, &zero, rates);
        let k = &self.kinematics;
        let links = || self.links.iter().enumerate().skip(1);
        // Mass centre of link i from Bo and its velocity relative to the base, in B.
        let rho = |i: usize, link: &MassProperties| k.p[i] + k.R[i] * link.p_BoBcm_B;
        let velocity =
            |i: usize, link: &MassProperties| k.v[i] + k.w[i].cross(&(k.R[i] * link.p_BoBcm_B));
        // (25), first part, and p_R of (27).
        let mass = self.arm_mass();
        let rho_R = links().map(|(i, b)| rho(i, b) * b.mass).sum::<Vector3>() / mass;
        let u = links()
            .map(|(i, b)| velocity(i, b) * b.mass)
            .sum::<Vector3>()
            / mass;
        // (25)-(26), second part, and h_R of (27), both about the arm's mass centre.
        let mut I_R = Matrix3::zeros();
        let mut h_R = wheel_momentum(self.tree, k, &self.spin_inertia, wheel_speed);
        for (i, link) in links() {
            let I_i = k.R[i] * link.I_BBcm_B * k.R[i].transpose();
            let arm = rho(i, link) - rho_R;
            I_R += I_i + parallel_axis(link.mass, &arm);
            h_R += I_i * k.w[i] + arm.cross(&velocity(i, link)) * link.mass;
        }
        Arm {
            mass,
            rho_R,
            I_R,
            u,
            h_R,
        }
    }

    /// Converts a sample to the form used by both steps.
    pub fn reading(&mut self, raw: &Raw) -> Reading {
        Reading {
            R_NB: raw.R_NB.to_rotation_matrix().into_inner(),
            v_NBo_B: raw.R_NB.inverse() * raw.v_NBo_N,
            w_NB_B: raw.w_NB_B,
            arm: self.arm(&raw.q, &raw.rates, &raw.wheel_speed),
        }
    }
}
