//! How many integration steps each interval takes, from the frequencies that are present in the record.
//!
//! The grid depends on measurements and nominal numbers alone, so it stays the same while a fit moves the unknowns: the
//! cost is then a smooth function of them. The end of the fit tests whether it is fine enough (`fit/step_error.rs`).

use super::steps::Grid;
use super::vehicle::Vehicle;
use crate::problem::segment::{Observations, SensorRecord};
use poinsot_dynamics::propagation::{Flexibility, LockedVehicle};
use poinsot_dynamics::{
    JointSlopes, Kinematics, Motion as Joint, Tree, composite, composite_and_momentum,
    wheel_momentum,
};
use poinsot_model::SensorKind;
use poinsot_spatial::{InertialParameters, Matrix3, Vector3, Vector6};

/// Largest turn of base and joints in a step, rad.
pub(super) const TURN: f64 = 0.02;
/// Largest phase of nutation about stored momentum in a step, rad. The end of a fit refines it if the sensors are more
/// accurate.
const NUTATION: f64 = 0.06;
/// Phase of nutation that counts as much as one of a flexible mode.
const OSCILLATION: f64 = 0.5;
/// Phase of motion in an interval from which the relative speed of a wheel is not straight within it, rad: the bend is an
/// eighth of its square.
const BEND: f64 = 0.1;
/// Largest number of steps in an interval: beyond it the samples do not determine the motion between them.
const MOST_STEPS: f64 = 4096.0;

impl Grid {
    /// The steps for a vehicle whose numbers are near enough: the nominal one.
    pub fn new(vehicle: &Vehicle, o: &Observations) -> Self {
        let frequencies = Frequencies::new(vehicle, o);
        let mut bends = false;
        let steps = o.time_s.windows(2).enumerate().map(|(k, t)| {
            let h = t[1] - t[0];
            let [turn, nutation] =
                [&frequencies.turn, &frequencies.nutation].map(|f| f64::max(f[k], f[k + 1]) * h);
            bends |= !vehicle.tree.rotors.is_empty() && turn + nutation > BEND;
            (turn / TURN + nutation / NUTATION)
                .ceil()
                .clamp(1.0, MOST_STEPS) as u32
        });
        Self {
            steps: steps.collect(),
            bends,
        }
    }
}

/// Frequencies at every grid time, rad/s.
struct Frequencies {
    /// Of base, joints and surroundings.
    turn: Vec<f64>,
    /// Of the nutation about the momentum of the wheels.
    nutation: Vec<f64>,
}

impl Frequencies {
    fn new(vehicle: &Vehicle, o: &Observations) -> Self {
        let tree = vehicle.tree;
        let (dof, wheels) = (tree.dof(), tree.rotors.len());
        let mut kinematics = Kinematics::new(tree);
        let place = |kinematics: &mut Kinematics, k: usize| {
            if let Some(q) = o.joint_position.get(k * dof..(k + 1) * dof) {
                kinematics.place(tree, q);
            }
            composite(&vehicle.bodies, kinematics)
        };
        let mut whole = place(&mut kinematics, 0);
        let length = gyration(&whole);
        let base = measured_rate(o);
        let modes = vehicle.modes.iter().map(|m| m.frequency_Hz);
        let modes = std::f64::consts::TAU * modes.fold(0.0, f64::max);
        let modes = OSCILLATION * modes.max(swing(vehicle, &kinematics));
        let mut all = Self {
            turn: Vec::with_capacity(base.len()),
            nutation: Vec::with_capacity(base.len()),
        };
        for (k, w) in base.iter().enumerate() {
            if dof > 0 && wheels > 0 {
                whole = place(&mut kinematics, k);
            }
            let rates = o.joint_rate.get(k * dof..(k + 1) * dof).unwrap_or(&[]);
            let speeds = o.wheel_speed.get(k * wheels..(k + 1) * wheels);
            let stored = speeds.map(|s| wheel_momentum(tree, &kinematics, &vehicle.spin, s));
            let nutation = stored.map_or(0.0, |h| nutation(&whole.I_SScm_B(), &h));
            let orbit = o.orbit.get(k).map_or(0.0, |(r, _)| {
                let gm = vehicle.gm.unwrap_or_default();
                (3.0 * gm / r.norm().powi(3)).sqrt()
            });
            let joints = joint_frequency(tree, rates, length);
            all.turn.push(finite(w + joints + orbit));
            all.nutation.push(finite(nutation + modes));
        }
        all
    }
}

