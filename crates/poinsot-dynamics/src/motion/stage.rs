//! One evaluation of the motion: drives, placement, base twist, accelerations, sample.
//!
//! State (DESIGN, "state = pose and momentum"), in N, continued by what a torque, a controller or a spring drives:
//!
//! ```text
//! y = [ q_NB (xyzw), p_NoScm, l_S, h_SScm, z of each driven wheel, q, q' of each free joint, y, p of each mode ]
//! ```
//!
//! Angular momentum is carried about the **system's mass centre** and the position is that of the mass
//! centre: then `p' = l/m` is a straight line, no `p x P` is ever formed, and both momenta are exactly
//! constant without thrust, however far the vehicle drifts. No internal force enters them. The base follows from
//!
//! ```text
//! I_SScm w = R^T h_SScm - (h_c - c x l_c) - h_wheels        (about the mass centre, in B)
//! v = R^T l_S / m - l_c / m - w x c                         (c = p_BoScm, l_c, h_c: joint rates alone)
//! R' = R [w]x,   l_S' = sum F,   h_SScm' = sum (p - p_Scm) x F
//! ```
//!
//! (`propagation/locked.rs`). `q''` of free joints comes from the articulated-body algorithm (`forward_dynamics.rs`).
//!
//! A wheel adds `a z` to `h_wheels` and the reaction `-(a z' + w_host x a z)` to its host. Where its speed is given, or its
//! acceleration commanded, `z = Js Omega`. One driven by a torque has `z = Js (Omega + a . w_host)`, `z' = torque`; its host
//! then moves like one whose inertia lacks `Js a a^T`.
//!
//! Flexible modes change the twist and move the mass centre (`propagation/modes.rs`); they begin at rest. Accelerations with them are in
//! `flexing.rs`.

use crate::algebra::V3;
use crate::forward_dynamics::{ForwardDynamics, JointInput, Singular};
use crate::gravity_gradient::{gravity_gradient_torque, tidal_wrench};
use crate::inverse_dynamics::InverseDynamics;
use crate::momentum::Wrench;
use crate::motion::controller::{Controller, WheelUse};
use crate::motion::flexing::Flexing;
use crate::motion::flight::{Flight, MotionError, check_times};
use crate::motion::integrate::{Flow, Halt};
use crate::motion::joint_drive::JointDrive;
use crate::motion::plan::{SmoothIntervals, Start, StartVelocity};
use crate::motion::rates_momentum::RatesMomentum;
use crate::motion::run::{SmoothByParts, run};
use crate::motion::sample::MotionSample;
use crate::motion::times::Times;
use crate::motion::wheel_motion::{Axial, WheelMotion};
use crate::orbit::orbit_state;
use crate::propagation::{
    BaseMotion, Flexibility, FlexibleMotion, FlexibleState, Internal, LockedVehicle, PoseMomentum,
};
use crate::propellant::Leaving;
use crate::quaternion;
use crate::thrust::{thrust_levels, thrust_wrench};
use core::f64::consts::TAU;
use nalgebra::Quaternion;
use poinsot_spatial::{InertialParameters, UnitQuaternion, Vector3};

pub(crate) const POSITION: usize = 4;
pub(crate) const LINEAR: usize = 7;
pub(crate) const ANGULAR: usize = 10;
pub(crate) const WHEELS: usize = 13;

