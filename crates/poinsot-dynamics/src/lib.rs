//! Kinematics, momentum, regressors and motion of a free-floating tree of rigid bodies.
//!
//! Kernels are plain functions on fixed-size matrices. A [`Tree`] is constant; a [`Kinematics`] is
//! scratch that one call fills and the next reads. Unless a name says otherwise every vector is in the
//! axes of the base B and every moment is about the base's frame origin `Bo`.
#![allow(non_snake_case)]

mod acceleration;
mod attitude_control;
mod integrate;
mod joint_motion;
mod joint_slopes;
mod kinematics;
mod momentum;
mod piecewise;
mod plan;
mod prescribed;
mod reaction_wheel;
mod regressor;
mod sensors;
mod stage;
mod thrust;
mod tree;
mod wheel_motion;

pub use acceleration::Accelerations;
pub use attitude_control::{
    AttitudeControl, ControlError, ControlledVehicle, Target, WheelDrive, WheelUse,
};
pub use integrate::{DormandPrince, Flow, Halt, Tolerance};
pub use joint_motion::{Fourier, JointMotion};
pub use joint_slopes::{JointSlope, JointSlopes};
pub use kinematics::Kinematics;
pub use momentum::{
    Composite, Twist, body_momentum, composite, momentum, shift_to_body, shift_to_inertial,
    twist_from_momentum, wheel_momentum,
};
pub use piecewise::{Jet, NodeError, PiecewisePolynomial};
pub use plan::{Plan, Start, StartVelocity, Stretches};
pub use prescribed::{MotionError, MotionSample, Prescribed};
pub use reaction_wheel::WheelLimits;
pub use regressor::{momentum_regressor, wheel_regressor};
pub use sensors::{Instrument, vector_reading};
pub use thrust::{Firing, Nozzle, thrust_levels, thrust_wrench};
pub use tree::{Link, Motion, Rotor, Tree};
pub use wheel_motion::WheelMotion;
