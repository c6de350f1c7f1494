//! `[limits]`: limits of a designed manoeuvre.

use super::Case;
use super::planner::{Part, Planner};
use super::thrusters::{ImpulseLimit, ThrusterLimit};
use crate::error::Error;
use poinsot_formats::case::{CapsuleFile, ConeFile, JointLimitFile, WheelLimitFile};
use poinsot_model::Model;
use poinsot_spatial::Vector3;

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
        self.planned(model, |planner| planner.limits(&self.file.limits))
    }
}

impl Planner<'_> {
    fn limits(&mut self, file: &poinsot_formats::case::LimitsFile) -> Limits {
        let mut joints = vec![JointLimit::FREE; self.tree.dof()];
        for (i, table) in file.joint.iter().enumerate() {
            let key = format!("limits.joint[{i}]");
            for k in self.parts(Part::Joint, table.joints.as_deref(), &key) {
                if let Some(given) = self.joint_limit(table, k, &key) {
                    joints[k].tighten(given);
                }
            }
        }
        let mut wheels = vec![WheelLimit::FREE; self.model.wheels.len()];
        for (i, table) in file.wheel.iter().enumerate() {
            let key = format!("limits.wheel[{i}]");
            for k in self.parts(Part::Wheel, table.wheels.as_deref(), &key) {
                wheels[k].tighten(table, self.model.wheels[k].spin_inertia);
            }
        }
        let (thrusters, impulses) = self.thruster_limits(&file.thruster);
        let cones = file.cone.iter().enumerate();
        let cones = cones.filter_map(|(i, c)| self.cone(c, &format!("limits.cone[{i}]")));
        let cones = cones.collect();
        let capsules = file.capsule.iter().enumerate();
        let capsules =
            capsules.filter_map(|(i, c)| self.capsule(c, &format!("limits.capsule[{i}]")));
        Limits {
            joints,
            wheels,
            thrusters,
            impulses,
            cones,
            capsules: capsules.collect(),
            body_rate: file.body_rate_rad_s.unwrap_or(f64::INFINITY),
            clearance: file.clearance_m.unwrap_or(0.0),
        }
    }

    fn joint_limit(
        &mut self,
        table: &JointLimitFile,
        joint: usize,
        key: &str,
    ) -> Option<JointLimit> {
        if self.other_unit(joint, key, table) {
            return None;
        }
        let position = table.position_rad.or(table.position_m);
        if position.is_some_and(|[low, high]| low >= high) {
            let unit = table.position_m.map_or("rad", |_| "m");
            let key = format!("{key}.position_{unit}");
            let problem = "the range of positions is empty";
            return self.refused("E0505", &key, problem, "give [lowest, highest]");
        }
        let limit = |rad: Option<f64>, m: Option<f64>| rad.or(m).unwrap_or(f64::INFINITY);
        Some(JointLimit {
            position: position.map_or(JointLimit::FREE.position, |[a, b]| (a, b)),
            rate: limit(table.rate_rad_s, table.rate_m_s),
            acceleration: limit(table.acceleration_rad_s2, table.acceleration_m_s2),
            effort: limit(table.torque_N_m, table.force_N),
        })
    }

    fn cone(&mut self, table: &ConeFile, key: &str) -> Option<Cone> {
        let mut unit = |name: &str, x: [f64; 3]| {
            let unit = Vector3::from(x).try_normalize(0.0);
            if unit.is_none() {
                let key = format!("{key}.{name}");
                let problem = "a direction must not be zero";
                self.refuse("E0505", &key, problem, "give three finite numbers");
            }
            unit
        };
        let axis_B = unit("axis_B", table.axis_B)?;
        let direction_N = unit("direction_N", table.direction_N)?;
        let (half_angle, keep_in) = match (table.keep_out_rad, table.keep_in_rad) {
            (Some(x), None) => (x, false),
            (None, Some(x)) => (x, true),
            _ => {
                let problem = "a cone needs either keep_out_rad or keep_in_rad";
                return self.refused("E0507", key, problem, "give one of the two");
            }
        };
        Some(Cone {
            name: table.name.clone(),
            axis_B,
            direction_N,
            half_angle,
            keep_in,
        })
    }

    fn capsule(&mut self, table: &CapsuleFile, key: &str) -> Option<Capsule> {
        let body = self.part(Part::Body, &table.body, &format!("{key}.body"))?;
        let to = table.to_m.unwrap_or(table.from_m);
        let ends = [table.from_m, to].map(Vector3::from);
        let radius = table.radius_m;
        Some(Capsule { body, ends, radius })
    }
}

impl JointLimit {
    /// Without limits.
    const FREE: Self = Self {
        position: (f64::NEG_INFINITY, f64::INFINITY),
        rate: f64::INFINITY,
        acceleration: f64::INFINITY,
        effort: f64::INFINITY,
    };

    fn tighten(&mut self, other: Self) {
        let (low, high) = other.position;
        self.position = (self.position.0.max(low), self.position.1.min(high));
        self.rate = self.rate.min(other.rate);
        self.acceleration = self.acceleration.min(other.acceleration);
        self.effort = self.effort.min(other.effort);
    }
}

impl WheelLimit {
    /// Without limits.
    const FREE: Self = Self {
        speed: f64::INFINITY,
        torque: f64::INFINITY,
    };

    fn tighten(&mut self, table: &WheelLimitFile, spin_inertia: f64) {
        let limit = |x: Option<f64>| x.unwrap_or(f64::INFINITY);
        let spin = spin_inertia.abs().max(f64::MIN_POSITIVE);
        let stored = limit(table.momentum_N_m_s) / spin;
        self.speed = self.speed.min(limit(table.speed_rad_s)).min(stored);
        self.torque = self.torque.min(limit(table.torque_N_m));
    }
}
