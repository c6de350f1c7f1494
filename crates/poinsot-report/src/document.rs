//! The parts of a document.

/// How good what is said is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// Neither.
    #[default]
    Plain,
    /// As hoped.
    Good,
    /// To be looked at.
    Fair,
    /// Not to be used.
    Bad,
}

impl Tone {
    /// Name on a page.
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
    /// The answer in one sentence.
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
            tone: Tone::Plain,
            sections: Vec::new(),
        }
    }

    /// The document with a colour of its verdict.
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

    /// The section with a colour of its title.
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
