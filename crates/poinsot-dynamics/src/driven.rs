//! Motion of the vehicle under joint torques, wheels and thrust.
//!
//! The equations are in `driven_stage.rs`.

use crate::driven_stage::{Driven, DrivenPlan, DrivenSample, DrivenStage};
use crate::joint_drive::JointDrive;
use crate::plan::Start;
use crate::prescribed::{MotionError, gravity_gradient};
use crate::run::{Integrator, run};
use crate::thrust::Nozzle;
use crate::tree::{Motion, Tree};
use crate::vehicle::Vehicle;
use crate::wheel_motion::WheelMotion;
use poinsot_spatial::InertialParameters;

impl<'p> Driven<'p> {
    /// Combines a vehicle with a plan.
    ///
    /// # Errors
    /// The plan does not fit the vehicle, or this form of gravity is not simulated.
    pub fn new(vehicle: impl Into<Vehicle>, plan: &'p DrivenPlan) -> Result<Self, MotionError> {
        let vehicle: Vehicle = vehicle.into();
        let parameters = vehicle.bodies.clone();
        Self::with_parameters(vehicle, parameters, plan)
    }

    /// The same with other inertial parameters (one set per body), about the bodies' origins. They need not be
    /// physical: base parameters have the same motion as the vehicle they were derived from.
    ///
    /// # Errors
    /// The plan or the parameters do not fit the vehicle, or this form of gravity is not simulated.
    pub fn with_parameters(
        vehicle: impl Into<Vehicle>,
        parameters: Vec<InertialParameters>,
        plan: &'p DrivenPlan,
    ) -> Result<Self, MotionError> {
        let vehicle: Vehicle = vehicle.into();
        let orbit = gravity_gradient(&vehicle.gravity)?;
        let (spin_inertia, nozzles) = (vehicle.spin_inertia, vehicle.nozzles);
        let driven = Self::from_parts(vehicle.tree, parameters, spin_inertia, nozzles, plan)?;
        Ok(Self { orbit, ..driven })
    }

    /// From the tree, ten parameters per body, spin inertia per wheel (kg m2) and the thrusters, in free fall.
    ///
    /// # Errors
    /// The plan or the parameters do not fit the tree.
    pub fn from_parts(
        tree: Tree,
        parameters: Vec<InertialParameters>,
        spin_inertia: Vec<f64>,
        nozzles: Vec<Nozzle>,
        plan: &'p DrivenPlan,
    ) -> Result<Self, MotionError> {
        MotionError::count("sets of parameters", parameters.len(), tree.bodies())?;
        MotionError::count("joint drives", plan.joints.len(), tree.dof())?;
        MotionError::count("wheel motions", plan.wheels.len(), tree.rotors.len())?;
        MotionError::count("spin inertias", spin_inertia.len(), tree.rotors.len())?;
        let mass: f64 = parameters.iter().map(|p| p.mass).sum();
        if mass.is_nan() || mass <= 0.0 {
            return Err(MotionError::NoMass);
        }
        let mut reduced = parameters.clone();
        for (i, (wheel, js)) in plan.wheels.iter().zip(&spin_inertia).enumerate() {
            if matches!(wheel, WheelMotion::Torque { .. }) {
                if js.is_nan() || *js <= 0.0 {
                    return Err(MotionError::InertialessWheel(i));
                }
                let rotor = &tree.rotors[i];
                let a = rotor.axis_B;
                reduced[rotor.body].I_BBo_B -= a * a.transpose() * *js;
            }
        }
        let free = tree
            .links
            .iter()
            .filter_map(|link| match link.motion {
                Motion::Revolute(k) | Motion::Prismatic(k) => Some(k),
                Motion::Fixed | Motion::Free => None,
            })
            .filter(|k| matches!(plan.joints.get(*k), Some(JointDrive::Force { .. })))
            .collect();
        Ok(Self {
            tree,
            reduced,
            parameters,
            spin_inertia,
            nozzles,
            plan,
            free,
            mass,
            orbit: None,
        })
    }

    /// The kinematic constants.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The state at time `t`, s: `q_NB` (scalar last), `p_NoScm`, `l_S`, `h_SScm` in N, momenta of torque-driven wheels,
    /// positions and then rates of the driven joints.
    ///
    /// # Errors
    /// The vehicle has no inertia.
    pub fn state(&self, start: &Start, t: f64) -> Result<Vec<f64>, MotionError> {
        Ok(DrivenStage::new(self, t).start(start, t)?)
    }

    /// Moves the vehicle from `start` (at the first of `times`; joints start as their drives define) through every
    /// time, s, and hands each sample to `sink`.
    ///
    /// # Errors
    /// The motion cannot be computed; samples before that point have been handed over.
    pub fn run(
        &self,
        start: &Start,
        times: &[f64],
        integrator: Integrator,
        sink: impl FnMut(&DrivenSample),
    ) -> Result<(), MotionError> {
        let first = MotionError::check_times(times)?;
        let mut stage = DrivenStage::new(self, first);
        let state = (stage.start(start, first)?, stage.scale());
        Ok(run(&mut stage, state, times, integrator, sink)?)
    }
}
