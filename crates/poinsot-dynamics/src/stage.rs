//! One evaluation of the motion: plan, placement, base twist, derivative, sample.
//!
//! State (DESIGN, "state = pose and momentum"), in N:
//!
//! ```text
//! y = [ q_NB (xyzw), p_NoScm, l_S, h_SScm, h_w of each torque-driven wheel ]
//! ```
//!
//! Angular momentum is carried about the **system's mass centre** and the position is that of the mass
//! centre: then `p' = l/m` is a straight line, no `p x P` is ever formed, and both momenta are exactly
//! constant without thrust, however far the vehicle drifts. The base follows from
//!
//! ```text
//! I_SScm w = R^T h_SScm - (h_c - c x l_c) - h_wheels        (about the mass centre, in B)
//! v = R^T l_S / m - l_c / m - w x c                         (c = p_BoScm, l_c, h_c: joint rates alone)
//! R' = R [w]x,   l_S' = sum F,   h_SScm' = sum (p - p_Scm) x F
//! ```
//!
//! A wheel with prescribed speed adds `Js Omega a` to `h_wheels`. One driven by a torque has `h_w = Js (Omega + a .
//! w_host)`, `h_w' = torque`; with `w_host = w + w_rel` its relative momentum is `a h_w - Js a a^T w_rel - Js a a^T w`:
//! the last term moves to the left side and reduces the inertia.

use crate::acceleration::Accelerations;
use crate::gravity_gradient::gravity_gradient_torque;
use crate::integrate::{Flow, Halt, Tolerance};
use crate::kinematics::Kinematics;
use crate::momentum::{Twist, composite, momentum};
use crate::orbit::{Orbit, orbit_state};
use crate::plan::{Plan, SmoothIntervals, Start, StartVelocity};
use crate::propellant::Leaving;
use crate::run::SmoothByParts;
use crate::thrust::{Nozzle, thrust_levels, thrust_wrench};
use crate::tree::Tree;
use crate::wheel_motion::WheelMotion;
use nalgebra::Quaternion;
use poinsot_spatial::{InertialParameters, Matrix3, UnitQuaternion, Vector3};

pub(crate) const POSITION: usize = 4;
pub(crate) const LINEAR: usize = 7;
pub(crate) const ANGULAR: usize = 10;
pub(crate) const WHEELS: usize = 13;

pub(crate) fn vector(y: &[f64], at: usize) -> Vector3 {
    Vector3::new(y[at], y[at + 1], y[at + 2])
}

pub(crate) fn attitude(y: &[f64]) -> UnitQuaternion {
    UnitQuaternion::new_normalize(Quaternion::new(y[3], y[0], y[1], y[2]))
}

/// The vehicle at one instant, with all ideal measurements.
#[derive(Debug, Clone)]
pub struct MotionSample {
    /// Time, s.
    pub time: f64,
    /// `R_NB`, continuous in sign.
    pub R_NB: UnitQuaternion,
    /// Position of the base origin, in N, m.
    pub p_NoBo_N: Vector3,
    /// Velocity of the base origin, in N, m/s.
    pub v_NBo_N: Vector3,
    /// Angular velocity of the base, in B, rad/s.
    pub w_NB_B: Vector3,
    /// Position of the system's mass centre, in N, m.
    pub p_NoScm_N: Vector3,
    /// Linear momentum in N, N s.
    pub l_S_N: Vector3,
    /// Angular momentum about the system's mass centre in N, N m s.
    pub h_SScm_N: Vector3,
    /// Joint positions, rad or m, one per coordinate of the tree.
    pub q: Vec<f64>,
    /// Joint rates, rad/s or m/s.
    pub rates: Vec<f64>,
    /// Joint accelerations, rad/s2 or m/s2.
    pub accelerations: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s.
    pub wheel_speed: Vec<f64>,
    /// Motor torques on the wheels, N m.
    pub wheel_torque: Vec<f64>,
    /// Thrust, N; at a switch the value just after it.
    pub thrust: Vec<f64>,
    /// Position of the reference orbit from the attracting body, in N, m; zero where none is simulated.
    pub p_orbit_N: Vector3,
    /// Placement and velocity of every body, in base axes.
    pub kinematics: Kinematics,
    /// Inertial accelerations of every body, in base axes: exact to round-off, as they come from the
    /// momentum equation and not from differences.
    pub body: Accelerations,
}

