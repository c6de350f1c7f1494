//! Free motion of one vehicle, or of several side by side, under joint forces alone.
//!
//! The state and the equations are those of `stage.rs` without wheels, thrust and gravity:
//! `y = [ q_NB (xyzw), p_NoScm, l_S, h_SScm, q, q' ]` in N.

use crate::algebra::{Real, V3};
use crate::forward_dynamics::{ForwardDynamics, JointInput};
use crate::inertial::Inertial;
use crate::kinematics::Kinematics;
use crate::momentum::Twist;
use crate::motion::integrate::{Flow, Halt};
use crate::motion::joint_drive::ForceProfile;
use crate::motion::rates_momentum::RatesMomentum;
use crate::motion::stage::{ANGULAR, LINEAR, POSITION, WHEELS};
use crate::propagation::LockedVehicle;
use crate::quaternion;
use crate::tree::Tree;

/// Numbers of a state before the joints.
pub(crate) const JOINTS: usize = WHEELS;

/// Vehicles with the same motors, and the scratch for them.
pub(crate) struct FreeMotion<'a, T> {
    pub tree: &'a Tree,
    /// Of every body of the vehicles.
    pub bodies: Vec<Inertial<T>>,
    pub motors: &'a [ForceProfile],
    /// A time inside the smooth stretch of the motors.
    pub within: f64,
    kinematics: Kinematics<T>,
    dynamics: ForwardDynamics<T>,
    carried: RatesMomentum<T>,
    inputs: Vec<JointInput<T>>,
    /// Time of `inputs`; NaN before the first.
    read_at: f64,
}

impl<'a, T: Real> FreeMotion<'a, T> {
    #[inline(always)]
    pub fn new(
        tree: &'a Tree,
        bodies: Vec<Inertial<T>>,
        motors: &'a [ForceProfile],
        zero: T,
    ) -> Self {
        Self {
            tree,
            bodies,
            motors,
            within: 0.0,
            kinematics: Kinematics::over(tree, zero),
            dynamics: ForwardDynamics::over(tree, zero),
            carried: RatesMomentum::new(tree),
            inputs: vec![JointInput::Force(zero); tree.dof()],
            read_at: f64::NAN,
        }
    }
}

#[inline(always)]
fn vector<T: Real>(y: &[T], at: usize) -> V3<T> {
    V3::new(y[at], y[at + 1], y[at + 2])
}

impl<T: Real> Flow<T> for FreeMotion<'_, T> {
    #[inline(always)]
    fn derivative(&mut self, t: f64, y: &[T], dy: &mut [T]) -> Result<(), Halt> {
        let (tree, dof) = (self.tree, self.tree.dof());
        let singular = Halt::Singular { time: t };
        if self.read_at != t {
            self.read_at = t;
            for (input, motor) in self.inputs.iter_mut().zip(self.motors) {
                *input = JointInput::Force(y[0].all(motor.at(t, self.within)));
            }
        }
        let q_NB = quaternion::unit([y[0], y[1], y[2], y[3]]);
        let (q, rates) = (&y[JOINTS..JOINTS + dof], &y[JOINTS + dof..JOINTS + 2 * dof]);
        self.kinematics.place(tree, q);
        self.dynamics
            .set_inertias(tree, self.bodies.iter().copied(), &self.kinematics);
        let (whole, l, h) = self.carried.of(tree, &self.dynamics, rates);
        let locked = LockedVehicle::over(&whole, &whole, (&l, &h)).ok_or(singular)?;
        let R_NB = quaternion::rotation(&q_NB);
        let l = R_NB.transpose_times(&vector(y, LINEAR));
        let h_SScm_B = R_NB.transpose_times(&vector(y, ANGULAR));
        let Twist { v, w } = locked.twist(&l, &h_SScm_B);
        self.kinematics.set_velocities(tree, &v, &w, rates);
        let found = &mut dy[JOINTS + dof..JOINTS + 2 * dof];
        self.dynamics
            .solve(tree, &self.kinematics, rates, &self.inputs, found)
            .map_err(|_| singular)?;
        dy[JOINTS..JOINTS + dof].copy_from_slice(rates);
        dy[..POSITION].copy_from_slice(&quaternion::rate(&q_NB, &V3::of(&w)));
        let velocity = vector(y, LINEAR) / whole.mass;
        [dy[POSITION], dy[POSITION + 1], dy[POSITION + 2]] = [velocity.x, velocity.y, velocity.z];
        // No force from outside: both momenta are constant.
        dy[LINEAR..JOINTS].fill(whole.mass.all(0.0));
        Ok(())
    }

    #[inline(always)]
    fn project(&self, y: &mut [T]) {
        let unit = quaternion::unit([y[0], y[1], y[2], y[3]]);
        y[..POSITION].copy_from_slice(&unit);
    }
}
