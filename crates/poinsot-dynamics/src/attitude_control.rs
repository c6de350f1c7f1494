//! Closed loop: quaternion feedback with reaction wheels. Joints are locked.
//!
//! State (pose and momentum, as in `prescribed`); without thrust and gravity gradient the momentum is constant and is left out:
//!
//! ```text
//! y = [ q_NB (xyzw), z of each wheel, p_NoScm, l_S, h_SScm ]      p_NoScm' = l_S / m
//! (I - sum Js a a^T) w = R^T h - sum a z         z = Js (Omega + a . w),  z' = motor + friction
//! I w = R^T h - sum a z                          z = Js Omega,            z' = command     (acceleration drive)
//! R' = R [w]x
//! ```
//!
//! The commanded torque of the wheels on the body is `u = -K_P q_e - K_D w` (Kim, Choi, Oh 2010, eq. 17; Wie 1998, sec.
//! 7.3), `q_e` the vector part of the error quaternion for the shorter rotation. The wheels share it with the smallest
//! sum of squares, `-C^T (C C^T)^-1 u`.

use crate::acceleration::Accelerations;
use crate::gravity_gradient::gravity_gradient_torque;
use crate::integrate::{Flow, Halt, Tolerance};
use crate::kinematics::Kinematics;
use crate::momentum::composite;
use crate::orbit::{Orbit, orbit_state};
use crate::plan::{SmoothIntervals, Start, StartVelocity};
use crate::prescribed::{MotionError, gravity_gradient};
use crate::reaction_wheel::WheelLimits;
use crate::run::{Integrator, SmoothByParts, run};
use crate::stage::MotionSample;
use crate::thrust::{Firing, Nozzle, thrust_levels, thrust_wrench};
use crate::tree::Tree;
use crate::vehicle::Vehicle;
use nalgebra::Quaternion;
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};

const WHEELS: usize = 4;
/// Share of a control period within which an output time and a control instant are the same.
const SAME: f64 = 1e-9;

/// Target attitude from a time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Time, s.
    pub time: f64,
    /// Attitude.
    pub R_NB: UnitQuaternion,
}

/// What the controller commands of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WheelDrive {
    /// The torque of its motor.
    #[default]
    Torque,
    /// Its acceleration relative to the body, so that the torque on the body is exactly `u`: eq. (1a) of Kim, Choi, Oh,
    /// whose u is `-C I_rw omega_rw'`. It differs from the motor torque by `Js a . w'`.
    Acceleration,
}

/// Quaternion feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct AttitudeControl {
    /// `K_P` on the vector part of the error quaternion, N m.
    pub proportional: Matrix3,
    /// `K_D`, N m s.
    pub derivative: Matrix3,
    /// Targets in order of time; the identity before the first.
    pub targets: Vec<Target>,
    /// Time over which a command is held, s; `None` is a continuous controller.
    pub period: Option<f64>,
    /// What is commanded.
    pub drive: WheelDrive,
}

/// Why a controller cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ControlError {
    /// The motion cannot be computed.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Too few wheel axes.
    #[error(
        "{wheels} wheels whose axes span {rank} of 3 directions cannot turn the vehicle about every axis; give it three wheels whose axes are independent"
    )]
    Allocation {
        /// Wheels.
        wheels: usize,
        /// Directions.
        rank: usize,
    },
    /// A list of the wrong length.
    #[error("{found} {what} are given for {wheels} wheels; give one for each")]
    Count {
        /// What is counted.
        what: &'static str,
        /// Number given.
        found: usize,
        /// Wheels of the model.
        wheels: usize,
    },
    /// An invalid number.
    #[error("{0}")]
    Number(&'static str),
}

impl From<Halt> for ControlError {
    fn from(halt: Halt) -> Self {
        Self::Motion(halt.into())
    }
}

/// Use of a wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelUse {
    /// Largest speed relative to the host at an output time, rad/s.
    pub speed: f64,
    /// Largest motor torque at an output time, N m.
    pub torque: f64,
    /// Whether a limit cut a command there.
    pub limited: bool,
}