impl MotionSample {
    /// Pose, momentum and twist; `y` is the state of an integration, `c` the mass centre from the base origin in B.
    pub(crate) fn set_state(
        &mut self,
        (R_NB, y): (&UnitQuaternion, &[f64]),
        c: &Vector3,
        twist: &Twist,
    ) {
        self.R_NB = *R_NB;
        self.p_NoScm_N = vector(y, POSITION);
        self.p_NoBo_N = self.p_NoScm_N - R_NB * c;
        self.v_NBo_N = R_NB * twist.v;
        self.w_NB_B = twist.w;
        self.l_S_N = vector(y, LINEAR);
        self.h_SScm_N = vector(y, ANGULAR);
    }

    /// Everything zero, with room for the coordinates of a tree, wheels and thrusters.
    pub(crate) fn new(tree: &Tree, wheels: usize, thrusters: usize) -> Self {
        let dof = tree.dof();
        Self {
            time: 0.0,
            R_NB: UnitQuaternion::identity(),
            p_NoBo_N: Vector3::zeros(),
            v_NBo_N: Vector3::zeros(),
            w_NB_B: Vector3::zeros(),
            p_NoScm_N: Vector3::zeros(),
            l_S_N: Vector3::zeros(),
            h_SScm_N: Vector3::zeros(),
            q: vec![0.0; dof],
            rates: vec![0.0; dof],
            accelerations: vec![0.0; dof],
            wheel_speed: vec![0.0; wheels],
            wheel_torque: vec![0.0; wheels],
            thrust: vec![0.0; thrusters],
            p_orbit_N: Vector3::zeros(),
            kinematics: Kinematics::new(tree),
            body: Accelerations::new(tree),
        }
    }
}

/// A vehicle with a plan, ready to move.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// let vehicle = Vehicle {
///     tree,
///     bodies: bodies.to_vec(),
///     spin_inertia: vec![0.01],
///     nozzles: vec![],
///     locked_at: vec![0.0],
///     gravity: Gravity::default(),
/// };
/// // The wheel runs at 100 rad/s in a vehicle without momentum: the base turns back.
/// let plan = Plan { wheels: vec![WheelMotion::constant(100.0)], ..Plan::hold(vehicle.clone()) };
/// let prescribed = Prescribed::new(vehicle, &plan, Tolerance::default())?;
/// let mut rate = 0.0;
/// prescribed.run(&Start::at_rest(), &[0.0, 1.0], |sample| rate = sample.w_NB_B.z)?;
/// assert!((rate + 1.0 / (1.5 + 8.0 / 3.0)).abs() < 1.0e-12);
/// # Ok::<(), MotionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Prescribed<'p> {
    pub(crate) tree: Tree,
    pub(crate) parameters: Vec<InertialParameters>,
    pub(crate) spin_inertia: Vec<f64>,
    pub(crate) nozzles: Vec<Nozzle>,
    pub(crate) plan: &'p Plan,
    pub(crate) mass: f64,
    /// Gravitational parameter and orbit of the gravity gradient.
    pub(crate) orbit: Option<(f64, Orbit)>,
    pub(crate) tolerance: Tolerance,
}

/// Input of a wheel: known relative speed, or known absolute axial momentum.
#[derive(Clone, Copy)]
enum Spin {
    Speed(f64),
    Momentum(f64),
}

/// The plan evaluated at one instant, and the scratch for it.
pub(crate) struct Stage<'s> {
    vehicle: &'s Prescribed<'s>,
    stretches: SmoothIntervals,
    /// A time inside the present smooth stretch.
    within: f64,
    /// The bodies with the propellant that is left, and their mass.
    parameters: Vec<InertialParameters>,
    mass: f64,
    spins: Vec<Spin>,
    /// Motor torque of torque-driven wheels, N m; acceleration of the others, rad/s2.
    wheel_input: Vec<f64>,
    c: Vector3,
    /// About the mass centre; on the left of the momentum equation.
    inertia: Matrix3,
    /// The same with all rotors as if locked.
    locked_inertia: Matrix3,
    sample: MotionSample,
}

impl<'s> Stage<'s> {
    /// In the smooth stretch at `t`.
    pub fn new(vehicle: &'s Prescribed<'s>, t: f64) -> Self {
        let wheels = vehicle.spin_inertia.len();
        let stretches = SmoothIntervals::new(vehicle.plan.breaks());
        Self {
            vehicle,
            within: stretches.of(t).0,
            stretches,
            parameters: vehicle.parameters.clone(),
            mass: vehicle.mass,
            spins: vec![Spin::Speed(0.0); wheels],
            wheel_input: vec![0.0; wheels],
            c: Vector3::zeros(),
            inertia: Matrix3::zeros(),
            locked_inertia: Matrix3::zeros(),
            sample: MotionSample::new(&vehicle.tree, wheels, vehicle.nozzles.len()),
        }
    }

