//! The vehicle: a tree of rigid bodies with joints, wheels, thrusters and sensors, read and checked.
#![allow(non_snake_case)]

mod vehicle;

pub use vehicle::*;