impl Flight<'_> {
    /// The state at time `t`, s: `q_NB` (scalar last), `p_NoScm`, `l_S`, `h_SScm` in N, momenta of the wheels that a torque
    /// or a controller drives, positions and then rates of the free joints, amplitude and conjugate momentum of each mode.
    ///
    /// # Errors
    /// The vehicle has no inertia.
    pub fn state(&self, start: &Start, t: f64) -> Result<Vec<f64>, MotionError> {
        Ok(Stage::new(self, &(&[t]).into()).start(start, t)?.0)
    }

    /// Moves the vehicle from `start` (at the first of `times`; free joints and driven wheels start as their drives define)
    /// through every time, s, and hands each sample to `sink`. Returns the use of the controlled wheels.
    ///
    /// # Errors
    /// The motion cannot be computed; samples before that point have been handed over.
    pub fn run<'t>(
        &self,
        start: &Start,
        times: impl Into<Times<'t>>,
        mut sink: impl FnMut(&MotionSample),
    ) -> Result<Vec<WheelUse>, MotionError> {
        self.run_while(start, times, |sample| {
            sink(sample);
            true
        })
    }

    /// The same, ended by the first sample for which `sink` is false.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_while<'t>(
        &self,
        start: &Start,
        times: impl Into<Times<'t>>,
        sink: impl FnMut(&MotionSample) -> bool,
    ) -> Result<Vec<WheelUse>, MotionError> {
        let times = times.into();
        let first = check_times(&times)?;
        let mut stage = Stage::new(self, &times);
        let state = stage.start(start, first)?;
        run(&mut stage, state, &times, self.integrator, sink)?;
        Ok(stage.used())
    }
}

/// Pose and momentum of a state, with the position of the mass centre.
fn pose_momentum(y: &[f64]) -> PoseMomentum {
    let vector = |at: usize| Vector3::new(y[at], y[at + 1], y[at + 2]);
    PoseMomentum {
        R_NB: UnitQuaternion::new_normalize(Quaternion::new(y[3], y[0], y[1], y[2])),
        p_NoBo_N: vector(POSITION),
        P: vector(LINEAR),
        h_SScm_N: vector(ANGULAR),
    }
}

/// A vehicle with modes at one instant.
#[derive(Clone, Copy)]
struct Flexed {
    flexibility: Flexibility,
    motion: FlexibleMotion,
}

/// The plan evaluated at one instant, and the scratch for it.
pub(crate) struct Stage<'s> {
    flight: &'s Flight<'s>,
    controller: Option<Controller<'s>>,
    stretches: SmoothIntervals,
    /// A time inside the present smooth stretch.
    within: f64,
    /// Time of the last evaluation of the drives; NaN before the first.
    read_at: f64,
    /// The bodies with the propellant that is left.
    bodies: Vec<InertialParameters>,
    /// The same without the axial inertia of wheels whose absolute momentum is a state.
    reduced: Vec<InertialParameters>,
    /// Motor force of free joints, acceleration of the others.
    inputs: Vec<f64>,
    /// The same plus springs: input of the dynamics.
    joints: Vec<JointInput>,
    /// Axial momentum `z` of each wheel and its rate, N m s and N m.
    wheel_momentum: Vec<f64>,
    wheel_rate: Vec<f64>,
    /// State of the modes, its rate, and the motion of a vehicle that has some.
    internal: Internal,
    internal_rate: Internal,
    flexed: Option<Flexed>,
    dynamics: ForwardDynamics,
    carried: RatesMomentum,
    inverse: InverseDynamics,
    /// On each body about its origin, in base axes.
    outside: Vec<Wrench>,
    sample: MotionSample,
}

impl<'s> Stage<'s> {
    /// In the smooth stretch at the first of the output times.
    pub fn new(flight: &'s Flight<'s>, times: &'s Times<'s>) -> Self {
        let (vehicle, plan) = (&flight.vehicle, flight.plan);
        let tree = &vehicle.tree;
        let stretches = SmoothIntervals::new(plan.breaks());
        let (dof, wheels) = (tree.dof(), vehicle.spin_inertia.len());
        let shares = (
            flight.allocation.as_slice(),
            vehicle.spin_inertia.as_slice(),
        );
        let mut reduced = vehicle.bodies.clone();
        flight.reduce(&mut reduced);
        Self {
            flight,
            controller: Controller::of(plan, shares, times),
            within: stretches.of(times.get(0).unwrap_or(0.0)).0,
            stretches,
            read_at: f64::NAN,
            bodies: vehicle.bodies.clone(),
            reduced,
            inputs: vec![0.0; dof],
            joints: vec![JointInput::Force(0.0); dof],
            wheel_momentum: vec![0.0; wheels],
            wheel_rate: vec![0.0; wheels],
            internal: Internal::zeros(),
            internal_rate: Internal::zeros(),
            flexed: None,
            dynamics: ForwardDynamics::new(tree),
            carried: RatesMomentum::new(tree),
            inverse: InverseDynamics::new(tree),
            outside: vec![Wrench::ZERO; tree.bodies()],
            sample: MotionSample::new(vehicle),
        }
    }

