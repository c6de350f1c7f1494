//! Converts checked links and joints to a [`Model`].

use super::Remark;
use super::inertial::rotation;
use super::raw::{Kind, Robot};
use super::tree::Order;
use crate::Environment;
use crate::knowledge::{Knowledge, Origin};
use crate::vehicle::{Body, EstimateSet, Joint, JointKind, Model, Momentum};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use poinsot_telemetry::TelemetryMap;
use std::collections::HashMap;

/// The vehicle; `None` after an error.
pub(super) fn model(
    robot: &Robot,
    order: &Order,
    inertials: &[MassProperties],
    remarks: &mut [Remark],
) -> Option<Model> {
    if remarks.iter().any(|r| r.code.is_some()) {
        return None;
    }
    let place: HashMap<&str, usize> = order
        .links
        .iter()
        .enumerate()
        .filter_map(|(at, k)| Some((robot.links.get(*k)?.name.as_str(), at)))
        .collect();
    let bodies = order
        .links
        .iter()
        .map(|&k| {
            Some(Body {
                name: robot.links.get(k)?.name.clone(),
                nominal: *inertials.get(k)?,
                estimate: EstimateSet::default(),
                prior: None,
                joint: order.carried_by.get(k).copied().flatten(),
            })
        })
        .collect::<Option<Vec<Body>>>()?;
    let joints = robot
        .joints
        .iter()
        .map(|j| {
            let kind = match j.kind {
                Kind::Turns => JointKind::Revolute,
                Kind::Slides => JointKind::Prismatic,
                Kind::Fixed => JointKind::Fixed,
            };
            let straight = j.rpy == [0.0; 3];
            Some(Joint {
                name: j.name.clone(),
                kind,
                parent: *place.get(j.parent.as_str())?,
                child: *place.get(j.child.as_str())?,
                p_PoCo_P: Vector3::from(j.xyz),
                R_PC_zero: if straight {
                    Matrix3::identity()
                } else {
                    rotation(j.rpy)
                },
                axis_C: match j.kind {
                    Kind::Fixed => Vector3::zeros(),
                    _ => Vector3::from(j.axis),
                },
                locked_at: None,
                spring_damper: None,
            })
        })
        .collect::<Option<Vec<Joint>>>()?;
    let model = Model {
        name: robot.name.clone(),
        bodies,
        joints,
        wheels: Vec::new(),
        thrusters: Vec::new(),
        modes: Vec::new(),
        sensors: Vec::new(),
        momentum: Momentum::default(),
        environment: Environment::default(),
        telemetry: TelemetryMap::default(),
        // A URDF gives no uncertainty of its numbers.
        knowledge: Knowledge {
            assumed: true,
            ..Knowledge::default()
        },
        notes: Vec::new(),
    };
    Some(model.with_usual_uncertainty(Origin::Cad))
}