/// A vehicle under attitude control.
#[derive(Debug, Clone)]
pub struct ControlledVehicle<'c> {
    tree: Tree,
    control: &'c AttitudeControl,
    limits: Vec<WheelLimits>,
    spin_inertia: Vec<f64>,
    /// Wheel axes in base axes.
    axes: Vec<Vector3>,
    /// Torque of each wheel for a torque on the body: rows of `-C^T (C C^T)^-1`.
    allocation: Vec<Vector3>,
    mass: f64,
    c: Vector3,
    /// About the mass centre, wheels locked.
    inertia: Matrix3,
    locked: Vec<f64>,
    kinematics: Kinematics,
    nozzles: Vec<Nozzle>,
    firings: Vec<Firing>,
    /// Gravitational parameter and orbit of the gravity gradient.
    orbit: Option<(f64, Orbit)>,
    tolerance: Tolerance,
}

impl<'c> ControlledVehicle<'c> {
    /// Puts a vehicle under control; `limits` is empty or has one
    /// entry per wheel.
    ///
    /// # Errors
    /// The wheels cannot control all axes, or a number is not valid.
    pub fn new(
        vehicle: impl Into<Vehicle>,
        control: &'c AttitudeControl,
        limits: &[WheelLimits],
        tolerance: Tolerance,
    ) -> Result<Self, ControlError> {
        let vehicle: Vehicle = vehicle.into();
        let orbit = gravity_gradient(&vehicle.gravity)?;
        let wheels = vehicle.spin_inertia.len();
        check(control, limits, wheels)?;
        let (tree, spin_inertia, locked) = (vehicle.tree, vehicle.spin_inertia, vehicle.locked_at);
        let mut kinematics = Kinematics::new(&tree);
        kinematics.place(&tree, &locked);
        let mass: f64 = vehicle.bodies.iter().map(|p| p.mass).sum();
        if mass.is_nan() || mass <= 0.0 {
            return Err(MotionError::NoMass.into());
        }
        let whole = composite(&vehicle.bodies, &kinematics);
        if let Some(i) = spin_inertia.iter().position(|js| js.is_nan() || *js <= 0.0) {
            return Err(MotionError::InertialessWheel(i).into());
        }
        let axes: Vec<Vector3> = tree
            .rotors
            .iter()
            .map(|r| kinematics.R[r.body] * r.axis_B)
            .collect();
        Ok(Self {
            allocation: allocation(&axes)?,
            control,
            limits: match limits {
                [] => vec![WheelLimits::default(); wheels],
                given => given.to_vec(),
            },
            spin_inertia,
            axes,
            mass,
            c: whole.p_BoScm_B(),
            inertia: whole.I_SScm_B(),
            locked,
            kinematics,
            nozzles: vehicle.nozzles,
            firings: Vec::new(),
            orbit,
            tree,
            tolerance,
        })
    }

    /// The same with thrusters that fire.
    #[must_use]
    pub fn firing(mut self, firings: &[Firing]) -> Self {
        self.firings = firings.to_vec();
        self
    }

    /// Whether anything changes the momentum.
    fn is_forced(&self) -> bool {
        !self.firings.is_empty() || self.orbit.is_some()
    }

    /// The kinematic constants.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Moves the vehicle from `start`, with the wheels at `wheel_speed` (rad/s), through every time, s.
    ///
    /// # Errors
    /// The motion cannot be computed; samples before that point have been handed over.
    pub fn run(
        &self,
        start: &Start,
        wheel_speed: &[f64],
        times: &[f64],
        sink: impl FnMut(&MotionSample),
    ) -> Result<Vec<WheelUse>, ControlError> {
        let wheels = self.axes.len();
        count("initial wheel speeds", wheel_speed.len(), wheels)?;
        MotionError::check_times(times)?;
        let mut flight = Flight::new(self, start, wheel_speed, times)?;
        let state = (flight.start(start, wheel_speed), flight.scale());
        let integrator = Integrator::DormandPrince8(self.tolerance);
        run(&mut flight, state, times, integrator, sink)?;
        Ok(flight.used)
    }

