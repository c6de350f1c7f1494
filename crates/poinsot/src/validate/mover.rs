//! A vehicle for simulation, from a model or from an estimate with undetermined numbers.

use poinsot_identify::CompletedVehicle;
use poinsot_model::Model;
use poinsot_spatial::InertialParameters;

/// A vehicle with its own inertial parameters, which may be unphysical.
#[derive(Debug, Clone, PartialEq)]
pub struct Mover {
    /// Tree, wheels, thrusters, sensors.
    pub model: Model,
    /// Barycentric parameters, one set per body.
    pub bodies: Vec<InertialParameters>,
    /// Factor on the force of each thruster.
    pub thrust_factor: Vec<f64>,
}

impl Mover {
    /// The vehicle with the nominal numbers of its model.
    pub fn of_model(model: Model) -> Self {
        Self {
            bodies: model.nominal_parameters(),
            thrust_factor: vec![1.0; model.thrusters.len()],
            model,
        }
    }

    /// The vehicle of a model with the numbers of an estimate.
    pub fn of_estimate(model: &Model, found: &CompletedVehicle) -> Self {
        let mut mover = Self::of_model(model.clone());
        mover.bodies.clone_from(&found.bodies);
        for (k, spin) in &found.spin_inertia {
            if let Some(wheel) = mover.model.wheels.get_mut(*k) {
                wheel.spin_inertia = *spin;
            }
        }
        for (k, factor) in &found.thrust_factor {
            if let Some(own) = mover.thrust_factor.get_mut(*k) {
                *own = *factor;
            }
        }
        mover
    }
}
