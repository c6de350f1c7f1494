//! Mass that leaves with the propellant: bodies that change with time, and the momentum that goes with it.
//!
//! A stronger thruster uses more: what is used follows the thrust with its factor.
//!
//! The mass properties of an answer are those at the start of the first record. What the records before have used is gone at the start
//! of a later one.

use super::vehicle::{Thrust, ThrustPlan, Vehicle};
use super::{Instant, Motion};
use crate::problem::parameters::UnknownKind;
use crate::problem::segment::{Observations, Segment};
use poinsot_dynamics::Leaving;
use poinsot_spatial::{InertialParameters, Vector3, Vector6};

/// Impulse of every thruster in records that end before one begins, N s.
pub(crate) fn impulse_before(segments: &[Segment], own: &Segment, thrusters: usize) -> Vec<f64> {
    let mut sum = vec![0.0; thrusters];
    let begins = own.observations.time_s.first();
    for segment in segments {
        let ends = segment.observations.time_s.last();
        if !ends.zip(begins).is_some_and(|(end, begin)| end <= begin) {
            continue;
        }
        for firing in &segment.firings {
            sum[firing.thruster] += firing.force * (firing.end_s - firing.start_s);
        }
    }
    sum
}

/// Impulse of every thruster up to each grid time, N s, one row each; empty where no mass is lost.
pub(super) fn impulses(vehicle: &Vehicle, thrust: &ThrustPlan, o: &Observations) -> Vec<f64> {
    if !vehicle.loses_mass() {
        return Vec::new();
    }
    let thrusters = vehicle.thrusters.len();
    let mut now = vehicle.impulse_before.clone();
    now.resize(thrusters, 0.0);
    let mut all = now.clone();
    for (k, t) in o.time_s.windows(2).enumerate() {
        for one in thrust.at(k) {
            now[one.thruster] += one.force * (t[1] - t[0]);
        }
        all.extend_from_slice(&now);
    }
    all
}

/// What leaves a body per impulse.
pub(super) struct Part {
    body: usize,
    lost: InertialParameters,
}

impl Vehicle<'_> {
    /// What an unknown makes a body lose per impulse.
    pub(super) fn lost(&self, unknown: usize) -> Option<Part> {
        let kind = &self.kinds[unknown];
        if let UnknownKind::ThrusterScale(k) | UnknownKind::Firing { thruster: k, .. } = kind {
            return self.lost_by(*k);
        }
        let (body, lost) = kind.lost()?;
        Some(Part { body, lost })
    }

    /// What a thruster takes along per impulse, if it loses any mass.
    fn lost_by(&self, thruster: usize) -> Option<Part> {
        let lost = self.propellant.get(thruster)?.as_ref()?.loss();
        let body = self.thrusters[thruster].body;
        Some(Part { body, lost })
    }

    /// Slopes of what is lost over the parameters of the bodies, per impulse.
    pub(super) fn loss_slopes(&self, unknown: usize) -> Vec<(usize, f64)> {
        let slopes = |part: Part| {
            let each = part.lost.to_array().into_iter().enumerate();
            let each = each.filter(|(_, lost)| *lost != 0.0);
            each.map(|(k, lost)| (10 * part.body + k, -lost)).collect()
        };
        self.lost(unknown).map_or_else(Vec::new, slopes)
    }
}

