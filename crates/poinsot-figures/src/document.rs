//! A document: a verdict and sections of rows and sentences, for terminal and page.

use serde::Serialize;

/// Stands for `|` in a cell of a terminal text; [`escaped`](poinsot_files::escaped) removes it from text of files.
pub(crate) const BAR: char = '\u{1f}';

/// Quality of a statement; a worse one is greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    /// Neutral.
    #[default]
    #[serde(rename = "off")]
    Plain,
    /// As hoped.
    Good,
    /// Needs attention.
    Fair,
    /// Not usable.
    Bad,
}

/// A verdict and the sections that support it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// The result in one sentence.
    pub verdict: String,
    /// Colour of the verdict.
    pub tone: Tone,
    /// Sections in reading order.
    pub sections: Vec<Section>,
}

/// A titled part of a document.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Section {
    /// Title.
    pub title: String,
    /// Colour of the title.
    pub tone: Tone,
    /// Column titles.
    pub head: Vec<String>,
    /// Rows of cells; all columns but the first are aligned right.
    pub rows: Vec<Vec<String>>,
    /// Sentences.
    pub lines: Vec<String>,
    /// Remark below the content.
    pub note: Option<String>,
}

impl Document {
    /// A document without sections.
    pub fn new(verdict: String) -> Self {
        Self {
            verdict,
            ..Self::default()
        }
    }

    /// Sets the colour of the verdict.
    pub fn toned(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// From the lines of a template, see [`Templates::document`](crate::Templates::document).
    pub(crate) fn parse(text: &str) -> Self {
        let mut lines = text.trim_start().lines();
        let mut document = Self::new(plain(lines.next().unwrap_or_default()));
        for line in lines {
            let rest = line.get(1..).unwrap_or_default();
            match (line.chars().next(), document.sections.last_mut()) {
                (Some('#'), _) => document.sections.push(Section::titled(rest)),
                (Some('|'), Some(section)) => section.push(cells(rest)),
                (Some('-'), Some(section)) => {
                    let sentence = rest.strip_prefix(' ').unwrap_or(rest);
                    section.lines.push(plain(sentence));
                }
                (Some('>'), Some(section)) if !rest.trim().is_empty() => {
                    section.note = Some(plain(rest.trim()));
                }
                _ => {}
            }
        }
        let is_empty = |s: &Section| s.rows.is_empty() && s.lines.is_empty();
        document.sections.retain(|s| !is_empty(s));
        document
    }
}

impl Section {
    /// From ` title`, or `bad title` with a tone.
    fn titled(text: &str) -> Self {
        let (word, title) = text.split_once(' ').unwrap_or(("", text));
        let tone = match word {
            "good" => Tone::Good,
            "fair" => Tone::Fair,
            "bad" => Tone::Bad,
            _ => Tone::Plain,
        };
        Self {
            title: plain(title),
            tone,
            ..Self::default()
        }
    }

    fn push(&mut self, row: Vec<String>) {
        match self.head.is_empty() {
            true => self.head = row,
            false => self.rows.push(row),
        }
    }

    /// Whether no cell of each column starts like a number.
    pub(crate) fn text_columns(&self) -> Vec<bool> {
        let numeric =
            |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "+-±".contains(c));
        let is_text = |column| !self.rows.iter().filter_map(|r| r.get(column)).any(numeric);
        (0..self.head.len()).map(is_text).collect()
    }
}

fn plain(text: &str) -> String {
    text.replace(BAR, "|")
}

fn cells(row: &str) -> Vec<String> {
    let row = row.trim_end();
    let cells = row.strip_suffix('|').unwrap_or(row).split('|');
    cells.map(|cell| plain(cell.trim())).collect()
}