    /// The target from `t` on.
    fn target(&self, t: f64) -> UnitQuaternion {
        let targets = &self.control.targets;
        let since = targets.partition_point(|target| target.time <= t + SAME);
        let index = since.checked_sub(1);
        index
            .and_then(|i| targets.get(i))
            .map_or(UnitQuaternion::identity(), |target| target.R_NB)
    }

    fn next_target(&self, t: f64) -> f64 {
        let mut targets = self.control.targets.iter().map(|target| target.time);
        targets
            .find(|time| *time > t + SAME)
            .unwrap_or(f64::INFINITY)
    }

    /// Inertia on the left of the momentum equation.
    fn moving_inertia(&self) -> Matrix3 {
        let rotors = self.axes.iter().zip(&self.spin_inertia);
        match self.control.drive {
            WheelDrive::Acceleration => self.inertia,
            WheelDrive::Torque => {
                rotors.fold(self.inertia, |I, (a, js)| I - a * a.transpose() * *js)
            }
        }
    }
}

fn count(what: &'static str, found: usize, wheels: usize) -> Result<(), ControlError> {
    if found == wheels {
        return Ok(());
    }
    Err(ControlError::Count {
        what,
        found,
        wheels,
    })
}

fn check(
    control: &AttitudeControl,
    limits: &[WheelLimits],
    wheels: usize,
) -> Result<(), ControlError> {
    let gains = control.proportional.iter().chain(&control.derivative);
    if !gains.into_iter().all(|x| x.is_finite()) {
        return Err(ControlError::Number(
            "a gain of the controller is not finite; write finite numbers",
        ));
    }
    if control.period.is_some_and(|p| !p.is_finite() || p <= 0.0) {
        return Err(ControlError::Number(
            "the control period is not positive; give a positive number, or leave it out",
        ));
    }
    let times = control.targets.windows(2);
    if !times.into_iter().all(|w| w[0].time < w[1].time)
        || !control.targets.iter().all(|x| x.time.is_finite())
    {
        return Err(ControlError::Number(
            "the times of the targets do not increase; sort them",
        ));
    }
    if !limits.is_empty() {
        count("sets of wheel limits", limits.len(), wheels)?;
    }
    if !limits.iter().all(WheelLimits::is_valid) {
        return Err(ControlError::Number(
            "a limit of a wheel is not positive, or its friction is negative; correct its numbers",
        ));
    }
    Ok(())
}

/// Rows of `-C^T (C C^T)^-1`.
fn allocation(axes: &[Vector3]) -> Result<Vec<Vector3>, ControlError> {
    let gram: Matrix3 = axes.iter().map(|a| a * a.transpose()).sum();
    let eigenvalues = gram.symmetric_eigenvalues();
    let rank = eigenvalues.iter().filter(|x| **x > 1e-9).count();
    match gram.cholesky().filter(|_| rank == 3) {
        Some(factor) => Ok(axes.iter().map(|a| -factor.solve(a)).collect()),
        None => Err(ControlError::Allocation {
            wheels: axes.len(),
            rank,
        }),
    }
}

/// One run: its constants, the current command, and workspace.
struct Flight<'v> {
    vehicle: &'v ControlledVehicle<'v>,
    moving_inertia: Matrix3,
    h_SScm_N: Vector3,
    /// Output times, s.
    times: &'v [f64],
    /// Control instants until now.
    instants: u64,
    stretches: SmoothIntervals,
    /// A time inside the present smooth stretch.
    within: f64,
    target: UnitQuaternion,
    held: Vec<f64>,
    command: Vec<f64>,
    used: Vec<WheelUse>,
    p_start_N: Vector3,
    sample: MotionSample,
}

