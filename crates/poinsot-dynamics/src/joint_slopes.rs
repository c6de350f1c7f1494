//! Derivatives of the momentum over all joints, and over other motions of a subtree, in one pass from the tips to the base.
//!
//! Everything is at fixed base twist, about the base origin `Bo`, in base axes. The subtree of joint j moves rigidly
//! with it: the part of its momentum that is the parent's motion changes with the subtree's mass, first moment and
//! inertia; the part that is relative to the parent turns with the subtree.

use crate::algebra::{M3, V3, stack};
use crate::inertial::Inertial;
use crate::kinematics::Kinematics;
use crate::tree::{Motion, Tree};
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};
use poinsot_spatial::InertialParameters;

/// A motion of a body with all that it carries: that of a joint, or of a joint that the vehicle does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubtreeMotion {
    /// First body that moves.
    pub link: usize,
    /// Body that the direction is fixed in: the parent of `link`, or `link` itself.
    pub frame: usize,
    /// Direction in the axes of `frame`. Slopes are linear in its length.
    pub axis: Vector3<f64>,
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
    pub fn axis_B(&self, kinematics: &Kinematics) -> Vector3<f64> {
        kinematics.R[self.frame] * self.axis
    }
}

/// Slopes over one joint coordinate, linear part first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointSlope {
    /// Momentum per joint rate (rad/s or m/s).
    pub rate: Vector6<f64>,
    /// Change of the momentum per joint position (rad or m), twist and rates held; wheels included.
    pub position: Vector6<f64>,
    /// Change of the first moment of the vehicle per joint position, kg m.
    pub first_moment: Vector3<f64>,
}

/// Scratch; one call of [`JointSlopes::fill`] makes all slopes.
#[derive(Debug, Clone, Default)]
pub struct JointSlopes {
    /// One per joint coordinate.
    pub of: Vec<JointSlope>,
    subtrees: Vec<Subtree>,
}

/// A body with all that it carries, and their momentum, in base axes: here about `Bo`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Subtree<T = f64> {
    pub body: Inertial<T>,
    pub l: V3<T>,
    pub h: V3<T>,
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
        for (i, body) in bodies.iter().map(Inertial::of).enumerate() {
            self.subtrees.push(alone(&body, kinematics, i));
        }
        for (rotor, (js, omega)) in tree.rotors.iter().zip(spin_inertia.iter().zip(wheel_speed)) {
            let axis = M3::of(&kinematics.R[rotor.body]).times(&V3::of(&rotor.axis_B));
            self.subtrees[rotor.body].h += axis * (*js * *omega);
        }
        self.of.clear();
        // Overwritten: every coordinate has a joint.
        if let Some(base) = self.subtrees.first() {
            let none = base.slope(kinematics, 0, 0, &base.body.mc, false);
            self.of.resize(tree.dof(), none);
        }
        // Parents stand before their children: from the last body to the base every subtree is whole.
        for (i, link) in tree.links.iter().enumerate().skip(1).rev() {
            let whole = self.subtrees[i];
            let (at, turns) = match link.motion {
                Motion::Revolute(k) => (Some(k), true),
                Motion::Prismatic(k) => (Some(k), false),
                Motion::Fixed | Motion::Free => (None, false),
            };
            if let Some(slope) = at.and_then(|k| self.of.get_mut(k)) {
                let axis = link.axis_in_base(&M3::of(&kinematics.R[i]));
                *slope = whole.slope(kinematics, i, link.parent, &axis, turns);
            }
            self.subtrees[link.parent].add(&whole);
        }
    }

    /// A body with all that it carries, about `Bo`, and the momentum of that, at the state of the last [`JointSlopes::fill`].
    pub(crate) fn carried(&self, body: usize) -> (Inertial<f64>, Vector6<f64>) {
        let whole = &self.subtrees[body];
        (whole.body, stack(&whole.l, &whole.h).into())
    }

    /// Slopes over a motion at the state of the last [`JointSlopes::fill`].
    pub fn along(&self, kinematics: &Kinematics, motion: &SubtreeMotion) -> JointSlope {
        let axis = V3::of(&motion.axis_B(kinematics));
        let whole = &self.subtrees[motion.link];
        whole.slope(kinematics, motion.link, motion.frame, &axis, motion.turns)
    }
}

#[inline(always)]
fn alone(body: &Inertial<f64>, kinematics: &Kinematics, i: usize) -> Subtree {
    let (R, p) = (M3::of(&kinematics.R[i]), V3::of(&kinematics.p[i]));
    let (v, w) = (V3::of(&kinematics.v[i]), V3::of(&kinematics.w[i]));
    let own = body.turned(&R);
    let l = v * own.mass + w.cross(&own.mc);
    Subtree {
        body: own.seen_from(&p),
        l,
        h: p.cross(&l) + own.mc.cross(&v) + own.I.times(&w),
    }
}

impl Subtree {
    #[inline(always)]
    fn add(&mut self, other: &Self) {
        self.body += other.body;
        self.l += other.l;
        self.h += other.h;
    }

    #[inline(always)]
    fn slope(
        &self,
        kinematics: &Kinematics,
        body: usize,
        frame: usize,
        axis: &V3<f64>,
        turns: bool,
    ) -> JointSlope {
        let p = V3::of(&kinematics.p[body]);
        let w = V3::of(&kinematics.w[frame]);
        // The motion of the frame at the joint, and the subtree about it.
        let v = V3::of(&kinematics.v[frame]) + w.cross(&(p - V3::of(&kinematics.p[frame])));
        let Inertial { mass, mc, I } = self.body.seen_from(&-p);
        let (rate_l, rate_h, dl, dh, first_moment);
        if turns {
            let l_relative = self.l - (v * mass + w.cross(&mc));
            let h_relative = self.h - p.cross(&self.l) - (mc.cross(&v) + I.times(&w));
            let dmc = axis.cross(&mc);
            rate_l = dmc;
            rate_h = I.times(axis);
            // The inertia turns with the subtree: [axis]x I - I [axis]x.
            let turned = axis.cross(&I.times(&w)) - I.times(&axis.cross(&w));
            dl = w.cross(&dmc) + axis.cross(&l_relative);
            dh = dmc.cross(&v) + turned + axis.cross(&h_relative);
            first_moment = dmc;
        } else {
            rate_l = *axis * mass;
            rate_h = mc.cross(axis);
            dl = w.cross(axis) * mass;
            dh = mc.cross(&w.cross(axis)) + axis.cross(&self.l);
            first_moment = *axis * mass;
        }
        JointSlope {
            rate: stack(&rate_l, &(rate_h + p.cross(&rate_l))).into(),
            position: stack(&dl, &(dh + p.cross(&dl))).into(),
            first_moment: first_moment.stored(),
        }
    }
}