    /// Use of the controlled wheels so far.
    pub fn used(&self) -> Vec<WheelUse> {
        self.controller
            .as_ref()
            .map_or(Vec::new(), Controller::used)
    }

    /// Evaluates all functions of time alone.
    #[inline]
    fn read_drives(&mut self, t: f64) {
        if self.read_at == t {
            return;
        }
        self.read_at = t;
        let (plan, within) = (self.flight.plan, self.within);
        let sample = &mut self.sample;
        for (k, joint) in plan.joints.iter().enumerate() {
            match joint {
                JointDrive::Force { motor, .. } => self.inputs[k] = motor.at(t, within),
                JointDrive::Motion(prescribed) => {
                    let jet = prescribed.at(t, within);
                    sample.q[k] = jet.value;
                    sample.rates[k] = jet.rate;
                    self.inputs[k] = jet.acceleration;
                }
            }
        }
        for (i, wheel) in plan.wheels.iter().enumerate() {
            match wheel {
                WheelMotion::Speed(profile) => {
                    let (jet, js) = (profile.at(t, within), self.flight.vehicle.spin_inertia[i]);
                    sample.wheel_speed[i] = jet.value;
                    self.wheel_momentum[i] = js * jet.value;
                    self.wheel_rate[i] = js * jet.rate;
                }
                WheelMotion::Torque { torque, .. } => {
                    self.wheel_rate[i] = torque.at(t, within).value;
                }
                WheelMotion::Controlled { .. } => {}
            }
        }
        thrust_levels(&plan.firings, within, &mut sample.thrust);
        self.use_propellant(t);
    }

    /// Takes off what was used by `t`.
    fn use_propellant(&mut self, t: f64) {
        let vehicle = &self.flight.vehicle;
        if vehicle.nozzles.iter().all(|n| n.propellant.is_none()) {
            return;
        }
        self.bodies.clone_from(&vehicle.bodies);
        for firing in &self.flight.plan.firings {
            let nozzle = vehicle.nozzles.get(firing.thruster);
            let Some((nozzle, propellant)) = nozzle.and_then(|n| Some((n, n.propellant?))) else {
                continue;
            };
            let body = &mut self.bodies[nozzle.body];
            *body = body.with_added(-firing.impulse_by(t), &propellant.loss());
        }
        self.reduced.clone_from(&self.bodies);
        self.flight.reduce(&mut self.reduced);
    }

    /// Takes wheels, free joints and modes from the state.
    #[inline]
    fn read_state(&mut self, y: &[f64]) {
        let flight = self.flight;
        let mut at = WHEELS;
        for (z, axial) in self.wheel_momentum.iter_mut().zip(&flight.axial) {
            if *axial != Axial::Given {
                *z = y[at];
                at += 1;
            }
        }
        let (q, rates) = y[at..].split_at(flight.free.len());
        for (k, (q, rate)) in flight.free.iter().zip(q.iter().zip(rates)) {
            self.sample.q[*k] = *q;
            self.sample.rates[*k] = *rate;
        }
        let modes = &y[y.len() - 2 * flight.vehicle.modes.len()..];
        self.internal.as_mut_slice()[..modes.len()].copy_from_slice(modes);
    }

    /// Springs, placement and inertias at the joint positions and rates of the sample; the wheels are part of their hosts
    /// where `whole`.
    #[inline]
    fn place(&mut self, whole: bool) {
        let flight = self.flight;
        let sample = &mut self.sample;
        for (k, joint) in flight.plan.joints.iter().enumerate() {
            self.joints[k] = match joint {
                JointDrive::Force { spring, .. } => {
                    JointInput::Force(self.inputs[k] + spring.force(sample.q[k], sample.rates[k]))
                }
                JointDrive::Motion(_) => JointInput::Acceleration(self.inputs[k]),
            };
        }
        let (tree, kinematics) = (&flight.vehicle.tree, &mut sample.kinematics);
        kinematics.place(tree, &sample.q);
        let bodies = if whole { &self.bodies } else { &self.reduced };
        self.dynamics.set_bodies(tree, bodies, kinematics);
    }

