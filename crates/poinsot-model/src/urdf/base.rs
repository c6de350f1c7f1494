//! Takes another link than the root as the base.

use super::Remark;
use super::raw::{Joint, Link, Robot};
use crate::vehicle::JointKind;
use poinsot_files::{excerpt, nearest};
use std::collections::HashMap;

/// Reverses the joints from a link to the root. Every link keeps its frame, and every joint its position: the parent of a joint that
/// moves is fixed to a new link without mass, which has the frame of the joint.
pub(super) fn choose(robot: &mut Robot, base: &str, remarks: &mut Vec<Remark>) {
    let names: Vec<&str> = robot.links.iter().map(|l| l.name.as_str()).collect();
    if !names.contains(&base) {
        let near = nearest(base, &names).map(|near| excerpt(near, 60));
        let remedy = near.map(|near| format!("did you mean \"{near}\"?"));
        let remedy = remedy.unwrap_or_else(|| "name a link of the file".to_owned());
        let problem = format!("there is no link \"{}\"", excerpt(base, 60));
        remarks.push(Remark::new(Some("E0111"), 0, problem, &remedy).on("--base"));
        return;
    }
    let joints = robot.joints.iter().enumerate();
    let mut carried: HashMap<String, usize> = joints.map(|(k, j)| (j.child.clone(), k)).collect();
    let mut link = base.to_owned();
    // Of links in a loop, which are refused later, each is passed once.
    while let Some(k) = carried.remove(&link) {
        let joint = &mut robot.joints[k];
        link.clone_from(&joint.parent);
        std::mem::swap(&mut joint.parent, &mut joint.child);
        let (kind, byte) = (joint.kind, joint.byte);
        let fixed = Joint {
            kind: JointKind::Fixed,
            reversed: true,
            ..joint.clone()
        };
        if kind == JointKind::Fixed {
            *joint = fixed;
            continue;
        }
        let name = format!("{}_frame", joint.name);
        joint.child.clone_from(&name);
        (joint.xyz, joint.rpy) = ([0.0; 3], [0.0; 3]);
        joint.axis = joint.axis.map(|x| 0.0 - x);
        robot.joints.push(Joint {
            name: name.clone(),
            parent: name.clone(),
            ..fixed
        });
        robot.links.push(Link {
            name,
            byte,
            inertial: None,
        });
    }
}
