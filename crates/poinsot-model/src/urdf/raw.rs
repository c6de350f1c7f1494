//! The raw file: links and joints with their numbers and positions.

use super::Remark;
use super::limits::excess;
use crate::check_name::misspelt;
use crate::shape::LARGEST;
use crate::vehicle::JointKind;
use poinsot_files::excerpt;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::BTreeMap;

/// Limit on the XML nodes of a file.
const NODES: u32 = 1_000_000;

pub(super) struct Robot {
    pub name: String,
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

pub(super) struct Link {
    pub name: String,
    pub byte: usize,
    pub inertial: Option<Inertial>,
}

/// Mass, pose of the inertial frame, tensor elements in it: xx, xy, xz, yy, yz, zz.
#[derive(Clone)]
pub(super) struct Inertial {
    pub byte: usize,
    pub mass: f64,
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
    pub elements: [f64; 6],
}

#[derive(Clone)]
pub(super) struct Joint {
    pub name: String,
    pub byte: usize,
    pub kind: JointKind,
    pub parent: String,
    pub child: String,
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
    pub axis: [f64; 3],
    /// Whether the origin is that of the parent in the child.
    pub reversed: bool,
}

/// Names of the elements of an inertia in the order of [`Inertial::elements`].
pub(crate) const ELEMENTS: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// Parses the text; `None` if it contains no robot.
pub(super) fn read(text: &str, remarks: &mut Vec<Remark>) -> Option<Robot> {
    if let Some(excess) = excess(text) {
        let remedy = "name a URDF file";
        let (code, byte) = (Some("E0120"), excess.byte);
        remarks.push(Remark::new(code, byte, excess.problem, remedy));
        return None;
    }
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: NODES,
        ..ParsingOptions::default()
    };
    let parsed = Document::parse_with_options(text, options);
    let ill_formed = |error| remarks.push(ill_formed(text, &error));
    let document = parsed.map_err(ill_formed).ok()?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let name = excerpt(root.tag_name().name(), 60);
        let problem = format!("the root element is <{name}>, not <robot>");
        let (byte, code) = (root.range().start, Some("E0103"));
        let remark = Remark::new(code, byte, problem, "give a URDF file");
        remarks.push(remark);
        return None;
    }
    find_xacro(&document, remarks);
    let mut robot = Robot {
        // A title that a model file cannot hold is dropped.
        name: root
            .attribute("name")
            .filter(|name| misspelt(name).is_none())
            .unwrap_or("robot")
            .to_owned(),
        links: Vec::new(),
        joints: Vec::new(),
    };
    let mut ignored: BTreeMap<&str, usize> = BTreeMap::new();
    for node in root.children().filter(Node::is_element) {
        let what = node.tag_name().name();
        let name = node.attribute("name").unwrap_or_default();
        let mut reader = Reader {
            subject: format!("{what} \"{}\"", excerpt(name, 60)),
            remarks,
        };
        match what {
            "link" => robot.links.push(reader.link(node, name)),
            "joint" => robot.joints.extend(reader.joint(node, name)),
            other => *ignored.entry(other).or_default() += 1,
        }
    }
    if !ignored.is_empty() {
        let names: Vec<String> = ignored
            .iter()
            .take(12)
            .map(|(name, n)| format!("{n} <{}>", excerpt(name, 40)))
            .collect();
        let problem = format!("not read: {}", names.join(", "));
        let remark = Remark::new(None, root.range().start, problem, "");
        remarks.push(remark.on("robot"));
    }
    Some(robot)
}

fn ill_formed(text: &str, error: &roxmltree::Error) -> Remark {
    let place = error.pos();
    let start = text
        .match_indices('\n')
        .nth((place.row as usize).saturating_sub(2))
        .map_or(0, |(at, _)| at + 1);
    let start = if place.row <= 1 { 0 } else { start };
    let column = (place.col as usize).saturating_sub(1);
    let byte = text
        .get(start..)
        .and_then(|rest| rest.char_indices().nth(column))
        .map_or(start, |(at, _)| start + at);
    let (problem, remedy) = match error {
        roxmltree::Error::DtdDetected => (
            "the file has a document type definition, which is not supported".to_owned(),
            "take <!DOCTYPE ...> out",
        ),
        roxmltree::Error::NodesLimitReached => (
            format!("the file has more than {NODES} XML nodes"),
            "name a URDF file",
        ),
        roxmltree::Error::UnknownNamespace(prefix, _) if prefix == "xacro" => (
            "the file has xacro tags and does not declare them".to_owned(),
            "expand it: xacro FILE > robot.urdf",
        ),
        other => {
            let mut words = excerpt(&other.to_string(), 160);
            if let Some(at) = words.rfind(" at ") {
                words.truncate(at);
            }
            (format!("not well-formed XML: {words}"), "correct it here")
        }
    };
    Remark::new(Some("E0120"), byte, problem, remedy)
}