    /// The vehicle as one body at the placement in hand.
    #[inline]
    fn locked(&mut self, t: f64) -> Result<LockedVehicle, Halt> {
        let tree = &self.flight.vehicle.tree;
        let sample = &mut self.sample;
        let (whole, l, mut h) = self.carried.of(tree, &self.dynamics, &sample.rates);
        for (rotor, z) in tree.rotors.iter().zip(&self.wheel_momentum) {
            h += V3::of(&(sample.kinematics.R[rotor.body] * rotor.axis_B)) * *z;
        }
        let locked = LockedVehicle::over(&whole, &whole, (&l, &h));
        locked.ok_or(Halt::Singular { time: t })
    }

    /// The motion of the base at the placement in hand, with modes at rest.
    #[inline]
    fn base_motion(&mut self, t: f64, state: &PoseMomentum) -> Result<BaseMotion, Halt> {
        let base = self.locked(t)?.base_motion(state);
        self.set_velocities(&base);
        Ok(base)
    }

    #[inline]
    fn set_velocities(&mut self, base: &BaseMotion) {
        let (tree, sample) = (&self.flight.vehicle.tree, &mut self.sample);
        let (v, w) = (&base.twist.v, &base.twist.w);
        sample.kinematics.set_velocities(tree, v, w, &sample.rates);
    }

    /// The modes at the placement in hand; the kinematics are then those while the base is still.
    fn flexibility(&mut self, t: f64, locked: &LockedVehicle) -> Result<Flexibility, Halt> {
        let (vehicle, sample) = (&self.flight.vehicle, &mut self.sample);
        let (still, k) = (Vector3::zeros(), &mut sample.kinematics);
        k.set_velocities(&vehicle.tree, &still, &still, &sample.rates);
        let found = Flexibility::new(&vehicle.modes, k, locked);
        found.ok_or(Halt::Singular { time: t })
    }

    /// The motion of the base with the modes as they are.
    #[inline]
    fn motion(&mut self, t: f64, state: &PoseMomentum) -> Result<BaseMotion, Halt> {
        if self.flight.vehicle.modes.is_empty() {
            return self.base_motion(t, state);
        }
        let locked = self.locked(t)?;
        let flexibility = self.flexibility(t, &locked)?;
        let state = FlexibleState {
            rigid: *state,
            internal: self.internal,
        };
        let motion = flexibility.motion(&locked, &state);
        let mut motion = motion.ok_or(Halt::Singular { time: t })?;
        // Deflections turn with hosts that joints turn, and with them the mass centre.
        let (k, centre) = (&self.sample.kinematics, &motion.base.centre);
        for (i, mode) in self.flight.vehicle.modes.iter().enumerate() {
            let deflection = k.R[mode.body] * mode.translation * self.internal[2 * i];
            motion.base.twist.v -= k.w[mode.body].cross(&deflection) / centre.mass;
        }
        self.set_velocities(&motion.base);
        self.flexed = Some(Flexed {
            flexibility,
            motion,
        });
        Ok(motion.base)
    }

    /// Rate of the modes under a force on the vehicle, in B.
    fn rate_modes(&mut self, force: &Vector3) {
        if let Some(flexed) = &self.flexed {
            let (flexibility, motion) = (&flexed.flexibility, &flexed.motion);
            self.internal_rate = flexibility.rate(motion, &self.internal, force);
        }
    }

    /// What the modes change of the accelerations and exert on the bodies, and their sample.
    fn bend(&mut self, t: f64, force: Vector3) -> Result<(), Halt> {
        self.rate_modes(&force);
        let (modes, sample) = (&self.flight.vehicle.modes, &mut self.sample);
        let Some(Flexed { motion, .. }) = &self.flexed else {
            return Ok(());
        };
        for i in 0..modes.len() {
            sample.mode_amplitude[i] = self.internal[2 * i];
            sample.mode_rate[i] = motion.rates[i];
        }
        let flexing = Flexing {
            modes,
            kinematics: &sample.kinematics,
            motion,
            internal: &self.internal,
            rate: &self.internal_rate,
            force,
        };
        let added = flexing.add(&mut sample.body, &mut self.outside);
        added.ok_or(Halt::Singular { time: t })
    }

