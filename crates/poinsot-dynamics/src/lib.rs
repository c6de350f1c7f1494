//! Kinematics, momentum, regressors and motion of a free-floating tree of rigid bodies.
//!
//! Kernels are plain functions on fixed-size matrices. A [`Tree`] is constant; a [`Kinematics`] is
//! scratch that one call fills and the next reads. Unless a name says otherwise every vector is in the
//! axes of the base B and every moment is about the base's frame origin `Bo`.
//!
//! Without the default feature `std` the kernels remain: tree, kinematics, momentum, regressors, accelerations, forward
//! and inverse dynamics, the step of pose and momentum with its linearisation, orbit, measurement models. They need `alloc` and, for the functions of `libm`, the feature `libm`.
//!
//! | subject | item |
//! |---|---|
//! | the vehicle | [`Tree`] (kinematic constants), [`Vehicle`], [`Link`], [`Rotor`], [`Nozzle`], [`Gravity`] |
//! | placement and velocities | [`Kinematics`], [`Accelerations`] |
//! | momentum and energy | [`momentum()`], [`composite`], [`twist_from_momentum`], [`wheel_momentum`], [`kinetic_energy`] |
//! | momentum as a linear function of the parameters | [`momentum_regressor`], [`wheel_regressor`], [`momentum_rate_column`] |
//! | forces and accelerations | [`ForwardDynamics`], [`InverseDynamics`], [`MassMatrix`], [`joint_jacobian`] |
//! | environment | [`orbit_state`], [`gravity_gradient_torque`], [`tidal_wrench`] |
//! | motion | [`Flight`] under a [`Plan`]: [`JointDrive`], [`WheelMotion`], [`AttitudeControl`], [`Firing`] |
//! | many states at once | `batch`, with the feature `batches` |
//!
//! # Example
//! A base with an arm, in free fall without momentum. The arm turns at 1 rad/s; the base turns back:
//!
//! ```
//! use poinsot_dynamics::{Kinematics, Link, Motion, Tree, composite, momentum, twist_from_momentum};
//! use poinsot_spatial::{MassProperties, Matrix3, Vector3};
//!
//! // The arm turns about z at x = 1 m. Its mass centre is 1 m further.
//! let hinge = Link::new(0, Motion::Revolute(0), Vector3::x(), Matrix3::identity(), Vector3::z());
//! let tree = Tree { links: vec![Link::base(), hinge], rotors: vec![], coordinates: vec![0] };
//! let base = MassProperties { mass: 2.0, p_BoBcm_B: Vector3::zeros(), I_BBcm_B: Matrix3::identity() };
//! let arm = MassProperties { mass: 1.0, p_BoBcm_B: Vector3::x(), I_BBcm_B: Matrix3::identity() * 0.5 };
//! let bodies = [base.parameters(), arm.parameters()];
//!
//! let mut kinematics = Kinematics::new(&tree);
//! kinematics.set_velocities(&tree, &Vector3::zeros(), &Vector3::zeros(), &[1.0]);
//! let of_arm = momentum(&bodies, &kinematics);
//! let (l, h) = (of_arm.fixed_rows::<3>(0).into(), of_arm.fixed_rows::<3>(3).into());
//! let (whole, none) = (composite(&bodies, &kinematics), Vector3::zeros());
//! let twist = twist_from_momentum(&whole, &none, &none, &l, &h).unwrap();
//!
//! // About the mass centre: the arm brings 0.5 + 2/3 * 2, the whole has 1.5 + 2/3 * 4 (reduced mass 2/3 kg).
//! assert!((twist.w.z + (0.5 + 4.0 / 3.0) / (1.5 + 8.0 / 3.0)).abs() < 1.0e-12);
//! ```
//!
//! # Files
//! - `vehicle.rs`: data of a vehicle for its motion. `tree.rs`: kinematic constants. `sensor.rs`: kinds of
//!   sensors, the facts of each in one constant.
//! - `kinematics.rs`: pose and velocity of every body.
//! - `momentum.rs`: momentum, its inverse, the shift between base and N. `joint_slopes.rs`: derivatives with respect to
//!   joints.
//! - `regressor.rs`: momentum as a linear function of the parameters. `rate_regressor.rs`: its time derivative.
//! - `acceleration.rs`: accelerations.
//! - `algebra.rs`: vectors and matrices of three over one number or several side by side. `symmetric.rs`,
//!   `inertial.rs`: inertia over the same numbers. `lanes.rs`: several numbers in a vector register, their sines and
//!   cosines.
//! - `forward_dynamics.rs`: articulated-body algorithm. `articulated.rs`: inertia of a body with what it carries.
//! - `batch/`: the same recursions over many states. `rows.rs`: rows in memory. `kernels.rs`, `motion.rs`:
//!   what is computed. `free_motion.rs`: derivative of a motion under joint forces alone.
//! - `inverse_dynamics.rs`, `mass_matrix.rs`, `jacobian.rs`, `energy.rs`: the other dynamics algorithms.
//! - `motion/`: a vehicle in time. `plan.rs`, `joint_drive.rs`, `joint_motion.rs`, `wheel_motion.rs`, `attitude_control.rs`:
//!   what drives it. `piecewise.rs`: functions of time. `reaction_wheel.rs`: limits and friction of a wheel. `flight.rs`: a
//!   vehicle under a plan. `stage.rs`: one evaluation of its motion, state and equations. `flexing.rs`: accelerations with
//!   modes. `rates_momentum.rs`: momentum of the joint rates. `controller.rs`: the closed loop of a run. `sample.rs`: all ideal
//!   measurements. `integrate.rs`: what integrators share. `dop853.rs`, `dop853_table.rs`: eighth order with step control and
//!   dense output. `runge_kutta.rs`: fixed steps of fourth order. `run.rs`: motion through the requested times, `times.rs`. `thrust.rs`: thrusters.
//! - `propagation/`: state of pose and momentum, the vehicle with locked joints, rows of the linearised equations, columns
//!   over a step (`columns.rs`: several side by side); `internal.rs`, `modes.rs`, `hinges.rs`: flexible modes and passive joints beside them. `quaternion.rs`: rotations over one number or several.
//! - `measurement.rs`, `measurement/`: ideal sensors with derivatives, one file a kind. `sensors.rs`: simulated sensors.
//!   `sensor_errors.rs`: model of sensor errors.
//! - `orbit.rs`, `gravity_gradient.rs`: orbit and gravity gradient.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(non_snake_case)]