/// Elements whose numbers and names are read.
const READ: [&str; 9] = [
    "link", "joint", "inertial", "mass", "inertia", "origin", "axis", "parent", "child",
];

fn is_xacro(text: &str) -> bool {
    text.contains("${") || text.contains("$(")
}

/// Finds xacro tags anywhere, or `${...}` and `$(...)` in names and numbers.
fn find_xacro(document: &Document<'_>, remarks: &mut Vec<Remark>) {
    let is_tag = |n: &Node<'_, '_>| {
        let name = n.tag_name();
        name.name().contains("xacro") || name.namespace().is_some_and(|s| s.contains("xacro"))
    };
    let substitutes = |n: &Node<'_, '_>| {
        let mut values = n.attributes().map(|a| a.value());
        READ.contains(&n.tag_name().name()) && values.any(is_xacro)
    };
    let mut elements = document.descendants().filter(Node::is_element);
    if let Some(node) = elements.find(|n| is_tag(n) || substitutes(n)) {
        let problem = "this is xacro, which has not been expanded";
        let remedy = "run xacro first: xacro FILE > robot.urdf";
        let (byte, code) = (node.range().start, Some("E0121"));
        let remark = Remark::new(code, byte, problem, remedy);
        remarks.push(remark.on(format!("<{}>", excerpt(node.tag_name().name(), 60))));
    }
}

/// Reads one link or joint.
struct Reader<'r> {
    /// What remarks call it.
    subject: String,
    remarks: &'r mut Vec<Remark>,
}

