//! Passive joints: internal coordinates that are exact at any angle.
//!
//! A joint that a spring alone moves has a position `q` and a momentum `pi = s . M`, conjugate to each other: s is its motion per
//! rate, M the momentum of all that it carries, V the motion of its parent, each about the base's origin and relative to the
//! velocity of the system's mass centre, l the linear momentum per rate. For a force F on the vehicle
//!
//! ```text
//! pi' = (V x s) . M - k (q - q_0) - c q' - l . F / m
//! ```
//!
//! since the axis moves with the parent (Featherstone 2008, ch. 2). The rates follow with the twist from all momenta, as those of
//! modes do (`modes.rs`). No acceleration appears.

use super::internal::{MOST_MODES, PerMode};
use crate::algebra::V3;
use crate::inertial::Inertial;
use crate::joint_slopes::{JointSlopes, SubtreeMotion};
use crate::kinematics::Kinematics;
use crate::spring::SpringDamper;
use crate::tree::Tree;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};
use poinsot_spatial::{angular, linear, stacked};

/// A joint coordinate that a spring and damper move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassiveJoint {
    /// The joint coordinate.
    pub coordinate: usize,
    /// What moves it.
    pub spring: SpringDamper,
}

/// The passive joints of a vehicle, with what each carries.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PassiveJoints {
    joints: Vec<PassiveJoint>,
    motions: Vec<SubtreeMotion>,
    /// Joints that carry each body: joint k where bit k is set.
    over: Vec<u8>,
    parents: Vec<usize>,
}

impl PassiveJoints {
    /// At most [`MOST_MODES`] joints of a tree; those beyond, and coordinates that it has not, are left out.
    pub fn new(tree: &Tree, joints: impl Iterator<Item = PassiveJoint>) -> Self {
        let known = |own: PassiveJoint| Some((own, SubtreeMotion::of_joint(tree, own.coordinate)?));
        let (joints, motions): (Vec<_>, Vec<_>) = joints.filter_map(known).take(MOST_MODES).unzip();
        let mut over = Vec::with_capacity(tree.bodies());
        for (i, link) in tree.links.iter().enumerate() {
            let above = over.get(link.parent).copied().unwrap_or(0);
            let own = motions.iter().position(|m: &SubtreeMotion| m.link == i);
            over.push(above | own.map_or(0, |k| 1 << k));
        }
        Self {
            joints,
            motions,
            over,
            parents: tree.links.iter().map(|link| link.parent).collect(),
        }
    }

    /// The joints.
    pub fn joints(&self) -> &[PassiveJoint] {
        &self.joints
    }

    /// The spring of one of them.
    pub fn spring_mut(&mut self, k: usize) -> Option<&mut SpringDamper> {
        self.joints.get_mut(k).map(|joint| &mut joint.spring)
    }

    /// Which joints carry a body: joint k where bit k is set.
    pub fn over(&self, body: usize) -> u8 {
        self.over.get(body).copied().unwrap_or(0)
    }

    /// Whether a body is carried by another, or is that one.
    fn is_within(&self, mut body: usize, carrier: usize) -> bool {
        while body > carrier {
            body = self.parents[body];
        }
        body == carrier
    }

    /// The joints where they are. `still` has the bodies while base and passive joints are at rest.
    pub(super) fn placed(
        &self,
        still: &JointSlopes,
        kinematics: &Kinematics,
    ) -> impl Iterator<Item = (Hinge, SpringDamper)> {
        let each = self.joints.iter().zip(&self.motions);
        each.map(|(joint, motion)| (self.hinge(motion, still, kinematics), joint.spring))
    }

