//! Checks that the joints form one tree with the base as root. Without recursion, so chains of thousands of links are
//! allowed.

use crate::file::{BodyFile, JointFile};
use crate::finding::{Findings, Key};
use poinsot_files::excerpt;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// Number of names listed for a cycle.
const SHOWN: usize = 12;

/// The tree, in file indices.
pub(crate) struct Tree {
    /// Bodies: base first, parents before children, otherwise in file order.
    pub order: Vec<usize>,
    /// The joint whose child is this body.
    pub carried_by: Vec<Option<usize>>,
}

pub(crate) fn check_tree(
    bodies: &[BodyFile],
    joints: &[JointFile],
    findings: &mut Findings<'_>,
) -> Tree {
    let name_of =
        |k: usize| -> &str { bodies.get(k).and_then(|b| b.name.as_deref()).unwrap_or("?") };
    let index: HashMap<&str, usize> = bodies
        .iter()
        .enumerate()
        .rev()
        .filter_map(|(k, b)| Some((b.name.as_deref()?, k)))
        .collect();
    let mut carried_by: Vec<Option<usize>> = vec![None; bodies.len()];
    let mut parent_of: Vec<Option<usize>> = vec![None; bodies.len()];
    // An unreadable joint may have any child, so bodies without a joint are not reported.
    let mut complete = true;
    for (k, joint) in joints.iter().enumerate() {
        let key = Key::entry("joint", k, joint.name.as_deref());
        let end = |name: &Option<String>| index.get(name.as_deref()?).copied();
        let parent = end(&joint.parent);
        let child = end(&joint.child);
        let Some(child) = child else {
            complete = false;
            continue;
        };
        let first = carried_by.get(child).copied().flatten();
        let first = first.map(|f| joints.get(f).and_then(|j| j.name.as_deref()));
        if let Some((problem, remedy)) = wrong_child(child, parent, first) {
            findings.refuse("E0112", &key.at("child"), problem, remedy);
            if parent == Some(child)
                && child != 0
                && let Some(carried) = carried_by.get_mut(child)
            {
                carried.get_or_insert(k);
            }
            continue;
        }
        if let Some(carried) = carried_by.get_mut(child) {
            *carried = Some(k);
        }
        if let (Some(parent), Some(slot)) = (parent, parent_of.get_mut(child)) {
            *slot = Some(parent);
        }
    }

    for (k, body) in bodies.iter().enumerate().skip(1) {
        if complete && body.name.is_some() && carried_by.get(k) == Some(&None) {
            let duplicate = body.name.as_deref().and_then(|n| index.get(n)) != Some(&k);
            if !duplicate {
                findings.refuse(
                    "E0112",
                    &Key::entry("body", k, None).at("name"),
                    "no joint has this body as its child: it is not connected to the base",
                    "add a [[joint]] with this child, type = \"fixed\" where it does not move",
                );
            }
        }
    }
    report_cycles(&parent_of, &carried_by, joints, &name_of, findings);
    Tree {
        order: topological(&parent_of),
        carried_by,
    }
}

/// Fault and remedy of a joint's child; `first` is the name of another joint with the same child.
fn wrong_child(
    child: usize,
    parent: Option<usize>,
    first: Option<Option<&str>>,
) -> Option<(String, &'static str)> {
    if child == 0 {
        return Some((
            "the base has no parent".to_owned(),
            "the first [[body]] is the base: name another child, or move the base to the top",
        ));
    }
    if parent == Some(child) {
        return Some((
            "the joint connects the body with itself".to_owned(),
            "name another parent or child",
        ));
    }
    first.map(|other| {
        let other = excerpt(other.unwrap_or("?"), 60);
        (
            format!("the body has two parents: it is also the child of joint \"{other}\""),
            "remove one of the joints; closed loops are not supported",
        )
    })
}

/// Follows every body to its root once; a path that returns to itself is a cycle.
fn report_cycles<'n>(
    parent_of: &[Option<usize>],
    carried_by: &[Option<usize>],
    joints: &[JointFile],
    name_of: &impl Fn(usize) -> &'n str,
    findings: &mut Findings<'_>,
) {
    // Zero: not visited. Otherwise the number of the walk that visited it.
    let mut visited = vec![0_usize; parent_of.len()];
    for start in 0..parent_of.len() {
        let walk = start + 1;
        let mut here = start;
        let met = loop {
            match visited.get_mut(here) {
                Some(mark) if *mark == 0 => *mark = walk,
                Some(mark) => break (*mark == walk).then_some(here),
                None => break None,
            }
            match parent_of.get(here).copied().flatten() {
                Some(parent) => here = parent,
                None => break None,
            }
        };
        let Some(met) = met else { continue };
        let mut cycle = vec![met];
        let mut at = parent_of.get(met).copied().flatten();
        while let Some(body) = at.filter(|body| *body != met) {
            cycle.push(body);
            at = parent_of.get(body).copied().flatten();
        }
        // From parent to child, starting with the first body in the file.
        cycle.reverse();
        let lowest = cycle
            .iter()
            .enumerate()
            .min_by_key(|(_, body)| **body)
            .map_or(0, |(at, _)| at);
        cycle.rotate_left(lowest);
        let first = cycle.first().copied().unwrap_or(met);
        let mut path: Vec<String> = cycle
            .iter()
            .take(SHOWN)
            .map(|body| excerpt(name_of(*body), 60))
            .collect();
        if cycle.len() > SHOWN {
            path.push(format!("... ({} bodies)", cycle.len()));
        }
        path.push(excerpt(name_of(first), 60));
        let joint = carried_by.get(first).copied().flatten().unwrap_or(0);
        let name = joints.get(joint).and_then(|j| j.name.as_deref());
        findings.refuse(
            "E0112",
            &Key::entry("joint", joint, name).at("parent"),
            format!("the joints form a loop: {}", path.join(" -> ")),
            "connect one of these bodies with the base instead",
        );
    }
}

/// Parents before children, otherwise in file order; bodies in a cycle are dropped.
fn topological(parent_of: &[Option<usize>]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parent_of.len()];
    let mut ready = BinaryHeap::new();
    for (k, parent) in parent_of.iter().enumerate() {
        match parent {
            Some(parent) => {
                if let Some(list) = children.get_mut(*parent) {
                    list.push(k);
                }
            }
            None => ready.push(Reverse(k)),
        }
    }
    let mut order = Vec::with_capacity(parent_of.len());
    while let Some(Reverse(k)) = ready.pop() {
        order.push(k);
        if let Some(list) = children.get(k) {
            ready.extend(list.iter().copied().map(Reverse));
        }
    }
    order
}
