//! One evaluation of the driven motion: drives, kinematics, base twist, joint accelerations, sample.
//!
//! State, in N: that of `stage.rs` (pose and momentum), continued by the joints that a force drives:
//!
//! ```text
//! y = [ q_NB (xyzw), p_NoScm, l_S, h_SScm, h_w of each torque-driven wheel, q, q' ]
//! ```
//!
//! No internal force enters the momenta, so they are exact in free fall without thrust, for any joint motion and step.
//! A gravity gradient acts on every body (`gravity_gradient.rs`), so it drives the joints too. The base twist follows
//! from the momentum minus that of the joint rates, and `q''` comes from the articulated-body algorithm
//! (`forward_dynamics.rs`).
//!
//! A wheel driven by a torque has `h_w = Js (Omega + a . w_host)`, `h_w' = torque`. Its host then moves like one whose
//! inertia lacks `Js a a^T` and that carries the known momentum `a h_w`: the reaction on the host is `-(a torque +
//! w_host x a h_w)`. One with prescribed speed leaves `Js` in the host, with the reaction `-(a Js Omega' + w_host x a
//! Js Omega)`.

use crate::algebra::V3;
use crate::forward_dynamics::{ForwardDynamics, JointInput};
use crate::gravity_gradient::tidal_wrench;
use crate::integrate::{Flow, Halt};
use crate::inverse_dynamics::{InverseDynamics, Wrench};
use crate::joint_drive::JointDrive;
use crate::momentum::Twist;
use crate::orbit::{Orbit, orbit_state};
use crate::plan::{SmoothIntervals, Start, StartVelocity};
use crate::rates_momentum::RatesMomentum;
use crate::run::SmoothByParts;
use crate::stage::{ANGULAR, LINEAR, MotionSample, POSITION, WHEELS, attitude, vector};
use crate::symmetric::Symmetric;
use crate::thrust::{Firing, Nozzle, thrust_levels};
use crate::tree::Tree;
use crate::wheel_motion::WheelMotion;
use nalgebra::Quaternion;
use poinsot_spatial::{InertialParameters, UnitQuaternion, Vector3};

/// What drives a vehicle.
#[derive(Debug, Clone, PartialEq)]
pub struct DrivenPlan {
    /// One per joint coordinate of the tree.
    pub joints: Vec<JointDrive>,
    /// One per wheel.
    pub wheels: Vec<WheelMotion>,
    /// In any order; firings of one thruster add up.
    pub firings: Vec<Firing>,
}

