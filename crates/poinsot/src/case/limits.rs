//! `[limits]`: limits of a designed manoeuvre.

use super::Case;
use super::fault::did_you_mean;
use super::planner::Planner;
use super::thrusters::{ImpulseLimit, ThrusterLimit};
use crate::error::Error;
use poinsot_dynamics::Tree;
use poinsot_formats::case::{CapsuleFile, ConeFile, JointLimitFile, Placed, WheelLimitFile};
use poinsot_model::{JointKind, Model};
use poinsot_spatial::Vector3;
use std::ops::Range;

/// Limits of one joint coordinate, rad or m and derivatives; infinite if unlimited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimit {
    /// Lowest and highest position.
    pub position: (f64, f64),
    /// Largest rate.
    pub rate: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest torque or force of the motor, N m or N.
    pub effort: f64,
}

/// Limits of one wheel; infinite if unlimited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WheelLimit {
    /// Largest speed relative to the host, rad/s, which can follow from stored momentum.
    pub speed: f64,
    /// Largest torque of the motor, N m.
    pub torque: f64,
}

/// An axis of the base and a cone about a direction in N.
#[derive(Debug, Clone, PartialEq)]
pub struct Cone {
    /// Name in the result.
    pub name: String,
    /// Unit axis in the base.
    pub axis_B: Vector3,
    /// Unit direction in N.
    pub direction_N: Vector3,
    /// Half angle of the cone, rad.
    pub half_angle: f64,
    /// Whether the axis must stay inside the cone, not outside.
    pub keep_in: bool,
}

/// A capsule around part of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Capsule {
    /// Index of the body.
    pub body: usize,
    /// Ends of its axis in the body's frame, m.
    pub ends: [Vector3; 2],
    /// Radius, m.
    pub radius: f64,
}

/// All limits of a manoeuvre.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// One entry per joint coordinate.
    pub joints: Vec<JointLimit>,
    /// One entry per wheel.
    pub wheels: Vec<WheelLimit>,
    /// One entry per thruster.
    pub thrusters: Vec<ThrusterLimit>,
    /// Common budgets of several thrusters.
    pub impulses: Vec<ImpulseLimit>,
    /// Largest angular rate of the base, rad/s; infinite if unlimited.
    pub body_rate: f64,
    /// Pointing limits.
    pub cones: Vec<Cone>,
    /// Shapes of the bodies; shapes of the same body or of neighbours are not compared.
    pub capsules: Vec<Capsule>,
    /// Least distance between two shapes, m.
    pub clearance: f64,
}

impl Case {
    /// The limits of a design for a model.
    ///
    /// # Errors
    /// All faults with this model.
    pub fn limits(&self, model: &Model) -> Result<Limits, Error> {
        let mut planner = self.planner(model);
        let limits = planner.limits(&self.file.limits);
        Error::none_or(planner.faults, limits)
    }
}

