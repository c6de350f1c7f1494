//! Derivatives of the momentum over all joints, and over other motions of a subtree, in one pass from the tips to the base.
//!
//! Everything is at fixed base twist, about the base origin `Bo`, in base axes. The subtree of joint j moves rigidly
//! with it: the part of its momentum that is the parent's motion changes with the subtree's mass, first moment and
//! inertia; the part that is relative to the parent turns with the subtree.

use crate::kinematics::Kinematics;
use crate::tree::{Motion, Tree};
use alloc::vec::Vec;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3, Vector6, parallel_axis, skew};

/// A motion of a body with all that it carries: that of a joint, or of a joint that the vehicle does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubtreeMotion {
    /// First body that moves.
    pub link: usize,
    /// Body that the direction is fixed in: the parent of `link`, or `link` itself.
    pub frame: usize,
    /// Direction in the axes of `frame`. Slopes are linear in its length.
    pub axis: Vector3,
    /// Whether the motion is a rotation about the origin of `link`; otherwise a translation.
    pub turns: bool,
}

impl SubtreeMotion {
    /// The motion of a joint coordinate; `None` if the vehicle has no such coordinate.
    pub fn of_joint(tree: &Tree, coordinate: usize) -> Option<Self> {
        let turns = |motion: Motion| match motion {
            Motion::Revolute(k) => (k == coordinate).then_some(true),
            Motion::Prismatic(k) => (k == coordinate).then_some(false),
            Motion::Fixed | Motion::Free => None,
        };
        let mut links = tree.links.iter().enumerate();
        links.find_map(|(i, link)| {
            Some(Self {
                link: i,
                frame: link.parent,
                axis: link.axis_P,
                turns: turns(link.motion)?,
            })
        })
    }

    /// Its direction in the base.
    pub fn axis_B(&self, kinematics: &Kinematics) -> Vector3 {
        kinematics.R[self.frame] * self.axis
    }
}

/// Slopes over one joint coordinate, linear part first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointSlope {
    /// Momentum per joint rate (rad/s or m/s).
    pub rate: Vector6,
    /// Change of the momentum per joint position (rad or m), twist and rates held; wheels included.
    pub position: Vector6,
    /// Change of the first moment of the vehicle per joint position, kg m.
    pub first_moment: Vector3,
}

/// Scratch; one call of [`JointSlopes::fill`] makes all slopes.
#[derive(Debug, Clone, Default)]
pub struct JointSlopes {
    /// One per joint coordinate.
    pub of: Vec<JointSlope>,
    subtrees: Vec<Subtree>,
}

/// A body with all that it carries, about `Bo` in base axes.
#[derive(Debug, Clone, Copy)]
struct Subtree {
    mass: f64,
    mc: Vector3,
    inertia: Matrix3,
    l: Vector3,
    h: Vector3,
}

impl JointSlopes {
    /// Slopes at the state of `kinematics` (velocities from the base twist and the joint rates), its wheels at
    /// `wheel_speed` rad/s.
    pub fn fill(
        &mut self,
        tree: &Tree,
        bodies: &[InertialParameters],
        kinematics: &Kinematics,
        spin_inertia: &[f64],
        wheel_speed: &[f64],
    ) {
        self.subtrees.clear();
        for (i, body) in bodies.iter().enumerate() {
            self.subtrees.push(alone(body, kinematics, i));
        }
        for (rotor, (js, omega)) in tree.rotors.iter().zip(spin_inertia.iter().zip(wheel_speed)) {
            let turned = kinematics.R[rotor.body] * rotor.axis_B;
            self.subtrees[rotor.body].h += turned * (js * omega);
        }
        let none = JointSlope {
            rate: Vector6::zeros(),
            position: Vector6::zeros(),
            first_moment: Vector3::zeros(),
        };
        self.of.clear();
        self.of.resize(tree.dof(), none);
        // Parents stand before their children: from the last body to the base every subtree is whole.
        for (i, link) in tree.links.iter().enumerate().skip(1).rev() {
            let whole = self.subtrees[i];
            let (at, turns) = match link.motion {
                Motion::Revolute(k) => (Some(k), true),
                Motion::Prismatic(k) => (Some(k), false),
                Motion::Fixed | Motion::Free => (None, false),
            };
            if let Some(slope) = at.and_then(|k| self.of.get_mut(k)) {
                let axis = link.axis_B(&kinematics.R[i]);
                *slope = whole.slope(kinematics, i, link.parent, &axis, turns);
            }
            self.subtrees[link.parent].add(&whole);
        }
    }

