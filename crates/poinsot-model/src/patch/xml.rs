//! Edits of an XML text at the places of its elements. What is not edited keeps its bytes: comments, blanks, order, quotes.

use super::{Measured, Patched, Spring};
use crate::urdf::excess;
use poinsot_spatial::MassProperties;
use roxmltree::{Attribute, Document, Node};
use std::ops::Range;

/// Element of a joint in every format.
const JOINT: &str = "joint";

/// Indices of the tensor elements in the order `xx, xy, xz, yy, yz, zz`.
pub(super) const UPPER: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// How a file states mass properties.
pub(super) struct Format {
    /// Element of a body; its attribute `name` is the body's.
    pub tag: &'static str,
    /// Largest depth of that element; the root has 1.
    pub depth: usize,
    /// The `<inertial>` that states the mass properties in this element; `None` where its axes cannot be read.
    pub wanted: fn(Node<'_, '_>, &MassProperties) -> Option<Wanted>,
    /// A `<joint>` with a spring; `None` where the format has none.
    pub spring: Option<fn(Node<'_, '_>, &Spring) -> Wanted>,
}

/// An element that is edited.
struct Part<'a, 'i> {
    node: Node<'a, 'i>,
    tag: &'static str,
    name: &'a str,
    /// What it is to state; `None` where that cannot be written.
    wanted: Option<Wanted>,
    /// The new numbers, and the element that holds them.
    words: [&'static str; 2],
}

impl Format {
    /// Edits the element of every body and joint, and checks that the written text states the same.
    pub fn patched(&self, text: &str, measured: &Measured) -> Result<Patched, String> {
        let old = document(text)?;
        let (mut all, mut missing) = (Vec::new(), Vec::new());
        for new in &measured.bodies {
            let Some(node) = self.found(&old, self.tag, &new.body) else {
                missing.push(new.body.clone());
                continue;
            };
            let inertial = (self.wanted)(node, &new.properties);
            all.push(Part {
                node,
                tag: self.tag,
                name: &new.body,
                wanted: inertial.map(|inertial| Wanted::holding(self.tag, vec![inertial])),
                words: ["mass, mass centre and inertia", "its <inertial>"],
            });
        }
        if let Some(of) = self.spring {
            for (name, spring) in Spring::all(&measured.numbers) {
                let node = self.found(&old, JOINT, name);
                all.extend(node.map(|node| Part {
                    node,
                    tag: JOINT,
                    name,
                    wanted: Some(of(node, &spring)),
                    words: ["spring", "the joint"],
                }));
            }
        }
        let mut edits = Edits::new();
        for part in &all {
            let wanted = part.wanted.iter();
            wanted.for_each(|wanted| wanted.edit(part.node, &mut edits));
        }
        edits.sort_by_key(|(place, _)| (place.start, place.end));
        edits.dedup_by(|a, b| a.0 == b.0);
        let mut text = text.to_owned();
        for (place, new) in edits.into_iter().rev() {
            text.replace_range(place, &new);
        }
        let again = document(&text)?;
        for part in &all {
            let node = self.found(&again, part.tag, part.name);
            let mut both = part.wanted.iter().zip(node);
            if !both.any(|(wanted, node)| wanted.is_said_by(node)) {
                let (tag, name, [what, place]) = (part.tag, part.name, part.words);
                return Err(format!(
                    "<{tag}> \"{name}\": the new {what} would not be read back; state each element of {place} once"
                ));
            }
        }
        let joints = all.iter().filter(|part| part.tag == JOINT);
        Ok(Patched {
            parts: joints.map(|part| part.name.to_owned()).collect(),
            text,
            missing,
        })
    }

    /// The element of a name; `None` if there is none or several.
    fn found<'a, 'i>(
        &self,
        document: &'a Document<'i>,
        tag: &str,
        name: &str,
    ) -> Option<Node<'a, 'i>> {
        let mut found = document.descendants().filter(|n| {
            n.has_tag_name(tag)
                && n.attribute("name") == Some(name)
                && n.ancestors().filter(Node::is_element).count() <= self.depth
        });
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }
}

/// Parses an XML text after checking its limits.
pub(super) fn document(text: &str) -> Result<Document<'_>, String> {
    if let Some(excess) = excess(text) {
        let before = text.get(..excess.byte).unwrap_or(text);
        let line = 1 + before.matches('\n').count();
        let problem = excess.problem;
        return Err(format!("line {line}: {problem}; simplify the file"));
    }
    Document::parse(text)
        .map_err(|error| format!("this is not XML: {error}; give the robot's file"))
}

/// The child element of a name, if there is exactly one.
fn only<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    let mut found = node.children().filter(|n| n.has_tag_name(name));
    found.next().filter(|_| found.next().is_none())
}

/// Numbers as text that reads back to the same bits.
pub(super) fn words(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
    words.join(" ")
}

/// Bytes of a text, and what takes their place.
type Edits = Vec<(Range<usize>, String)>;

