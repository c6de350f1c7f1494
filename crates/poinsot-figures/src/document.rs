//! The parts of a document.

/// Quality of a statement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// Neutral.
    #[default]
    Plain,
    /// As hoped.
    Good,
    /// Needs attention.
    Fair,
    /// Not usable.
    Bad,
}

impl Tone {
    /// Name in HTML.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "off",
            Self::Good => "good",
            Self::Fair => "fair",
            Self::Bad => "bad",
        }
    }
}

/// A verdict and the sections that support it.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// The result in one sentence.
    pub verdict: String,
    /// Colour of the verdict.
    pub tone: Tone,
    /// Sections in reading order.
    pub sections: Vec<Section>,
}

/// A titled part of a document.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Title.
    pub title: String,
    /// Colour of the title.
    pub tone: Tone,
    /// Content.
    pub content: Content,
    /// Remark below the content.
    pub note: Option<String>,
}

/// Content of a section.
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
            tone: Tone::Plain,
            sections: Vec::new(),
        }
    }

    /// Sets the colour of the verdict.
    pub fn toned(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
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
            tone: Tone::Plain,
            content: Content::Table(table),
            note: None,
        }
    }

    /// Sets the colour of the title.
    pub fn toned(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// A section with sentences.
    pub fn list(title: &str, lines: Vec<String>) -> Self {
        Self {
            title: title.to_owned(),
            tone: Tone::Plain,
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