    /// Reads the plan at `t`; torque-driven wheels take their momentum from `h_w`, or their initial speed
    /// where `h_w` ends.
    fn set_inputs(&mut self, t: f64, h_w: &[f64]) {
        let (plan, sample) = (self.vehicle.plan, &mut self.sample);
        for (k, joint) in plan.joints.iter().enumerate() {
            let jet = joint.at(t, self.within);
            sample.q[k] = jet.value;
            sample.rates[k] = jet.rate;
            sample.accelerations[k] = jet.acceleration;
        }
        let mut momenta = h_w.iter();
        for (i, wheel) in plan.wheels.iter().enumerate() {
            (self.spins[i], self.wheel_input[i]) = match wheel {
                WheelMotion::Speed(profile) => {
                    let jet = profile.at(t, self.within);
                    (Spin::Speed(jet.value), jet.rate)
                }
                WheelMotion::Torque {
                    initial_speed,
                    torque,
                } => {
                    let spin = momenta
                        .next()
                        .map_or(Spin::Speed(*initial_speed), |h| Spin::Momentum(*h));
                    (spin, torque.at(t, self.within).value)
                }
            };
        }
        thrust_levels(&plan.firings, self.within, &mut sample.thrust);
        self.use_propellant(t);
    }

    /// Takes off what was used by `t`.
    fn use_propellant(&mut self, t: f64) {
        let vehicle = self.vehicle;
        if vehicle.nozzles.iter().all(|n| n.propellant.is_none()) {
            return;
        }
        self.parameters.clone_from(&vehicle.parameters);
        for firing in &vehicle.plan.firings {
            let nozzle = vehicle.nozzles.get(firing.thruster);
            let Some((nozzle, propellant)) = nozzle.and_then(|n| Some((n, n.propellant?))) else {
                continue;
            };
            let body = &mut self.parameters[nozzle.body];
            *body = body.with_added(-firing.impulse_by(t), &propellant.loss());
        }
        self.mass = self.parameters.iter().map(|p| p.mass).sum();
    }

    /// What leaves with the propellant at the placement in hand: change of momentum, of angular momentum about the mass centre, and
    /// first moment about it, each per second in B.
    fn leaving(&self, twist: &Twist, l_S_B: &Vector3) -> [Vector3; 3] {
        let k = &self.sample.kinematics;
        let mut sum = [Vector3::zeros(); 3];
        for (nozzle, level) in self.vehicle.nozzles.iter().zip(&self.sample.thrust) {
            let Some(propellant) = nozzle.propellant.filter(|_| *level != 0.0) else {
                continue;
            };
            let i = nozzle.body;
            let (v, w) = (k.v[i] + twist.v + twist.w.cross(&k.p[i]), k.w[i] + twist.w);
            let system = (&self.c, &(l_S_B / self.mass));
            let out = Leaving::new(&propellant.loss(), (&k.R[i], &k.p[i]), (&v, &w), system);
            let parts = [out.l_B, out.h_Scm_B, out.first_moment_B];
            sum.iter_mut()
                .zip(parts)
                .for_each(|(s, x)| *s += x * *level);
        }
        sum
    }

    /// Places the bodies, and solves the momentum equations above for the base twist.
    fn solve(
        &mut self,
        t: f64,
        R_NB: &UnitQuaternion,
        l_S_N: &Vector3,
        h_SScm_N: &Vector3,
    ) -> Result<Twist, Halt> {
        let (vehicle, sample) = (self.vehicle, &mut self.sample);
        let kinematics = &mut sample.kinematics;
        let zero = Vector3::zeros();
        kinematics.place(&vehicle.tree, &sample.q);
        kinematics.set_velocities(&vehicle.tree, &zero, &zero, &sample.rates);
        let whole = composite(&self.parameters, kinematics);
        let joints = momentum(&self.parameters, kinematics);
        let (l_c, h_c) = (
            Vector3::new(joints[0], joints[1], joints[2]),
            Vector3::new(joints[3], joints[4], joints[5]),
        );
        self.c = whole.p_BoScm_B();
        self.inertia = whole.I_SScm_B();
        self.locked_inertia = self.inertia;
        let to_base = R_NB.inverse();
        let mut h = to_base * h_SScm_N - (h_c - self.c.cross(&l_c));
        let rotors = vehicle.tree.rotors.iter().zip(&vehicle.spin_inertia);
        for ((rotor, js), spin) in rotors.zip(&self.spins) {
            let a = kinematics.R[rotor.body] * rotor.axis_B;
            match spin {
                Spin::Speed(speed) => h -= a * (js * speed),
                Spin::Momentum(h_w) => {
                    h -= a * (h_w - js * a.dot(&kinematics.w[rotor.body]));
                    self.inertia -= a * a.transpose() * *js;
                }
            }
        }
        let factor = self.inertia.cholesky().ok_or(Halt::Singular { time: t })?;
        let w = factor.solve(&h);
        let v = (to_base * l_S_N - l_c) / self.mass - w.cross(&self.c);
        Ok(Twist { v, w })
    }

