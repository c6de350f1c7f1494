//! Momentum of the joint rates while the base is at rest, by one recursion over the bodies.

use crate::algebra::{Real, V3};
use crate::forward_dynamics::ForwardDynamics;
use crate::inertial::Inertial;
use crate::joint_slopes::Subtree;
use crate::tree::{Motion, Tree};

/// Scratch of the recursion.
#[derive(Debug, Clone)]
pub(crate) struct RatesMomentum<T = f64> {
    /// Each about its own origin, with the base at rest.
    subtrees: Vec<Subtree<T>>,
}

impl<T: Real> RatesMomentum<T> {
    /// Scratch for a tree.
    pub fn new(tree: &Tree) -> Self {
        Self {
            subtrees: Vec::with_capacity(tree.bodies()),
        }
    }

    /// The vehicle as one rigid body, and the momentum `l`, `h` about `Bo` in B (N s, N m s) of the joint rates (rad/s or
    /// m/s), with the bodies of the dynamics before a solution. The same numbers as [`crate::composite`] and
    /// [`crate::momentum`].
    #[inline(always)]
    pub fn of(
        &mut self,
        tree: &Tree,
        dynamics: &ForwardDynamics<T>,
        rates: &[T],
    ) -> (Inertial<T>, V3<T>, V3<T>) {
        self.subtrees.clear();
        for i in 0..tree.links.len() {
            let (body, ..) = dynamics.body(i);
            let l = V3::all(body.mass.all(0.0));
            self.subtrees.push(Subtree { body, l, h: l });
        }
        for (i, link) in tree.links.iter().enumerate().skip(1).rev() {
            let (_, axis, r) = dynamics.body(i);
            let mut subtree = self.subtrees[i];
            let Inertial { mass, mc, I } = &subtree.body;
            match link.motion {
                Motion::Revolute(k) => {
                    let turn = axis * rates[k];
                    subtree.l += turn.cross(mc);
                    subtree.h += I.times(&turn);
                }
                Motion::Prismatic(k) => {
                    let slide = axis * rates[k];
                    subtree.l += slide * *mass;
                    subtree.h += mc.cross(&slide);
                }
                Motion::Fixed | Motion::Free => {}
            }
            self.subtrees[link.parent].carry(&subtree, &r);
        }
        let base = &self.subtrees[0];
        (base.body, base.l, base.h)
    }
}

impl<T: Real> Subtree<T> {
    /// Adds the inertia and momentum of a child with all it carries, moved from `Co` to `Po` over `r = p_PoCo`.
    #[inline(always)]
    fn carry(&mut self, child: &Self, r: &V3<T>) {
        self.body += child.body.seen_from(r);
        self.l += child.l;
        self.h += child.h + r.cross(&child.l);
    }
}
