//! The links make one tree. Names are unique among links and among joints.

use super::raw::Robot;
use super::{Remark, UrdfDefect};
use crate::check::MOST_BODIES;
use crate::check_name::misspelt;
use poinsot_files::excerpt;
use std::collections::HashMap;

/// The tree in indices of the file.
pub(super) struct Order {
    /// Links, the root first, parents before children.
    pub links: Vec<usize>,
    /// The joint that carries each link.
    pub carried_by: Vec<Option<usize>>,
}

pub(super) fn check(robot: &Robot, remarks: &mut Vec<Remark>) -> Order {
    let mut push = |defect, code, byte, subject: String, problem: String, remedy: &str| {
        remarks.push(Remark {
            defect,
            code: Some(code),
            byte,
            subject,
            value: String::new(),
            problem,
            remedy: remedy.to_owned(),
        });
    };
    if robot.links.len() > MOST_BODIES {
        let problem = format!("the file has {} links", robot.links.len());
        push(
            UrdfDefect::Roots,
            "E0119",
            0,
            "robot".to_owned(),
            problem,
            "keep to 10000 links",
        );
        return Order {
            links: Vec::new(),
            carried_by: Vec::new(),
        };
    }
    let links = robot.links.iter().map(|l| (l.name.as_str(), l.byte));
    let joints = robot.joints.iter().map(|j| (j.name.as_str(), j.byte));
    for (what, list) in [
        ("link", links.collect::<Vec<_>>()),
        ("joint", joints.collect()),
    ] {
        let mut seen: HashMap<&str, usize> = HashMap::new();
        for (name, byte) in list {
            let subject = format!("{what} \"{}\"", excerpt(name, 60));
            if name.trim().is_empty() {
                let problem = format!("a {what} without name");
                push(
                    UrdfDefect::Names,
                    "E0109",
                    byte,
                    subject,
                    problem,
                    "give it a name",
                );
            } else if let Some(problem) = misspelt(name) {
                push(
                    UrdfDefect::Names,
                    "E0109",
                    byte,
                    subject,
                    problem.to_owned(),
                    "give it a plain name",
                );
            } else if seen.insert(name, byte).is_some() {
                let problem = format!("two {what}s have this name");
                push(
                    UrdfDefect::Names,
                    "E0110",
                    byte,
                    subject,
                    problem,
                    "rename one",
                );
            }
        }
    }
    let index: HashMap<&str, usize> = robot
        .links
        .iter()
        .enumerate()
        .rev()
        .map(|(k, l)| (l.name.as_str(), k))
        .collect();
    let mut carried_by: Vec<Option<usize>> = vec![None; robot.links.len()];
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); robot.links.len()];
    for (k, joint) in robot.joints.iter().enumerate() {
        let subject = || format!("joint \"{}\"", excerpt(&joint.name, 60));
        let mut find = |which: &str, name: &str| {
            let found = index.get(name).copied();
            if found.is_none() && !name.is_empty() {
                push(
                    UrdfDefect::MissingLink,
                    "E0111",
                    joint.byte,
                    format!("{} <{which}>", subject()),
                    format!("there is no link \"{}\"", excerpt(name, 60)),
                    "name a link of the file",
                );
            }
            found
        };
        let (parent, child) = (find("parent", &joint.parent), find("child", &joint.child));
        let Some(child) = child else { continue };
        let Some(slot) = carried_by.get_mut(child) else {
            continue;
        };
        if let Some(first) = *slot {
            let other = robot.joints.get(first).map_or("", |j| j.name.as_str());
            push(
                UrdfDefect::TwoParents,
                "E0112",
                joint.byte,
                subject(),
                format!(
                    "link \"{}\" has two parents: joint \"{}\" carries it too",
                    excerpt(&joint.child, 60),
                    excerpt(other, 60)
                ),
                "remove one of the joints; closed loops are not supported",
            );
            continue;
        }
        *slot = Some(k);
        if let Some(list) = parent.and_then(|p| children.get_mut(p)) {
            list.push(child);
        }
    }
    // A second link of one name hangs on nothing because of that name.
    let is_first = |k: usize| {
        let link = robot.links.get(k);
        link.and_then(|l| index.get(l.name.as_str())) == Some(&k)
    };
    let roots: Vec<usize> = (0..robot.links.len())
        .filter(|&k| carried_by.get(k) == Some(&None) && is_first(k))
        .collect();
    let named = |list: &[usize]| {
        let names = list.iter().take(8).filter_map(|&k| robot.links.get(k));
        let names: Vec<String> = names
            .map(|l| format!("\"{}\"", excerpt(&l.name, 60)))
            .collect();
        names.join(", ")
    };
    if roots.len() != 1 {
        let (problem, remedy) = match roots.len() {
            0 if robot.links.is_empty() => ("the robot has no link".to_owned(), "add <link>"),
            0 => (
                "no link is the base: the joints run in a circle".to_owned(),
                "remove one of the joints",
            ),
            n => (
                format!("{n} links hang on nothing: {}", named(&roots)),
                "connect them by joints of type fixed; one link is the base",
            ),
        };
        push(
            UrdfDefect::Roots,
            "E0112",
            0,
            "robot".to_owned(),
            problem,
            remedy,
        );
    }
    let mut order: Vec<usize> = roots.iter().copied().take(1).collect();
    let mut at = 0;
    while let Some(&link) = order.get(at) {
        at += 1;
        order.extend(children.get(link).into_iter().flatten().copied());
    }
    if roots.len() == 1 && order.len() < robot.links.len() {
        let mut reached = vec![false; robot.links.len()];
        for &k in &order {
            if let Some(mark) = reached.get_mut(k) {
                *mark = true;
            }
        }
        let lost: Vec<usize> = (0..robot.links.len())
            .filter(|&k| reached.get(k) == Some(&false) && is_first(k))
            .collect();
        if lost.is_empty() {
            return Order {
                links: order,
                carried_by,
            };
        }
        push(
            UrdfDefect::Roots,
            "E0112",
            0,
            "robot".to_owned(),
            format!("the joints of {} run in a circle", named(&lost)),
            "remove one of the joints",
        );
    }
    Order {
        links: order,
        carried_by,
    }
}
