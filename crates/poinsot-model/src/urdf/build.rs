//! Converts checked links and joints to a [`Model`].

use super::Remark;
use super::inertial::rotation;
use super::raw::{self, Kind, Robot};
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
    let links = order.links.iter().enumerate();
    let names = links.map(|(at, k)| (robot.links[*k].name.as_str(), at));
    let place: HashMap<&str, usize> = names.collect();
    let body = |k: &usize| Body {
        given: None,
        name: robot.links[*k].name.clone(),
        nominal: inertials[*k],
        estimate: EstimateSet::default(),
        prior: None,
        joint: order.carried_by[*k],
    };
    let joint = |j: &raw::Joint| {
        let (kind, axis) = match j.kind {
            Kind::Turns => (JointKind::Revolute, j.axis),
            Kind::Slides => (JointKind::Prismatic, j.axis),
            Kind::Fixed => (JointKind::Fixed, [0.0; 3]),
        };
        let straight = j.rpy == [0.0; 3];
        Some(Joint {
            name: j.name.clone(),
            kind,
            parent: *place.get(j.parent.as_str())?,
            child: *place.get(j.child.as_str())?,
            p_PoCo_P: Vector3::from(j.xyz),
            R_PC_zero: match straight {
                true => Matrix3::identity(),
                false => rotation(j.rpy),
            },
            axis_C: Vector3::from(axis),
            locked_at: None,
            spring_damper: None,
        })
    };
    let joints: Option<Vec<Joint>> = robot.joints.iter().map(joint).collect();
    let model = Model {
        name: robot.name.clone(),
        bodies: order.links.iter().map(body).collect(),
        joints: joints?,
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
