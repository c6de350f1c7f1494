//! Motion of the vehicle under prescribed joint and wheel motion and thrust.
//!
//! The equations are in `stage.rs`.

use crate::integrate::{Halt, Tolerance};
use crate::orbit::Orbit;
use crate::plan::{Plan, Start};
use crate::run::{Integrator, run};
use crate::stage::{MotionSample, Prescribed, Stage};
use crate::tree::Tree;
use crate::vehicle::{Gravity, Vehicle};
use crate::wheel_motion::WheelMotion;

/// Why a motion could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The integration stopped.
    #[error(transparent)]
    Halt(#[from] Halt),
    /// The vehicle has no mass.
    #[error("the vehicle has no mass; give its base one")]
    NoMass,
    /// This form of gravity is not simulated.
    #[error("{0}")]
    Gravity(&'static str),
    /// Propellant leaves only a vehicle whose motion is prescribed.
    #[error(
        "propellant use (specific_impulse_s) is simulated with prescribed joints and wheels alone, not under a controller, joint forces or another vehicle's bodies; take specific_impulse_s out of the thrusters that fire"
    )]
    Propellant,
    /// The plan does not fit the vehicle.
    #[error("the plan has {found} {what}, the model {expected}; give one for each of the model")]
    Plan {
        /// What is counted.
        what: &'static str,
        /// Number in the plan.
        found: usize,
        /// Number in the model.
        expected: usize,
    },
    /// A torque drives a wheel without spin inertia.
    #[error(
        "wheel {0} (counted from 0) has no spin inertia, so a torque cannot drive it; give spin_inertia_kg_m2, or its speed"
    )]
    InertialessWheel(usize),
    /// Output times must not decrease, and be finite.
    #[error(
        "output time {0} (counted from 0) is not finite or not after the previous one; sort the times"
    )]
    Times(usize),
}

impl<'p> Prescribed<'p> {
    /// Combines a vehicle with a plan.
    ///
    /// # Errors
    /// The plan does not fit the vehicle, or this form of gravity is not simulated.
    pub fn new(
        vehicle: impl Into<Vehicle>,
        plan: &'p Plan,
        tolerance: Tolerance,
    ) -> Result<Self, MotionError> {
        let vehicle: Vehicle = vehicle.into();
        let orbit = gravity_gradient(&vehicle.gravity)?;
        let (joints, wheels) = (vehicle.tree.dof(), vehicle.spin_inertia.len());
        MotionError::count("joint motions", plan.joints.len(), joints)?;
        MotionError::count("wheel motions", plan.wheels.len(), wheels)?;
        for (i, (wheel, js)) in plan.wheels.iter().zip(&vehicle.spin_inertia).enumerate() {
            if matches!(wheel, WheelMotion::Torque { .. }) && (js.is_nan() || *js <= 0.0) {
                return Err(MotionError::InertialessWheel(i));
            }
        }
        let mass: f64 = vehicle.bodies.iter().map(|p| p.mass).sum();
        if mass.is_nan() || mass <= 0.0 {
            return Err(MotionError::NoMass);
        }
        Ok(Self {
            tree: vehicle.tree,
            parameters: vehicle.bodies,
            spin_inertia: vehicle.spin_inertia,
            nozzles: vehicle.nozzles,
            plan,
            mass,
            orbit,
            tolerance,
        })
    }

    /// The kinematic constants.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Moves the vehicle from `start` (at the first of `times`) through every time, s, and hands each
    /// sample to `sink`.
    ///
    /// # Errors
    /// The motion cannot be computed; samples before that point have been handed over.
    pub fn run(
        &self,
        start: &Start,
        times: &[f64],
        sink: impl FnMut(&MotionSample),
    ) -> Result<(), MotionError> {
        let first = MotionError::check_times(times)?;
        let mut stage = Stage::new(self, first);
        let state = (stage.start(start, first)?, stage.scale());
        let integrator = Integrator::DormandPrince8(self.tolerance);
        Ok(run(&mut stage, state, times, integrator, sink)?)
    }
}

/// What the gravity gradient of a simulation needs; `None` in free fall.
pub(crate) fn gravity_gradient(around: &Gravity) -> Result<Option<(f64, Orbit)>, MotionError> {
    match (around.gm, around.gradient, around.orbit) {
        (None, _, _) => Ok(None),
        (Some(gm), true, Some(orbit)) => Ok(Some((gm, orbit))),
        (Some(_), true, None) => Err(MotionError::Gravity(
            "the gravity gradient of a simulation needs an orbit; add orbit = { semi_major_axis_m = ... } to [environment]",
        )),
        (Some(_), false, _) => Err(MotionError::Gravity(
            "N is in free fall with the vehicle, so gravity alone has no effect; add gravity_gradient = true, or take gravity out of [environment]",
        )),
    }
}

impl MotionError {
    /// The plan must have as many entries as the model.
    pub(crate) fn count(what: &'static str, found: usize, expected: usize) -> Result<(), Self> {
        if found == expected {
            return Ok(());
        }
        Err(Self::Plan {
            what,
            found,
            expected,
        })
    }

    /// The first of the output times, where they are finite and do not decrease.
    pub(crate) fn check_times(times: &[f64]) -> Result<f64, Self> {
        let finite = |t: &[f64]| t[0] <= t[1] && t[1].is_finite();
        if let Some(i) = times.windows(2).position(|t| !finite(t)) {
            return Err(Self::Times(i + 1));
        }
        let first = times.first().copied().filter(|t| t.is_finite());
        first.ok_or(Self::Times(0))
    }
}
