//! Position and velocity of a point of a body, with their derivatives over the joints.

use super::{Column, Motion};
use poinsot_dynamics::Twist;
use poinsot_spatial::{Matrix3, Vector3, Vector6};

/// A point P fixed in body i, seen from the base; all in base axes.
pub(crate) struct PointKinematics {
    /// `R_BBi`.
    pub R: Matrix3,
    /// `p_BoP_B`, m.
    pub r: Vector3,
    /// `v_NP_B`, m/s.
    pub v: Vector3,
    /// `w_NBi_B`, rad/s.
    pub w: Vector3,
    /// The joints between base and body, virtual ones behind them.
    pub joints: Vec<JointEffect>,
}

/// Slopes of a place over one joint, the base twist held.
pub(crate) struct JointEffect {
    /// Joint coordinate; the virtual ones follow the real ones.
    pub joint: usize,
    /// Turn of the body and shift of the point over the joint's position; also `w` and `v` over its rate.
    pub turn: Vector3,
    pub shift: Vector3,
    /// `w` and `v` over the joint's position.
    pub w: Vector3,
    pub v: Vector3,
}

impl Motion<'_> {
    /// A point of a body at the instant of the last [`Motion::velocity`].
    pub fn place(&mut self, twist: &Twist, (body, p): (usize, &Vector3)) -> PointKinematics {
        if body == 0 {
            return PointKinematics {
                R: Matrix3::identity(),
                r: *p,
                v: twist.v + twist.w.cross(p),
                w: twist.w,
                joints: Vec::new(),
            };
        }
        let mut list = self.spare.effects.pop().unwrap_or_default();
        let (tree, input_state) = (self.vehicle.tree, &mut self.input_state);
        let placed = &mut input_state.kinematics;
        placed.set_velocities(tree, &twist.v, &twist.w, &input_state.rates);
        let arm = placed.R[body] * p;
        let mut place = PointKinematics {
            R: placed.R[body],
            r: placed.p[body] + arm,
            v: placed.v[body] + placed.w[body].cross(&arm),
            w: placed.w[body],
            joints: Vec::new(),
        };
        let joints = 0..self.vehicle.joint_motions.len();
        list.extend(joints.filter_map(|joint| self.effect(joint, body, &place)));
        place.joints = list;
        place
    }

    /// Keeps the memory of a place that is no longer needed.
    pub fn leave(&mut self, mut place: PointKinematics) {
        if place.joints.capacity() > 0 {
            place.joints.clear();
            self.spare.effects.push(place.joints);
        }
    }

    /// Slopes of a place over a joint; `None` if the joint does not carry the body.
    fn effect(&self, joint: usize, body: usize, place: &PointKinematics) -> Option<JointEffect> {
        let motion = self.carrying(joint, body)?;
        let placed = &self.input_state.kinematics;
        let (axis, w) = (motion.axis_B(placed), placed.w[motion.frame]);
        if !motion.turns {
            return Some(JointEffect {
                joint,
                turn: Vector3::zeros(),
                shift: axis,
                w: Vector3::zeros(),
                v: w.cross(&axis),
            });
        }
        // All beyond the joint turns as one. What moves relative to the frame turns with it.
        let arm = place.r - placed.p[motion.link];
        let v = placed.v[motion.frame] + w.cross(&(place.r - placed.p[motion.frame]));
        Some(JointEffect {
            joint,
            turn: axis,
            shift: axis.cross(&arm),
            w: axis.cross(&(place.w - w)),
            v: w.cross(&axis.cross(&arm)) + axis.cross(&(place.v - v)),
        })
    }

    /// Change of state and base twist with every sensitivity column, at the instant of the last [`Motion::velocity`].
    pub fn sensitivities(&self) -> impl Iterator<Item = (&Column, &Vector6)> {
        self.columns.iter().zip(&self.twist_columns)
    }

    /// Effect of unknowns on joints at the current instant: sensitivity column, joint, change of its position and rate.
    pub fn joint_changes(&self) -> impl Iterator<Item = (usize, usize, f64, f64)> {
        self.input_state.changes.iter().filter_map(|change| {
            let (joint, dq, drate) = change.joint?;
            Some((self.initial_columns + change.unknown, joint, dq, drate))
        })
    }
}