    /// A motion of a subtree as that of a joint among these, placed like them.
    pub fn hinge(
        &self,
        motion: &SubtreeMotion,
        still: &JointSlopes,
        kinematics: &Kinematics,
    ) -> Hinge {
        let (axis, p) = (motion.axis_B(kinematics), kinematics.p[motion.link]);
        let s = match motion.turns {
            true => stacked(&p.cross(&axis), &axis),
            false => stacked(&axis, &Vector3::zeros()),
        };
        let (body, momentum) = still.carried(motion.link);
        let (frame_v, frame_w) = (kinematics.v[motion.frame], kinematics.w[motion.frame]);
        let moves = |(k, own): (usize, &SubtreeMotion)| {
            let inside = self.is_within(own.link, motion.link);
            u8::from(inside) << k
        };
        Hinge {
            s,
            body,
            swing: times(&body, &s),
            carried: momentum,
            parent: stacked(
                &(frame_v - frame_w.cross(&kinematics.p[motion.frame])),
                &frame_w,
            ),
            inboard: self.over(motion.frame),
            moved: self.motions.iter().enumerate().map(moves).sum(),
        }
    }
}

/// A joint at one placement, about the base's origin in base axes: motions are `[v; w]`, momenta `[l; h]`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hinge {
    /// Motion per unit of its rate.
    s: Vector6<f64>,
    /// All that it carries.
    body: Inertial<f64>,
    /// Momentum of that per unit of its rate.
    pub(super) swing: Vector6<f64>,
    /// Its momentum and the motion of its parent while base and passive joints are at rest.
    carried: Vector6<f64>,
    parent: Vector6<f64>,
    /// The passive joints that carry it, and those that move with it, itself among them: joint k where bit k is set.
    inboard: u8,
    moved: u8,
}

/// What a change does at the present motion, rates and twist held: to linear momentum, to the momentum that each passive joint
/// carries, and to the rate of its own.
#[derive(Debug, Clone, Copy, Default)]
pub struct HeldChange {
    pub(super) l: Vector3<f64>,
    pub(super) carried: [Vector6<f64>; MOST_MODES],
    pub(super) push: PerMode,
}

/// The passive joints of a placement in a motion of the base relative to the mass centre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Swinging<'a> {
    pub hinges: &'a [Hinge],
    /// Twist of the base, and rate of each joint.
    pub twist: Vector6<f64>,
    pub rates: PerMode,
}

impl Hinge {
    fn moves(&self, k: usize) -> bool {
        self.moved & (1 << k) != 0
    }

    fn hangs_on(&self, k: usize) -> bool {
        self.inboard & (1 << k) != 0
    }

    /// Element of the mass matrix with itself or another, both by their index.
    pub(super) fn shared(&self, other: &Self, (own, others): (usize, usize)) -> f64 {
        if self.moves(others) {
            self.s.dot(&other.swing)
        } else if other.moves(own) {
            other.s.dot(&self.swing)
        } else {
            0.0
        }
    }

    /// Its own momentum while base and passive joints are at rest.
    pub(super) fn still(&self) -> f64 {
        self.s.dot(&self.carried)
    }

    /// Linear momentum per rate that changes by the masses of bodies that it carries.
    pub(super) fn pull(&self, dm: f64, dmc: &Vector3<f64>) -> Vector3<f64> {
        linear(&self.s) * dm + angular(&self.s).cross(dmc)
    }

    pub(super) fn along(&self, momentum: &Vector6<f64>) -> f64 {
        self.s.dot(momentum)
    }
}