impl Reader<'_> {
    /// The child element of a name; a second one is refused, since it would state the same again.
    fn child<'a, 'i>(&mut self, node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
        let is_named = |n: &Node| n.is_element() && n.tag_name().name() == name;
        let mut all = node.children().filter(is_named);
        let first = all.next();
        if let Some(second) = all.next() {
            let parent = node.tag_name().name();
            let problem = format!("<{}> has two <{name}>", excerpt(parent, 40));
            self.refuse(second, problem, "keep one of them");
        }
        first
    }

    fn refuse(&mut self, node: Node<'_, '_>, problem: String, remedy: &str) {
        self.remark("", refused(node, problem, remedy));
    }

    /// A remark on a part of this link or joint.
    fn remark(&mut self, part: &str, remark: Remark) {
        let subject = format!("{}{part}", self.subject);
        self.remarks.push(remark.on(subject));
    }

    fn link(&mut self, node: Node<'_, '_>, name: &str) -> Link {
        let inertial = self.child(node, "inertial");
        let inertial = inertial.and_then(|inertial| self.inertial(inertial));
        Link {
            name: name.to_owned(),
            byte: node.range().start,
            inertial,
        }
    }

    fn inertial(&mut self, node: Node<'_, '_>) -> Option<Inertial> {
        let mass = match self.child(node, "mass") {
            Some(mass) => self.numbers(mass, "value", None),
            None => {
                let problem = "<inertial> has no <mass value=\"...\">".to_owned();
                self.refuse(node, problem, "add it, kg");
                None
            }
        };
        let mut elements = [0.0; 6];
        let mut whole = true;
        match self.child(node, "inertia") {
            Some(inertia) => {
                for (slot, name) in elements.iter_mut().zip(ELEMENTS) {
                    match self.numbers(inertia, name, None) {
                        Some([x]) => *slot = x,
                        None => whole = false,
                    }
                }
            }
            None => {
                let problem = "<inertial> has no <inertia ixx=...>".to_owned();
                let remedy = "add it, kg m2 about the mass centre";
                self.refuse(node, problem, remedy);
                whole = false;
            }
        }
        let (xyz, rpy) = self.origin(node)?;
        let [mass] = mass?;
        whole.then_some(Inertial {
            byte: node.range().start,
            mass,
            xyz,
            rpy,
            elements,
        })
    }

    fn origin(&mut self, node: Node<'_, '_>) -> Option<([f64; 3], [f64; 3])> {
        let Some(origin) = self.child(node, "origin") else {
            return Some(([0.0; 3], [0.0; 3]));
        };
        let xyz = self.numbers(origin, "xyz", Some([0.0; 3]));
        let rpy = self.numbers(origin, "rpy", Some([0.0; 3]));
        Some((xyz?, rpy?))
    }

    /// Parses exactly `N` finite numbers separated by blanks.
    fn numbers<const N: usize>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        missing: Option<[f64; N]>,
    ) -> Option<[f64; N]> {
        let mut refuse = |problem: String, remedy: &str| {
            let element = excerpt(node.tag_name().name(), 40);
            let mut remark = refused(node, problem, remedy);
            if let Some(text) = node.attribute(name).filter(|text| !text.is_empty()) {
                remark = remark.with_value(text, 60);
            }
            self.remark(&format!(" <{element} {name}>"), remark);
        };
        let Some(text) = node.attribute(name) else {
            if missing.is_none() {
                refuse("the number is missing".to_owned(), "add it");
            }
            return missing;
        };
        let mut values = [0.0; N];
        let mut count = 0;
        for word in text.split_whitespace() {
            match word.parse::<f64>() {
                Ok(x) if x.abs() <= LARGEST => {
                    if let Some(slot) = values.get_mut(count) {
                        *slot = x;
                    }
                    count += 1;
                }
                _ => {
                    let (problem, remedy) = cause(word);
                    refuse(problem, remedy);
                    return None;
                }
            }
        }
        if count != N {
            let remedy = match N {
                1 => "write one number",
                _ => "write three numbers with blanks between them",
            };
            refuse(format!("{count} numbers instead of {N}"), remedy);
            return None;
        }
        Some(values)
    }

    fn joint(&mut self, node: Node<'_, '_>, name: &str) -> Option<Joint> {
        let byte = node.range().start;
        let word = node.attribute("type").unwrap_or_default();
        let kind = match word {
            "revolute" | "continuous" => Some(JointKind::Revolute),
            "prismatic" => Some(JointKind::Prismatic),
            "fixed" => Some(JointKind::Fixed),
            _ => None,
        };
        if kind.is_none() {
            let problem = "this type of joint is not supported";
            let remedy =
                "write revolute, continuous, prismatic or fixed; a base that floats needs no joint";
            let remark = Remark::new(Some("E0122"), byte, problem, remedy);
            self.remark(" type", remark.with_value(word, 40));
        }
        if let Some(mimic) = self.child(node, "mimic") {
            let problem = format!(
                "mimics \"{}\" (multiplier {}, offset {}): it is used as an independent joint, and telemetry needs its column",
                excerpt(mimic.attribute("joint").unwrap_or_default(), 60),
                excerpt(mimic.attribute("multiplier").unwrap_or("1"), 20),
                excerpt(mimic.attribute("offset").unwrap_or("0"), 20),
            );
            self.remark("", Remark::new(None, mimic.range().start, problem, ""));
        }
        let mut end = |which: &str| {
            let end = self.child(node, which);
            if let Some(link) = end.and_then(|n| n.attribute("link")) {
                return link.to_owned();
            }
            let problem = format!("the joint has no <{which} link=\"...\">");
            self.refuse(node, problem, "add it");
            String::new()
        };
        let (parent, child_name) = (end("parent"), end("child"));
        let (xyz, rpy) = self.origin(node).unwrap_or_default();
        let kind = kind.unwrap_or(JointKind::Fixed);
        let axis = self.axis(node, kind).unwrap_or([1.0, 0.0, 0.0]);
        Some(Joint {
            name: name.to_owned(),
            byte,
            kind,
            parent,
            child: child_name,
            xyz,
            rpy,
            axis,
            reversed: false,
        })
    }

    /// Unit axis of a moving joint; default x, as URDF defines.
    fn axis(&mut self, node: Node<'_, '_>, kind: JointKind) -> Option<[f64; 3]> {
        if kind == JointKind::Fixed {
            return None;
        }
        let Some(axis) = self.child(node, "axis") else {
            let problem = "no axis is given: x, the default of URDF";
            let remark = Remark::new(None, node.range().start, problem, "");
            self.remark(" <axis>", remark);
            return None;
        };
        let text = axis.attribute("xyz").unwrap_or("1 0 0");
        let byte = axis.range().start;
        let [x, y, z] = self.numbers(axis, "xyz", Some([1.0, 0.0, 0.0]))?;
        let length = (x * x + y * y + z * z).sqrt();
        let mut note = |code, problem: String, remedy: &str| {
            let remark = Remark::new(code, byte, problem, remedy).with_value(text, 60);
            self.remark(" <axis xyz>", remark);
        };
        if length <= 0.0 || !length.is_finite() {
            let problem = "the axis has no direction".to_owned();
            let remedy = "give its direction in the joint's frame";
            note(Some("E0113"), problem, remedy);
            return None;
        }
        if (length - 1.0).abs() > 1e-6 {
            let problem = format!("the axis has length {length}; it was made a unit vector");
            note(None, problem, "");
        }
        Some([x / length, y / length, z / length])
    }
}

/// The fault of an element.
fn refused(node: Node<'_, '_>, problem: String, remedy: &str) -> Remark {
    Remark::new(Some("E0107"), node.range().start, problem, remedy)
}

fn cause(word: &str) -> (String, &'static str) {
    let (what, remedy) = match word.parse::<f64>() {
        _ if is_xacro(word) => ("is xacro", "run xacro first: xacro FILE > robot.urdf"),
        _ if word.contains(',') => (
            "has a comma",
            "write a decimal point, and blanks between numbers",
        ),
        Ok(x) if x.is_finite() => (
            "is larger than 1e30",
            "check its unit: all quantities are SI",
        ),
        Ok(_) => ("is not finite", "write a finite number"),
        Err(_) => ("is not a number", "write a decimal number"),
    };
    (format!("'{}' {what}", excerpt(word, 40)), remedy)
}
