//! Converts checked links and joints to a [`Model`].

use super::Remark;
use super::inertial::rotation;
use super::raw::{self, Robot};
use super::tree::Order;
use crate::knowledge::{Knowledge, Origin};
use crate::vehicle::{Body, EstimateSet, Joint, JointKind, Model};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
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
        let axis = match j.kind {
            JointKind::Fixed => [0.0; 3],
            _ => j.axis,
        };
        let R = match j.rpy {
            [0.0, 0.0, 0.0] => Matrix3::identity(),
            rpy => rotation(rpy),
        };
        let p = Vector3::from(j.xyz);
        let (R_PC_zero, p_PoCo_P) = match j.reversed {
            true => (R.transpose(), R.transpose() * (Vector3::zeros() - p)),
            false => (R, p),
        };
        Some(Joint {
            name: j.name.clone(),
            kind: j.kind,
            parent: *place.get(j.parent.as_str())?,
            child: *place.get(j.child.as_str())?,
            p_PoCo_P,
            R_PC_zero,
            axis_C: Vector3::from(axis),
            locked_at: None,
            spring_damper: None,
            spring_unknown: Vec::new(),
        })
    };
    let joints: Option<Vec<Joint>> = robot.joints.iter().map(joint).collect();
    let model = Model {
        name: robot.name.clone(),
        bodies: order.links.iter().map(body).collect(),
        joints: joints?,
        // A URDF gives no uncertainty of its numbers.
        knowledge: Knowledge {
            assumed: true,
            ..Knowledge::default()
        },
        ..Model::default()
    };
    Some(model.with_usual_uncertainty(Origin::Cad))
}