impl<'v> Flight<'v> {
    fn new(
        vehicle: &'v ControlledVehicle<'v>,
        start: &Start,
        wheel_speed: &[f64],
        times: &'v [f64],
    ) -> Result<Self, ControlError> {
        let mut breaks: Vec<f64> = vehicle.firings.iter().flat_map(|f| [f.on, f.off]).collect();
        breaks.sort_by(f64::total_cmp);
        let R = start.R_NB;
        let rotors = vehicle.axes.iter().zip(&vehicle.spin_inertia);
        let h_wheels: Vector3 = rotors
            .zip(wheel_speed)
            .map(|((a, js), s)| a * (js * s))
            .sum();
        let (l_S_N, h_SScm_N) = match start.velocity {
            StartVelocity::Momentum { l_S_N, h_SScm_N } => (l_S_N, h_SScm_N),
            StartVelocity::Twist { v_NBo_N, w_NB_B } => (
                (v_NBo_N + R * w_NB_B.cross(&vehicle.c)) * vehicle.mass,
                R * (vehicle.inertia * w_NB_B + h_wheels),
            ),
        };
        let (dof, wheels) = (vehicle.tree.dof(), vehicle.axes.len());
        let moving_inertia = vehicle.moving_inertia();
        if moving_inertia.cholesky().is_none() {
            return Err(Halt::Singular { time: 0.0 }.into());
        }
        Ok(Self {
            vehicle,
            moving_inertia,
            h_SScm_N,
            times,
            instants: 0,
            stretches: SmoothIntervals::new(breaks),
            within: 0.0,
            target: UnitQuaternion::identity(),
            held: vec![0.0; wheels],
            command: vec![0.0; wheels],
            used: vec![WheelUse::default(); wheels],
            p_start_N: start.p_NoBo_N + R * vehicle.c,
            sample: MotionSample {
                time: 0.0,
                R_NB: R,
                p_NoBo_N: start.p_NoBo_N,
                v_NBo_N: Vector3::zeros(),
                w_NB_B: Vector3::zeros(),
                p_NoScm_N: Vector3::zeros(),
                l_S_N,
                h_SScm_N,
                q: vehicle.locked.clone(),
                rates: vec![0.0; dof],
                accelerations: vec![0.0; dof],
                wheel_speed: wheel_speed.to_vec(),
                wheel_torque: vec![0.0; wheels],
                thrust: vec![0.0; vehicle.nozzles.len()],
                p_orbit_N: Vector3::zeros(),
                kinematics: vehicle.kinematics.clone(),
                body: Accelerations::new(&vehicle.tree),
            },
        })
    }

    fn start(&self, start: &Start, wheel_speed: &[f64]) -> Vec<f64> {
        let v = self.vehicle;
        let rotors = v.axes.iter().zip(&v.spin_inertia).zip(wheel_speed);
        let h_wheels: Vector3 = rotors.clone().map(|((a, js), s)| a * (js * s)).sum();
        let h = start.R_NB.inverse() * self.h_SScm_N - h_wheels;
        let w = v
            .inertia
            .cholesky()
            .map_or(Vector3::zeros(), |f| f.solve(&h));
        let q = start.R_NB.coords;
        let mut y = vec![q.x, q.y, q.z, q.w];
        y.extend(rotors.map(|((a, js), speed)| match v.control.drive {
            WheelDrive::Torque => js * (speed + a.dot(&w)),
            WheelDrive::Acceleration => js * speed,
        }));
        if v.is_forced() {
            let momenta = [self.p_start_N, self.sample.l_S_N, self.h_SScm_N];
            y.extend(momenta.iter().flat_map(|x| x.iter()));
        }
        y
    }

    /// Takes position and momenta from the state where they change.
    fn set_momenta(&mut self, y: &[f64]) {
        let (_, forced) = y.split_at(WHEELS + self.vehicle.axes.len());
        if let [p, l, h] = forced.as_chunks::<3>().0 {
            let vector = |x: &[f64; 3]| Vector3::from(*x);
            self.sample.p_NoScm_N = vector(p);
            (self.sample.l_S_N, self.h_SScm_N) = (vector(l), vector(h));
        }
    }

    /// Force of thrust, and torque of thrust and gravity gradient about the system's mass centre, in base axes.
    fn loads(&mut self, t: f64, R: &UnitQuaternion) -> (Vector3, Vector3) {
        let v = self.vehicle;
        thrust_levels(&v.firings, self.within, &mut self.sample.thrust);
        let (force, torque) = thrust_wrench(&v.nozzles, &v.kinematics, &self.sample.thrust);
        let mut torque = torque - v.c.cross(&force);
        if let Some((gm, orbit)) = &v.orbit {
            self.sample.p_orbit_N = orbit_state(*gm, orbit, t).0;
            let r_B = R.inverse() * self.sample.p_orbit_N;
            torque += gravity_gradient_torque(*gm, &r_B, &v.inertia);
        }
        (force, torque)
    }

