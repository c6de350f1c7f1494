//! A vehicle with what drives it, ready to move. The equations are in `stage.rs`.

use crate::kinematics::Kinematics;
use crate::motion::controller::allocation;
use crate::motion::integrate::Halt;
use crate::motion::joint_drive::JointDrive;
use crate::motion::plan::Plan;
use crate::motion::run::Integrator;
use crate::motion::times::Times;
use crate::motion::wheel_motion::{Axial, WheelMotion};
use crate::orbit::Orbit;
use crate::propagation::MOST_MODES;
use crate::thrust::Firing;
use crate::tree::Tree;
use crate::vehicle::{Gravity, Vehicle};
use poinsot_spatial::{InertialParameters, Vector3};

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
    /// Beside flexible modes this is not simulated.
    #[error("{0} beside flexible modes is not simulated; take [[mode]] out of the model, or {1}")]
    Modes(&'static str, &'static str),
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
    /// A torque or a controller drives a wheel without spin inertia.
    #[error(
        "wheel {0} (counted from 0) has no spin inertia, so a torque cannot drive it; give spin_inertia_kg_m2, or its speed"
    )]
    InertialessWheel(usize),
    /// A controller has too few wheel axes.
    #[error(
        "{wheels} wheels whose axes span {rank} of 3 directions cannot turn the vehicle about every axis; give it three wheels whose axes are independent"
    )]
    Allocation {
        /// Wheels.
        wheels: usize,
        /// Directions.
        rank: usize,
    },
    /// A number of the controller or of its wheels is not valid.
    #[error("{0}")]
    Control(&'static str),
    /// Output times must not decrease, and be finite.
    #[error(
        "output time {0} (counted from 0) is not finite or not after the previous one; sort the times"
    )]
    Times(usize),
}

/// A vehicle with a plan, ready to move.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // The wheel runs at 100 rad/s in a vehicle without momentum: the base turns back.
/// let vehicle = Vehicle::new(tree, bodies.to_vec(), vec![0.01], vec![]);
/// let plan = Plan { wheels: vec![WheelMotion::constant(100.0)], ..Plan::hold(vehicle.clone()) };
/// let flight = Flight::new(vehicle.clone(), &plan, Tolerance::default())?;
/// let mut rate = 0.0;
/// flight.run(&Start::at_rest(), &[0.0, 1.0], |sample| rate = sample.w_NB_B.z)?;
/// assert!((rate + 1.0 / (1.5 + 8.0 / 3.0)).abs() < 1.0e-12);
///
/// // The arm swings on a spring with its base: no momentum, and energy is kept.
/// let spring = SpringDamper { stiffness: 2.0, rest: 0.0, damping: 0.0 };
/// let motor = ForceProfile::none();
/// let swing = JointDrive::Force { motor, spring, initial_position: 0.1, initial_rate: 0.0 };
/// let plan = Plan { joints: vec![swing], ..Plan::hold(vehicle.clone()) };
/// let mut energy = 0.0;
/// Flight::new(vehicle, &plan, Tolerance::default())?.run(&Start::at_rest(), &[0.0, 5.0], |sample| {
///     energy = kinetic_energy(&bodies, &sample.kinematics) + spring.energy(sample.q[0]);
/// })?;
/// assert!((energy - spring.energy(0.1)).abs() < 1.0e-11);
/// # Ok::<(), MotionError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Flight<'p> {
    pub(crate) vehicle: Vehicle,
    pub(crate) plan: &'p Plan,
    /// What is known of each wheel's axial momentum.
    pub(crate) axial: Vec<Axial>,
    /// The joint coordinates that are part of the state.
    pub(crate) free: Vec<usize>,
    /// Torque of each controlled wheel for a torque on the body.
    pub(crate) allocation: Vec<Vector3>,
    /// Gravitational parameter and orbit of the gravity gradient.
    pub(crate) orbit: Option<(f64, Orbit)>,
    pub(crate) integrator: Integrator,
}