/// What an element is to state; all else that it states stays.
#[derive(Default)]
pub(super) struct Wanted {
    tag: &'static str,
    /// Attributes with their values; `None` where an attribute is removed.
    attributes: Vec<(&'static str, Option<String>)>,
    /// Text in place of all content; empty for no text.
    text: String,
    children: Vec<Wanted>,
}

impl Wanted {
    /// An element with attributes.
    pub fn new(tag: &'static str, attributes: Vec<(&'static str, String)>) -> Self {
        let given = attributes.into_iter();
        Self {
            tag,
            attributes: given.map(|(name, value)| (name, Some(value))).collect(),
            ..Self::default()
        }
    }

    /// An element with child elements; missing ones are put in front, in this order.
    pub fn holding(tag: &'static str, children: Vec<Self>) -> Self {
        Self {
            children,
            ..Self::new(tag, Vec::new())
        }
    }

    /// An element with a text.
    pub fn saying(tag: &'static str, text: String) -> Self {
        Self {
            text,
            ..Self::new(tag, Vec::new())
        }
    }

    /// The same without these attributes.
    pub fn without(mut self, names: &[&'static str]) -> Self {
        self.attributes
            .extend(names.iter().map(|name| (*name, None)));
        self
    }

    /// Whether an element says this, each part once.
    fn is_said_by(&self, node: Node<'_, '_>) -> bool {
        let given = self.attributes.iter();
        let has =
            |(name, value): &(&str, Option<String>)| node.attribute(*name) == value.as_deref();
        let says = |child: &Self| only(node, child.tag).is_some_and(|own| child.is_said_by(own));
        given.into_iter().all(has)
            && (self.text.is_empty() || node.text() == Some(&self.text))
            && self.children.iter().all(says)
    }

    /// A new element, with the prefix of the one around it.
    fn element(&self, prefix: &str) -> String {
        let given = self.attributes.iter();
        let given =
            given.filter_map(|(name, value)| Some(format!(" {name}=\"{}\"", value.as_ref()?)));
        let (tag, attributes) = (self.tag, given.collect::<String>());
        let children = self.children.iter().map(|child| child.element(prefix));
        match self.text.clone() + &children.collect::<String>() {
            content if content.is_empty() => format!("<{prefix}{tag}{attributes}/>"),
            content => format!("<{prefix}{tag}{attributes}>{content}</{prefix}{tag}>"),
        }
    }

    /// Adds the edits of an element that is there.
    fn edit(&self, node: Node<'_, '_>, edits: &mut Edits) {
        let source = node.document().input_text();
        let start = start_tag(source, node.range());
        let head = source.get(start.clone()).unwrap_or_default();
        let name = head.trim_start_matches('<');
        let name = name.split(|c: char| c.is_whitespace() || "/>".contains(c));
        let name = name.into_iter().next().unwrap_or_default();
        let prefix = name
            .strip_suffix(node.tag_name().name())
            .unwrap_or_default();
        let is_empty = head.ends_with("/>");
        let close = start.end - if is_empty { 2 } else { 1 };
        let before = |at: usize| source.get(..at).unwrap_or_default().trim_end().len();
        let mut added = String::new();
        for (name, value) in &self.attributes {
            let old = node
                .attributes()
                .find(|a| a.name() == *name && a.namespace().is_none());
            match (old, value) {
                (Some(old), Some(value)) => edits.push((value_of(source, &old), value.clone())),
                (Some(old), None) => {
                    let place = old.range();
                    edits.push((before(place.start)..place.end, String::new()));
                }
                (None, Some(value)) => added += &format!(" {name}=\"{value}\""),
                (None, None) => {}
            }
        }
        if !added.is_empty() {
            edits.push((before(close)..before(close), added));
        }
        let mut content = self.text.clone();
        for child in &self.children {
            let mut there = node.children().filter(|n| n.has_tag_name(child.tag));
            match there.next() {
                Some(there) => child.edit(there, edits),
                None => content += &child.element(prefix),
            }
        }
        let end_tag = source.get(..node.range().end).and_then(|s| s.rfind("</"));
        let inside = match (self.text.is_empty(), end_tag) {
            (false, Some(end)) => start.end..end,
            _ => start.end..start.end,
        };
        match (content.is_empty(), is_empty) {
            (true, _) => {}
            (false, true) => edits.push((close..start.end, format!(">{content}</{name}>"))),
            (false, false) => edits.push((inside, content)),
        }
    }
}

/// The start tag of an element: to the first `>` outside quotes.
fn start_tag(source: &str, element: Range<usize>) -> Range<usize> {
    let text = source.get(element.clone()).unwrap_or_default();
    let mut quote = None;
    let end = text.bytes().position(|byte| {
        match (quote, byte) {
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if open == byte => quote = None,
            _ => {}
        }
        quote.is_none() && byte == b'>'
    });
    element.start..end.map_or(element.end, |end| element.start + end + 1)
}

/// The value of an attribute, between its quotes.
fn value_of(source: &str, attribute: &Attribute<'_, '_>) -> Range<usize> {
    let (place, last) = (attribute.range(), attribute.range().end - 1);
    let text = source.get(place.start..last).unwrap_or_default();
    let open = text
        .find(['"', '\''])
        .map_or(last, |at| place.start + at + 1);
    open..last
}
