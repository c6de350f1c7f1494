//! The vehicle at one instant of its motion.

use crate::acceleration::Accelerations;
use crate::kinematics::Kinematics;
use crate::vehicle::Vehicle;
use poinsot_spatial::{UnitQuaternion, Vector3};

/// The vehicle at one instant, with all ideal measurements.
#[derive(Debug, Clone, Default)]
pub struct MotionSample {
    /// Time, s.
    pub time: f64,
    /// `R_NB`, continuous in sign.
    pub R_NB: UnitQuaternion,
    /// Position of the base origin, in N, m.
    pub p_NoBo_N: Vector3,
    /// Velocity of the base origin, in N, m/s.
    pub v_NBo_N: Vector3,
    /// Angular velocity of the base, in B, rad/s.
    pub w_NB_B: Vector3,
    /// Position of the system's mass centre, in N, m.
    pub p_NoScm_N: Vector3,
    /// Linear momentum in N, N s.
    pub l_S_N: Vector3,
    /// Angular momentum about the system's mass centre in N, N m s.
    pub h_SScm_N: Vector3,
    /// Joint positions, rad or m, one per coordinate of the tree.
    pub q: Vec<f64>,
    /// Joint rates, rad/s or m/s.
    pub rates: Vec<f64>,
    /// Joint accelerations, rad/s2 or m/s2.
    pub accelerations: Vec<f64>,
    /// Motor force of each joint coordinate, N m or N, without spring and damper; for a prescribed joint the force it
    /// needs.
    pub motor_force: Vec<f64>,
    /// Force of spring and damper of each joint coordinate, N m or N; zero where the motion is prescribed.
    pub spring_force: Vec<f64>,
    /// Wheel speeds relative to their hosts, rad/s.
    pub wheel_speed: Vec<f64>,
    /// Motor torques on the wheels, N m.
    pub wheel_torque: Vec<f64>,
    /// Thrust, N; at a switch the value just after it.
    pub thrust: Vec<f64>,
    /// Amplitude of each mode, kg^1/2 m.
    pub mode_amplitude: Vec<f64>,
    /// Its rate, kg^1/2 m/s.
    pub mode_rate: Vec<f64>,
    /// Position of the reference orbit from the attracting body, in N, m; zero where none is simulated.
    pub p_orbit_N: Vector3,
    /// Placement and velocity of every body, in base axes.
    pub kinematics: Kinematics,
    /// Inertial accelerations of every body, in base axes: exact to round-off, as they come from the equations of motion
    /// and not from differences.
    pub body: Accelerations,
}

impl MotionSample {
    /// Everything zero, with room for a vehicle.
    pub(crate) fn new(vehicle: &Vehicle) -> Self {
        let tree = &vehicle.tree;
        let (wheels, thrusters) = (vehicle.spin_inertia.len(), vehicle.nozzles.len());
        let modes = vec![0.0; vehicle.modes.len()];
        let joints = vec![0.0; tree.dof()];
        Self {
            q: joints.clone(),
            rates: joints.clone(),
            accelerations: joints.clone(),
            motor_force: joints.clone(),
            spring_force: joints,
            wheel_speed: vec![0.0; wheels],
            wheel_torque: vec![0.0; wheels],
            thrust: vec![0.0; thrusters],
            mode_amplitude: modes.clone(),
            mode_rate: modes,
            kinematics: Kinematics::new(tree),
            body: Accelerations::new(tree),
            ..Self::default()
        }
    }
}
