//! Checks that the links form one tree, and that link and joint names are unique.

use super::Remark;
use super::raw::{Joint, Robot};
use crate::check::MOST_BODIES;
use crate::check_name::misspelt;
use poinsot_files::excerpt;
use std::collections::{HashMap, HashSet};

/// The tree, in file indices.
#[derive(Default)]
pub(super) struct Order {
    /// Links: root first, parents before children.
    pub links: Vec<usize>,
    /// The joint whose child is this link.
    pub carried_by: Vec<Option<usize>>,
}

pub(super) fn check(robot: &Robot, remarks: &mut Vec<Remark>) -> Order {
    let mut tree = Tree::new(robot, remarks);
    if robot.links.len() > MOST_BODIES {
        let problem = format!("the file has {} links", robot.links.len());
        tree.refuse(WHOLE, problem, "keep to 10000 links");
        return Order::default();
    }
    tree.check_names();
    let (carried_by, children) = tree.attach();
    let roots = tree.roots(&carried_by);
    let mut links: Vec<usize> = roots.iter().copied().take(1).collect();
    let mut at = 0;
    while let Some(&link) = links.get(at) {
        at += 1;
        links.extend(children.get(link).into_iter().flatten().copied());
    }
    if roots.len() == 1 {
        tree.refuse_unreached(&links);
    }
    Order { links, carried_by }
}

/// Code and position of a remark.
type Place = (&'static str, usize);

/// Too many links.
const WHOLE: Place = ("E0119", 0);
/// Links that are not connected to one base.
const NO_TREE: Place = ("E0112", 0);

/// Number of link names listed in a message.
const LISTED: usize = 8;
/// Characters of a name in a message.
const NAME: usize = 60;

struct Tree<'a> {
    robot: &'a Robot,
    /// The first link with each name.
    index: HashMap<&'a str, usize>,
    remarks: &'a mut Vec<Remark>,
}

impl<'a> Tree<'a> {
    fn new(robot: &'a Robot, remarks: &'a mut Vec<Remark>) -> Self {
        let links = robot.links.iter().enumerate().rev();
        Self {
            robot,
            index: links.map(|(k, l)| (l.name.as_str(), k)).collect(),
            remarks,
        }
    }

    fn push(&mut self, place: Place, subject: String, problem: String, remedy: &str) {
        let (code, byte) = place;
        let remark = Remark::new(Some(code), byte, problem, remedy);
        self.remarks.push(remark.on(subject));
    }

    fn refuse(&mut self, place: Place, problem: String, remedy: &str) {
        self.push(place, "robot".to_owned(), problem, remedy);
    }

    /// Checks that link and joint names are valid and unique.
    fn check_names(&mut self) {
        let links = self.robot.links.iter().map(|l| (l.name.as_str(), l.byte));
        let joints = self.robot.joints.iter().map(|j| (j.name.as_str(), j.byte));
        for (what, list) in [
            ("link", links.collect::<Vec<_>>()),
            ("joint", joints.collect()),
        ] {
            let mut seen = HashSet::new();
            for (name, byte) in list {
                let (code, problem, remedy) = if name.trim().is_empty() {
                    ("E0109", format!("a {what} without name"), "give it a name")
                } else if let Some(problem) = misspelt(name) {
                    ("E0109", problem.to_owned(), "give it a plain name")
                } else if !seen.insert(name) {
                    ("E0110", format!("two {what}s have this name"), "rename one")
                } else {
                    continue;
                };
                let subject = format!("{what} \"{}\"", excerpt(name, NAME));
                self.push((code, byte), subject, problem, remedy);
            }
        }
    }

    /// The joint whose child is each link, and the children of each link.
    fn attach(&mut self) -> (Vec<Option<usize>>, Vec<Vec<usize>>) {
        let robot = self.robot;
        let mut carried_by: Vec<Option<usize>> = vec![None; robot.links.len()];
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); robot.links.len()];
        for (k, joint) in robot.joints.iter().enumerate() {
            let parent = self.find(joint, "parent", &joint.parent);
            let child = self.find(joint, "child", &joint.child);
            let Some((child, slot)) = child.and_then(|c| Some((c, carried_by.get_mut(c)?))) else {
                continue;
            };
            if let Some(first) = *slot {
                let other = robot.joints.get(first).map_or("", |j| j.name.as_str());
                let problem = format!(
                    "link \"{}\" has two parents: it is also the child of joint \"{}\"",
                    excerpt(&joint.child, NAME),
                    excerpt(other, NAME)
                );
                let remedy = "remove one of the joints; closed loops are not supported";
                let place = ("E0112", joint.byte);
                self.push(place, named(joint), problem, remedy);
                continue;
            }
            *slot = Some(k);
            if let Some(list) = parent.and_then(|p| children.get_mut(p)) {
                list.push(child);
            }
        }
        (carried_by, children)
    }

    fn find(&mut self, joint: &Joint, which: &str, name: &str) -> Option<usize> {
        let found = self.index.get(name).copied();
        if found.is_none() && !name.is_empty() {
            let subject = format!("{} <{which}>", named(joint));
            let problem = format!("there is no link \"{}\"", excerpt(name, NAME));
            let place = ("E0111", joint.byte);
            self.push(place, subject, problem, "name a link of the file");
        }
        found
    }

    /// Whether a link is the first with its name; a duplicate has no parent for that reason.
    fn is_first(&self, k: usize) -> bool {
        let link = self.robot.links.get(k);
        link.and_then(|l| self.index.get(l.name.as_str())) == Some(&k)
    }

    /// Links without parent; exactly one is allowed.
    fn roots(&mut self, carried_by: &[Option<usize>]) -> Vec<usize> {
        let roots: Vec<usize> = (0..self.robot.links.len())
            .filter(|&k| carried_by.get(k) == Some(&None) && self.is_first(k))
            .collect();
        let (problem, remedy) = match roots.len() {
            1 => return roots,
            0 if self.robot.links.is_empty() => ("the robot has no link".to_owned(), "add <link>"),
            0 => (
                "no link is the base: the joints form a loop".to_owned(),
                "remove one of the joints",
            ),
            n => (
                format!("{n} links have no parent: {}", self.names(&roots)),
                "connect them by joints of type fixed; one link is the base",
            ),
        };
        self.refuse(NO_TREE, problem, remedy);
        roots
    }

    fn refuse_unreached(&mut self, reached: &[usize]) {
        let reached: HashSet<usize> = reached.iter().copied().collect();
        let lost: Vec<usize> = (0..self.robot.links.len())
            .filter(|k| !reached.contains(k) && self.is_first(*k))
            .collect();
        if !lost.is_empty() {
            let problem = format!("the joints of {} form a loop", self.names(&lost));
            self.refuse(NO_TREE, problem, "remove one of the joints");
        }
    }

    fn names(&self, list: &[usize]) -> String {
        let links = list.iter().take(LISTED);
        let links = links.filter_map(|&k| self.robot.links.get(k));
        let names: Vec<String> = links
            .map(|l| format!("\"{}\"", excerpt(&l.name, NAME)))
            .collect();
        names.join(", ")
    }
}

fn named(joint: &Joint) -> String {
    format!("joint \"{}\"", excerpt(&joint.name, NAME))
}
