//! Parts of the robot: their samples, their composition, and bodies from the whole and the tip sides.

use super::super::least_squares::shown_and_hidden;
use super::super::roles::{joint_name, no_velocity};
use super::super::single_body::{Push, SingleRow, momenta};
use super::super::swarm::{Particle, Range};
use super::super::two_body::{Side, TwoBodyReading, equations, rows};
use super::super::{natural, particle};
use super::{Searched, Work};
use crate::samples::add_smallest;
use faer::Mat;
use poinsot_dynamics::{Kinematics, body_momentum};
use poinsot_files::Faults;
use poinsot_identify::{Impulse, Segment, thrust_impulses};
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};

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
            let cut = (0..outers.len()).find(|&j| r != 0 && self.child(j) == r);
            let whole = cut.and_then(|j| outers[j]).unwrap_or(total);
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
        what.transported(&(inverse * n.R[from]), &(inverse * (n.p[from] - n.p[to])))
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
    pub(super) fn carries(&self, root: usize, b: usize) -> bool {
        self.problem.tree.carries(root, b)
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

/// An unobservable transfer across a joint: gain of the child, gain of the parent side.
struct Transfer {
    child: usize,
    parent: usize,
    gains: [InertialParameters; 2],
}

impl Work<'_> {
    /// Applies the smallest transfers, in natural units, that give these bodies their known mass and mass centre.
    pub(super) fn keep_known(&mut self, outers: &[Option<InertialParameters>]) {
        let roots = self.roots(outers);
        let alone = |b: usize| roots.iter().filter(|r| **r == roots[b]).count() == 1;
        let known = (0..roots.len()).filter(|&b| self.roles.tensor_alone[b]);
        let kept: Vec<usize> = known.filter(|&b| alone(b)).collect();
        let moves = self.transfers(outers, &roots);
        if kept.is_empty() || moves.is_empty() {
            return;
        }
        // Mass and first moment of the kept bodies, in natural units.
        let natural = |b: usize| natural(&self.problem.model.bodies[b].nominal);
        let units: Vec<[f64; 10]> = kept.iter().map(|&b| natural(b)).collect();
        let A = Mat::from_fn(4 * kept.len(), moves.len(), |i, j| {
            let (b, k, t) = (kept[i / 4], i % 4, &moves[j]);
            let ends = [t.child, t.parent].into_iter().zip(&t.gains);
            let own = ends.filter(|(body, _)| *body == b);
            own.map(|(_, gain)| gain.to_array()[k]).sum::<f64>() / units[i / 4][k]
        });
        let missing = |i: usize| {
            let (b, k) = (kept[i / 4], i % 4);
            let nominal = self.problem.model.bodies[b].nominal.parameters();
            (nominal.to_array()[k] - self.found.bodies[b].to_array()[k]) / units[i / 4][k]
        };
        let missing: Vec<f64> = (0..4 * kept.len()).map(missing).collect();
        let mut amounts = vec![0.0; moves.len()];
        if add_smallest(&A, &missing, 1.0e-9, &mut amounts).is_none() {
            return;
        }
        for (t, amount) in moves.iter().zip(amounts) {
            for (body, gain) in [t.child, t.parent].into_iter().zip(&t.gains) {
                self.found.bodies[body] = self.found.bodies[body].with_added(amount, gain);
            }
        }
    }

    /// Every unobservable direction of a joint with unknown bodies on both sides.
    fn transfers(&self, outers: &[Option<InertialParameters>], roots: &[usize]) -> Vec<Transfer> {
        let takes =
            |root: usize| (0..roots.len()).find(|&b| roots[b] == root && self.roles.unknown[b]);
        let mut list = Vec::new();
        for joint in (0..outers.len()).filter(|&j| outers[j].is_some()) {
            let c = self.child(joint);
            let (Some(child), Some(parent)) = (takes(c), takes(roots[self.parent(c)])) else {
                continue;
            };
            let (R, p) = (self.normal.R[c], self.normal.p[c]);
            let negative = |x: &InertialParameters| InertialParameters::ZERO.with_added(-1.0, x);
            let across = |x: &InertialParameters| [negative(&x.transported(&R, &p)), *x];
            let nominal = self.composite(c, |b| self.carries(c, b));
            let Some(units) = nominal.mass_properties().map(|body| natural(&body)) else {
                continue;
            };
            let seen = equations(&rows(&self.motions(joint), across));
            let Some((_, hidden)) = shown_and_hidden(&seen, &units) else {
                continue;
            };
            list.extend((0..hidden.ncols()).map(|h| {
                let d = std::array::from_fn(|k| units[k] * hidden[(k, h)]);
                let d = InertialParameters::from_array(&d);
                Transfer {
                    child,
                    parent,
                    gains: [
                        self.moved(&d, c, child),
                        negative(&self.moved(&d, c, parent)),
                    ],
                }
            }));
        }
        list
    }
}

