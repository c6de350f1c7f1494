//! Kinematics, momentum, regressors and motion of a free-floating tree of rigid bodies.
//!
//! Kernels are plain functions on fixed-size matrices. A [`Tree`] is constant; a [`Kinematics`] is
//! scratch that one call fills and the next reads. Unless a name says otherwise every vector is in the
//! axes of the base B and every moment is about the base's frame origin `Bo`.
#![allow(non_snake_case)]

mod kinematics;
mod momentum;
mod regressor;
mod tree;

pub use kinematics::Kinematics;
pub use momentum::{
    Composite, Twist, body_momentum, composite, momentum, shift_to_body, shift_to_inertial,
    twist_from_momentum, wheel_momentum,
};
pub use regressor::{momentum_regressor, wheel_regressor};
pub use tree::{Link, Motion, Rotor, Tree};
