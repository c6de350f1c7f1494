//! What a motion needs to know of a vehicle: plain numbers, no names and no files.

use crate::orbit::Orbit;
use crate::thrust::Nozzle;
use crate::tree::Tree;
use alloc::vec::Vec;
use poinsot_spatial::InertialParameters;

/// A vehicle whose numbers are taken as the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    /// The kinematic constants.
    pub tree: Tree,
    /// Ten parameters of each body about its own origin.
    pub bodies: Vec<InertialParameters>,
    /// Spin inertia of each wheel, kg m2.
    pub spin_inertia: Vec<f64>,
    /// Thrusters.
    pub nozzles: Vec<Nozzle>,
    /// Where each joint coordinate stands while it is locked, rad or m.
    pub locked_at: Vec<f64>,
    /// Gravity, where it is declared.
    pub gravity: Gravity,
}

/// Gravity of one attracting body; free fall by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gravity {
    /// Gravitational parameter, m3/s2; `None` in free fall.
    pub gm: Option<f64>,
    /// Whether the gravity-gradient torque acts.
    pub gradient: bool,
    /// The reference orbit, where it is known.
    pub orbit: Option<Orbit>,
}
