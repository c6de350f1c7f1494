//! Sensitivity of the motion to its inputs: joint positions, joint rates and wheel speeds.

use super::{Instant, Matrix6x12, Motion, State, matrix};
use poinsot_dynamics::JointSlopes;
use poinsot_dynamics::propagation::StateRows;
use poinsot_spatial::{Matrix3, Vector3, Vector6, skew};

impl Motion<'_> {
    /// Time from the grid time before k to k, s.
    pub fn step_s(&self, k: usize) -> f64 {
        let t = &self.observations.time_s;
        k.checked_sub(1).map_or(0.0, |before| t[k] - t[before])
    }

    /// Slopes of the momentum over the joints where the last velocity was taken.
    pub fn joint_slopes(&mut self, instant: &Instant, slopes: &mut JointSlopes) {
        let (v, twist, now) = (self.vehicle, &instant.twist, &mut self.input_state);
        now.set_velocities(v.tree, &twist.v, &twist.w);
        slopes.fill(v.tree, &now.bodies, &now.kinematics, &v.spin, &now.wheels);
    }

    /// Slopes of `P'` and `h'` over the state in the interval after grid time k: six rows. Force and torque turn with
    /// the base; `map` is the first of [`Self::slopes`].
    pub fn wrench_slopes(
        &self,
        state: &State,
        instant: &Instant,
        map: &Matrix6x12,
        k: usize,
    ) -> Matrix6x12 {
        let R = matrix(&state.R_NB);
        let (w, centre) = (instant.twist.w, &instant.centre);
        let (F, T) = self.external_wrench(state, instant, k);
        // Force and torque turn with the base; what else they follow is added.
        let mut slopes = StateRows::of_wrench(state, &F, &T).matrix();
        if !self.follows_motion(k) {
            return slopes;
        }
        for j in 0..12 {
            let mut dphi = Vector3::zeros();
            if j < 3 {
                dphi[j] = 1.0;
            }
            let dw: Vector3 = map.fixed_view::<3, 1>(3, j).into();
            let change = self.environment_torque_change(state, centre, (&w, &dw), &dphi, None);
            let dl_B = match j {
                0..3 => centre.l_B.cross(&dphi),
                6..9 => R.row(j - 6).transpose(),
                _ => Vector3::zeros(),
            };
            let dtwist = map.column(j).into();
            let loss = self.momentum_loss_change(instant, k, (&dtwist, &dl_B));
            let (dP, dh) = (-(R * loss.0), R * (change - loss.1));
            let sum = slopes.column(j) + Vector6::new(dP.x, dP.y, dP.z, dh.x, dh.y, dh.z);
            slopes.set_column(j, &sum);
        }
        slopes
    }

    /// Change of force and torque with a joint position: thrusters beyond the joint move, and so does the
    /// mass centre.
    pub fn wrench_change(
        &self,
        state: &State,
        instant: &Instant,
        k: usize,
        joint: usize,
        first_moment: &Vector3,
    ) -> (Vector3, Vector3) {
        let mut change = (Vector3::zeros(), Vector3::zeros());
        let dc = first_moment / instant.centre.mass;
        for force in self.thrust_now(instant, k) {
            let body = self.vehicle.thrusters[force.thruster].body;
            let p_BoT_B = force.arm_B + instant.centre.p_BoScm_B;
            let (dF, dp) = self.carried(body, joint, &p_BoT_B, &force.F_B);
            change.0 += dF;
            change.1 += (dp - dc).cross(&force.F_B) + force.arm_B.cross(&dF);
        }
        if self.vehicle.gm.is_some() {
            let dI = self.inertia_carried(joint, &instant.centre.p_BoScm_B);
            change.1 += self.gradient_change(state, &dI);
        }
        change
    }

    /// Change of the external torque with the base's rate.
    pub fn drag_change(&self, state: &State, instant: &Instant, dw: &Vector3) -> Vector3 {
        let (w, still) = (&instant.twist.w, Vector3::zeros());
        self.environment_torque_change(state, &instant.centre, (w, dw), &still, None)
    }

    /// Change of the inertia about the system's mass centre with a joint position, in B. The mass centre's own move is
    /// of second order in it.
    fn inertia_carried(&self, joint: usize, c: &Vector3) -> Matrix3 {
        let kinematics = &self.input_state.kinematics;
        let mut sum = Matrix3::zeros();
        for (i, body) in self.input_state.bodies.iter().enumerate() {
            let (R, D) = (&kinematics.R[i], kinematics.p[i] - c);
            let mc = R * body.mc_B;
            // A first moment is a mass times a place that moves as its body's origin does, and turns.
            let (dmc, dD) = self.carried(i, joint, &kinematics.p[i], &mc);
            let (turn, _) = self.turned_by(i, joint);
            let J = R * body.I_BBo_B * R.transpose();
            let W = skew(&turn);
            let about = |a: &Vector3, b: &Vector3| {
                Matrix3::identity() * (2.0 * a.dot(b)) - a * b.transpose() - b * a.transpose()
            };
            sum += W * J - J * W + about(&D, &dD) * body.mass + about(&dD, &mc) + about(&D, &dmc);
        }
        sum
    }

    /// Change of a vector and of a point fixed in a body with a joint position; zero for bodies before the joint.
    fn carried(&self, body: usize, joint: usize, p: &Vector3, F: &Vector3) -> (Vector3, Vector3) {
        let (turn, shift) = self.turned_by(body, joint);
        (turn.cross(F), turn.cross(p) + shift)
    }

    /// How a body turns with a joint position and how a point of it at the base's origin would move, in B; zero for
    /// bodies before the joint.
    pub(super) fn turned_by(&self, body: usize, joint: usize) -> (Vector3, Vector3) {
        let Some(motion) = self.carrying(joint, body) else {
            return (Vector3::zeros(), Vector3::zeros());
        };
        let kinematics = &self.input_state.kinematics;
        let axis = motion.axis_B(kinematics);
        match motion.turns {
            true => (axis, kinematics.p[motion.link].cross(&axis)),
            false => (Vector3::zeros(), axis),
        }
    }
}
