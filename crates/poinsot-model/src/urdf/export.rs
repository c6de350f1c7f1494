//! Mass properties written into a URDF file; every other byte stays as it is.

use super::inertial::rotation;
use super::raw::ELEMENTS;
use poinsot_spatial::MassProperties;
use roxmltree::{Document, Node};
use std::ops::Range;

/// New mass properties of a link, in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkInertial {
    /// Name of the link.
    pub link: String,
    /// Mass, mass centre, central inertia.
    pub properties: MassProperties,
}

/// The file with new mass properties.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UrdfExport {
    /// The text.
    pub text: String,
    /// Links that the file does not have.
    pub missing: Vec<String>,
}

/// Puts mass properties into the text of a URDF file that was read without error before.
///
/// The axes of an `<inertial>` (its `rpy`) stay; the tensor is turned into them. What is missing (`<inertial>`,
/// `<origin>`, an element) is added.
pub fn export_urdf(text: &str, links: &[LinkInertial]) -> UrdfExport {
    let unchanged = |missing| UrdfExport {
        text: text.to_owned(),
        missing,
    };
    let names = || links.iter().map(|l| l.link.clone()).collect();
    let Ok(document) = Document::parse(text) else {
        return unchanged(names());
    };
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    let mut missing = Vec::new();
    for new in links {
        let link = document.root_element().children().find(|n| {
            n.tag_name().name() == "link" && n.attribute("name") == Some(new.link.as_str())
        });
        match link {
            Some(link) => edit_link(text, link, &new.properties, &mut edits),
            None => missing.push(new.link.clone()),
        }
    }
    edits.sort_by_key(|e| e.0.start);
    let mut out = String::with_capacity(text.len() + 256);
    let mut at = 0;
    for (range, new) in &edits {
        out.push_str(text.get(at..range.start).unwrap_or_default());
        out.push_str(new);
        at = range.end;
    }
    out.push_str(text.get(at..).unwrap_or_default());
    UrdfExport { text: out, missing }
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children()
        .find(|n| n.is_element() && n.tag_name().name() == name)
}

fn edit_link(
    text: &str,
    link: Node<'_, '_>,
    new: &MassProperties,
    edits: &mut Vec<(Range<usize>, String)>,
) {
    let c = &new.p_BoBcm_B;
    let centre = format!("{:?} {:?} {:?}", c.x, c.y, c.z);
    let Some(inertial) = child(link, "inertial") else {
        let whole = format!(
            "<inertial><origin xyz=\"{centre}\"/><mass value=\"{:?}\"/>{}</inertial>",
            new.mass,
            tensor_element(new, [0.0; 3])
        );
        insert_inside(text, link, &whole, edits);
        return;
    };
    let origin = child(inertial, "origin");
    let rpy = origin
        .and_then(|o| o.attribute("rpy"))
        .map(|t| {
            t.split_whitespace()
                .filter_map(|w| w.parse().ok())
                .collect::<Vec<f64>>()
        })
        .and_then(|v| <[f64; 3]>::try_from(v).ok())
        .unwrap_or_default();
    match origin {
        Some(origin) => set(origin, "xyz", &centre, edits),
        None => insert_inside(
            text,
            inertial,
            &format!("<origin xyz=\"{centre}\"/>"),
            edits,
        ),
    }
    match child(inertial, "mass") {
        Some(mass) => set(mass, "value", &format!("{:?}", new.mass), edits),
        None => insert_inside(
            text,
            inertial,
            &format!("<mass value=\"{:?}\"/>", new.mass),
            edits,
        ),
    }
    match child(inertial, "inertia") {
        Some(inertia) => {
            for (name, value) in ELEMENTS.iter().zip(elements(new, rpy)) {
                set(inertia, name, &format!("{value:?}"), edits);
            }
        }
        None => insert_inside(text, inertial, &tensor_element(new, rpy), edits),
    }
}

/// Tensor elements in the axes of the inertial frame.
fn elements(new: &MassProperties, rpy: [f64; 3]) -> [f64; 6] {
    let i = if rpy == [0.0; 3] {
        new.I_BBcm_B
    } else {
        let turn = rotation(rpy);
        turn.transpose() * new.I_BBcm_B * turn
    };
    [
        i[(0, 0)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 1)],
        i[(1, 2)],
        i[(2, 2)],
    ]
}

fn tensor_element(new: &MassProperties, rpy: [f64; 3]) -> String {
    let attributes: Vec<String> = ELEMENTS
        .iter()
        .zip(elements(new, rpy))
        .map(|(name, value)| format!("{name}=\"{value:?}\""))
        .collect();
    format!("<inertia {}/>", attributes.join(" "))
}

/// Replaces the value of an attribute, or adds it after the tag's name.
fn set(node: Node<'_, '_>, name: &str, value: &str, edits: &mut Vec<(Range<usize>, String)>) {
    match node.attribute_node(name) {
        Some(attribute) => edits.push((attribute.range_value(), value.to_owned())),
        None => {
            let at = node.range().start + 1 + node.tag_name().name().len();
            edits.push((at..at, format!(" {name}=\"{value}\"")));
        }
    }
}

/// Puts an element first inside of another, whose tag may close itself.
fn insert_inside(
    text: &str,
    node: Node<'_, '_>,
    element: &str,
    edits: &mut Vec<(Range<usize>, String)>,
) {
    let range = node.range();
    if let Some(first) = node.first_child() {
        let at = first.range().start;
        edits.push((at..at, element.to_owned()));
        return;
    }
    let whole = text.get(range.clone()).unwrap_or_default();
    let name = node.tag_name().name();
    if whole.ends_with("/>") {
        let at = range.end - 2;
        edits.push((at..range.end, format!(">{element}</{name}>")));
    } else if let Some(close) = whole.rfind("</") {
        let at = range.start + close;
        edits.push((at..at, element.to_owned()));
    }
}
