//! Rotation, twist, momentum, inertia and inertial parameters of one rigid body.
//!
//! Names follow Drake's monogram notation, written out in `NOTATION.md`: `p_BoBcm_B` is the position of `Bcm` from
//! `Bo` in the axes of B, `R_NB` rotates components from B to N. Everything is SI. Twists and wrenches are six-vectors
//! with the **linear part first**.
//!
//! # Files
//! - `inertial.rs`: order, point and axes of the ten parameters, conversions, physical consistency of a body.
//! - `skew.rs`: cross-product matrix.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(non_snake_case)]

mod inertial;
mod skew;

pub use inertial::{
    InertialParameters, MassProperties, PARAMETER_NAMES, TENSOR, Unphysical, elements,
    parallel_axis, pseudo_inertia, tensor, tensor_index, tensor_name, tensor_regressor,
};
pub use skew::skew;

/// A vector of three numbers.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A twist `[v; w]` or a momentum `[l; h]`: linear part first.
pub type Vector6 = nalgebra::Vector6<f64>;
/// A 6 x 6 matrix acting on twists.
pub type Matrix6 = nalgebra::Matrix6<f64>;
/// An attitude: `R_NB` as a unit quaternion, Hamilton, body to inertial.
pub type UnitQuaternion = nalgebra::UnitQuaternion<f64>;