    fn scale(&self) -> Vec<f64> {
        let mut scale = vec![1.0; WHEELS];
        let v = self.vehicle;
        scale.extend(&v.spin_inertia);
        if v.is_forced() {
            // As in `stage.rs`: 1 m, 1 cm/s, 0.01 rad/s.
            scale.extend([1.0; 3]);
            scale.extend([0.01 * v.mass; 3]);
            scale.extend([0.01 * v.inertia.trace() / 3.0; 3]);
        }
        scale
    }

    /// Attitude and rates of a state; wheel speeds go into the sample.
    fn rates(&mut self, t: f64, y: &[f64]) -> Result<(UnitQuaternion, Vector3), Halt> {
        self.set_momenta(y);
        let v = self.vehicle;
        let R = UnitQuaternion::new_normalize(Quaternion::new(y[3], y[0], y[1], y[2]));
        let h = v.axes.iter().zip(&y[WHEELS..]);
        let h = h.fold(R.inverse() * self.h_SScm_N, |h, (a, z)| h - a * *z);
        let factor = self.moving_inertia.cholesky();
        let w = factor.ok_or(Halt::Singular { time: t })?.solve(&h);
        for (i, (a, js)) in v.axes.iter().zip(&v.spin_inertia).enumerate() {
            let along = match v.control.drive {
                WheelDrive::Torque => a.dot(&w),
                WheelDrive::Acceleration => 0.0,
            };
            self.sample.wheel_speed[i] = y[WHEELS + i] / js - along;
        }
        Ok((R, w))
    }

    /// The command for a state, within the limits of the wheels.
    fn decide(&mut self, R: &UnitQuaternion, w: &Vector3, period: Option<f64>) {
        let v = self.vehicle;
        let e = self.target.inverse() * R;
        // The shorter rotation.
        let q_e = if e.w < 0.0 { -e.imag() } else { e.imag() };
        let u = -(v.control.proportional * q_e) - v.control.derivative * w;
        for (i, row) in v.allocation.iter().enumerate() {
            let (wanted, speed) = (row.dot(&u), self.sample.wheel_speed[i]);
            let given = v.limits[i].admit(wanted, speed, v.spin_inertia[i], period);
            self.command[i] = given;
            self.used[i].limited |= given != wanted && period.is_some();
        }
    }

    /// Sets the command for the next period.
    fn hold(&mut self, t: f64, y: &[f64]) -> Result<(), Halt> {
        self.target = self.vehicle.target(t);
        let (R, w) = self.rates(t, y)?;
        self.decide(&R, &w, self.vehicle.control.period);
        self.held.copy_from_slice(&self.command);
        Ok(())
    }

    /// Rate of the wheel momenta for a state.
    fn wheel_rates(&mut self, R: &UnitQuaternion, w: &Vector3) {
        let v = self.vehicle;
        if v.control.period.is_some() {
            self.command.copy_from_slice(&self.held);
        } else {
            self.decide(R, w, None);
        }
        if v.control.drive == WheelDrive::Torque {
            let wheels = self.command.iter_mut().zip(&v.limits);
            for ((torque, limits), speed) in wheels.zip(&self.sample.wheel_speed) {
                *torque += limits.friction(*speed);
            }
        }
    }

    /// The next control instant, s.
    fn due(&self, period: f64) -> f64 {
        self.event(self.first() + self.instants as f64 * period, SAME * period)
    }

    fn first(&self) -> f64 {
        self.times.first().copied().unwrap_or(0.0)
    }

    /// The time of a change of the command, or the output time that is the same but for `tolerance`, s.
    fn event(&self, time: f64, tolerance: f64) -> f64 {
        let after = self.times.partition_point(|t| *t < time - tolerance);
        let output = self.times.get(after).filter(|t| **t <= time + tolerance);
        output.copied().unwrap_or(time)
    }
}