impl Planner<'_> {
    fn limits(&mut self, file: &poinsot_formats::case::LimitsFile) -> Limits {
        let tree = Tree::new(self.model);
        let free = JointLimit {
            position: (f64::NEG_INFINITY, f64::INFINITY),
            rate: f64::INFINITY,
            acceleration: f64::INFINITY,
            effort: f64::INFINITY,
        };
        let mut joints = vec![free; tree.dof()];
        for (i, table) in file.joint.iter().enumerate() {
            let key = format!("limits.joint[{i}]");
            let span = table.span();
            for k in self.joints_of(&tree, table.get_ref().joints.as_deref(), &key) {
                let kind = self.model.joints[tree.coordinates[k]].kind;
                if let Some(given) = self.joint_limit(table.get_ref(), kind, &key, span.clone()) {
                    joints[k] = tighter(joints[k], given);
                }
            }
        }
        let mut wheels = vec![
            WheelLimit {
                speed: f64::INFINITY,
                torque: f64::INFINITY,
            };
            self.model.wheels.len()
        ];
        for (i, table) in file.wheel.iter().enumerate() {
            let key = format!("limits.wheel[{i}]");
            for k in self.wheels_of(table.get_ref().wheels.as_deref(), &key) {
                let given = self.wheel_limit(table.get_ref(), k, &key);
                wheels[k].speed = wheels[k].speed.min(given.speed);
                wheels[k].torque = wheels[k].torque.min(given.torque);
            }
        }
        let (thrusters, impulses) = self.thruster_limits(&file.thruster);
        let cones = file.cone.iter().enumerate();
        let cones = cones.filter_map(|(i, c)| self.cone(c.get_ref(), &format!("limits.cone[{i}]")));
        let cones = cones.collect();
        let capsules = file.capsule.iter().enumerate();
        let capsules = capsules
            .filter_map(|(i, c)| self.capsule(c.get_ref(), &format!("limits.capsule[{i}]")));
        Limits {
            joints,
            wheels,
            thrusters,
            impulses,
            cones,
            capsules: capsules.collect(),
            body_rate: self.limit("limits.body_rate_rad_s", file.body_rate_rad_s.as_ref()),
            clearance: match &file.clearance_m {
                None => 0.0,
                given => self.limit("limits.clearance_m", given.as_ref()),
            },
        }
    }

    /// A positive limit; infinite if not given.
    pub(super) fn limit(&mut self, key: &str, given: Option<&Placed<f64>>) -> f64 {
        let Some(x) = given else {
            return f64::INFINITY;
        };
        if !(x.get_ref().is_finite() && *x.get_ref() > 0.0) {
            self.refuse(
                "E0505",
                key,
                x.span(),
                "a limit must be a positive number",
                "give one, or leave it out",
            );
        }
        *x.get_ref()
    }

    /// Joint coordinates of a list of names; all without a list.
    pub(super) fn joints_of(
        &mut self,
        tree: &Tree,
        names: Option<&[Placed<String>]>,
        key: &str,
    ) -> Vec<usize> {
        match names {
            None => (0..tree.dof()).collect(),
            Some(names) => names
                .iter()
                .filter_map(|n| self.joint(tree, n, key))
                .collect(),
        }
    }

    pub(super) fn wheels_of(&mut self, names: Option<&[Placed<String>]>, key: &str) -> Vec<usize> {
        let Some(names) = names else {
            return (0..self.model.wheels.len()).collect();
        };
        let mut found = Vec::new();
        for name in names {
            match self.model.wheel(name.get_ref()) {
                Some(k) => found.push(k),
                None => {
                    let known = self.model.wheels.iter().map(|w| w.name.as_str());
                    let remedy = did_you_mean(name.get_ref(), known);
                    self.unknown("wheel", &format!("{key}.wheels"), name, remedy);
                }
            }
        }
        found
    }

    fn joint_limit(
        &mut self,
        table: &JointLimitFile,
        kind: JointKind,
        key: &str,
        span: Range<usize>,
    ) -> Option<JointLimit> {
        let turning = [
            &table.rate_rad_s,
            &table.acceleration_rad_s2,
            &table.torque_N_m,
        ];
        let sliding = [&table.rate_m_s, &table.acceleration_m_s2, &table.force_N];
        let slides = kind == JointKind::Prismatic;
        let (own, other) = match slides {
            true => ((&table.position_m, sliding), (&table.position_rad, turning)),
            false => ((&table.position_rad, turning), (&table.position_m, sliding)),
        };
        if other.0.is_some() || other.1.iter().any(|x| x.is_some()) {
            let (problem, remedy) = match slides {
                true => (
                    "a prismatic joint moves in metres",
                    "use the keys of m and N",
                ),
                false => (
                    "a revolute joint moves in radians",
                    "use the keys of rad and N_m",
                ),
            };
            self.refuse("E0507", key, span, problem, remedy);
            return None;
        }
        let position = match own.0 {
            None => (f64::NEG_INFINITY, f64::INFINITY),
            Some(x) => {
                let [low, high] = *x.get_ref();
                if !(low.is_finite() && high.is_finite() && low < high) {
                    let key = format!("{key}.position");
                    let problem = "the range of positions is empty or not finite";
                    self.refuse("E0505", &key, x.span(), problem, "give [lowest, highest]");
                    return None;
                }
                (low, high)
            }
        };
        let [rate, acceleration, effort] = own.1;
        Some(JointLimit {
            position,
            rate: self.limit(&format!("{key}.rate"), rate.as_ref()),
            acceleration: self.limit(&format!("{key}.acceleration"), acceleration.as_ref()),
            effort: self.limit(&format!("{key}.torque"), effort.as_ref()),
        })
    }

    fn wheel_limit(&mut self, table: &WheelLimitFile, wheel: usize, key: &str) -> WheelLimit {
        let speed = self.limit(&format!("{key}.speed_rad_s"), table.speed_rad_s.as_ref());
        let torque = self.limit(&format!("{key}.torque_N_m"), table.torque_N_m.as_ref());
        let momentum = table.momentum_N_m_s.as_ref();
        let momentum = self.limit(&format!("{key}.momentum_N_m_s"), momentum);
        let spin = self.model.wheels[wheel].spin_inertia;
        WheelLimit {
            speed: speed.min(momentum / spin.abs().max(f64::MIN_POSITIVE)),
            torque,
        }
    }

    fn cone(&mut self, table: &ConeFile, key: &str) -> Option<Cone> {
        let mut unit = |name: &str, x: &Placed<[f64; 3]>| {
            let v = Vector3::from(*x.get_ref());
            if !(v.norm().is_finite() && v.norm() > 0.0) {
                let key = format!("{key}.{name}");
                self.refuse(
                    "E0505",
                    &key,
                    x.span(),
                    "a direction must not be zero",
                    "give three finite numbers",
                );
                return None;
            }
            Some(v.normalize())
        };
        let axis_B = unit("axis_B", &table.axis_B)?;
        let direction_N = unit("direction_N", &table.direction_N)?;
        let (angle, keep_in) = match (&table.keep_out_rad, &table.keep_in_rad) {
            (Some(x), None) => (x, false),
            (None, Some(x)) => (x, true),
            _ => {
                let problem = "a cone needs either keep_out_rad or keep_in_rad";
                self.refuse(
                    "E0507",
                    key,
                    table.name.span(),
                    problem,
                    "give one of the two",
                );
                return None;
            }
        };
        let half_angle = *angle.get_ref();
        if !(half_angle > 0.0 && half_angle < std::f64::consts::PI) {
            let problem = "the half angle of a cone must be between 0 and pi";
            self.refuse("E0505", key, angle.span(), problem, "give it in rad");
            return None;
        }
        Some(Cone {
            name: table.name.get_ref().clone(),
            axis_B,
            direction_N,
            half_angle,
            keep_in,
        })
    }

    fn capsule(&mut self, table: &CapsuleFile, key: &str) -> Option<Capsule> {
        let name = table.body.get_ref();
        let Some(body) = self.model.bodies.iter().position(|b| b.name == *name) else {
            let names = self.model.bodies.iter().map(|b| b.name.as_str());
            let remedy = did_you_mean(name, names);
            self.unknown("body", &format!("{key}.body"), &table.body, remedy);
            return None;
        };
        let to = table.to_m.as_ref().unwrap_or(&table.from_m);
        let ends = [&table.from_m, to].map(|x| Vector3::from(*x.get_ref()));
        let radius = *table.radius_m.get_ref();
        let finite = ends.iter().all(|e| e.iter().all(|x| x.is_finite()));
        if !(finite && radius.is_finite() && radius >= 0.0) {
            let problem = "a capsule needs finite ends and a radius that is not negative";
            self.refuse("E0505", key, table.radius_m.span(), problem, "correct them");
            return None;
        }
        Some(Capsule { body, ends, radius })
    }
}

fn tighter(a: JointLimit, b: JointLimit) -> JointLimit {
    JointLimit {
        position: (
            a.position.0.max(b.position.0),
            a.position.1.min(b.position.1),
        ),
        rate: a.rate.min(b.rate),
        acceleration: a.acceleration.min(b.acceleration),
        effort: a.effort.min(b.effort),
    }
}
