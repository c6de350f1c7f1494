//! Kinematics, momentum, regressors and motion of a free-floating tree of rigid bodies.
//!
//! Kernels are plain functions on fixed-size matrices. A [`Tree`] is constant; a [`Kinematics`] is
//! scratch that one call fills and the next reads. Unless a name says otherwise every vector is in the
//! axes of the base B and every moment is about the base's frame origin `Bo`.
#![allow(non_snake_case)]

mod acceleration;
mod attitude_control;
mod dop853;
mod dop853_table;
mod driven;
mod driven_stage;
mod energy;
mod forward_dynamics;
mod gravity_gradient;
mod integrate;
mod inverse_dynamics;
mod jacobian;
mod joint_drive;
mod joint_motion;
mod joint_slopes;
mod kinematics;
mod mass_matrix;
mod momentum;
mod orbit;
mod piecewise;
mod plan;
mod prescribed;
mod rate_regressor;
mod reaction_wheel;
mod regressor;
mod runge_kutta;
mod sensor;
mod sensors;
mod stage;
mod symmetric;
mod thrust;
mod tree;
mod vehicle;
mod wheel_motion;

pub use acceleration::Accelerations;
pub use attitude_control::{
    AttitudeControl, ControlError, ControlledVehicle, Target, WheelDrive, WheelUse,
};
pub use dop853::DormandPrince8;
pub use driven::{Driven, DrivenPlan, Integrator};
pub use driven_stage::DrivenSample;
pub use energy::kinetic_energy;
pub use forward_dynamics::{ForwardDynamics, JointInput, Singular};
pub use gravity_gradient::gravity_gradient_torque;
pub use integrate::{DormandPrince, Flow, Halt, Tolerance};
pub use inverse_dynamics::{InverseDynamics, Wrench};
pub use jacobian::{base_jacobian, generalise_jacobian, joint_jacobian, point_of_body};
pub use joint_drive::{ForceProfile, JointDrive, SpringDamper};
pub use joint_motion::{Fourier, JointMotion};
pub use joint_slopes::{JointSlope, JointSlopes};
pub use kinematics::Kinematics;
pub use mass_matrix::MassMatrix;
pub use momentum::{
    Composite, Twist, body_momentum, composite, momentum, shift_to_body, shift_to_inertial,
    twist_from_momentum, wheel_momentum,
};
pub use orbit::{Orbit, orbit_state};
pub use piecewise::{Jet, NodeError, PiecewisePolynomial};
pub use plan::{Plan, Start, StartVelocity, Stretches};
pub use prescribed::{MotionError, MotionSample, Prescribed};
pub use rate_regressor::{momentum_rate_column, wheel_rate};
pub use reaction_wheel::WheelLimits;
pub use regressor::{momentum_regressor, wheel_regressor};
pub use runge_kutta::RungeKutta4;
pub use sensor::{Nuisance, Sensor, SensorKind};
pub use sensors::{Instrument, vector_reading};
pub use thrust::{Firing, Nozzle, thrust_levels, thrust_wrench};
pub use tree::{Link, Motion, Rotor, Tree};
pub use vehicle::{Gravity, Vehicle};
pub use wheel_motion::WheelMotion;