impl<'p> Flight<'p> {
    /// Combines a vehicle with a plan. Its inertial parameters need not be physical: base parameters have the same motion
    /// as the vehicle that they were derived from.
    ///
    /// # Errors
    /// The plan does not fit the vehicle, or this form of gravity is not simulated.
    pub fn new(
        vehicle: impl Into<Vehicle>,
        plan: &'p Plan,
        integrator: impl Into<Integrator>,
    ) -> Result<Self, MotionError> {
        let vehicle: Vehicle = vehicle.into();
        let orbit = gravity_gradient(&vehicle.gravity)?;
        let (tree, spin) = (&vehicle.tree, &vehicle.spin_inertia);
        count("sets of parameters", vehicle.bodies.len(), tree.bodies())?;
        count("joint motions", plan.joints.len(), tree.dof())?;
        count("wheel motions", plan.wheels.len(), tree.rotors.len())?;
        count("spin inertias", spin.len(), tree.rotors.len())?;
        let mass: f64 = vehicle.bodies.iter().map(|p| p.mass).sum();
        if mass.is_nan() || mass <= 0.0 {
            return Err(MotionError::NoMass);
        }
        let law = plan.control.as_ref();
        let axial: Vec<Axial> = plan.wheels.iter().map(|w| w.axial(law)).collect();
        let given = |axial: &Axial| *axial == Axial::Given;
        let mut wheels = axial.iter().zip(spin);
        if let Some(i) = wheels.position(|(axial, js)| !given(axial) && (js.is_nan() || *js <= 0.0))
        {
            return Err(MotionError::InertialessWheel(i));
        }
        let allocation = allocate(tree, plan)?;
        let is_free = |k: &usize| plan.joints[*k].is_free();
        let free: Vec<usize> = (0..tree.dof()).filter(is_free).collect();
        let burns = |firing: &Firing| {
            let nozzle = vehicle.nozzles.get(firing.thruster);
            nozzle.is_some_and(|nozzle| nozzle.propellant.is_some())
        };
        let beside = [
            (
                !free.is_empty(),
                "a joint that is free",
                "prescribe its motion",
            ),
            (
                orbit.is_some(),
                "the gravity gradient",
                "take it out of [environment]",
            ),
            (
                plan.firings.iter().any(burns),
                "mass that leaves",
                "take specific_impulse_s out of the thruster",
            ),
            (
                vehicle.modes.len() > MOST_MODES,
                "a seventh mode",
                "keep the six of the lowest frequencies",
            ),
        ];
        if let Some((_, what, instead)) = beside.iter().find(|b| b.0 && !vehicle.modes.is_empty()) {
            return Err(MotionError::Modes(what, instead));
        }
        Ok(Self {
            free,
            axial,
            allocation,
            orbit,
            integrator: integrator.into(),
            vehicle,
            plan,
        })
    }

    /// Takes the axial inertia of the wheels whose absolute momentum is a state off their hosts.
    pub(crate) fn reduce(&self, bodies: &mut [InertialParameters]) {
        let rotors = self.vehicle.tree.rotors.iter();
        for ((rotor, axial), js) in rotors.zip(&self.axial).zip(&self.vehicle.spin_inertia) {
            if *axial == Axial::Absolute {
                bodies[rotor.body].I_BBo_B -= rotor.axis_B * rotor.axis_B.transpose() * *js;
            }
        }
    }
}

/// Shares of the controlled wheels in a torque on the body, at the placement at time zero.
fn allocate(tree: &Tree, plan: &Plan) -> Result<Vec<Vector3>, MotionError> {
    let Some(law) = &plan.control else {
        let waits = plan.wheels.iter().any(|w| w.controlled().is_some());
        let what = "a wheel waits for a controller; give the plan one";
        return if waits {
            Err(MotionError::Control(what))
        } else {
            Ok(Vec::new())
        };
    };
    let mut controlled = plan.wheels.iter().filter_map(WheelMotion::controlled);
    let fault = law.fault();
    if let Some(what) = fault.or_else(|| {
        let valid = controlled.all(|(speed, limits)| limits.is_valid() && speed.is_finite());
        (!valid).then_some(
            "a limit of a wheel is not positive, or its friction is negative; correct its numbers",
        )
    }) {
        return Err(MotionError::Control(what));
    }
    let q: Vec<f64> = plan.joints.iter().map(JointDrive::first_position).collect();
    let kinematics = Kinematics::at(tree, &q);
    let rotors = tree.rotors.iter().zip(&plan.wheels);
    let axes: Vec<Vector3> = rotors
        .filter(|(_, wheel)| wheel.controlled().is_some())
        .map(|(rotor, _)| kinematics.R[rotor.body] * rotor.axis_B)
        .collect();
    let wheels = axes.len();
    allocation(&axes).map_err(|rank| MotionError::Allocation { wheels, rank })
}

/// What the gravity gradient of a simulation needs; `None` in free fall.
fn gravity_gradient(around: &Gravity) -> Result<Option<(f64, Orbit)>, MotionError> {
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

/// The plan must have as many entries as the model.
fn count(what: &'static str, found: usize, expected: usize) -> Result<(), MotionError> {
    match found == expected {
        true => Ok(()),
        false => Err(MotionError::Plan {
            what,
            found,
            expected,
        }),
    }
}

/// The first of the output times, where they are finite and do not decrease.
pub(crate) fn check_times(times: &Times) -> Result<f64, MotionError> {
    let mut before = f64::NEG_INFINITY;
    let follows = |t: f64| t.is_finite() && std::mem::replace(&mut before, t) <= t;
    match times.iter().map(follows).position(|follows| !follows) {
        Some(i) => Err(MotionError::Times(i)),
        None => times.get(0).ok_or(MotionError::Times(0)),
    }
}
