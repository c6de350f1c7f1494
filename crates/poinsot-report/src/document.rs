//! The parts of a document.

/// A verdict and the sections that support it.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// The answer in one sentence.
    pub verdict: String,
    /// Sections in reading order.
    pub sections: Vec<Section>,
}

/// A titled part of a document.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Title.
    pub title: String,
    /// Content.
    pub content: Content,
    /// A remark under the content.
    pub note: Option<String>,
}

/// What a section holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Rows of cells.
    Table(Table),
    /// Sentences.
    List(Vec<String>),
}

/// A table of text cells; all columns but the first are aligned right.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Column titles.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

impl Document {
    /// A document without sections.
    pub fn new(verdict: String) -> Self {
        Self {
            verdict,
            sections: Vec::new(),
        }
    }

    /// Adds a section.
    pub fn push(&mut self, section: Section) {
        self.sections.push(section);
    }
}

impl Section {
    /// A section with a table.
    pub fn table(title: &str, table: Table) -> Self {
        Self {
            title: title.to_owned(),
            content: Content::Table(table),
            note: None,
        }
    }

    /// A section with sentences.
    pub fn list(title: &str, lines: Vec<String>) -> Self {
        Self {
            title: title.to_owned(),
            content: Content::List(lines),
            note: None,
        }
    }
}

impl Table {
    /// An empty table.
    pub fn new(head: &[&str]) -> Self {
        Self {
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push(&mut self, row: Vec<String>) {
        self.rows.push(row);
    }
}