impl Swinging<'_> {
    /// Motion of the parent of a joint beyond that while all is still.
    fn carried_by(&self, own: &Hinge) -> Vector6<f64> {
        let each = self.hinges.iter().zip(self.rates.iter()).enumerate();
        let above = each.filter(|(k, _)| own.hangs_on(*k));
        let above = above.map(|(_, (hinge, rate))| hinge.s * *rate);
        self.twist + above.sum::<Vector6<f64>>()
    }

    /// Momentum of what a joint carries beyond that while all is still.
    fn carries(&self, own: &Hinge) -> Vector6<f64> {
        let each = self.hinges.iter().zip(self.rates.iter()).enumerate();
        let below = each.filter(|(k, _)| own.moves(*k));
        let below = below.map(|(_, (hinge, rate))| hinge.swing * *rate);
        times(&own.body, &self.carried_by(own)) + below.sum::<Vector6<f64>>()
    }

    fn parent(&self, own: &Hinge) -> Vector6<f64> {
        own.parent + self.carried_by(own)
    }

    fn momentum(&self, own: &Hinge) -> Vector6<f64> {
        own.carried + self.carries(own)
    }

    /// `(V x s) . M`.
    pub fn push(&self, own: &Hinge) -> f64 {
        cross(&self.parent(own), &own.s).dot(&self.momentum(own))
    }

    /// Its change with that of the motion, and with what is held.
    pub fn push_change(&self, change: &Swinging, held: Option<&HeldChange>) -> PerMode {
        let mut out = held.map_or_else(PerMode::zeros, |held| held.push);
        for (k, own) in self.hinges.iter().enumerate() {
            let mut momentum = change.carries(own);
            if let Some(held) = held {
                momentum += held.carried[k];
            }
            out[k] += cross(&change.carried_by(own), &own.s).dot(&self.momentum(own))
                + cross(&self.parent(own), &own.s).dot(&momentum);
        }
        out
    }

    /// What a unit of a joint's position changes under an acceleration of the mass centre, and the momentum of the whole.
    pub fn moved(&self, joint: &Hinge, a: &Vector3<f64>) -> (HeldChange, Vector6<f64>) {
        let turn = cross(&joint.s, &self.parent(joint));
        let whole = cross_force(&joint.s, &self.momentum(joint)) - times(&joint.body, &turn);
        let mut held = HeldChange {
            l: linear(&whole),
            ..HeldChange::default()
        };
        for (k, own) in self.hinges.iter().enumerate() {
            let swing = if joint.moves(k) {
                held.carried[k] = -times(&own.body, &turn);
                held.push[k] = -cross(&turn, &own.s).dot(&self.momentum(own));
                cross_force(&joint.s, &own.swing)
            } else if joint.hangs_on(k) {
                held.carried[k] = whole;
                let swung = times(&joint.body, &own.s);
                cross_force(&joint.s, &swung) - times(&joint.body, &cross(&joint.s, &own.s))
            } else {
                continue;
            };
            held.push[k] -= linear(&swing).dot(a);
        }
        (held, whole)
    }

    /// The same for a unit of the rate of a joint that is not among them.
    pub fn driven(&self, joint: &Hinge) -> HeldChange {
        let mut held = HeldChange {
            l: linear(&joint.swing),
            ..HeldChange::default()
        };
        for (k, own) in self.hinges.iter().enumerate() {
            if joint.moves(k) {
                held.carried[k] = times(&own.body, &joint.s);
                held.push[k] = cross(&joint.s, &own.s).dot(&self.momentum(own));
            } else if joint.hangs_on(k) {
                held.carried[k] = joint.swing;
            }
        }
        held
    }
}

impl HeldChange {
    /// Adds another one, times a factor.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        self.l += other.l * factor;
        self.push += other.push * factor;
        let each = self.carried.iter_mut().zip(&other.carried);
        each.for_each(|(own, other)| *own += other * factor);
    }
}

/// Momentum of a body in a motion.
fn times(body: &Inertial<f64>, motion: &Vector6<f64>) -> Vector6<f64> {
    let (v, w) = (V3::of(&linear(motion)), V3::of(&angular(motion)));
    let l = v * body.mass + w.cross(&body.mc);
    let h = body.mc.cross(&v) + body.I.times(&w);
    stacked(&l.stored(), &h.stored())
}

/// Change of a motion `b` that is carried along by `a`.
fn cross(a: &Vector6<f64>, b: &Vector6<f64>) -> Vector6<f64> {
    let (w, turned) = (angular(a), angular(b));
    let v = w.cross(&linear(b)) + linear(a).cross(&turned);
    stacked(&v, &w.cross(&turned))
}

/// The same of a momentum.
fn cross_force(a: &Vector6<f64>, b: &Vector6<f64>) -> Vector6<f64> {
    let (w, l) = (angular(a), linear(b));
    let h = w.cross(&angular(b)) + linear(a).cross(&l);
    stacked(&w.cross(&l), &h)
}
