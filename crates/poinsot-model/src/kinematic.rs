//! Converts the checked model to the types of `poinsot-dynamics`.

use crate::vehicle::{Joint, JointKind, Model};
use poinsot_dynamics::propagation::{PassiveJoint, PassiveJoints};
use poinsot_dynamics::{Gravity, Link, Motion, Nozzle, Rotor, Tree, Vehicle};

impl From<&Model> for Tree {
    fn from(model: &Model) -> Self {
        let mut coordinates = Vec::new();
        let mut coordinate_of = vec![usize::MAX; model.joints.len()];
        for (k, joint) in model.joints.iter().enumerate() {
            if joint.kind != JointKind::Fixed {
                coordinate_of[k] = coordinates.len();
                coordinates.push(k);
            }
        }
        let links = model
            .bodies
            .iter()
            .map(|body| match body.joint {
                None => Link::base(),
                Some(k) => {
                    let joint = &model.joints[k];
                    let motion = match joint.kind {
                        JointKind::Fixed => Motion::Fixed,
                        JointKind::Revolute => Motion::Revolute(coordinate_of[k]),
                        JointKind::Prismatic => Motion::Prismatic(coordinate_of[k]),
                    };
                    Link::new(
                        joint.parent,
                        motion,
                        joint.p_PoCo_P,
                        joint.R_PC_zero,
                        joint.axis_C,
                    )
                }
            })
            .collect();
        let rotors = model
            .wheels
            .iter()
            .map(|w| Rotor {
                body: w.body,
                axis_B: w.axis_B,
            })
            .collect();
        Self {
            links,
            rotors,
            coordinates,
        }
    }
}

impl Model {
    /// The joints that springs move where no column measures them.
    pub fn passive_joints(&self, tree: &Tree) -> PassiveJoints {
        let joints = tree.coordinates.iter().enumerate();
        let passive = joints.filter_map(|(coordinate, joint)| {
            let joint = self.joints.get(*joint).filter(|j| j.is_passive())?;
            let spring = joint.spring_damper?;
            Some(PassiveJoint { coordinate, spring })
        });
        PassiveJoints::new(tree, passive)
    }
}

/// The vehicle with its nominal numbers as true values.
impl From<&Model> for Vehicle {
    fn from(model: &Model) -> Self {
        let tree = Tree::new(model);
        let joints = tree.coordinates.iter().filter_map(|k| model.joints.get(*k));
        let nozzles = model.thrusters.iter().map(|t| Nozzle {
            body: t.body,
            p_BoT_B: t.p_BoT_B,
            direction_B: t.direction_B,
            propellant: t.propellant.map(|p| p.flow()),
        });
        let around = &model.environment;
        Self {
            bodies: model.nominal_parameters(),
            spin_inertia: model.spin_inertias(),
            nozzles: nozzles.collect(),
            modes: model.modes.iter().map(|m| m.mode).collect(),
            locked_at: joints.map(Joint::standing_at).collect(),
            gravity: Gravity {
                gm: around.point_mass_gm,
                gradient: around.gravity_gradient,
                orbit: around.orbit,
            },
            tree,
        }
    }
}
