//! The vehicle parameters of a motion: numbers only, no names and no files.

use crate::orbit::Orbit;
use crate::propagation::Mode;
use crate::thrust::Nozzle;
use crate::tree::Tree;
use alloc::vec;
use alloc::vec::Vec;
use poinsot_spatial::InertialParameters;

/// A vehicle with its true numbers.
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
    /// Flexible modes of its bodies.
    pub modes: Vec<Mode>,
    /// Locked position of each joint coordinate, rad or m.
    pub locked_at: Vec<f64>,
    /// Gravity, where it is declared.
    pub gravity: Gravity,
}

impl Vehicle {
    /// In free fall, its joints locked at zero.
    pub fn new(
        tree: Tree,
        bodies: Vec<InertialParameters>,
        spin_inertia: Vec<f64>,
        nozzles: Vec<Nozzle>,
    ) -> Self {
        Self {
            locked_at: vec![0.0; tree.dof()],
            gravity: Gravity::default(),
            tree,
            bodies,
            spin_inertia,
            nozzles,
            modes: Vec::new(),
        }
    }
}

/// Gravity of one attracting body; free fall by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gravity {
    /// Gravitational parameter, m3/s2; `None` in free fall.
    pub gm: Option<f64>,
    /// Whether the gravity-gradient torque is included.
    pub gradient: bool,
    /// The reference orbit, where it is known.
    pub orbit: Option<Orbit>,
}
