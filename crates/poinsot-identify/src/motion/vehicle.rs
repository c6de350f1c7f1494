//! The vehicle at one value of the unknowns, with its inputs between samples.

use super::joint_scales::{JointScales, joint_scales};
use super::steps::{Fineness, Grid};
use super::virtual_joints::{VirtualJoint, virtual_joints};
use crate::motion::input_curves::InputCurves;
use crate::problem::parameters::{Parameters, UnknownKind};
use crate::problem::segment::{Firing, Observations, Segment};
use poinsot_dynamics::propagation::{Mode, PassiveJoints};
use poinsot_dynamics::{Propellant, SubtreeMotion, Tree};
use poinsot_model::Thruster;
use poinsot_spatial::{InertialParameters, Vector3};
use std::borrow::Cow;

/// The vehicle at one value of the unknowns.
pub(crate) struct Vehicle<'a> {
    pub tree: &'a Tree,
    pub thrusters: &'a [Thruster],
    /// Index of the segment that it is in.
    pub segment: usize,
    pub bodies: Vec<InertialParameters>,
    pub spin: Vec<f64>,
    /// Flexible modes of the bodies.
    pub modes: Vec<Mode>,
    /// Joints that springs move.
    pub passive: PassiveJoints,
    /// Factor on each thruster's declared force.
    pub thrust_factor: Vec<f64>,
    /// How unknowns move the barycentric parameters.
    pub slopes: Vec<Vec<(usize, f64)>>,
    /// Bodies whose parameters they move.
    pub moved_bodies: Vec<usize>,
    pub kinds: Vec<UnknownKind>,
    /// Whether each unknown moves the vehicle: all but the errors of sensors.
    pub moving: Vec<bool>,
    /// Unknowns that are forces or torques from outside: they have slopes even where their value is zero.
    pub unknown_wrenches: Vec<usize>,
    /// Constant torque in body axes, N m.
    pub torque_B: Vector3,
    /// Constant torque in inertial axes, N m.
    pub torque_N: Vector3,
    /// Coefficients of the drag torque `-c |w| w`, kg m2.
    pub drag: Vector3,
    /// Whether wheel speeds are smooth between samples, or linear (constant torque).
    pub wheels_smooth: bool,
    /// Integration steps in each interval; `None`: those of the vehicle.
    pub grid: Option<&'a Grid>,
    /// Refinement of them.
    pub fineness: Fineness,
    /// Unknowns that change joint and wheel motion.
    pub input_faults: Vec<InputFault>,
    /// Joints with unknown scales, or errors of their rates.
    pub joint_scales: Vec<JointScales>,
    /// Motion of each joint coordinate, then of the virtual joints.
    pub joint_motions: Vec<SubtreeMotion>,
    /// Joints that do not move, by which unknowns displace subtrees.
    pub virtual_joints: Vec<VirtualJoint>,
    /// Curves along which lags shift the inputs, where any is unknown.
    pub curves: Option<&'a InputCurves>,
    /// Slope of its wheel's axis over each unknown that is a tilt; zero for all others.
    pub tilt_slopes: Vec<Vector3>,
    /// Delayed thrusters: unknown, thrusters, delay in s.
    pub late_thrusters: Vec<(usize, Vec<usize>, f64)>,
    /// Gravitational parameter of the gravity gradient, where one acts.
    pub gm: Option<f64>,
    /// Propellant of each thruster.
    pub propellant: Vec<Option<Propellant>>,
    /// Impulse of each thruster before the record, N s; empty: none.
    pub impulse_before: Vec<f64>,
}

/// An unknown error of joint or wheel samples.
pub(crate) struct InputFault {
    /// Index of the unknown.
    pub unknown: usize,
    /// Its value.
    pub value: f64,
}