    /// Drives, placement, velocities and the command of the wheels.
    #[inline]
    fn evaluate(&mut self, t: f64, y: &[f64]) -> Result<(PoseMomentum, BaseMotion), Halt> {
        let state = pose_momentum(y);
        self.read_drives(t);
        self.read_state(y);
        self.place(false);
        let base = self.motion(t, &state)?;
        if let Some(mut controller) = self.controller.take() {
            self.set_wheel_speeds();
            if controller.is_continuous() {
                controller.decide(&state.R_NB, &base.twist.w, &self.sample.wheel_speed);
            }
            controller.command(&self.sample.wheel_speed, &mut self.wheel_rate);
            self.controller = Some(controller);
        }
        Ok((state, base))
    }

    /// Speeds of the wheels whose momentum is part of the state.
    fn set_wheel_speeds(&mut self) {
        let vehicle = &self.flight.vehicle;
        for (i, rotor) in vehicle.tree.rotors.iter().enumerate() {
            let js = vehicle.spin_inertia[i];
            let k = &self.sample.kinematics;
            let host = (k.R[rotor.body] * rotor.axis_B).dot(&k.w[rotor.body]);
            match self.flight.axial[i] {
                Axial::Given => {}
                Axial::Relative => self.sample.wheel_speed[i] = self.wheel_momentum[i] / js,
                Axial::Absolute => self.sample.wheel_speed[i] = self.wheel_momentum[i] / js - host,
            }
        }
    }

    /// Force of thrust, and torque of thrust and gravity gradient about the system's mass centre, in base axes.
    #[inline]
    fn load(&mut self, t: f64, R_NB: &UnitQuaternion, base: &BaseMotion) -> (Vector3, Vector3) {
        let vehicle = &self.flight.vehicle;
        let sample = &mut self.sample;
        let kinematics = &sample.kinematics;
        let (force, torque) = thrust_wrench(&vehicle.nozzles, kinematics, &sample.thrust);
        let mut torque = torque - base.centre.p_BoScm_B.cross(&force);
        if let Some((gm, orbit)) = &self.flight.orbit {
            sample.p_orbit_N = orbit_state(*gm, orbit, t).0;
            // The field acts on free rotors too.
            let mut inertia = base.centre.I_SScm_B;
            let rotors = vehicle.tree.rotors.iter().zip(&vehicle.spin_inertia);
            for ((rotor, js), axial) in rotors.zip(&self.flight.axial) {
                if *axial == Axial::Absolute {
                    let a = kinematics.R[rotor.body] * rotor.axis_B;
                    inertia += a * a.transpose() * *js;
                }
            }
            torque += gravity_gradient_torque(*gm, &(R_NB.inverse() * sample.p_orbit_N), &inertia);
        }
        (force, torque)
    }

    /// What leaves with the propellant: change of momentum, of angular momentum about the mass centre, and first moment
    /// about it, each per second in B.
    fn leaving(&self, base: &BaseMotion) -> [Vector3; 3] {
        let k = &self.sample.kinematics;
        let mut sum = [Vector3::zeros(); 3];
        let centre = &base.centre;
        let system = (&centre.p_BoScm_B, &(centre.l_B / centre.mass));
        for (nozzle, level) in self.flight.vehicle.nozzles.iter().zip(&self.sample.thrust) {
            let Some(propellant) = nozzle.propellant.filter(|_| *level != 0.0) else {
                continue;
            };
            let i = nozzle.body;
            let (place, velocity) = ((&k.R[i], &k.p[i]), (&k.v[i], &k.w[i]));
            let out = Leaving::new(&propellant.loss(), place, velocity, system);
            let parts = [out.l_B, out.h_Scm_B, out.first_moment_B];
            sum.iter_mut()
                .zip(parts)
                .for_each(|(s, x)| *s += x * *level);
        }
        sum
    }

