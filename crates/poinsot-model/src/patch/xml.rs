//! Edits on the tree of an XML text. What is not edited keeps its bytes: comments, blanks, order, quotes.

use super::{BodyProperties, Patched};
use crate::urdf::{ELEMENTS, excess};
use poinsot_spatial::{MassProperties, Matrix3};
use quick_xml::events::{BytesStart, BytesText, Event};
use quick_xml::{Reader, Writer};
use roxmltree::{Document, Node};
use std::ops::Range;

/// Largest relative change of a tensor element by rotation and back.
const ROUNDING: f64 = 1.0e-12;

/// Indices of the tensor elements in the order `xx, xy, xz, yy, yz, zz`.
pub(super) const UPPER: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// How a file states mass properties.
pub(super) struct Format {
    /// Element of a body; its attribute `name` is the body's.
    pub tag: &'static str,
    /// Largest depth of that element; the root has 1.
    pub depth: usize,
    /// Writes the mass properties into the element, as far as it can.
    pub edit: fn(Element<'_>, &MassProperties),
    /// Reads them; `None` if they are not there exactly once.
    pub read: fn(Node<'_, '_>) -> Option<MassProperties>,
}

impl Format {
    /// Edits the element of every body, and reads the written text back.
    pub fn patched(&self, text: &str, bodies: &[BodyProperties]) -> Result<Patched, String> {
        let old = document(text)?;
        let (there, absent): (Vec<_>, Vec<_>) = bodies
            .iter()
            .partition(|new| self.found(&old, &new.body).is_some());
        let unread = |why| format!("this is not XML: {why}; give the robot's file");
        let mut events = events(text).map_err(|error| unread(error.to_string()))?;
        for new in &there {
            if let Some(at) = self.place(&events, &new.body) {
                let events = &mut events;
                (self.edit)(Element { events, at }, &new.properties);
            }
        }
        let text = self::text(events, text).map_err(|error| unread(error.to_string()))?;
        let written = document(&text)?;
        for new in there {
            let read = self.found(&written, &new.body).and_then(self.read);
            if !read.is_some_and(|read| is_same(&read, &new.properties)) {
                return Err(format!(
                    "<{}> \"{}\": the new mass, mass centre and inertia would not be read back; state each element of its <inertial> once",
                    self.tag, new.body
                ));
            }
        }
        Ok(Patched {
            text,
            missing: absent.into_iter().map(|new| new.body.clone()).collect(),
        })
    }

    /// The place of the first element of a body.
    fn place(&self, events: &[Event<'_>], body: &str) -> Option<usize> {
        let mut depth = 0;
        events.iter().position(|event| {
            match event {
                Event::Start(_) => depth += 1,
                Event::End(_) => depth -= 1,
                _ => {}
            }
            let (tag, depth) = match event {
                Event::Start(tag) => (tag, depth),
                Event::Empty(tag) => (tag, depth + 1),
                _ => return false,
            };
            let name = tag.try_get_attribute("name").ok().flatten();
            depth <= self.depth
                && is(tag, self.tag)
                && name.is_some_and(|a| a.unescape_value().is_ok_and(|name| name == body))
        })
    }

    /// The element of a body; `None` if there is none or several.
    fn found<'a, 'i>(&self, document: &'a Document<'i>, body: &str) -> Option<Node<'a, 'i>> {
        let mut found = document.descendants().filter(|n| {
            n.has_tag_name(self.tag)
                && n.attribute("name") == Some(body)
                && n.ancestors().filter(Node::is_element).count() <= self.depth
        });
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }
}

fn is_same(read: &MassProperties, new: &MassProperties) -> bool {
    let rounding = ROUNDING * new.I_BBcm_B.amax();
    read.mass == new.mass
        && read.p_BoBcm_B == new.p_BoBcm_B
        && (read.I_BBcm_B - new.I_BBcm_B).amax() <= rounding
}

/// Parses an XML text after checking its limits.
pub(super) fn document(text: &str) -> Result<Document<'_>, String> {
    if let Some(excess) = excess(text) {
        let before = text.get(..excess.byte).unwrap_or(text);
        let line = 1 + before.matches('\n').count();
        return Err(format!(
            "line {line}: {}; simplify the file",
            excess.problem
        ));
    }
    Document::parse(text)
        .map_err(|error| format!("this is not XML: {error}; give the robot's file"))
}

/// The child element of a name, if there is exactly one.
pub(super) fn only<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    let mut found = node.children().filter(|n| n.has_tag_name(name));
    found.next().filter(|_| found.next().is_none())
}

/// Numbers of an attribute or a text.
pub(super) fn numbers<const N: usize>(text: Option<&str>) -> Option<[f64; N]> {
    let words = text?.split_whitespace();
    let all: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
    all?.try_into().ok()
}

