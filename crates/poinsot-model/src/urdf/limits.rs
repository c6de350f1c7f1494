//! Limits that protect the XML reader, checked in one pass before a tree is built. The reader's time grows with depth
//! times namespaces, and with the square of an element's attributes.

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

/// The first exceeded limit of a text. For malformed text the result is arbitrary, because the XML reader rejects it
/// anyway.
pub(crate) fn excess(text: &str) -> Option<Excess> {
    let (mut depth, mut namespaces, mut at) = (0_usize, 0_usize, 0_usize);
    let over = |byte, count: &str, limit| {
        Some(Excess {
            byte,
            problem: format!("more than {limit} {count}"),
        })
    };
    while let Some(start) = find(text, at, "<") {
        at = match skipped(text, start) {
            Skip::Past(end) => end,
            Skip::Close(end) => {
                depth = depth.saturating_sub(1);
                end
            }
            Skip::Open => {
                let tag = tag(text, start);
                namespaces += tag.namespaces;
                depth += 1;
                if depth > DEPTH {
                    return over(start, "elements inside each other", DEPTH);
                }
                if tag.attributes > ATTRIBUTES {
                    return over(start, "attributes of one element", ATTRIBUTES);
                }
                if namespaces > NAMESPACES {
                    return over(start, "declarations of namespaces", NAMESPACES);
                }
                depth -= usize::from(tag.closed);
                tag.end
            }
        };
    }
    None
}

/// Markup that starts with `<`.
enum Skip {
    /// Comment, CDATA, processing instruction or declaration that ends at this byte.
    Past(usize),
    /// End tag that ends at this byte.
    Close(usize),
    /// A start tag.
    Open,
}

fn skipped(text: &str, start: usize) -> Skip {
    let rest = text.get(start..).unwrap_or_default();
    for (begin, end) in [
        ("<!--", "-->"),
        ("<![CDATA[", "]]>"),
        ("<?", "?>"),
        ("<!", ">"),
    ] {
        if rest.starts_with(begin) {
            return Skip::Past(past(text, start + begin.len(), end));
        }
    }
    match rest.starts_with("</") {
        true => Skip::Close(past(text, start, ">")),
        false => Skip::Open,
    }
}

struct Tag {
    end: usize,
    attributes: usize,
    namespaces: usize,
    closed: bool,
}

fn tag(text: &str, start: usize) -> Tag {
    let (mut attributes, mut namespaces) = (0, 0);
    let mut word = start + 1;
    let mut at = word;
    let bytes = text.as_bytes();
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'>' => {
                let closed = bytes.get(at - 1) == Some(&b'/');
                return Tag {
                    end: at + 1,
                    attributes,
                    namespaces,
                    closed,
                };
            }
            b'=' => {
                attributes += 1;
                let name = bytes.get(word..at).unwrap_or_default();
                namespaces += usize::from(name.starts_with(b"xmlns"));
                at += 1;
            }
            quote @ (b'"' | b'\'') => {
                let end = if quote == b'"' { "\"" } else { "'" };
                at = past(text, at + 1, end);
                word = at;
            }
            b' ' | b'\t' | b'\r' | b'\n' => {
                at += 1;
                // Blanks may precede the equals sign.
                if bytes.get(at).is_some_and(|b| b.is_ascii_alphabetic()) {
                    word = at;
                }
            }
            _ => at += 1,
        }
    }
    Tag {
        end: text.len(),
        attributes,
        namespaces,
        closed: false,
    }
}

fn find(text: &str, from: usize, what: &str) -> Option<usize> {
    text.get(from..)?.find(what).map(|at| from + at)
}

/// Offset after the next `what`, or the end of the text.
fn past(text: &str, from: usize, what: &str) -> usize {
    find(text, from, what).map_or(text.len(), |at| at + what.len())
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