    /// Wrenches of thrust, gravity and wheels on each body at the current kinematics.
    #[inline]
    fn set_outside(&mut self, R_NB: &UnitQuaternion, base: &BaseMotion) {
        let vehicle = &self.flight.vehicle;
        let sample = &self.sample;
        self.outside.fill(Wrench::ZERO);
        let kinematics = &sample.kinematics;
        for (nozzle, level) in vehicle.nozzles.iter().zip(&sample.thrust) {
            if *level != 0.0 {
                let R = &kinematics.R[nozzle.body];
                let force = R * nozzle.direction_B * *level;
                self.outside[nozzle.body].force += force;
                self.outside[nozzle.body].torque += (R * nozzle.p_BoT_B).cross(&force);
            }
        }
        if let Some((gm, _)) = &self.flight.orbit {
            let r_B = R_NB.inverse() * sample.p_orbit_N;
            for (i, body) in self.bodies.iter().enumerate() {
                let tide = tidal_wrench(*gm, &r_B, &base.centre.p_BoScm_B, body, kinematics, i);
                self.outside[i].force += tide.force;
                self.outside[i].torque += tide.torque;
            }
        }
        for (i, rotor) in vehicle.tree.rotors.iter().enumerate() {
            let a = kinematics.R[rotor.body] * rotor.axis_B;
            let turned = kinematics.w[rotor.body].cross(&a) * self.wheel_momentum[i];
            self.outside[rotor.body].torque -= a * self.wheel_rate[i] + turned;
        }
    }

    /// Accelerations of joints and bodies at the placement and velocities found.
    #[inline]
    fn accelerate(&mut self, t: f64, R_NB: &UnitQuaternion, base: &BaseMotion) -> Result<(), Halt> {
        self.set_outside(R_NB, base);
        for (i, wrench) in self.outside.iter().enumerate() {
            self.dynamics.add_wrench(i, &wrench.force, &wrench.torque);
        }
        let tree = &self.flight.vehicle.tree;
        let MotionSample {
            kinematics,
            rates,
            accelerations,
            ..
        } = &mut self.sample;
        let solved = self
            .dynamics
            .solve(tree, kinematics, rates, &self.joints, accelerations);
        solved.map_err(|why| match why {
            Singular::Joint(coordinate) => Halt::Joint {
                time: t,
                coordinate,
            },
            Singular::Base => Halt::Singular { time: t },
        })
    }

    /// The state at the first instant, and the natural magnitudes of its components: 1 rad, 1 m, and the momenta of the
    /// vehicle moving at 1 cm/s and turning at 0.01 rad/s; joint rates 0.01 rad/s. Modes are at rest without deflection.
    pub fn start(&mut self, start: &Start, t: f64) -> Result<(Vec<f64>, Vec<f64>), Halt> {
        let flight = self.flight;
        self.read_drives(t);
        for (k, joint) in flight.plan.joints.iter().enumerate() {
            if let JointDrive::Force {
                initial_position,
                initial_rate,
                ..
            } = joint
            {
                self.sample.q[k] = *initial_position;
                self.sample.rates[k] = *initial_rate;
            }
        }
        let spin = &flight.vehicle.spin_inertia;
        for (i, wheel) in flight.plan.wheels.iter().enumerate() {
            if let WheelMotion::Torque { initial_speed, .. }
            | WheelMotion::Controlled { initial_speed, .. } = wheel
            {
                self.wheel_momentum[i] = spin[i] * initial_speed;
            }
        }
        // With wheels that turn with their hosts: their absolute momentum follows once the turning is known.
        self.place(true);
        let (base, l, h) = self.start_motion(start, t)?;
        let p = start.p_NoBo_N + start.R_NB * base.centre.p_BoScm_B;
        let q = start.R_NB.coords;
        let mut y = vec![q.x, q.y, q.z, q.w, p.x, p.y, p.z];
        y.extend(l.iter().chain(h.iter()));
        let mut scale = vec![1.0; LINEAR];
        scale.resize(ANGULAR, 0.01 * base.centre.mass);
        scale.resize(WHEELS, 0.01 * base.centre.I_SScm_B.trace() / 3.0);
        let sample = &self.sample;
        for (i, rotor) in flight.vehicle.tree.rotors.iter().enumerate() {
            let k = &sample.kinematics;
            let host = (k.R[rotor.body] * rotor.axis_B).dot(&k.w[rotor.body]);
            match flight.axial[i] {
                Axial::Given => continue,
                Axial::Relative => y.push(self.wheel_momentum[i]),
                Axial::Absolute => y.push(self.wheel_momentum[i] + spin[i] * host),
            }
            scale.push(spin[i]);
        }
        y.extend(flight.free.iter().map(|k| sample.q[*k]));
        y.extend(flight.free.iter().map(|k| sample.rates[*k]));
        scale.resize(scale.len() + flight.free.len(), 1.0);
        scale.resize(scale.len() + flight.free.len(), 0.01);
        if !flight.vehicle.modes.is_empty() {
            let locked = self.locked(t)?;
            let resting = self.flexibility(t, &locked)?.at_rest(&base.twist.w);
            y.extend(resting.iter().take(2 * flight.vehicle.modes.len()));
            // The momentum of a mode whose energy is that of the turning vehicle.
            let usual = 0.01 * (base.centre.I_SScm_B.trace() / 3.0).sqrt();
            let each = flight.vehicle.modes.iter();
            scale.extend(each.flat_map(|mode| [usual / (TAU * mode.frequency_Hz), usual]));
        }
        Ok((y, scale))
    }

