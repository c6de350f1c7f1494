//! Limits that protect the XML reader, checked in one pass before a tree is built. The reader's time grows with depth
//! times namespaces, and with the square of an element's attributes.

use quick_xml::Reader;
use quick_xml::events::Event;

/// Limit on the nesting of elements; URDF needs 6.
const DEPTH: usize = 64;
/// Limit on the attributes of an element, including namespace declarations; URDF needs 6.
const ATTRIBUTES: usize = 64;
/// Limit on the namespace declarations of a file.
const NAMESPACES: usize = 64;

/// The exceeded limit, and its byte offset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Excess {
    pub byte: usize,
    pub problem: String,
}

/// The first exceeded limit of a text. Malformed text is counted up to its fault, at which the XML reader stops too.
pub(crate) fn excess(text: &str) -> Option<Excess> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().check_end_names = false;
    let (mut depth, mut namespaces) = (0_usize, 0);
    loop {
        let byte = reader.buffer_position();
        let (tag, closed) = match reader.read_event() {
            Ok(Event::Start(tag)) => (tag, 0),
            Ok(Event::Empty(tag)) => (tag, 1),
            Ok(Event::End(_)) => {
                depth = depth.saturating_sub(1);
                continue;
            }
            Ok(Event::Eof) | Err(_) => return None,
            Ok(_) => continue,
        };
        depth += 1;
        let mut attributes = 0;
        for attribute in tag.attributes().with_checks(false) {
            attributes += 1;
            namespaces +=
                usize::from(attribute.is_ok_and(|a| a.key.as_ref().starts_with(b"xmlns")));
        }
        let counted = [
            (depth, DEPTH, "elements inside each other"),
            (attributes, ATTRIBUTES, "attributes of one element"),
            (namespaces, NAMESPACES, "declarations of namespaces"),
        ];
        if let Some((_, limit, what)) = counted.into_iter().find(|(n, limit, _)| n > limit) {
            return Some(Excess {
                byte: usize::try_from(byte).unwrap_or(text.len()),
                problem: format!("more than {limit} {what}"),
            });
        }
        depth -= closed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> Option<String> {
        excess(text).map(|e| e.problem)
    }

    #[test]
    fn exact_limits_are_counted_as_xml_counts() {
        let nested = |n: usize| "<a>".repeat(n) + &"</a>".repeat(n);
        assert_eq!(problem(&nested(DEPTH)), None);
        let deep = Some("more than 64 elements inside each other".to_owned());
        assert_eq!(problem(&nested(DEPTH + 1)), deep);
        let attributes = |n: usize| {
            let all: String = (0..n).map(|k| format!(" a{k}='>'")).collect();
            format!("<robot{all}/>")
        };
        assert_eq!(problem(&attributes(ATTRIBUTES)), None);
        let many = Some("more than 64 attributes of one element".to_owned());
        assert_eq!(problem(&attributes(ATTRIBUTES + 1)), many);
        let spaces = |n: usize| {
            let all: String = (0..n)
                .map(|k| format!("<b xmlns:n{k} = \"u{k}\" c='1'/>"))
                .collect();
            format!("<robot>{all}</robot>")
        };
        assert_eq!(problem(&spaces(NAMESPACES)), None);
        let named = Some("more than 64 declarations of namespaces".to_owned());
        assert_eq!(problem(&spaces(NAMESPACES + 1)), named);
    }

    #[test]
    fn exact_what_is_no_tag_is_not_counted() {
        let text = format!(
            "<?xml version='1.0'?><!-- {0} --><robot><![CDATA[{0}]]>{1}</robot>",
            "<a>".repeat(100),
            "<link name='a/'></link><joint/>".repeat(1000)
        );
        assert_eq!(problem(&text), None);
    }

    #[test]
    fn prop_any_cut_of_a_text_ends() {
        let text = "<?xml?><!DOCTYPE r><!-- x --><r a='1' xmlns:b = \"ü\"><![CDATA[<]]><b:c/></r>";
        for (at, _) in text.char_indices() {
            assert_eq!(problem(text.get(..at).unwrap_or_default()), None);
            assert_eq!(problem(text.get(at..).unwrap_or_default()), None);
        }
    }

    /// Before the limits, 79 kB took 8 s and 100,000 attributes 16 s.
    #[test]
    fn regress_nested_namespaces_and_many_attributes_are_refused_at_once() {
        let nested: String = (0..4000).map(|k| format!("<a xmlns:n{k}=\"u\">")).collect();
        let wide: String = (0..100_000).map(|k| format!(" a{k}=\"\"")).collect();
        for text in [format!("<robot>{nested}"), format!("<robot{wide}/>")] {
            let started = std::time::Instant::now();
            let read = super::super::parse_urdf(&text, "r.urdf");
            let error = read.model.err().map(|e| e.to_string()).unwrap_or_default();
            assert!(error.starts_with("E0120 r.urdf:1:"), "{error}");
            assert!(error.contains("more than 64"), "{error}");
            assert!(started.elapsed().as_secs() < 4);
        }
    }
}
