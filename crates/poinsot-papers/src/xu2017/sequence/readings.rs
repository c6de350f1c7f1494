//! Inputs of each step: thrust and accelerations, impulses, both sides of a joint.

use super::super::roles::no_velocity;
use super::super::single_body::{Push, SingleRow, momenta};
use super::super::two_body::{Side, TwoBodyReading};
use super::Work;
use poinsot_dynamics::{Kinematics, body_momentum};
use poinsot_files::Faults;
use poinsot_identify::{Segment, thrust_impulses};
use poinsot_spatial::Vector3;

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
        let since = sums.total.iter();
        let since: Vec<_> = since
            .map(|i| (i.linear, i.angular, i.per_mass_centre))
            .collect();
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