    /// Motion of the base at the start, and the momenta in N.
    fn start_motion(
        &mut self,
        start: &Start,
        t: f64,
    ) -> Result<(BaseMotion, Vector3, Vector3), Halt> {
        let mut state = PoseMomentum {
            R_NB: start.R_NB,
            p_NoBo_N: start.p_NoBo_N,
            P: Vector3::zeros(),
            h_SScm_N: Vector3::zeros(),
        };
        match &start.velocity {
            StartVelocity::Momentum { l_S_N, h_SScm_N } => {
                (state.P, state.h_SScm_N) = (*l_S_N, *h_SScm_N);
            }
            StartVelocity::Twist { v_NBo_N, w_NB_B } => {
                // Momentum is affine in the twist and vanishes at `rest`.
                let rest = self.base_motion(t, &state)?;
                let centre = &rest.centre;
                let dv = start.R_NB.inverse() * v_NBo_N - rest.twist.v;
                let dw = w_NB_B - rest.twist.w;
                state.P = start.R_NB * ((dv + dw.cross(&centre.p_BoScm_B)) * centre.mass);
                state.h_SScm_N = start.R_NB * (centre.I_SScm_B * dw);
            }
        }
        Ok((self.base_motion(t, &state)?, state.P, state.h_SScm_N))
    }

    /// Motor torques of the wheels, from accelerations.
    fn set_wheel_torques(&mut self) {
        let flight = self.flight;
        let sample = &mut self.sample;
        for (i, rotor) in flight.vehicle.tree.rotors.iter().enumerate() {
            let a = sample.kinematics.R[rotor.body] * rotor.axis_B;
            let host = match flight.axial[i] {
                Axial::Absolute => 0.0,
                Axial::Given | Axial::Relative => {
                    flight.vehicle.spin_inertia[i] * a.dot(&sample.body.alpha[rotor.body])
                }
            };
            let friction = flight.plan.wheels[i].friction(sample.wheel_speed[i]);
            sample.wheel_torque[i] = self.wheel_rate[i] + host - friction;
        }
    }

    /// Motors and springs; prescribed joints by inverse dynamics.
    fn set_joint_forces(&mut self) {
        let tree = &self.flight.vehicle.tree;
        let sample = &mut self.sample;
        if self.flight.free.len() < tree.dof() {
            self.inverse.solve(
                tree,
                &self.reduced,
                &sample.kinematics,
                &sample.body,
                &self.outside,
                &mut sample.motor_force,
            );
        }
        for (k, joint) in self.flight.plan.joints.iter().enumerate() {
            if let JointDrive::Force { spring, .. } = joint {
                sample.motor_force[k] = self.inputs[k];
                sample.spring_force[k] = spring.force(sample.q[k], sample.rates[k]);
            }
        }
    }
}