impl<'a> Vehicle<'a> {
    pub fn new(
        tree: &'a Tree,
        thrusters: &'a [Thruster],
        parameters: &Parameters,
        nominal_spin: &[f64],
        x: &[f64],
    ) -> Self {
        let virtual_joints = virtual_joints(tree, parameters);
        let real = (0..tree.dof()).filter_map(|k| SubtreeMotion::of_joint(tree, k));
        let joint_motions = real
            .chain(virtual_joints.iter().map(|j| j.motion))
            .collect();
        let mut spin = nominal_spin.to_vec();
        let mut thrust_factor = vec![1.0; thrusters.len()];
        let (mut torque_B, mut torque_N) = (Vector3::zeros(), Vector3::zeros());
        let (mut drag, mut late_thrusters) = (Vector3::zeros(), Vec::new());
        for (u, (unknown, value)) in parameters.unknowns.iter().zip(x).enumerate() {
            match unknown.kind {
                UnknownKind::SpinInertia(k) => spin[k] = *value,
                UnknownKind::ThrusterScale(k) => thrust_factor[k] = 1.0 + value,
                UnknownKind::DisturbanceTorque(k) => torque_B[k] = *value,
                UnknownKind::InertialTorque(k) => torque_N[k] = *value,
                UnknownKind::DragTorque(k) => drag[k] = *value,
                UnknownKind::ThrusterLag(ref list) => {
                    late_thrusters.push((u, list.clone(), *value))
                }
                _ => {}
            }
        }
        let kinds = parameters.unknowns.iter().map(|u| u.kind.clone());
        let kinds: Vec<UnknownKind> = kinds.collect();
        let mut vehicle = Self {
            tree,
            thrusters,
            segment: 0,
            bodies: parameters.bodies(x),
            modes: parameters.modes_at(x),
            passive: parameters.passive_at(x),
            spin,
            thrust_factor,
            slopes: parameters.slopes(x),
            moved_bodies: Vec::new(),
            moving: kinds.iter().map(|k| !k.is_of_sensor()).collect(),
            unknown_wrenches: (0..kinds.len())
                .filter(|u| kinds[*u].is_external_wrench())
                .collect(),
            kinds,
            torque_B,
            torque_N,
            drag,
            wheels_smooth: false,
            grid: None,
            fineness: Fineness::default(),
            input_faults: input_faults(parameters, x),
            joint_scales: joint_scales(parameters, x),
            joint_motions,
            virtual_joints,
            curves: None,
            tilt_slopes: tilt_slopes(parameters, x),
            late_thrusters,
            gm: parameters.gm,
            propellant: thrusters
                .iter()
                .map(|t| t.propellant.map(|p| p.flow()))
                .collect(),
            impulse_before: Vec::new(),
        };
        for unknown in 0..vehicle.kinds.len() {
            if vehicle.slopes[unknown].is_empty() {
                vehicle.slopes[unknown] = vehicle.loss_slopes(unknown);
            }
        }
        let moved = |body: &usize| {
            let mut slopes = vehicle.slopes.iter().flatten();
            slopes.any(|(at, _)| at / 10 == *body)
        };
        vehicle.moved_bodies = (0..tree.bodies()).filter(moved).collect();
        vehicle
    }

    /// Whether bodies lose mass as thrusters fire.
    pub fn loses_mass(&self) -> bool {
        self.propellant.iter().any(Option::is_some) || self.kinds.iter().any(|k| k.lost().is_some())
    }

    /// Whether its state goes beyond pose and momentum.
    pub fn is_flexible(&self) -> bool {
        !self.modes.is_empty() || self.has_passive_joints()
    }

    /// Whether its placement is part of its state.
    pub fn has_passive_joints(&self) -> bool {
        !self.passive.joints().is_empty()
    }

    /// Whether every mode has a frequency, and no spring pushes.
    pub fn is_stable(&self) -> bool {
        let (mut modes, mut joints) = (self.modes.iter(), self.passive.joints().iter());
        modes.all(|m| m.frequency_Hz > 0.0 && m.damping_ratio.abs() < 1.0)
            && joints.all(|j| j.spring.stiffness >= 0.0)
    }

    /// Whether external torques depend on attitude or motion.
    pub fn has_environment_torque(&self) -> bool {
        self.gm.is_some() || self.torque_B != Vector3::zeros() || self.drag != Vector3::zeros()
    }

    /// External torque on the base in B, N m.
    pub fn torque(&self, w: &Vector3) -> Vector3 {
        self.torque_B - self.drag.component_mul(w) * w.norm()
    }