impl Motion<'_> {
    /// Takes off what was used up to a share of the interval after grid time k; the base is still.
    pub(super) fn use_propellant(&mut self, k: usize, at: f64) {
        let v = self.vehicle;
        if self.impulses.is_empty() {
            return;
        }
        let input_state = &mut self.input_state;
        let thrusters = v.thrusters.len();
        let row = |k: usize| self.impulses.get(k * thrusters..(k + 1) * thrusters);
        let Some(here) = row(k) else { return };
        let there = row(k + 1).unwrap_or(here);
        input_state.impulse.clear();
        let between = here.iter().zip(there).map(|(a, b)| a + at * (b - a));
        let true_impulse = between
            .zip(&v.thrust_factor)
            .map(|(sum, factor)| sum * factor);
        input_state.impulse.extend(true_impulse);
        input_state.bodies.clone_from(&v.bodies);
        let used = v.thrusters.iter().zip(&v.propellant);
        for ((thruster, propellant), impulse) in used.zip(&input_state.impulse) {
            if let Some(propellant) = propellant {
                let body = &mut input_state.bodies[thruster.body];
                *body = body.with_added(-impulse, &propellant.loss());
            }
        }
        let kinematics = &input_state.kinematics;
        input_state.velocities.clear();
        let each = kinematics.v.iter().zip(&kinematics.w);
        input_state.velocities.extend(each.map(|(v, w)| (*v, *w)));
    }

    /// Factor of the slopes of an unknown over the parameters of the bodies: where mass is lost, the impulse so far.
    pub(super) fn slope_factor(&self, unknown: usize) -> f64 {
        let v = self.vehicle;
        let now = &self.input_state;
        match &v.kinds[unknown] {
            kind @ UnknownKind::PropellantUse { .. } => {
                let own = v.thrusters.iter().zip(&now.impulse).enumerate();
                let own = own.filter(|(k, (thruster, _))| kind.changes_use_of(*k, thruster.body));
                own.map(|(_, (_, impulse))| impulse).sum()
            }
            UnknownKind::ThrusterScale(thruster) => {
                let impulse = now.impulse.get(*thruster);
                impulse.map_or(0.0, |impulse| impulse / v.thrust_factor[*thruster])
            }
            UnknownKind::Firing {
                segment,
                firing,
                thruster,
            } if *segment == v.segment => {
                let impulse = self.firings.get(*firing).map(|f| f.impulse_by(now.time_s));
                impulse.unwrap_or(0.0) * v.thrust_factor[*thruster]
            }
            UnknownKind::Firing { .. } => 0.0,
            _ => 1.0,
        }
    }

    /// What leaves at the twist of the base given: linear momentum, and angular momentum about the mass centre, per impulse in B.
    fn takes(&self, part: &Part, twist: &Vector6, (c, v_Scm): (&Vector3, &Vector3)) -> Leaving {
        let k = &self.input_state.kinematics;
        let (R, p) = (&k.R[part.body], &k.p[part.body]);
        let w: Vector3 = twist.fixed_rows::<3>(3).into();
        let v = twist.fixed_rows::<3>(0) + w.cross(p);
        Leaving::new(&part.lost, (R, p), (&v, &w), (c, v_Scm))
    }

    /// The same with the motion of the joints.
    pub(super) fn leaves(&self, part: &Part, instant: &Instant) -> Leaving {
        let k = &self.input_state.kinematics;
        let (R, p) = (&k.R[part.body], &k.p[part.body]);
        let (v, w) = self.input_state.velocities[part.body];
        let w_B = w + instant.twist.w;
        let v_B = v + instant.twist.v + instant.twist.w.cross(p);
        let centre = &instant.centre;
        let system = (&centre.p_BoScm_B, &(centre.l_B / centre.mass));
        Leaving::new(&part.lost, (R, p), (&v_B, &w_B), system)
    }

    /// Thrust now with what its propellant takes along.
    fn flows(&self, k: usize) -> impl Iterator<Item = (f64, Part)> {
        self.thrust.at(k).iter().filter_map(|now| {
            let part = self.vehicle.lost_by(now.thruster)?;
            Some((now.force * self.vehicle.thrust_factor[now.thruster], part))
        })
    }

    /// Whether mass leaves in the interval after grid time k.
    pub(super) fn loses_mass_at(&self, k: usize) -> bool {
        self.flows(k).next().is_some()
    }

    /// Momentum that leaves in the interval after grid time k, per second in B: linear, and angular about the mass centre;
    /// `takes`: what a part takes along per impulse.
    pub(super) fn leaving(&self, k: usize, takes: impl Fn(&Part) -> Leaving) -> (Vector3, Vector3) {
        let mut sum = (Vector3::zeros(), Vector3::zeros());
        for (force, part) in self.flows(k) {
            let out = takes(&part);
            sum.0 += out.l_B * force;
            sum.1 += out.h_Scm_B * force;
        }
        sum
    }

    /// Its change with the twist of the base and with the linear momentum in B.
    pub(super) fn momentum_loss_change(
        &self,
        instant: &Instant,
        k: usize,
        (twist, dl_B): (&Vector6, &Vector3),
    ) -> (Vector3, Vector3) {
        let centre = &instant.centre;
        let system = (&centre.p_BoScm_B, &(dl_B / centre.mass));
        self.leaving(k, |part| self.takes(part, twist, system))
    }

    /// Its change with one unknown, the state held: by the twist, by the mass centre and mass, and by another use of propellant.
    pub(super) fn momentum_loss_slope(
        &self,
        instant: &Instant,
        k: usize,
        (unknown, twist): (usize, &Vector6),
        dc: &Vector3,
    ) -> (Vector3, Vector3) {
        if self.impulses.is_empty() {
            return (Vector3::zeros(), Vector3::zeros());
        }
        let centre = &instant.centre;
        let dm = self.mass_change(unknown);
        // The velocity of the mass centre is l / m.
        let v_Scm = centre.l_B / centre.mass;
        let dl_B = -v_Scm * dm;
        let mut sum = self.momentum_loss_change(instant, k, (twist, &dl_B));
        for (force, part) in self.flows(k) {
            let out = self.leaves(&part, instant);
            sum.1 += (dc.cross(&v_Scm) * part.lost.mass - dc.cross(&out.l_B)) * force;
        }
        if let Some(part) = self.vehicle.lost(unknown) {
            let out = self.leaves(&part, instant);
            let thrust = self.thrust.at(k).iter();
            let force: f64 = thrust.map(|now| self.used_by(unknown, now)).sum();
            sum.0 += out.l_B * force;
            sum.1 += out.h_Scm_B * force;
        }
        sum
    }

    /// Thrust whose propellant an unknown changes, per unit of it, N.
    fn used_by(&self, unknown: usize, now: &Thrust) -> f64 {
        let v = self.vehicle;
        let factor = v.thrust_factor[now.thruster];
        match &v.kinds[unknown] {
            kind if kind.changes_use_of(now.thruster, v.thrusters[now.thruster].body) => {
                now.force * factor
            }
            UnknownKind::ThrusterScale(thruster) if now.thruster == *thruster => now.force,
            UnknownKind::Firing {
                segment, firing, ..
            } if (*segment, *firing) == (v.segment, now.firing) => now.force * factor,
            _ => 0.0,
        }
    }

    /// Its change with position and rate of a joint, twist held.
    pub(super) fn joint_loss(
        &self,
        instant: &Instant,
        k: usize,
        (joint, dq, drate): (usize, f64, f64),
        dc: &Vector3,
    ) -> (Vector3, Vector3) {
        let (centre, kinematics) = (&instant.centre, &self.input_state.kinematics);
        let still = |body: usize, r: &Vector3| {
            let (v, w) = self.input_state.velocities[body];
            v + w.cross(&(r - kinematics.p[body]))
        };
        let mut sum = (Vector3::zeros(), Vector3::zeros());
        for (force, part) in self.flows(k) {
            let m = part.lost.mass;
            let r = kinematics.p[part.body] + kinematics.R[part.body] * part.lost.mc_B / m;
            let (mut dr, mut du) = (Vector3::zeros(), Vector3::zeros());
            if let Some(motion) = self.carrying(joint, part.body) {
                let (turn, shift) = self.turned_by(part.body, joint);
                let along = turn.cross(&r) + shift;
                dr = along * dq;
                let w_before = self.input_state.velocities[motion.frame].1 + instant.twist.w;
                let relative = still(part.body, &r) - still(motion.frame, &r);
                du = w_before.cross(&dr) + turn.cross(&relative) * dq + along * drate;
            }
            let u = still(part.body, &r) + instant.twist.v + instant.twist.w.cross(&r);
            let past = u - centre.l_B / centre.mass;
            sum.0 += du * (m * force);
            sum.1 += ((dr - dc).cross(&past) + (r - centre.p_BoScm_B).cross(&du)) * (m * force);
        }
        sum
    }

    /// Change of the mass of the whole with one unknown.
    fn mass_change(&self, unknown: usize) -> f64 {
        let slopes = self.vehicle.slopes[unknown].iter();
        let of_mass: f64 = slopes.filter(|(at, _)| at % 10 == 0).map(|s| s.1).sum();
        of_mass * self.slope_factor(unknown)
    }
}
