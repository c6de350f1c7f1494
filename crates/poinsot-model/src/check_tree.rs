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
    let names = bodies.iter().enumerate().rev();
    let names = names.filter_map(|(k, b)| Some((b.name.as_deref()?, k)));
    let index: HashMap<&str, usize> = names.collect();
    let mut carried_by: Vec<Option<usize>> = vec![None; bodies.len()];
    let mut parent_of: Vec<Option<usize>> = vec![None; bodies.len()];
    // An unreadable joint may have any child, so bodies without a joint are not reported.
    let mut complete = true;
    for (k, joint) in joints.iter().enumerate() {
        let end = |name: &Option<String>| index.get(name.as_deref()?).copied();
        let parent = end(&joint.parent);
        let Some(child) = end(&joint.child) else {
            complete = false;
            continue;
        };
        let first = carried_by[child].map(|first| joints[first].name.as_deref());
        let Some((problem, remedy)) = wrong_child(child, parent, first) else {
            (carried_by[child], parent_of[child]) = (Some(k), parent);
            continue;
        };
        let key = Key::entry("joint", k, joint.name.as_deref()).at("child");
        findings.refuse("E0112", &key, problem, remedy);
        if parent == Some(child) && child != 0 {
            carried_by[child].get_or_insert(k);
        }
    }
    for (k, body) in bodies.iter().enumerate().skip(1) {
        // Of equal names the first has the joint.
        let first = body.name.as_deref().and_then(|n| index.get(n)) == Some(&k);
        if complete && first && carried_by[k].is_none() {
            let key = Key::entry("body", k, None).at("name");
            let problem = "no joint has this body as its child: it is not connected to the base";
            let remedy = "add a [[joint]] with this child, type = \"fixed\" where it does not move";
            findings.refuse("E0112", &key, problem, remedy);
        }
    }
    report_cycles(&parent_of, &carried_by, (bodies, joints), findings);
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
        let remedy =
            "the first [[body]] is the base: name another child, or move the base to the top";
        return Some(("the base has no parent".to_owned(), remedy));
    }
    if parent == Some(child) {
        let problem = "the joint connects the body with itself";
        return Some((problem.to_owned(), "name another parent or child"));
    }
    let other = excerpt(first?.unwrap_or("?"), 60);
    let problem = format!("the body has two parents: it is also the child of joint \"{other}\"");
    let remedy = "remove one of the joints; closed loops are not supported";
    Some((problem, remedy))
}

/// Follows every body to its root once; a path that returns to itself is a cycle.
fn report_cycles(
    parent_of: &[Option<usize>],
    carried_by: &[Option<usize>],
    (bodies, joints): (&[BodyFile], &[JointFile]),
    findings: &mut Findings<'_>,
) {
    let name = |body: usize| excerpt(bodies[body].name.as_deref().unwrap_or("?"), 60);
    // Zero: not visited. Otherwise the number of the walk that visited it.
    let mut visited = vec![0_usize; parent_of.len()];
    for start in 0..parent_of.len() {
        let mut here = Some(start);
        while let Some(body) = here.filter(|body| visited[*body] == 0) {
            visited[body] = start + 1;
            here = parent_of[body];
        }
        let Some(met) = here.filter(|body| visited[*body] == start + 1) else {
            continue;
        };
        let next = |body: &usize| parent_of[*body].filter(|parent| *parent != met);
        let mut cycle: Vec<usize> = std::iter::successors(Some(met), next).collect();
        // From parent to child, starting with the first body in the file.
        cycle.reverse();
        let lowest = (0..cycle.len()).min_by_key(|at| cycle[*at]);
        cycle.rotate_left(lowest.unwrap_or(0));
        let first = cycle[0];
        let mut path: Vec<String> = cycle.iter().take(SHOWN).map(|body| name(*body)).collect();
        if cycle.len() > SHOWN {
            path.push(format!("... ({} bodies)", cycle.len()));
        }
        path.push(name(first));
        let joint = carried_by[first].unwrap_or(0);
        let key = Key::entry("joint", joint, joints[joint].name.as_deref()).at("parent");
        let problem = format!("the joints form a loop: {}", path.join(" -> "));
        let remedy = "connect one of these bodies with the base instead";
        findings.refuse("E0112", &key, problem, remedy);
    }
}

/// Parents before children, otherwise in file order; bodies in a cycle are dropped.
fn topological(parent_of: &[Option<usize>]) -> Vec<usize> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parent_of.len()];
    let mut ready = BinaryHeap::new();
    for (k, parent) in parent_of.iter().enumerate() {
        match parent {
            Some(parent) => children[*parent].push(k),
            None => ready.push(Reverse(k)),
        }
    }
    let mut order = Vec::with_capacity(parent_of.len());
    while let Some(Reverse(k)) = ready.pop() {
        order.push(k);
        ready.extend(children[k].iter().copied().map(Reverse));
    }
    order
}