    /// Gravity-gradient torque about the system's mass centre, in B; the placement is that of `inertia`, without
    /// torque-driven rotors, on which the field acts too.
    fn gradient_torque(&self, t: f64, R_NB: &UnitQuaternion) -> Vector3 {
        let Some((gm, orbit)) = &self.vehicle.orbit else {
            return Vector3::zeros();
        };
        let r_B = R_NB.inverse() * orbit_state(*gm, orbit, t).0;
        gravity_gradient_torque(*gm, &r_B, &self.locked_inertia)
    }

    /// The state vector at the first instant.
    pub fn start(&mut self, start: &Start, t: f64) -> Result<Vec<f64>, Halt> {
        self.set_inputs(t, &[]);
        let zero = Vector3::zeros();
        // The placement is what matters here; the twist is that of zero momentum.
        let rest = self.solve(t, &start.R_NB, &zero, &zero)?;
        let (l, h, twist) = match &start.velocity {
            StartVelocity::Momentum { l_S_N, h_SScm_N } => {
                let twist = self.solve(t, &start.R_NB, l_S_N, h_SScm_N)?;
                (*l_S_N, *h_SScm_N, twist)
            }
            StartVelocity::Twist { v_NBo_N, w_NB_B } => {
                // Momentum is affine in the twist and vanishes at `rest`.
                let v = start.R_NB.inverse() * v_NBo_N;
                let (dv, dw) = (v - rest.v, w_NB_B - rest.w);
                let l = (dv + dw.cross(&self.c)) * self.mass;
                let h = self.inertia * dw;
                (start.R_NB * l, start.R_NB * h, Twist { v, w: *w_NB_B })
            }
        };
        let p = start.p_NoBo_N + start.R_NB * self.c;
        let q = start.R_NB.coords;
        let mut y = vec![q.x, q.y, q.z, q.w, p.x, p.y, p.z];
        y.extend(l.iter().chain(h.iter()));
        let vehicle = self.vehicle;
        for (i, wheel) in vehicle.plan.wheels.iter().enumerate() {
            if let WheelMotion::Torque { initial_speed, .. } = wheel {
                let rotor = &vehicle.tree.rotors[i];
                let kinematics = &self.sample.kinematics;
                let a = kinematics.R[rotor.body] * rotor.axis_B;
                let w_host = twist.w + kinematics.w[rotor.body];
                y.push(vehicle.spin_inertia[i] * (initial_speed + a.dot(&w_host)));
            }
        }
        Ok(y)
    }

    /// Natural magnitudes of the state: 1 rad, 1 m, and the momenta of the vehicle moving at 1 cm/s and
    /// turning at 0.01 rad/s.
    pub fn scale(&self) -> Vec<f64> {
        let mut scale = vec![1.0; LINEAR];
        scale.resize(ANGULAR, 0.01 * self.vehicle.mass);
        scale.resize(WHEELS, 0.01 * self.inertia.trace() / 3.0);
        let spins = self
            .vehicle
            .plan
            .wheels
            .iter()
            .zip(&self.vehicle.spin_inertia);
        for (wheel, js) in spins {
            if matches!(wheel, WheelMotion::Torque { .. }) {
                scale.push(*js);
            }
        }
        scale
    }