impl SmoothByParts for Flight<'_> {
    type Sample = MotionSample;

    fn enter(&mut self, t: f64, y: &[f64]) -> Result<f64, Halt> {
        let (within, end) = self.stretches.of(t);
        self.within = within;
        let next = match self.vehicle.control.period {
            Some(period) => {
                if self.due(period) - t <= SAME * period {
                    self.hold(t, y)?;
                    self.instants += 1;
                }
                self.due(period)
            }
            None => self.event(self.vehicle.next_target(t), SAME),
        };
        self.target = self.vehicle.target(t);
        Ok(end.min(next))
    }

    /// All ideal measurements.
    fn sample(&mut self, t: f64, y: &[f64]) -> Result<&MotionSample, Halt> {
        let (v, first) = (self.vehicle, self.first());
        let (R, w) = self.rates(t, y)?;
        self.wheel_rates(&R, &w);
        let (force, torque) = self.loads(t, &R);
        let h_B = R.inverse() * self.h_SScm_N;
        let factor = self.moving_inertia.cholesky();
        let rotors = v.axes.iter().zip(&self.command);
        let moment = rotors.fold(torque - w.cross(&h_B), |m, (a, rate)| m - a * *rate);
        let alpha = factor.ok_or(Halt::Singular { time: t })?.solve(&moment);
        let sample = &mut self.sample;
        sample.time = t;
        sample.R_NB = R;
        sample.w_NB_B = w;
        sample.h_SScm_N = self.h_SScm_N;
        if !v.is_forced() {
            sample.p_NoScm_N = self.p_start_N + sample.l_S_N * ((t - first) / v.mass);
        }
        sample.p_NoBo_N = sample.p_NoScm_N - R * v.c;
        let v_B = R.inverse() * sample.l_S_N / v.mass - w.cross(&v.c);
        sample.v_NBo_N = R * v_B;
        let kinematics = &mut sample.kinematics;
        kinematics.set_velocities(&v.tree, &v_B, &w, &sample.rates);
        let still = &sample.accelerations;
        sample
            .body
            .set_without_base(&v.tree, kinematics, &sample.rates, still);
        let a = force / v.mass - (alpha.cross(&v.c) + w.cross(&w.cross(&v.c)));
        sample.body.add_base(kinematics, &a, &alpha);
        for (i, axis) in v.axes.iter().enumerate() {
            let friction = v.limits[i].friction(sample.wheel_speed[i]);
            sample.wheel_torque[i] = match v.control.drive {
                WheelDrive::Torque => self.command[i] - friction,
                WheelDrive::Acceleration => {
                    self.command[i] + v.spin_inertia[i] * axis.dot(&alpha) - friction
                }
            };
            let used = &mut self.used[i];
            used.speed = used.speed.max(sample.wheel_speed[i].abs());
            used.torque = used.torque.max(sample.wheel_torque[i].abs());
            used.limited |= used.speed >= 0.99 * v.limits[i].speed
                || used.torque >= v.limits[i].torque * (1.0 - SAME);
        }
        Ok(&self.sample)
    }
}

impl Flow for Flight<'_> {
    fn derivative(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), Halt> {
        let (R, w) = self.rates(t, y)?;
        // q' = q (0, w) / 2
        let q = R.quaternion() * Quaternion::from_imag(w * 0.5);
        dy[..WHEELS].copy_from_slice(q.coords.as_slice());
        self.wheel_rates(&R, &w);
        let (wheels, forced) = dy[WHEELS..].split_at_mut(self.command.len());
        wheels.copy_from_slice(&self.command);
        if let [p, l, h] = forced.as_chunks_mut::<3>().0 {
            let (force, torque) = self.loads(t, &R);
            *p = (self.sample.l_S_N / self.vehicle.mass).into();
            (*l, *h) = ((R * force).into(), (R * torque).into());
        }
        Ok(())
    }

    fn project(&self, y: &mut [f64]) {
        let norm = y[..WHEELS].iter().map(|q| q * q).sum::<f64>().sqrt();
        y[..WHEELS].iter_mut().for_each(|q| *q /= norm);
    }
}