    /// Change of that torque with the rate and with one unknown.
    pub fn torque_change(
        &self,
        w: &Vector3,
        dw: &Vector3,
        unknown: Option<&UnknownKind>,
    ) -> Vector3 {
        let size = w.norm();
        let mut change = Vector3::zeros();
        if self.drag != Vector3::zeros() && size > 0.0 {
            change -= self
                .drag
                .component_mul(&(dw * size + w * (w.dot(dw) / size)));
        }
        match unknown {
            Some(UnknownKind::DisturbanceTorque(k)) => change[*k] += 1.0,
            Some(UnknownKind::DragTorque(k)) => change[*k] -= size * w[*k],
            _ => {}
        }
        change
    }
}

fn input_faults(parameters: &Parameters, x: &[f64]) -> Vec<InputFault> {
    let all = parameters.unknowns.iter().zip(x).enumerate();
    all.filter(|(_, (u, _))| u.kind.shifts_inputs())
        .map(|(unknown, (_, value))| InputFault {
            unknown,
            value: *value,
        })
        .collect()
}

/// The tree with its wheels' axes tilted as the unknowns say: `a = (a0 + sum t_i e_i x a0)`, made a unit vector.
pub(crate) fn tilted<'a>(tree: &'a Tree, parameters: &Parameters, x: &[f64]) -> Cow<'a, Tree> {
    let mut tree = Cow::Borrowed(tree);
    for (wheel, axis) in tilted_axes(parameters, x) {
        tree.to_mut().rotors[wheel].axis_B = axis.normalize();
    }
    tree
}

/// Tilted wheels with the sum above before it is made a unit vector.
fn tilted_axes(parameters: &Parameters, x: &[f64]) -> Vec<(usize, Vector3)> {
    let mut list: Vec<(usize, Vector3)> = Vec::new();
    for (unknown, value) in parameters.unknowns.iter().zip(x) {
        let UnknownKind::WheelTilt(wheel, i) = unknown.kind else {
            continue;
        };
        let (axis, across) = &parameters.wheel_axes[wheel];
        if list.last().is_none_or(|(last, _)| *last != wheel) {
            list.push((wheel, *axis));
        }
        if let Some((_, sum)) = list.last_mut() {
            *sum += across[i].cross(axis) * *value;
        }
    }
    list
}

fn tilt_slopes(parameters: &Parameters, x: &[f64]) -> Vec<Vector3> {
    let tilted = tilted_axes(parameters, x);
    let slope = |kind: &UnknownKind| {
        let UnknownKind::WheelTilt(wheel, i) = kind else {
            return Vector3::zeros();
        };
        let (axis, across) = &parameters.wheel_axes[*wheel];
        let sum = tilted.iter().find(|(w, _)| w == wheel);
        let sum = sum.map_or(*axis, |(_, sum)| *sum);
        let (unit, d) = (sum.normalize(), across[*i].cross(axis));
        (d - unit * unit.dot(&d)) / sum.norm()
    };
    parameters.unknowns.iter().map(|u| slope(&u.kind)).collect()
}

/// Slope of a wheel's speed at grid time i, rad/s2: that of the process that it is, or of the parabola through its neighbours, of the
/// straight line at the ends.
pub(crate) fn wheel_slope(o: &Observations, wheels: usize, wheel: usize, i: usize) -> f64 {
    if let Some(known) = o.wheel(wheel).acceleration.get(i) {
        return *known;
    }
    let speed = |i: usize| o.wheel_speed[i * wheels + wheel];
    parabola_slope(&o.time_s, speed, i)
}

/// Slope at grid time i of the parabola through a value and its neighbours; of the straight line at the ends.
pub(crate) fn parabola_slope(t: &[f64], value: impl Fn(usize) -> f64, i: usize) -> f64 {
    let secant = |i: usize| (value(i + 1) - value(i)) / (t[i + 1] - t[i]);
    let last = t.len() - 1;
    match i {
        0 => secant(0),
        i if i == last => secant(last - 1),
        i => {
            let left = t[i] - t[i - 1];
            let right = t[i + 1] - t[i];
            (secant(i - 1) * right + secant(i) * left) / (left + right)
        }
    }
}

