//! Edits of an XML text that leave all other bytes unchanged.

use super::{BodyProperties, Patched};
use crate::urdf::excess;
use poinsot_spatial::MassProperties;
use roxmltree::{Document, Node};
use std::ops::Range;

/// Parses an XML text after checking its limits.
pub(super) fn document(text: &str) -> Result<Document<'_>, String> {
    if let Some(excess) = excess(text) {
        let line = 1 + text.as_bytes()[..excess.byte.min(text.len())]
            .iter()
            .filter(|b| **b == b'\n')
            .count();
        return Err(format!(
            "line {line}: {}; simplify the file",
            excess.problem
        ));
    }
    Document::parse(text)
        .map_err(|error| format!("this is not XML: {error}; give the robot's file"))
}

/// The first child element of a name.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children()
        .find(|n| n.is_element() && n.tag_name().name() == name)
}

/// The element with this tag and `name`, anywhere in the document; `None` if there is none or several.
pub(super) fn named<'a, 'i>(
    document: &'a Document<'i>,
    tag: &str,
    name: &str,
) -> Option<Node<'a, 'i>> {
    let mut found = document
        .descendants()
        .filter(|n| n.has_tag_name(tag) && n.attribute("name") == Some(name));
    let first = found.next()?;
    found.next().is_none().then_some(first)
}

/// Edits the element of every body; a body without one is missing.
pub(super) fn patched<'a, 'i: 'a>(
    text: &str,
    bodies: &[BodyProperties],
    find: impl Fn(&str) -> Option<Node<'a, 'i>>,
    edit: impl Fn(Node<'a, 'i>, &MassProperties, &mut Edits),
) -> Patched {
    let mut edits = Edits::new(text);
    let mut missing = Vec::new();
    for new in bodies {
        match find(&new.body) {
            Some(element) => edit(element, &new.properties, &mut edits),
            None => missing.push(new.body.clone()),
        }
    }
    Patched {
        text: edits.finish(),
        missing,
    }
}

/// Edits of a text, collected and then applied together.
pub(super) struct Edits<'t> {
    text: &'t str,
    edits: Vec<(Range<usize>, String)>,
}

impl<'t> Edits<'t> {
    pub fn new(text: &'t str) -> Self {
        Self {
            text,
            edits: Vec::new(),
        }
    }

    /// Replaces the value of an attribute, or adds it after the tag's name.
    pub fn set(&mut self, node: Node<'_, '_>, name: &str, value: &str) {
        match node.attribute_node(name) {
            Some(attribute) => self.edits.push((attribute.range_value(), value.to_owned())),
            None => {
                let at = node.range().start + 1 + node.tag_name().name().len();
                self.edits.push((at..at, format!(" {name}=\"{value}\"")));
            }
        }
    }

    /// Removes an attribute and the preceding blank.
    pub fn remove(&mut self, node: Node<'_, '_>, name: &str) {
        if let Some(attribute) = node.attribute_node(name) {
            let range = attribute.range();
            let before = self.text.get(..range.start).unwrap_or_default();
            let blank = before.len() - before.trim_end().len();
            self.edits
                .push((range.start - blank..range.end, String::new()));
        }
    }

    /// Replaces an element.
    pub fn replace(&mut self, node: Node<'_, '_>, element: String) {
        self.edits.push((node.range(), element));
    }

    /// Inserts an element as first child of another, which may be self-closing.
    pub fn insert_inside(&mut self, node: Node<'_, '_>, element: &str) {
        let range = node.range();
        if let Some(first) = node.first_child() {
            let at = first.range().start;
            self.edits.push((at..at, element.to_owned()));
            return;
        }
        let whole = self.text.get(range.clone()).unwrap_or_default();
        let name = node.tag_name().name();
        if whole.ends_with("/>") {
            let at = range.end - 2;
            self.edits
                .push((at..range.end, format!(">{element}</{name}>")));
        } else if let Some(close) = whole.rfind("</") {
            let at = range.start + close;
            self.edits.push((at..at, element.to_owned()));
        }
    }

    /// The text with all edits.
    pub fn finish(mut self) -> String {
        self.edits.sort_by_key(|e| e.0.start);
        let mut out = String::with_capacity(self.text.len() + 256);
        let mut at = 0;
        for (range, new) in &self.edits {
            out.push_str(self.text.get(at..range.start).unwrap_or_default());
            out.push_str(new);
            at = range.end;
        }
        out.push_str(self.text.get(at..).unwrap_or_default());
        out
    }
}