impl Work<'_> {
    /// Samples of (35): thrust with accelerations, in base axes.
    pub(super) fn pushes(&self, segment: &Segment) -> Vec<Push> {
        let Some(measured) = &segment.accelerations else {
            return Vec::new();
        };
        let s = &segment.samples;
        let push = |k: usize| {
            let (F_B, T_B) = self.thrust(segment, s.time_s[k]);
            Push {
                w_NB_B: s.w_NB_B[k],
                dw_NB_B: measured.dw_NB_B[k],
                a_NS_B: measured.a_NS_B.as_ref().map(|a| a[k]),
                p_BoS_B: measured.p_BoS_B,
                F_B,
                T_B,
            }
        };
        let count = s.time_s.len().min(measured.dw_NB_B.len());
        (0..count).map(push).collect()
    }

    /// Force and moment about the base origin just after a time.
    pub(super) fn thrust(&self, segment: &Segment, time: f64) -> (Vector3, Vector3) {
        let later = time + 1.0e-9;
        let on = segment.firings.iter();
        let on = on.filter(|f| f.start_s <= later && later < f.end_s);
        on.fold((Vector3::zeros(), Vector3::zeros()), |(F, T), firing| {
            let thruster = &self.problem.model.thrusters[firing.thruster];
            let R = &self.normal.R[thruster.body];
            let f = R * thruster.direction_B * firing.force;
            let r = self.normal.p[thruster.body] + R * thruster.p_BoT_B;
            (F + f, T + r.cross(&f))
        })
    }

    /// (35) integrated, with the impulse about the base origin.
    pub(super) fn impulses(&self, segment: &Segment) -> Vec<SingleRow> {
        let mut turning = segment.clone();
        turning.samples.translation = None;
        let tree = self.problem.tree;
        let sums = thrust_impulses(tree, &self.problem.model.thrusters, &turning);
        let three = |i: &Impulse| (i.linear, i.angular, i.per_mass_centre);
        let since: Vec<_> = sums.total.iter().map(three).collect();
        let s = &segment.samples;
        let velocity = s.translation.as_ref().map(|t| t.v_NBo_N.as_slice());
        momenta(&s.R_NB, velocity, &s.w_NB_B, &since)
    }

    /// Samples of the segments in which only this joint moves.
    pub(super) fn readings(
        &self,
        joint: usize,
    ) -> Result<Vec<(usize, Vec<TwoBodyReading>)>, Faults> {
        let child = self.child(joint);
        let of = |&at: &usize| Ok((at, self.measured(at, child, Some(joint))?));
        self.roles.of_joint[joint].iter().map(of).collect()
    }

    /// Both sides at every sample. With `alone`, all other joints are in the normal configuration. Otherwise every
    /// joint may move, and all bodies except `body` are known.
    pub(super) fn measured(
        &self,
        at: usize,
        body: usize,
        alone: Option<usize>,
    ) -> Result<Vec<TwoBodyReading>, Faults> {
        let (tree, segment) = (self.problem.tree, &self.problem.segments[at]);
        let s = &segment.samples;
        let translation = s.translation.as_ref();
        let translation = translation.ok_or_else(|| no_velocity(segment))?;
        let dof = tree.dof();
        let mut kinematics = Kinematics::new(tree);
        let mut q = self.roles.normal.clone();
        let mut rates = vec![0.0; dof];
        let list = (0..s.time_s.len()).map(|k| {
            for j in (0..dof).filter(|&j| alone.is_none_or(|a| a == j)) {
                q[j] = s.joint_position[k * dof + j];
                rates[j] = s.joint_rate[k * dof + j];
            }
            let v = s.R_NB[k].inverse() * translation.v_NBo_N[k];
            kinematics.place(tree, &q);
            kinematics.set_velocities(tree, &v, &s.w_NB_B[k], &rates);
            let mut rest = [Vector3::zeros(); 3];
            let others = self.found.bodies.iter().enumerate();
            for (b, pi) in others.filter(|(b, _)| alone.is_none() && *b != body) {
                let m = &kinematics;
                let (l, h) = body_momentum(pi, &m.R[b], &m.p[b], &m.v[b], &m.w[b]);
                let first = m.R[b] * pi.mc_B + m.p[b] * pi.mass;
                rest = [rest[0] + l, rest[1] + h, rest[2] + first];
            }
            TwoBodyReading {
                R_NB: s.R_NB[k],
                p_NoBo_N: translation.p_NoBo_N[k],
                inner: Side::of(&kinematics, 0),
                outer: Side::of(&kinematics, body),
                rest,
            }
        });
        Ok(list.collect())
    }
}
