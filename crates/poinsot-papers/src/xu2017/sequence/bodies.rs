//! Composition of the robot from its parts, and bodies from the whole and the tip sides.

use super::super::swarm::{Particle, Range};
use super::super::two_body::transported;
use super::super::{particle, roles::joint_name};
use super::{Searched, Work};
use poinsot_spatial::{InertialParameters, MassProperties};

impl Work<'_> {
    /// Bodies from the whole and the tip sides: the parts further out are subtracted, (43)-(46). Bodies not separated
    /// by a moving joint count as one; the first unknown of them takes the difference.
    pub(super) fn share_out(&mut self, outers: &[Option<InertialParameters>]) {
        let Some(total) = self.found.total else {
            return;
        };
        let bodies = self.problem.model.bodies.len();
        let root = self.roots(outers);
        for r in (0..bodies).filter(|&r| root[r] == r) {
            let whole = (0..outers.len())
                .find(|&j| r != 0 && self.child(j) == r)
                .and_then(|j| outers[j])
                .unwrap_or(total);
            let mut own = whole;
            for (j, outer) in outers.iter().enumerate() {
                let c = self.child(j);
                let Some(outer) = outer.filter(|_| root[self.parent(c)] == r && c != r) else {
                    continue;
                };
                own = own.with_added(-1.0, &self.moved(&outer, c, r));
            }
            let members: Vec<usize> = (0..bodies).filter(|&b| root[b] == r).collect();
            let Some(&takes) = members.iter().find(|&&b| self.roles.unknown[b]) else {
                continue;
            };
            for &b in members.iter().filter(|&&b| b != takes) {
                own = own.with_added(-1.0, &self.moved(&self.found.bodies[b], b, r));
            }
            self.found.bodies[takes] = self.moved(&own, r, takes);
        }
    }

    /// For each body, the root of the rigid part it belongs to.
    pub(super) fn roots(&self, outers: &[Option<InertialParameters>]) -> Vec<usize> {
        let mut root: Vec<usize> = vec![0; self.problem.model.bodies.len()];
        for b in 1..root.len() {
            let cut = (0..outers.len()).find(|&j| self.child(j) == b && outers[j].is_some());
            root[b] = cut.map_or(root[self.parent(b)], |_| b);
        }
        root
    }

    /// Transforms parameters from the frame of body `from` to the frame of body `to`, in the normal configuration.
    pub(super) fn moved(
        &self,
        what: &InertialParameters,
        from: usize,
        to: usize,
    ) -> InertialParameters {
        let n = &self.normal;
        let inverse = n.R[to].transpose();
        transported(
            what,
            &(inverse * n.R[from]),
            &(inverse * (n.p[from] - n.p[to])),
        )
    }

    /// Sum of the nominal bodies, in the frame of body `frame`.
    pub(super) fn composite(
        &self,
        frame: usize,
        takes: impl Fn(usize) -> bool,
    ) -> InertialParameters {
        let bodies = self.problem.model.bodies.iter().enumerate();
        let taken = bodies.filter(|(b, _)| takes(*b));
        taken.fold(InertialParameters::ZERO, |all, (b, body)| {
            all.with_added(1.0, &self.moved(&body.nominal.parameters(), b, frame))
        })
    }

    pub(super) fn child(&self, joint: usize) -> usize {
        self.problem.model.joints[self.problem.tree.coordinates[joint]].child
    }

    pub(super) fn parent(&self, body: usize) -> usize {
        self.problem.tree.links[body].parent
    }

    /// Whether body `b` is body `root` or in its subtree.
    pub(super) fn carries(&self, root: usize, mut b: usize) -> bool {
        while b != root && b != 0 {
            b = self.parent(b);
        }
        b == root
    }

    /// Whether every body of the base side, and of the tip side, of a joint is known.
    pub(super) fn sides_known(&self, joint: usize) -> [bool; 2] {
        let (child, unknown) = (self.child(joint), &self.roles.unknown);
        [false, true]
            .map(|tip| (0..unknown.len()).all(|b| self.carries(child, b) != tip || !unknown[b]))
    }

    pub(super) fn name(&self, part: Searched) -> String {
        let joint = |j| joint_name(self.problem, j);
        match part {
            Searched::Single => "equivalent single body".to_owned(),
            Searched::Inner(j) => format!("base side of {}", joint(j)),
            Searched::Outer(j) => format!("tip side of {}", joint(j)),
            Searched::Body(b) => self.problem.model.bodies[b].name.clone(),
        }
    }

    pub(super) fn rest_mass(&self, part: Searched) -> f64 {
        let takes = |b: usize| match part {
            Searched::Single => false,
            Searched::Inner(j) => self.carries(self.child(j), b),
            Searched::Outer(j) => !self.carries(self.child(j), b),
            Searched::Body(body) => b != body,
        };
        self.composite(0, takes).mass
    }

    pub(super) fn range(&self, nominal: &MassProperties) -> Range {
        let share = self.solver.share;
        let x = particle(nominal);
        let I = nominal.I_BBcm_B;
        let products = share * I.trace().abs() / 3.0;
        let length = share * nominal.radius_of_gyration().max(1.0e-3);
        let mut half: Particle = [products; 10];
        half[0] = share * x[0];
        (1..4).for_each(|d| half[d] = share * x[d].abs());
        (7..10).for_each(|d| half[d] = length);
        Range::around(&x, &half)
    }
}