/// Frequency of the fastest passive joint where the joints are placed, rad/s.
fn swing(vehicle: &Vehicle, kinematics: &Kinematics) -> f64 {
    if !vehicle.has_passive_joints() {
        return 0.0;
    }
    let (whole, _) = composite_and_momentum(&vehicle.bodies, kinematics);
    let (mut still, speeds) = (JointSlopes::default(), vec![0.0; vehicle.spin.len()]);
    let tree = vehicle.tree;
    still.fill(tree, &vehicle.bodies, kinematics, &vehicle.spin, &speeds);
    let locked = LockedVehicle::new(&whole, &whole, &Vector6::zeros());
    let placed = (&vehicle.passive, &still);
    let frequency = |locked: LockedVehicle| {
        let flexible = Flexibility::with_joints(&[], placed, kinematics, &locked)?;
        Some(finite(flexible.fastest(&locked, false)))
    };
    locked.and_then(frequency).unwrap_or(0.0)
}

fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}

/// Radius of gyration of the whole about its mass centre, m.
pub(super) fn gyration(whole: &InertialParameters) -> f64 {
    (whole.I_SScm_B().trace() / (2.0 * whole.mass)).sqrt()
}

/// Frequency that the fastest joint causes, rad/s: a slide that passes the radius of gyration changes the vehicle as much
/// as a turn of one radian.
pub(super) fn joint_frequency(tree: &Tree, rates: &[f64], length: f64) -> f64 {
    let of = tree.links.iter().map(|link| match link.motion {
        Joint::Revolute(j) => rates.get(j).map_or(0.0, |r| r.abs()),
        Joint::Prismatic(j) => rates.get(j).map_or(0.0, |r| r.abs() / length),
        _ => 0.0,
    });
    of.filter(|f| f.is_finite()).fold(0.0, f64::max)
}

/// Nutation of a body at rest about a stored momentum, rad/s: the eigenvalue `sqrt(h . I h / det I)` of `I^-1 [h]x`.
fn nutation(I: &Matrix3, h: &Vector3) -> f64 {
    (h.dot(&(I * h)) / I.determinant()).max(0.0).sqrt()
}

/// Size of the rate of the base at every grid time, rad/s: between two measurements the larger one. A single outlier does
/// not count. Where no rate is measured on the base, that on a link, or of the attitude; zero where none is.
fn measured_rate(o: &Observations) -> Vec<f64> {
    let n = o.time_s.len();
    let size = |(k, w): (usize, Vector3)| (k, w.norm());
    let mut known: Vec<(usize, f64)> = o.rates().map(size).collect();
    if known.is_empty() {
        let of_link = o.of_kind(SensorKind::Gyro).take(1);
        known = of_link.flat_map(SensorRecord::vectors).map(size).collect();
    }
    if known.is_empty() {
        let attitude: Vec<_> = o.attitudes().collect();
        let turn = attitude.windows(2).map(|pair| {
            let [(a, from), (b, to)] = [pair[0], pair[1]];
            (b, from.angle_to(&to) / (o.time_s[b] - o.time_s[a]))
        });
        known = turn.collect();
    }
    let sizes: Vec<f64> = known.iter().map(|(_, w)| *w).collect();
    for (i, (_, w)) in known.iter_mut().enumerate() {
        let near = [i.saturating_sub(1), i, (i + 1).min(sizes.len() - 1)].map(|i| sizes[i]);
        let [a, b, c] = near;
        // The median of three.
        *w = a.min(b).max(a.max(b).min(c));
    }
    let mut after = known.iter().peekable();
    let mut before = 0.0;
    (0..n)
        .map(|k| {
            while let Some((_, w)) = after.next_if(|(at, _)| *at <= k) {
                before = *w;
            }
            let exact = known.binary_search_by_key(&k, |(at, _)| *at).is_ok();
            let next = after.peek().map_or(before, |(_, w)| *w);
            if exact {
                before
            } else {
                f64::max(before, next)
            }
        })
        .collect()
}