extern crate alloc;

mod acceleration;
mod algebra;
mod articulated;
#[cfg(feature = "batches")]
pub mod batch;
mod energy;
mod forward_dynamics;
mod gravity_gradient;
mod inertial;
mod inverse_dynamics;
mod jacobian;
mod joint_slopes;
mod kinematics;
#[cfg(feature = "std")]
mod lanes;
mod mass_matrix;
mod measurement;
mod momentum;
#[cfg(feature = "std")]
mod motion;
mod orbit;
pub mod propagation;
mod propellant;
mod quaternion;
mod rate_regressor;
mod regressor;
mod sensor;
mod sensor_errors;
#[cfg(feature = "std")]
mod sensors;
mod spring;
mod symmetric;
mod thrust;
mod tree;
mod vehicle;

pub use acceleration::Accelerations;
pub use algebra::Real;
pub use energy::kinetic_energy;
pub use forward_dynamics::{ForwardDynamics, JointInput, Singular};
pub use gravity_gradient::{gravity_gradient_torque, tidal_wrench};
pub use inverse_dynamics::InverseDynamics;
pub use jacobian::{base_jacobian, generalise_jacobian, joint_jacobian, point_of_body};
pub use joint_slopes::{JointSlope, JointSlopes, SubtreeMotion};
pub use kinematics::Kinematics;
#[cfg(feature = "std")]
pub use lanes::vectorised;
pub use mass_matrix::MassMatrix;
pub use measurement::{
    BasePose, Carried, Ideal, JointEffect, Measurement, OverJoint, PointMotion, Scene,
};
pub use momentum::{
    Twist, Wrench, body_momentum, composite, composite_and_momentum, momentum, shift_to_body,
    twist_from_momentum, wheel_momentum,
};
#[cfg(feature = "std")]
pub use motion::*;
pub use orbit::{Orbit, orbit_state};
pub use propellant::{Leaving, Propellant, point_mass};
pub use rate_regressor::{momentum_rate_column, wheel_rate};
pub use regressor::{body_regressor, momentum_regressor, wheel_regressor};
pub use sensor::{Axes, ErrorKey, Nuisance, Sensor, SensorKind, SlowError, printed_unit};
pub use sensor_errors::{SensorError, SensorErrors};
#[cfg(feature = "std")]
pub use sensors::{Instrument, vector_reading};
pub use spring::SpringDamper;
pub use thrust::{Firing, Nozzle, SAME_TIME, thrust_held, thrust_levels, thrust_wrench};
pub use tree::{Link, Motion, Rotor, Tree};
pub use vehicle::{Gravity, Vehicle};
