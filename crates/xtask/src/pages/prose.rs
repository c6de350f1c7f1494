//! What a person reads as sentences on a page.

use crate::fault::Fault;
use crate::repository::pattern;
use regex::{Captures, Regex};

/// Reads the prose of a page.
pub struct Prose {
    /// Parts that are left out or replaced, in this order.
    replaced: Vec<(Regex, &'static str)>,
    fence: Regex,
    link: Regex,
    address: Regex,
    /// The line below the head of a table.
    rule: Regex,
    item: Regex,
    word: Regex,
}

impl Prose {
    /// Compiles its patterns.
    pub fn new() -> Result<Self, Fault> {
        let fence = r"(?ms)^```.*?^```[^\n]*$|^~~~.*?^~~~[^\n]*$";
        // Code and formulas become "X", so that a sentence keeps its length.
        let replaced = [
            (r"(?s)<!--.*?-->", ""),
            (fence, "\n"),
            (r"(?ms)^\$\$.*?\$\$$", "\n"),
            (r"\{\{#.*?\}\}", ""),
            (r"`[^`]+`", "X"),
            (r"(?s)\$\$.*?\$\$", "X"),
            (r"\$[^$\n]+(\n[^$\n]+)?\$", "X"),
            (r"!\[([^\]]*)\]\([^)]*\)", "$1"),
        ];
        let replaced = replaced.map(|(from, to)| Ok((pattern(from)?, to)));
        Ok(Self {
            replaced: replaced.into_iter().collect::<Result<_, Fault>>()?,
            fence: pattern(fence)?,
            link: pattern(r"\[(?P<words>[^\]]*)\]\((?P<target>[^)\s]+)\)")?,
            address: pattern(r"https?://\S+")?,
            rule: pattern(r"^\s*\|[\s:|-]+\|$")?,
            item: pattern(r"^\s*([-*]|\d+\.) ")?,
            word: pattern(r"[\w'%/+.-]*\w[\w'%/+.-]*")?,
        })
    }

    /// A page without blocks of code.
    pub fn without_code(&self, source: &str) -> String {
        self.fence.replace_all(source, "").into_owned()
    }

    /// A text with the words of each link in its place; pictures stay.
    pub fn without_links(&self, text: &str) -> String {
        let mut out = String::new();
        let (mut written, mut from) = (0, 0);
        while let Some(link) = self.link.captures_at(text, from) {
            let Some(place) = link.get(0) else { break };
            if text[..place.start()].ends_with('!') {
                from = place.start() + 1;
                continue;
            }
            out.push_str(&text[written..place.start()]);
            out.push_str(words(&link));
            written = place.end();
            from = place.end();
        }
        out + &text[written..]
    }

    /// Sentences of a page, one paragraph a block, with or without tables and headings.
    pub fn of(&self, source: &str, tables: bool) -> String {
        let mut text = source.to_owned();
        for (from, to) in &self.replaced {
            text = from.replace_all(&text, *to).into_owned();
        }
        let text = self.without_links(&text);
        let text = self.address.replace_all(&text, "X");
        self.paragraphs(&text, tables)
            .join("\n")
            .replace("**", "")
            .replace('*', "")
    }

    fn paragraphs(&self, text: &str, tables: bool) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        let mut indented = false;
        for line in text.lines() {
            let after_blank = lines.last().is_none_or(String::is_empty);
            let is_item = self.item.is_match(line);
            indented = line.starts_with("    ") && (after_blank || indented) && !is_item;
            if indented || self.rule.is_match(line) {
                lines.push(String::new());
            } else if line.trim_start().starts_with('|') {
                // A cell is a paragraph of its own.
                let cells = line.trim().trim_matches('|').split('|').filter(|_| tables);
                let before = lines.len();
                lines.extend(cells.flat_map(|cell| [cell.trim().to_owned(), String::new()]));
                if lines.len() == before {
                    lines.push(String::new());
                }
            } else if line.starts_with('#') {
                let heading = line.trim_start_matches(['#', ' ']).to_owned();
                lines.push(String::new());
                lines.extend(Some(heading).filter(|_| tables));
                lines.push(String::new());
            } else if is_item {
                lines.extend([String::new(), self.item.replace(line, "").into_owned()]);
            } else {
                lines.push(line.trim().to_owned());
            }
        }
        lines
    }

    /// Average words of sentences outside tables and headings; 0 where there is none.
    pub fn average(&self, source: &str) -> f64 {
        let prose = self.of(source, false);
        let counts = sentences(&prose)
            .into_iter()
            .map(|part| self.word.find_iter(part).count());
        // One word is a label.
        let counts: Vec<_> = counts.filter(|count| *count > 1).collect();
        counts.iter().sum::<usize>() as f64 / counts.len().max(1) as f64
    }
}

fn words<'a>(link: &Captures<'a>) -> &'a str {
    link.name("words").map_or("", |words| words.as_str())
}

/// Splits prose after a stop before a capital, a number or a quotation, and at blank lines.
fn sentences(prose: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut start, mut at) = (0, 0);
    while let Some(letter) = prose[at..].chars().next() {
        match gap(prose, at) {
            Some(length) => {
                parts.push(&prose[start..at]);
                at += length;
                start = at;
            }
            None => at += letter.len_utf8(),
        }
    }
    parts.push(&prose[start..]);
    parts
}

/// Length of the white space between two sentences, where there is such a gap.
fn gap(prose: &str, at: usize) -> Option<usize> {
    let rest = &prose[at..];
    let after = rest.trim_start();
    let space = rest.len() - after.len();
    let stops = prose[..at].ends_with(['.', '!', '?', ':']);
    let starts = |letter: char| {
        letter.is_ascii_uppercase() || letter.is_ascii_digit() || "*\"(".contains(letter)
    };
    if stops && space > 0 && after.starts_with(starts) {
        return Some(space);
    }
    let blank_lines = rest.len() - rest.trim_start_matches('\n').len();
    (blank_lines > 1).then_some(blank_lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_sentences_are_split_as_read() {
        let text = "One. Two e.g. three.  \"Four\"\n\nfive\nsix: Seven";
        let expected = ["One.", "Two e.g. three.", "\"Four\"", "five\nsix:", "Seven"];
        assert_eq!(sentences(text), expected);
    }

    #[test]
    fn unit_links_become_words_and_pictures_stay() {
        let prose = Prose::new().unwrap();
        let text = "a [b](c.md), ![d](e.svg) ![f [g](h)](i)";
        assert_eq!(prose.without_links(text), "a b, ![d](e.svg) ![f g](i)");
    }

    #[test]
    fn unit_code_formulas_and_tables_are_no_prose() {
        let prose = Prose::new().unwrap();
        let page = "# Title\n\nRun `a b c` with $x + y$.\n\n```sh\nno\n```\n\n    no\n    no\n\n| h | i |\n|---|---|\n| j | k |\n- *item*\n";
        assert_eq!(
            prose
                .of(page, true)
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" "),
            "Title Run X with X. h i j k item"
        );
        assert_eq!(
            prose
                .of(page, false)
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" "),
            "Run X with X. item"
        );
        assert!((prose.average("One two. Three four five six.\n\nseven") - 3.0).abs() < 1e-12);
    }
}
