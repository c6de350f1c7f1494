//! The text of a file with its parsed tree: positions and values of keys.

use poinsot_files::excerpt;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// One step of a key path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Step {
    /// Into a table.
    Key(String),
    /// Into a list, from zero.
    Index(usize),
}

/// Path to a value from the top of the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct KeyPath(pub Vec<Step>);

impl KeyPath {
    /// The path of a text such as `want[1].number`.
    pub fn parse(text: &str) -> Self {
        let steps = text.split(['.', '[', ']']).filter(|step| !step.is_empty());
        let step = |step: &str| match step.parse() {
            Ok(index) => Step::Index(index),
            Err(_) => Step::Key(step.to_owned()),
        };
        Self(steps.map(step).collect())
    }

    /// The path extended by a key.
    pub fn key(&self, key: &str) -> Self {
        let mut path = self.clone();
        path.0.push(Step::Key(key.to_owned()));
        path
    }

    /// The name of the last key.
    pub fn key_name(&self) -> &str {
        let names = self.0.iter().rev().filter_map(|step| match step {
            Step::Key(key) => Some(key.as_str()),
            Step::Index(_) => None,
        });
        names.into_iter().next().unwrap_or_default()
    }

    /// The path extended by an index.
    pub fn index(&self, index: usize) -> Self {
        let mut path = self.clone();
        path.0.push(Step::Index(index));
        path
    }
}

impl std::fmt::Display for KeyPath {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (k, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if k > 0 => write!(f, ".{}", excerpt(key, 60))?,
                Step::Key(key) => write!(f, "{}", excerpt(key, 60))?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// A parsed file.
pub(crate) struct Document<'i> {
    /// File name in messages.
    pub file: String,
    /// Text.
    pub text: &'i str,
    /// Parsed tree.
    pub table: DeTable<'i>,
    lines: Lines,
}

/// Where the lines of a text begin.
pub(crate) struct Lines(Vec<usize>);

impl Lines {
    /// Those of a text.
    pub fn of(text: &str) -> Self {
        let later = text.match_indices('\n').map(|(at, _)| at + 1);
        Self(std::iter::once(0).chain(later).collect())
    }

    /// Line and column of a byte of the text, from one; columns count characters.
    pub fn line_column(&self, text: &str, byte: usize) -> (usize, usize) {
        let line = self.0.partition_point(|start| *start <= byte).max(1);
        let before = text.get(self.0[line - 1]..byte).unwrap_or("");
        (line, before.chars().count() + 1)
    }
}

impl<'i> Document<'i> {
    /// Parses the text; after syntax errors the tree holds the readable part.
    pub fn new(text: &'i str, file: &str) -> (Self, Vec<toml::de::Error>) {
        let (table, errors) = DeTable::parse_recoverable(text);
        let document = Self {
            file: excerpt(file, 300),
            text,
            table: table.into_inner(),
            lines: Lines::of(text),
        };
        (document, errors)
    }

    /// Line and column of a byte, from one; columns count characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        self.lines.line_column(self.text, byte)
    }

    /// Offset and text of the value at a path; for a missing key, those of the nearest table above it, without a
    /// value.
    pub fn place(&self, path: &KeyPath) -> (usize, String) {
        let mut span = 0..0;
        let mut node: Option<&Spanned<DeValue<'_>>> = None;
        for step in &path.0 {
            let next = match (step, node) {
                (Step::Key(key), None) => self.table.get(key.as_str()),
                (Step::Key(key), Some(value)) => value.get_ref().get(key.as_str()),
                (Step::Index(index), Some(value)) => value.get_ref().get(*index),
                (Step::Index(_), None) => None,
            };
            let Some(next) = next else {
                return (span.start, String::new());
            };
            span = next.span();
            node = Some(next);
        }
        (
            span.start,
            node.map_or_else(String::new, |value| self.excerpt(value)),
        )
    }

    /// The value as written, on one line and shortened; empty for a whole section.
    pub fn excerpt(&self, value: &Spanned<DeValue<'_>>) -> String {
        let text = self.text.get(value.span()).unwrap_or("");
        let section = match value.get_ref() {
            DeValue::Table(_) => text.starts_with('['),
            DeValue::Array(items) => items.first().is_some_and(|item| item.get_ref().is_table()),
            _ => false,
        };
        if section {
            return String::new();
        }
        // Blanks are joined before the text is shortened.
        let start: String = text.chars().take(400).collect();
        let words: Vec<&str> = start.split_whitespace().collect();
        excerpt(&words.join(" "), 80)
    }
}