/// The tensor of `xx, xy, xz, yy, yz, zz`.
pub(super) fn symmetric([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Matrix3 {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// The tensor whose elements have the names of URDF and SDF.
pub(super) fn tensor<'t>(text: impl Fn(&str) -> Option<&'t str>) -> Option<Matrix3> {
    let mut elements = [0.0; 6];
    for (element, name) in elements.iter_mut().zip(ELEMENTS) {
        [*element] = numbers(text(name))?;
    }
    Some(symmetric(elements))
}

/// Numbers as text that reads back to the same bits.
pub(super) fn words(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
    words.join(" ")
}

/// An element in the list of what a text consists of; children are what stands before its end tag.
pub(super) struct Element<'t> {
    events: &'t mut Vec<Event<'static>>,
    at: usize,
}

impl Element<'_> {
    /// Gives a self-closing element an end tag.
    fn open(&mut self) {
        if let Some(Event::Empty(tag)) = self.events.get(self.at) {
            let (tag, end) = (tag.clone(), tag.to_end().into_owned());
            let opened = [Event::Start(tag), Event::End(end)];
            self.events.splice(self.at..=self.at, opened);
        }
    }

    /// The first child element of a name; a new one in front if there is none.
    pub fn child(&mut self, name: &str) -> Element<'_> {
        self.open();
        let at = self.scan(name).unwrap_or_else(|_| {
            let prefix = self.tag().and_then(|tag| tag.name().prefix().map(text_of));
            let name = prefix.map_or(name.to_owned(), |prefix| format!("{prefix}:{name}"));
            let new = Event::Empty(BytesStart::new(name));
            self.events.insert(self.at + 1, new);
            self.at + 1
        });
        let events = &mut *self.events;
        Element { events, at }
    }

    /// Makes missing children, in this order.
    pub fn with_children(mut self, names: &[&str]) -> Self {
        for name in names.iter().rev() {
            self.child(name);
        }
        self
    }

    /// The value of an attribute as written.
    pub fn attribute(&self, name: &str) -> Option<String> {
        let value = self.placed(name)?.value;
        self.tag().and_then(|tag| tag.get(value)).map(text_of)
    }

    /// Replaces the value of an attribute, or adds the attribute.
    pub fn set(&mut self, name: &str, value: String) {
        match self.placed(name) {
            Some(old) => self.write(old.value, &value),
            None => {
                let end = self.tag().map_or(0, |tag| tag.trim_ascii_end().len());
                self.write(end..end, &format!(" {name}=\"{value}\""));
            }
        }
    }

    /// Removes attributes.
    pub fn remove(&mut self, names: &[&str]) {
        for name in names {
            if let Some(old) = self.placed(name) {
                self.write(old.whole, "");
            }
        }
    }

    /// Replaces the content of a child element by a text.
    pub fn set_text(&mut self, name: &str, text: &str) {
        let mut child = self.child(name);
        child.open();
        let end = child.scan("").unwrap_or_else(|end| end);
        let text = Event::Text(BytesText::new(text).into_owned());
        child.events.splice(child.at + 1..end, [text]);
    }

    /// The index of the first child of a name; otherwise that of the end tag.
    fn scan(&self, name: &str) -> Result<usize, usize> {
        let mut depth = 0;
        for (k, event) in self.events.iter().enumerate().skip(self.at + 1) {
            match event {
                Event::Start(tag) | Event::Empty(tag) if depth == 0 && is(tag, name) => {
                    return Ok(k);
                }
                Event::End(_) if depth == 0 => return Err(k),
                Event::Start(_) => depth += 1,
                Event::End(_) => depth -= 1,
                _ => {}
            }
        }
        Err(self.events.len())
    }

    fn tag(&self) -> Option<&BytesStart<'static>> {
        match self.events.get(self.at) {
            Some(Event::Start(tag) | Event::Empty(tag)) => Some(tag),
            _ => None,
        }
    }

    /// Where an attribute stands in its tag.
    fn placed(&self, name: &str) -> Option<Placed> {
        let tag = self.tag()?;
        let mut all = tag.attributes().flatten();
        let found = all.find(|a| a.key.as_ref() == name.as_bytes())?;
        let at = |part: &[u8]| (part.as_ptr() as usize).checked_sub(tag.as_ptr() as usize);
        let (key, value) = (at(found.key.as_ref())?, at(&found.value)?);
        let end = value + found.value.len();
        let before = tag.get(..key)?.trim_ascii_end().len();
        Some(Placed {
            whole: before..end + 1,
            value: value..end,
        })
    }

    /// Replaces a part of the tag.
    fn write(&mut self, part: Range<usize>, new: &str) {
        if let Some(Event::Start(tag) | Event::Empty(tag)) = self.events.get_mut(self.at) {
            let (mut text, name) = (text_of(&**tag), tag.name().as_ref().len());
            text.replace_range(part, new);
            *tag = BytesStart::from_content(text, name);
        }
    }
}

/// Bytes of an attribute in its tag.
struct Placed {
    /// From the blank before its name to its last quote.
    whole: Range<usize>,
    value: Range<usize>,
}

fn text_of(bytes: impl AsRef<[u8]>) -> String {
    String::from_utf8_lossy(bytes.as_ref()).into_owned()
}

fn is(tag: &BytesStart<'_>, name: &str) -> bool {
    tag.local_name().as_ref() == name.as_bytes()
}

/// What a text consists of, in order.
fn events(text: &str) -> quick_xml::Result<Vec<Event<'static>>> {
    let mut reader = Reader::from_str(text);
    // The other reader has matched the tags.
    reader.config_mut().check_end_names = false;
    reader.config_mut().trim_markup_names_in_closing_tags = false;
    let mut events = Vec::new();
    loop {
        match reader.read_event()? {
            Event::Eof => return Ok(events),
            event => events.push(event.into_owned()),
        }
    }
}

/// The text of what [`events`] gave, with the byte order mark of the first.
fn text(events: Vec<Event<'static>>, first: &str) -> std::io::Result<String> {
    let mut writer = Writer::new(Vec::new());
    if first.starts_with('\u{feff}') {
        writer.write_bom()?;
    }
    for event in events {
        writer.write_event(event)?;
    }
    String::from_utf8(writer.into_inner()).map_err(std::io::Error::other)
}