impl DrivenPlan {
    /// The times at which some derivative of the motion jumps, s, ascending.
    pub fn breaks(&self) -> Vec<f64> {
        let joints = self.joints.iter().flat_map(|j| j.breaks());
        let wheels = self.wheels.iter().flat_map(|w| w.breaks());
        let firings = self.firings.iter().flat_map(|f| [f.on, f.off]);
        let mut times: Vec<f64> = joints.chain(wheels).copied().chain(firings).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

/// A vehicle with what drives it, ready to move.
///
/// ```
#[doc = include_str!("../doc/arm.txt")]
/// // The arm swings on a spring with its base: no momentum, and energy is kept.
/// let spring = SpringDamper { stiffness: 2.0, rest: 0.0, damping: 0.0 };
/// let motor = ForceProfile::none();
/// let swing = JointDrive::Force { motor, spring, initial_position: 0.1, initial_rate: 0.0 };
/// let wheels = vec![WheelMotion::constant(0.0)];
/// let plan = DrivenPlan { joints: vec![swing], wheels, firings: vec![] };
/// let driven = Driven::from_parts(tree, bodies.to_vec(), vec![0.01], vec![], &plan)?;
/// let (mut energy, accuracy) = (0.0, Integrator::DormandPrince8(Tolerance::default()));
/// driven.run(&Start::at_rest(), &[0.0, 5.0], accuracy, |sample| {
///     energy = kinetic_energy(&bodies, &sample.motion.kinematics) + spring.energy(sample.motion.q[0]);
/// })?;
/// assert!((energy - spring.energy(0.1)).abs() < 1.0e-11);
/// # Ok::<(), MotionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Driven<'p> {
    pub(crate) tree: Tree,
    /// Inertia of a host without the axial part of its torque-driven wheels.
    pub(crate) reduced: Vec<InertialParameters>,
    pub(crate) parameters: Vec<InertialParameters>,
    pub(crate) spin_inertia: Vec<f64>,
    pub(crate) nozzles: Vec<Nozzle>,
    pub(crate) plan: &'p DrivenPlan,
    /// The joint coordinates that are part of the state.
    pub(crate) free: Vec<usize>,
    pub(crate) mass: f64,
    /// Gravitational parameter and orbit of the gravity gradient.
    pub(crate) orbit: Option<(f64, Orbit)>,
}

/// All ideal measurements, with the forces at the joints.
#[derive(Debug, Clone)]
pub struct DrivenSample {
    /// Pose, velocities, accelerations, joints, wheels, thrust.
    pub motion: MotionSample,
    /// Motor force of each joint coordinate, N m or N, without spring and damper; for a prescribed joint the force it
    /// needs.
    pub motor_force: Vec<f64>,
    /// Force of spring and damper of each joint coordinate, N m or N; zero where the motion is prescribed.
    pub spring_force: Vec<f64>,
}

/// The drives evaluated at one instant, and the scratch for it.
pub(crate) struct DrivenStage<'s> {
    vehicle: &'s Driven<'s>,
    stretches: SmoothIntervals,
    /// A time inside the present smooth stretch.
    within: f64,
    /// Time of the last evaluation of the drives; NaN before the first.
    read_at: f64,
    /// Motor force of driven joints, acceleration of the others.
    inputs: Vec<f64>,
    /// The same plus springs: input of the dynamics.
    joints: Vec<JointInput>,
    /// Motor torque of torque-driven wheels, N m; acceleration of the others, rad/s2.
    wheel_input: Vec<f64>,
    /// Axial momentum not included in the host, N m s.
    wheel_momentum: Vec<f64>,
    dynamics: ForwardDynamics,
    carried: RatesMomentum,
    inverse: InverseDynamics,
    /// On each body about its origin, in base axes.
    outside: Vec<Wrench>,
    /// External wrench on the vehicle about `Bo`, in base axes.
    total: Wrench,
    c: Vector3,
    inertia: Symmetric,
    sample: DrivenSample,
}

impl<'s> DrivenStage<'s> {
    /// In the smooth stretch at `t`.
    pub fn new(vehicle: &'s Driven<'s>, t: f64) -> Self {
        let tree = &vehicle.tree;
        let stretches = SmoothIntervals::new(vehicle.plan.breaks());
        let (dof, wheels) = (tree.dof(), vehicle.spin_inertia.len());
        let motion = MotionSample::new(tree, wheels, vehicle.nozzles.len());
        Self {
            vehicle,
            within: stretches.of(t).0,
            stretches,
            read_at: f64::NAN,
            inputs: vec![0.0; dof],
            joints: vec![JointInput::Force(0.0); dof],
            wheel_input: vec![0.0; wheels],
            wheel_momentum: vec![0.0; wheels],
            dynamics: ForwardDynamics::new(tree),
            carried: RatesMomentum::new(tree),
            inverse: InverseDynamics::new(tree),
            outside: vec![Wrench::ZERO; tree.bodies()],
            total: Wrench::ZERO,
            c: Vector3::zeros(),
            inertia: Symmetric::new([0.0; 6]),
            sample: DrivenSample {
                motion,
                motor_force: vec![0.0; dof],
                spring_force: vec![0.0; dof],
            },
        }
    }

