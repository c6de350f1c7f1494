//! Position and velocity of a point of a body, with their derivatives over the joints.

use super::{Column, EvaluatedState, Motion};
use poinsot_dynamics::propagation::{ModeRows, STATE};
use poinsot_dynamics::{JointEffect, PointMotion, Twist};
use poinsot_spatial::{Vector3, Vector6};

/// A point fixed in a body, with its derivatives over joints.
pub(crate) struct PointKinematics {
    pub point: PointMotion,
    /// The joints between base and body, virtual ones behind them, each with its index: that of the coordinate; the
    /// virtual ones follow the real ones.
    pub joints: Vec<(usize, JointEffect)>,
}

impl Motion<'_> {
    /// A point of a body at the instant of the last [`Motion::velocity`].
    pub fn place(&mut self, twist: &Twist, (body, p): (usize, &Vector3)) -> PointKinematics {
        if body == 0 {
            return PointKinematics {
                point: PointMotion::of_base(twist, p),
                joints: Vec::new(),
            };
        }
        let mut list = self.spare.effects.pop().unwrap_or_default();
        let (tree, now) = (self.vehicle.tree, &mut self.input_state);
        now.set_velocities(tree, &twist.v, &twist.w);
        let point = PointMotion::new(&now.kinematics, body, p);
        let joints = 0..self.vehicle.joint_motions.len();
        list.extend(joints.filter_map(|joint| Some((joint, self.effect(joint, body, &point)?))));
        PointKinematics {
            point,
            joints: list,
        }
    }

    /// Keeps the memory of a place that is no longer needed.
    pub fn leave(&mut self, mut place: PointKinematics) {
        if place.joints.capacity() > 0 {
            place.joints.clear();
            self.spare.effects.push(place.joints);
        }
    }

    /// Slopes of a place over a joint; `None` if the joint does not carry the body.
    fn effect(&self, joint: usize, body: usize, place: &PointMotion) -> Option<JointEffect> {
        let motion = self.carrying(joint, body)?;
        let placed = &self.input_state.kinematics;
        let (axis, w) = (motion.axis_B(placed), placed.w[motion.frame]);
        if !motion.turns {
            return Some(JointEffect {
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

    /// Effect of unknowns on joints at the current instant, and of all columns on passive ones: sensitivity column, joint, change of
    /// its position and rate.
    pub fn joint_changes(&self) -> impl Iterator<Item = (usize, usize, f64, f64)> {
        let read = self.input_state.changes.iter().filter_map(|change| {
            let (joint, dq, drate) = change.joint?;
            Some((self.initial_columns + change.unknown, joint, dq, drate))
        });
        let swings = |_: &&EvaluatedState| self.vehicle.has_passive_joints();
        let evaluated = self.evaluated.as_deref().filter(swings);
        let variation = evaluated.and_then(|e| e.variation.as_deref());
        let swinging = variation.into_iter().flat_map(move |variation| {
            let columns = self.columns.iter().enumerate();
            columns.flat_map(move |(column, x)| {
                let unknown = column.checked_sub(self.initial_columns);
                let drive = unknown.map(|u| &variation.internal[u]);
                self.swings(variation.modes.as_deref(), x)
                    .map(move |(joint, number, dq, drate)| {
                        let own = drive.map_or(0.0, |d| d[number]);
                        (column, joint, dq, drate + own)
                    })
            })
        });
        read.chain(swinging)
    }

    /// Passive joints with the place of each in the internal state, and the change of its position and rate with a column.
    pub fn swings(
        &self,
        modes: Option<&ModeRows>,
        x: &Column,
    ) -> impl Iterator<Item = (usize, usize, f64, f64)> {
        let first = self.vehicle.modes.len();
        let joints = self.vehicle.passive.joints().iter().enumerate();
        modes.into_iter().flat_map(move |modes| {
            joints.clone().map(move |(i, joint)| {
                let number = 2 * (first + i);
                let (dq, drate) = (x[STATE + number], modes.rate_times(number, x));
                (joint.coordinate, number, dq, drate)
            })
        })
    }
}
