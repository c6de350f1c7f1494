//! Rotation, twist, momentum, inertia and inertial parameters of one rigid body.
//!
//! Names follow Drake's monogram notation, written out in `NOTATION.md`: `p_BoBcm_B` is the position of `Bcm` from
//! `Bo` in the axes of B, `R_NB` rotates components from B to N. Everything is SI. Twists and wrenches are six-vectors
//! with the **linear part first**.
//!
//! | subject | item |
//! |---|---|
//! | the ten parameters about the frame origin, in which momentum is linear | [`InertialParameters`], [`PARAMETER_NAMES`] |
//! | mass, mass centre and inertia about the mass centre, as engineers write them | [`MassProperties`] |
//! | whether a body can exist | [`MassProperties::check_physical`], [`pseudo_inertia`] |
//! | parts of formulas | [`parallel_axis`], [`skew()`], [`tensor`], [`elements`], [`tensor_regressor`] |
//! | parts of six-vectors | [`linear`], [`angular`], [`stacked`] |
//!
//! # Example
//! Two bodies fixed to each other: their parameters about one point add up.
//!
//! ```
//! use poinsot_spatial::{MassProperties, Matrix3, Vector3};
//!
//! let ball = |x: f64| MassProperties {
//!     mass: 5.0,
//!     p_BoBcm_B: Vector3::new(x, 0.0, 0.0),
//!     I_BBcm_B: Matrix3::identity() * 0.2,
//! };
//! let both = ball(-1.0).parameters().with_added(1.0, &ball(1.0).parameters());
//! let dumbbell = both.mass_properties().unwrap();
//! assert_eq!((dumbbell.mass, dumbbell.p_BoBcm_B), (10.0, Vector3::zeros()));
//! // 2 * 0.2 kg m2 along the bar; across it 2 * 5 kg * (1 m)^2 more.
//! let (moments, _) = dumbbell.principal();
//! assert!((moments[0] - 0.4).abs() < 1.0e-12 && (moments[2] - 10.4).abs() < 1.0e-12);
//! ```
//!
//! # Files
//! - `inertial.rs`: order, point and axes of the ten parameters, conversions, physical consistency of a body.
//! - `skew.rs`: cross-product matrix, parts of six-vectors.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(non_snake_case)]

mod inertial;
mod skew;

pub use inertial::{
    InertialParameters, MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS, MassProperties, PARAMETER_NAMES,
    TENSOR, Unphysical, elements, parallel_axis, principal_axes, pseudo_inertia, tensor,
    tensor_index, tensor_name, tensor_regressor,
};
pub use skew::{angular, linear, skew, stacked};

/// A vector of three numbers.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A rotation matrix.
pub type Rotation3 = nalgebra::Rotation3<f64>;
/// A twist `[v; w]` or a momentum `[l; h]`: linear part first.
pub type Vector6 = nalgebra::Vector6<f64>;
/// A 6 x 6 matrix acting on twists.
pub type Matrix6 = nalgebra::Matrix6<f64>;
/// An attitude: `R_NB` as a unit quaternion, Hamilton, body to inertial.
pub type UnitQuaternion = nalgebra::UnitQuaternion<f64>;