    /// Evaluates all functions of time alone.
    #[inline]
    fn read_drives(&mut self, t: f64) {
        if self.read_at == t {
            return;
        }
        self.read_at = t;
        let (plan, within) = (self.vehicle.plan, self.within);
        let motion = &mut self.sample.motion;
        for (k, joint) in plan.joints.iter().enumerate() {
            match joint {
                JointDrive::Force { motor, .. } => self.inputs[k] = motor.at(t, within),
                JointDrive::Motion(prescribed) => {
                    let jet = prescribed.at(t, within);
                    motion.q[k] = jet.value;
                    motion.rates[k] = jet.rate;
                    self.inputs[k] = jet.acceleration;
                }
            }
        }
        for (i, wheel) in plan.wheels.iter().enumerate() {
            self.wheel_input[i] = match wheel {
                WheelMotion::Speed(profile) => {
                    let jet = profile.at(t, within);
                    self.wheel_momentum[i] = self.vehicle.spin_inertia[i] * jet.value;
                    jet.rate
                }
                WheelMotion::Torque { torque, .. } => torque.at(t, within).value,
            };
        }
        thrust_levels(&plan.firings, within, &mut motion.thrust);
    }

    /// Takes joints and wheels from the state, adds the springs, places the bodies.
    #[inline]
    fn read_state(&mut self, y: &[f64]) {
        let vehicle = self.vehicle;
        let mut at = WHEELS;
        for (wheel, h_w) in vehicle.plan.wheels.iter().zip(&mut self.wheel_momentum) {
            if matches!(wheel, WheelMotion::Torque { .. }) {
                *h_w = y[at];
                at += 1;
            }
        }
        let (q, rates) = y[at..].split_at(vehicle.free.len());
        let motion = &mut self.sample.motion;
        for (k, (q, rate)) in vehicle.free.iter().zip(q.iter().zip(rates)) {
            motion.q[*k] = *q;
            motion.rates[*k] = *rate;
        }
        self.place();
    }

    /// Springs, placement and inertias at the joint positions and rates of the sample.
    #[inline]
    fn place(&mut self) {
        let vehicle = self.vehicle;
        let motion = &mut self.sample.motion;
        for (k, joint) in vehicle.plan.joints.iter().enumerate() {
            self.joints[k] = match joint {
                JointDrive::Force { spring, .. } => {
                    JointInput::Force(self.inputs[k] + spring.force(motion.q[k], motion.rates[k]))
                }
                JointDrive::Motion(_) => JointInput::Acceleration(self.inputs[k]),
            };
        }
        let kinematics = &mut motion.kinematics;
        kinematics.place(&vehicle.tree, &motion.q);
        self.dynamics
            .set_bodies(&vehicle.tree, &vehicle.reduced, kinematics);
    }

    /// The base twist from the momentum in base axes: `h` about the system's mass centre.
    #[inline]
    fn twist(&mut self, t: f64, l: &Vector3, h: &Vector3) -> Result<Twist, Halt> {
        let vehicle = self.vehicle;
        let motion = &mut self.sample.motion;
        let (whole, l_c, h_c) = self
            .carried
            .of(&vehicle.tree, &self.dynamics, &motion.rates);
        let c = whole.centre();
        self.c = c.stored();
        self.inertia = whole.about_centre(&c);
        let mut h = V3::of(h) - (h_c - c.cross(&l_c));
        for (rotor, h_w) in vehicle.tree.rotors.iter().zip(&self.wheel_momentum) {
            h -= V3::of(&(motion.kinematics.R[rotor.body] * rotor.axis_B)) * *h_w;
        }
        let w = self.inertia.solve(&h).ok_or(Halt::Singular { time: t })?;
        let v = ((V3::of(l) - l_c) / vehicle.mass - w.cross(&c)).stored();
        let w = w.stored();
        motion
            .kinematics
            .set_velocities(&vehicle.tree, &v, &w, &motion.rates);
        Ok(Twist { v, w })
    }

