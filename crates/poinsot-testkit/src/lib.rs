//! References for the tests of the other crates: closed-form motions, momentum by definition, recorded results of
//! independent programs, and measures of difference.
//!
//! This crate shares no code with the others: it has its own types (`Kit...`) and computes trees body by body in
//! inertial axes. Names follow the monogram notation of the project (`p_BoBcm_B`, `R_NB`); everything is SI.
//!
//! # Files
//! - `rigid_body.rs`: torque-free motion in closed form. `momentum_sum.rs`: momentum by definition.
//! - `trees.rs`: the recorded trees of `validation/`.
//! - `vehicles.rs`: model files of test vehicles.
//! - `elliptic.rs`, `quadrature.rs`, `joint_plans.rs`, `compare.rs`. `outside.rs`: data that are not shipped.
#![allow(non_snake_case)]

pub mod compare;
mod elliptic;
pub mod joint_plans;
pub mod momentum_sum;
pub mod outside;
mod quadrature;
pub mod rigid_body;
pub mod trees;
pub mod vehicles;

/// A column of three numbers.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A twist `[v; w]` or a momentum `[l; h]`: linear part first.
pub type Vector6 = nalgebra::Vector6<f64>;
/// A 6 x 6 matrix that acts on twists.
pub type Matrix6 = nalgebra::Matrix6<f64>;

/// Rotation matrix of the rotation vector `rotation` (axis times angle, rad).
pub(crate) fn turn(rotation: Vector3) -> Matrix3 {
    nalgebra::Rotation3::new(rotation).into_inner()
}