    /// Base acceleration from `F = l'`, `T = h'`, both split into what the base adds and the rest; then
    /// wheel speeds and torques.
    fn set_accelerations(&mut self, t: f64) -> Result<(), Halt> {
        let gradient_B = self.gradient_torque(t, &self.sample.R_NB);
        let (vehicle, sample) = (self.vehicle, &mut self.sample);
        let (tree, kinematics) = (&vehicle.tree, &sample.kinematics);
        let body = &mut sample.body;
        body.set_without_base(tree, kinematics, &sample.rates, &sample.accelerations);
        let (l_rate, mut h_rate) = body.momentum_rate(&self.parameters, kinematics);
        for (i, rotor) in tree.rotors.iter().enumerate() {
            let a = kinematics.R[rotor.body] * rotor.axis_B;
            let (w, alpha) = (kinematics.w[rotor.body], body.alpha[rotor.body]);
            let js = vehicle.spin_inertia[i];
            let axial = match self.spins[i] {
                Spin::Speed(speed) => {
                    sample.wheel_speed[i] = speed;
                    js * self.wheel_input[i]
                }
                Spin::Momentum(h_w) => {
                    sample.wheel_speed[i] = h_w / js - a.dot(&w);
                    self.wheel_input[i] - js * a.dot(&alpha)
                }
            };
            h_rate += a * axial + w.cross(&a) * (js * sample.wheel_speed[i]);
        }
        let (force, mut torque) = thrust_wrench(&vehicle.nozzles, kinematics, &sample.thrust);
        torque += gradient_B;
        let (f, n) = (force - l_rate, torque - h_rate);
        let factor = self.inertia.cholesky().ok_or(Halt::Singular { time: t })?;
        let alpha = factor.solve(&(n - self.c.cross(&f)));
        let a = f / self.mass - alpha.cross(&self.c);
        body.add_base(kinematics, &a, &alpha);
        for (i, rotor) in tree.rotors.iter().enumerate() {
            sample.wheel_torque[i] = match self.spins[i] {
                Spin::Momentum(_) => self.wheel_input[i],
                Spin::Speed(_) => {
                    let axis = kinematics.R[rotor.body] * rotor.axis_B;
                    let alpha_host = body.alpha[rotor.body];
                    vehicle.spin_inertia[i] * (self.wheel_input[i] + axis.dot(&alpha_host))
                }
            };
        }
        Ok(())
    }
}

impl SmoothByParts for Stage<'_> {
    type Sample = MotionSample;

    fn enter(&mut self, t: f64, _: &[f64]) -> Result<f64, Halt> {
        let (within, end) = self.stretches.of(t);
        self.within = within;
        Ok(end)
    }

    fn sample(&mut self, t: f64, y: &[f64]) -> Result<&MotionSample, Halt> {
        self.set_inputs(t, &y[WHEELS..]);
        let (R_NB, l, h) = (attitude(y), vector(y, LINEAR), vector(y, ANGULAR));
        let twist = self.solve(t, &R_NB, &l, &h)?;
        let vehicle = self.vehicle;
        let sample = &mut self.sample;
        sample.time = t;
        if let Some((gm, orbit)) = &vehicle.orbit {
            sample.p_orbit_N = orbit_state(*gm, orbit, t).0;
        }
        sample.set_state((&R_NB, y), &self.c, &twist);
        sample
            .kinematics
            .set_velocities(&vehicle.tree, &twist.v, &twist.w, &sample.rates);
        self.set_accelerations(t)?;
        Ok(&self.sample)
    }
}

impl Flow for Stage<'_> {
    fn derivative(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
        self.set_inputs(t, &y[WHEELS..]);
        let (R_NB, l, h) = (attitude(y), vector(y, LINEAR), vector(y, ANGULAR));
        let twist = self.solve(t, &R_NB, &l, &h)?;
        // q' = q (0, w) / 2
        let q = R_NB.quaternion() * Quaternion::from_imag(twist.w * 0.5);
        dy[..POSITION].copy_from_slice(q.coords.as_slice());
        let (force, torque) = thrust_wrench(
            &self.vehicle.nozzles,
            &self.sample.kinematics,
            &self.sample.thrust,
        );
        let gradient_B = self.gradient_torque(t, &R_NB);
        let [l_out, h_out, moment_out] = self.leaving(&twist, &(R_NB.inverse() * l));
        let blocks = [
            (l - R_NB * moment_out) / self.mass,
            R_NB * (force - l_out),
            R_NB * (torque + gradient_B - self.c.cross(&force) - h_out),
        ];
        for (out, block) in dy[POSITION..WHEELS].chunks_exact_mut(3).zip(&blocks) {
            out.copy_from_slice(block.as_slice());
        }
        let wheels = self.spins.iter().zip(&self.wheel_input);
        let torques = wheels.filter(|(spin, _)| matches!(spin, Spin::Momentum(_)));
        for (out, (_, torque)) in dy[WHEELS..].iter_mut().zip(torques) {
            *out = *torque;
        }
        Ok(())
    }

    fn project(&self, y: &mut [f64]) {
        let norm = y[..POSITION].iter().map(|q| q * q).sum::<f64>().sqrt();
        y[..POSITION].iter_mut().for_each(|q| *q /= norm);
    }
}