    /// External and wheel wrenches on each body at the current kinematics, and the sum of the external ones about `Bo`.
    #[inline]
    fn set_outside(&mut self, t: f64, R_NB: &UnitQuaternion) {
        let vehicle = self.vehicle;
        let motion = &mut self.sample.motion;
        self.outside.fill(Wrench::ZERO);
        let kinematics = &motion.kinematics;
        for (nozzle, level) in vehicle.nozzles.iter().zip(&motion.thrust) {
            if *level != 0.0 {
                let R = &kinematics.R[nozzle.body];
                let force = R * nozzle.direction_B * *level;
                self.outside[nozzle.body].force += force;
                self.outside[nozzle.body].torque += (R * nozzle.p_BoT_B).cross(&force);
            }
        }
        if let Some((gm, orbit)) = &vehicle.orbit {
            motion.p_orbit_N = orbit_state(*gm, orbit, t).0;
            let r_B = R_NB.inverse() * motion.p_orbit_N;
            // The field acts on free rotors too: bodies include their rotors.
            for (i, body) in vehicle.parameters.iter().enumerate() {
                let tide = tidal_wrench(*gm, &r_B, &self.c, body, kinematics, i);
                self.outside[i].force += tide.force;
                self.outside[i].torque += tide.torque;
            }
        }
        self.total = Wrench::ZERO;
        for (wrench, p) in self.outside.iter().zip(&kinematics.p) {
            self.total.force += wrench.force;
            self.total.torque += wrench.torque + p.cross(&wrench.force);
        }
        for (i, rotor) in vehicle.tree.rotors.iter().enumerate() {
            let reaction = self.wheel_reaction(i);
            self.outside[rotor.body].torque += reaction;
        }
    }

    /// Joint accelerations at the placement and velocities found.
    #[inline]
    fn accelerate(&mut self, t: f64, R_NB: &UnitQuaternion) -> Result<(), Halt> {
        self.set_outside(t, R_NB);
        for (i, wrench) in self.outside.iter().enumerate() {
            self.dynamics.add_wrench(i, &wrench.force, &wrench.torque);
        }
        let vehicle = self.vehicle;
        let motion = &mut self.sample.motion;
        self.dynamics
            .solve(
                &vehicle.tree,
                &motion.kinematics,
                &motion.rates,
                &self.joints,
                &mut motion.accelerations,
            )
            .map_err(|_| Halt::Singular { time: t })
    }

    /// Torque of wheel `i` on its host without `Js`, in base axes.
    #[inline]
    fn wheel_reaction(&self, i: usize) -> Vector3 {
        let vehicle = self.vehicle;
        let rotor = &vehicle.tree.rotors[i];
        let kinematics = &self.sample.motion.kinematics;
        let a = kinematics.R[rotor.body] * rotor.axis_B;
        let axial = match vehicle.plan.wheels[i] {
            WheelMotion::Speed(_) => vehicle.spin_inertia[i] * self.wheel_input[i],
            WheelMotion::Torque { .. } => self.wheel_input[i],
        };
        let w = &kinematics.w[rotor.body];
        -(a * axial + w.cross(&a) * self.wheel_momentum[i])
    }

    /// The state vector at the first instant.
    pub fn start(&mut self, start: &Start, t: f64) -> Result<Vec<f64>, Halt> {
        let vehicle = self.vehicle;
        self.read_drives(t);
        for (k, joint) in vehicle.plan.joints.iter().enumerate() {
            if let JointDrive::Force {
                initial_position,
                initial_rate,
                ..
            } = joint
            {
                self.sample.motion.q[k] = *initial_position;
                self.sample.motion.rates[k] = *initial_rate;
            }
        }
        self.place();
        // The absolute momentum of a torque-driven wheel follows from its relative speed once the host's
        // turning is known: first with the whole inertia, wheels turning with their hosts.
        let momenta = self.start_wheels(t, start)?;
        self.place();
        let rest = self.twist(t, &Vector3::zeros(), &Vector3::zeros())?;
        let (l, h) = match &start.velocity {
            StartVelocity::Momentum { l_S_N, h_SScm_N } => (*l_S_N, *h_SScm_N),
            StartVelocity::Twist { v_NBo_N, w_NB_B } => {
                // Momentum is affine in the twist and vanishes at `rest`.
                let v = start.R_NB.inverse() * v_NBo_N;
                let (dv, dw) = (v - rest.v, w_NB_B - rest.w);
                let l = (dv + dw.cross(&self.c)) * vehicle.mass;
                (
                    start.R_NB * l,
                    start.R_NB * self.inertia.times(&V3::of(&dw)).stored(),
                )
            }
        };
        let p = start.p_NoBo_N + start.R_NB * self.c;
        let q = start.R_NB.coords;
        let mut y = vec![q.x, q.y, q.z, q.w, p.x, p.y, p.z];
        y.extend(l.iter().chain(h.iter()));
        y.extend(momenta);
        let motion = &self.sample.motion;
        y.extend(vehicle.free.iter().map(|k| motion.q[*k]));
        y.extend(vehicle.free.iter().map(|k| motion.rates[*k]));
        Ok(y)
    }