/// Grid times and weights of the values that make up [`parabola_slope`]; at an end one of the three has no weight.
pub(crate) fn slope_weights(t: &[f64], i: usize) -> [(usize, f64); 3] {
    let weight = |j: usize| parabola_slope(t, |k| f64::from(u8::from(k == j)), i);
    [i.checked_sub(1), Some(i), Some(i + 1)].map(|j| {
        let within = j.filter(|j| *j < t.len());
        within.map_or((i, 0.0), |j| (j, weight(j)))
    })
}

/// A thruster that fires.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Thrust {
    pub thruster: usize,
    /// Declared force, N.
    pub force: f64,
    /// Index of the firing in its segment.
    pub firing: usize,
}

/// Thrusters that fire in the interval after each grid time, one list behind the other.
pub(crate) struct ThrustPlan {
    all: Vec<Thrust>,
    /// Where the list of each interval ends.
    ends: Vec<usize>,
}

impl ThrustPlan {
    /// The grid holds all edges of firings.
    pub fn new(segment: &Segment) -> Self {
        let t = &segment.observations.time_s;
        let mut running = Running::new(&segment.firings);
        let mut plan = Self {
            all: Vec::new(),
            ends: Vec::with_capacity(t.len()),
        };
        for ends in t.windows(2) {
            let middle = 0.5 * (ends[0] + ends[1]);
            let thrust = |(firing, f): &(usize, &Firing)| Thrust {
                thruster: f.thruster,
                force: f.force,
                firing: *firing,
            };
            let now = running.between(middle, middle);
            plan.all.extend(now.iter().map(thrust));
            plan.ends.push(plan.all.len());
        }
        plan
    }

    /// Those in the interval after grid time k; none after the last.
    pub fn at(&self, k: usize) -> &[Thrust] {
        let end = self.ends.get(k).copied().unwrap_or(self.all.len());
        let start = match k.checked_sub(1) {
            Some(before) => self.ends.get(before).copied().unwrap_or(self.all.len()),
            None => 0,
        };
        self.all.get(start..end).unwrap_or(&[])
    }
}

/// Firings with their indices, over intervals that follow each other: sorted once, each is begun and ended once.
pub(crate) struct Running<'a> {
    waiting: std::iter::Peekable<std::vec::IntoIter<(usize, &'a Firing)>>,
    now: Vec<(usize, &'a Firing)>,
}

impl<'a> Running<'a> {
    pub fn new(firings: &'a [Firing]) -> Self {
        let all = firings.iter().enumerate();
        let mut sorted: Vec<(usize, &Firing)> = all.filter(|(_, f)| f.force != 0.0).collect();
        sorted.sort_by(|a, b| a.1.start_s.total_cmp(&b.1.start_s));
        Self {
            waiting: sorted.into_iter().peekable(),
            now: Vec::new(),
        }
    }

    /// Those that start at `last` at the latest and end after `first`; neither time may fall from call to call.
    pub fn between(&mut self, first: f64, last: f64) -> &[(usize, &'a Firing)] {
        while let Some(next) = self.waiting.next_if(|f| f.1.start_s <= last) {
            self.now.push(next);
        }
        self.now.retain(|f| f.1.end_s > first);
        &self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_one_sweep_finds_the_firings_of_every_interval() {
        let firing = |k: usize| {
            let start_s = (k * 37 % 101) as f64 * 0.1;
            Firing {
                thruster: k,
                start_s,
                end_s: start_s + 0.05 * (1 + k % 40) as f64,
                force: f64::from(u8::from(!k.is_multiple_of(5))),
            }
        };
        let firings: Vec<Firing> = (0..200).map(firing).collect();
        let mut running = Running::new(&firings);
        for k in 0..300 {
            let middle = 0.04 * k as f64;
            let mut found: Vec<usize> = running
                .between(middle, middle)
                .iter()
                .map(|f| f.1.thruster)
                .collect();
            found.sort_unstable();
            let scanned = firings
                .iter()
                .filter(|f| f.start_s <= middle && middle < f.end_s && f.force != 0.0);
            assert_eq!(found, scanned.map(|f| f.thruster).collect::<Vec<_>>());
        }
    }
}