    /// Slopes over a motion at the state of the last [`JointSlopes::fill`].
    pub fn along(&self, kinematics: &Kinematics, motion: &SubtreeMotion) -> JointSlope {
        let axis = motion.axis_B(kinematics);
        let whole = &self.subtrees[motion.link];
        whole.slope(kinematics, motion.link, motion.frame, &axis, motion.turns)
    }
}

fn alone(body: &InertialParameters, kinematics: &Kinematics, i: usize) -> Subtree {
    let (R, p) = (&kinematics.R[i], &kinematics.p[i]);
    let (v, w) = (&kinematics.v[i], &kinematics.w[i]);
    let own = R * body.mc_B;
    let about_own_origin = R * body.I_BBo_B * R.transpose();
    let l = v * body.mass + w.cross(&own);
    Subtree {
        mass: body.mass,
        mc: own + p * body.mass,
        inertia: about_own_origin + moved(body.mass, p, &own),
        l,
        h: p.cross(&l) + own.cross(v) + about_own_origin * w,
    }
}

/// Change of the inertia about a point that moves by `-p`, `mc` the first moment about it before.
fn moved(mass: f64, p: &Vector3, mc: &Vector3) -> Matrix3 {
    Matrix3::identity() * (2.0 * p.dot(mc)) - p * mc.transpose() - mc * p.transpose()
        + parallel_axis(mass, p)
}

impl Subtree {
    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.mc += other.mc;
        self.inertia += other.inertia;
        self.l += other.l;
        self.h += other.h;
    }

    fn slope(
        &self,
        kinematics: &Kinematics,
        body: usize,
        frame: usize,
        axis: &Vector3,
        turns: bool,
    ) -> JointSlope {
        let p = kinematics.p[body];
        let w = kinematics.w[frame];
        // The motion of the frame at the joint, and the subtree about it.
        let v = kinematics.v[frame] + w.cross(&(p - kinematics.p[frame]));
        let mc = self.mc - p * self.mass;
        let inertia = self.inertia - moved(self.mass, &p, &mc);
        let (rate_l, rate_h, dl, dh, first_moment);
        if turns {
            let l_relative = self.l - (v * self.mass + w.cross(&mc));
            let h_relative = self.h - p.cross(&self.l) - (mc.cross(&v) + inertia * w);
            let dmc = axis.cross(&mc);
            rate_l = dmc;
            rate_h = inertia * axis;
            let turn = skew(axis);
            dl = w.cross(&dmc) + axis.cross(&l_relative);
            dh = dmc.cross(&v) + (turn * inertia - inertia * turn) * w + axis.cross(&h_relative);
            first_moment = dmc;
        } else {
            rate_l = axis * self.mass;
            rate_h = mc.cross(axis);
            dl = w.cross(axis) * self.mass;
            dh = mc.cross(&w.cross(axis)) + axis.cross(&self.l);
            first_moment = axis * self.mass;
        }
        JointSlope {
            rate: stack(&rate_l, &(rate_h + p.cross(&rate_l))),
            position: stack(&dl, &(dh + p.cross(&dl))),
            first_moment,
        }
    }
}

fn stack(l: &Vector3, h: &Vector3) -> Vector6 {
    Vector6::new(l.x, l.y, l.z, h.x, h.y, h.z)
}