    /// Absolute axial momentum of the torque-driven wheels at the start.
    fn start_wheels(&mut self, t: f64, start: &Start) -> Result<Vec<f64>, Halt> {
        let vehicle = self.vehicle;
        let torque_driven = |i: &usize| match &vehicle.plan.wheels[*i] {
            WheelMotion::Torque { initial_speed, .. } => Some((*i, *initial_speed)),
            WheelMotion::Speed(_) => None,
        };
        let wheels: Vec<(usize, f64)> = (0..vehicle.spin_inertia.len())
            .filter_map(|i| torque_driven(&i))
            .collect();
        if wheels.is_empty() {
            return Ok(Vec::new());
        }
        let kinematics = &self.sample.motion.kinematics;
        self.dynamics
            .set_bodies(&vehicle.tree, &vehicle.parameters, kinematics);
        for (i, speed) in &wheels {
            self.wheel_momentum[*i] = vehicle.spin_inertia[*i] * speed;
        }
        let to_base = start.R_NB.inverse();
        let w = match &start.velocity {
            StartVelocity::Momentum { l_S_N, h_SScm_N } => {
                self.twist(t, &(to_base * l_S_N), &(to_base * h_SScm_N))?.w
            }
            StartVelocity::Twist { w_NB_B, .. } => *w_NB_B,
        };
        let motion = &mut self.sample.motion;
        let zero = Vector3::zeros();
        motion
            .kinematics
            .set_velocities(&vehicle.tree, &zero, &w, &motion.rates);
        let mut momenta = Vec::with_capacity(wheels.len());
        for (i, speed) in wheels {
            let rotor = &vehicle.tree.rotors[i];
            let a = motion.kinematics.R[rotor.body] * rotor.axis_B;
            let axial = a.dot(&motion.kinematics.w[rotor.body]);
            self.wheel_momentum[i] = vehicle.spin_inertia[i] * (speed + axial);
            momenta.push(self.wheel_momentum[i]);
        }
        Ok(momenta)
    }

    /// Natural magnitudes of the state: 1 rad, 1 m, and the momenta of the vehicle moving at 1 cm/s and
    /// turning at 0.01 rad/s; joint rates 0.01 rad/s.
    pub fn scale(&self) -> Vec<f64> {
        let mut scale = vec![1.0; LINEAR];
        scale.resize(ANGULAR, 0.01 * self.vehicle.mass);
        let trace = self.inertia.trace();
        scale.resize(WHEELS, 0.01 * trace / 3.0);
        let vehicle = self.vehicle;
        for (wheel, js) in vehicle.plan.wheels.iter().zip(&vehicle.spin_inertia) {
            if matches!(wheel, WheelMotion::Torque { .. }) {
                scale.push(*js);
            }
        }
        scale.resize(scale.len() + vehicle.free.len(), 1.0);
        scale.resize(scale.len() + vehicle.free.len(), 0.01);
        scale
    }

    /// Wheel speeds and motor torques, from momenta and accelerations.
    fn set_wheels(&mut self) {
        let vehicle = self.vehicle;
        let motion = &mut self.sample.motion;
        for (i, rotor) in vehicle.tree.rotors.iter().enumerate() {
            let axis = motion.kinematics.R[rotor.body] * rotor.axis_B;
            let js = vehicle.spin_inertia[i];
            (motion.wheel_speed[i], motion.wheel_torque[i]) = match &vehicle.plan.wheels[i] {
                WheelMotion::Torque { .. } => {
                    let host = axis.dot(&motion.kinematics.w[rotor.body]);
                    (self.wheel_momentum[i] / js - host, self.wheel_input[i])
                }
                WheelMotion::Speed(profile) => {
                    let host = axis.dot(&motion.body.alpha[rotor.body]);
                    let speed = profile.at(motion.time, self.within).value;
                    (speed, js * (self.wheel_input[i] + host))
                }
            };
        }
    }