impl SmoothByParts for Stage<'_> {
    type Sample = MotionSample;

    fn enter(&mut self, t: f64, y: &[f64]) -> Result<f64, Halt> {
        let (within, end) = self.stretches.of(t);
        self.within = within;
        self.read_at = f64::NAN;
        if self.controller.as_mut().is_some_and(|c| c.enter(t)) {
            let (state, base) = self.evaluate(t, y)?;
            if let Some(controller) = &mut self.controller {
                controller.decide(&state.R_NB, &base.twist.w, &self.sample.wheel_speed);
            }
        }
        Ok(self.controller.as_ref().map_or(end, |c| end.min(c.next(t))))
    }

    fn sample(&mut self, t: f64, y: &[f64]) -> Result<&MotionSample, Halt> {
        let (state, base) = self.evaluate(t, y)?;
        let R_NB = state.R_NB;
        let (force, _) = self.load(t, &R_NB, &base);
        self.accelerate(t, &R_NB, &base)?;
        let sample = &mut self.sample;
        sample.time = t;
        sample.R_NB = R_NB;
        sample.p_NoScm_N = state.p_NoBo_N;
        sample.p_NoBo_N = sample.p_NoScm_N - R_NB * base.centre.p_BoScm_B;
        sample.v_NBo_N = R_NB * base.twist.v;
        sample.w_NB_B = base.twist.w;
        (sample.l_S_N, sample.h_SScm_N) = (state.P, state.h_SScm_N);
        let bodies = sample.body.a.iter_mut().zip(&mut sample.body.alpha);
        for (i, (a, alpha)) in bodies.enumerate() {
            (*a, *alpha) = self.dynamics.acceleration(i);
        }
        self.bend(t, force)?;
        for (k, input) in self.joints.iter().enumerate() {
            if let JointInput::Acceleration(given) = input {
                self.sample.accelerations[k] = *given;
            }
        }
        self.set_wheel_speeds();
        self.set_wheel_torques();
        self.set_joint_forces();
        if let Some(controller) = &mut self.controller {
            controller.note(&self.sample.wheel_speed, &self.sample.wheel_torque);
        }
        Ok(&self.sample)
    }
}

impl Flow for Stage<'_> {
    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
        let (state, base) = self.evaluate(t, y)?;
        let R_NB = &state.R_NB;
        let (force, torque) = self.load(t, R_NB, &base);
        let flight = self.flight;
        if !flight.free.is_empty() {
            self.accelerate(t, R_NB, &base)?;
        }
        let q = quaternion::rate(&quaternion::numbers(&state.R_NB), &V3::of(&base.twist.w));
        dy[..POSITION].copy_from_slice(&q);
        let [l_out, h_out, moment_out] = self.leaving(&base);
        let blocks = [
            (state.P - R_NB * moment_out) / base.centre.mass,
            R_NB * (force - l_out),
            R_NB * (torque - h_out),
        ];
        for (out, block) in dy[POSITION..WHEELS].chunks_exact_mut(3).zip(&blocks) {
            out.copy_from_slice(block.as_slice());
        }
        let mut at = WHEELS;
        for (rate, axial) in self.wheel_rate.iter().zip(&flight.axial) {
            if *axial != Axial::Given {
                dy[at] = *rate;
                at += 1;
            }
        }
        let (rates, accelerations) = dy[at..].split_at_mut(flight.free.len());
        for (k, (rate, acceleration)) in flight.free.iter().zip(rates.iter_mut().zip(accelerations))
        {
            *rate = self.sample.rates[*k];
            *acceleration = self.sample.accelerations[*k];
        }
        self.rate_modes(&force);
        let modes = 2 * flight.vehicle.modes.len();
        let at = dy.len() - modes;
        dy[at..].copy_from_slice(&self.internal_rate.as_slice()[..modes]);
        Ok(())
    }

    fn project(&self, y: &mut [f64]) {
        let norm = y[..POSITION].iter().map(|q| q * q).sum::<f64>().sqrt();
        y[..POSITION].iter_mut().for_each(|q| *q /= norm);
    }
}