    /// Motors and springs; prescribed joints by inverse dynamics.
    fn set_joint_forces(&mut self) {
        let vehicle = self.vehicle;
        let prescribed = vehicle.free.len() < vehicle.tree.dof();
        if prescribed {
            let motion = &self.sample.motion;
            self.inverse.solve(
                &vehicle.tree,
                &vehicle.reduced,
                &motion.kinematics,
                &motion.body,
                &self.outside,
                &mut self.sample.motor_force,
            );
        }
        let motion = &self.sample.motion;
        for (k, joint) in vehicle.plan.joints.iter().enumerate() {
            if let JointDrive::Force { spring, .. } = joint {
                self.sample.motor_force[k] = self.inputs[k];
                self.sample.spring_force[k] = spring.force(motion.q[k], motion.rates[k]);
            }
        }
    }
}

impl SmoothByParts for DrivenStage<'_> {
    type Sample = DrivenSample;

    fn enter(&mut self, t: f64, _: &[f64]) -> Result<f64, Halt> {
        let (within, end) = self.stretches.of(t);
        self.within = within;
        self.read_at = f64::NAN;
        Ok(end)
    }

    fn sample(&mut self, t: f64, y: &[f64]) -> Result<&DrivenSample, Halt> {
        let (R_NB, l, h) = (attitude(y), vector(y, LINEAR), vector(y, ANGULAR));
        let to_base = R_NB.inverse();
        self.read_drives(t);
        self.read_state(y);
        let twist = self.twist(t, &(to_base * l), &(to_base * h))?;
        self.accelerate(t, &R_NB)?;
        let motion = &mut self.sample.motion;
        motion.time = t;
        motion.set_state((&R_NB, y), &self.c, &twist);
        for i in 0..motion.body.a.len() {
            (motion.body.a[i], motion.body.alpha[i]) = self.dynamics.acceleration(i);
        }
        self.set_wheels();
        self.set_joint_forces();
        Ok(&self.sample)
    }
}

impl Flow for DrivenStage<'_> {
    #[inline]
    fn derivative(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
        let (R_NB, l, h) = (attitude(y), vector(y, LINEAR), vector(y, ANGULAR));
        let R = R_NB.to_rotation_matrix().into_inner();
        self.read_drives(t);
        self.read_state(y);
        let twist = self.twist(t, &R.tr_mul(&l), &R.tr_mul(&h))?;
        self.accelerate(t, &R_NB)?;
        // q' = q (0, w) / 2
        let q = R_NB.quaternion() * Quaternion::from_imag(twist.w * 0.5);
        dy[..POSITION].copy_from_slice(q.coords.as_slice());
        let vehicle = self.vehicle;
        let motion = &self.sample.motion;
        let Wrench { force, torque } = self.total;
        let blocks = [
            l / vehicle.mass,
            R * force,
            R * (torque - self.c.cross(&force)),
        ];
        for (out, block) in dy[POSITION..WHEELS].chunks_exact_mut(3).zip(&blocks) {
            out.copy_from_slice(block.as_slice());
        }
        let mut at = WHEELS;
        for (wheel, torque) in vehicle.plan.wheels.iter().zip(&self.wheel_input) {
            if matches!(wheel, WheelMotion::Torque { .. }) {
                dy[at] = *torque;
                at += 1;
            }
        }
        let (rates, accelerations) = dy[at..].split_at_mut(vehicle.free.len());
        for (k, (rate, acceleration)) in
            vehicle.free.iter().zip(rates.iter_mut().zip(accelerations))
        {
            *rate = motion.rates[*k];
            *acceleration = motion.accelerations[*k];
        }
        Ok(())
    }

    fn project(&self, y: &mut [f64]) {
        let norm = y[..POSITION].iter().map(|q| q * q).sum::<f64>().sqrt();
        y[..POSITION].iter_mut().for_each(|q| *q /= norm);
    }
}
