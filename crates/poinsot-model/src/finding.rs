//! What is wrong with a model file, each finding with its place, and all of them at once.

use crate::document::{Document, KeyPath};
use poinsot_files::excerpt;
use std::fmt;

/// Findings shown; the rest is counted.
const SHOWN: usize = 20;

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Stable code, `E0101` and up; see `poinsot explain`.
    pub code: &'static str,
    /// File as given.
    pub file: String,
    /// Line, from one; zero where the file could not be read.
    pub line: usize,
    /// Column in characters, from one.
    pub column: usize,
    /// Way to the key, for example `body[2].inertia_kg_m2.xx`; list positions count from zero.
    pub key: String,
    /// What the entry calls itself, for example `body "link2"`; empty where it has no name.
    pub subject: String,
    /// The value as written; empty where there is none.
    pub value: String,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub remedy: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.code, self.file)?;
        if self.line > 0 {
            write!(f, ":{}:{}", self.line, self.column)?;
        }
        write!(f, ": ")?;
        if !self.key.is_empty() {
            write!(f, "{}", self.key)?;
            if !self.subject.is_empty() {
                write!(f, " ({})", self.subject)?;
            }
            if !self.value.is_empty() {
                write!(f, " = {}", self.value)?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}; {}", self.problem, self.remedy)
    }
}

/// A model file that was refused: its findings sorted by place, at most 20, the others counted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelError {
    /// The findings, never empty.
    pub findings: Vec<Finding>,
    /// How many more there are.
    pub omitted: usize,
    /// Whether the surroundings (disk, permission) failed and not the file.
    pub environment: bool,
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, finding) in self.findings.iter().enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            write!(f, "{finding}")?;
        }
        if self.omitted > 0 {
            write!(f, "\nand {} more", self.omitted)?;
        }
        Ok(())
    }
}

impl std::error::Error for ModelError {}

impl ModelError {
    /// A file that could not be read at all.
    pub(crate) fn unreadable(file: &str, problem: String, remedy: &str, environment: bool) -> Self {
        Self {
            findings: vec![Finding {
                code: "E0101",
                file: excerpt(file, 300),
                line: 0,
                column: 0,
                key: String::new(),
                subject: String::new(),
                value: String::new(),
                problem,
                remedy: remedy.to_owned(),
            }],
            omitted: 0,
            environment,
        }
    }
}

/// A key with the name of the entry it belongs to.
#[derive(Debug, Clone)]
pub(crate) struct Key {
    pub path: KeyPath,
    pub subject: String,
}

impl Key {
    /// A table at the top of the file.
    pub fn top(table: &str) -> Self {
        Self {
            path: KeyPath::default().key(table),
            subject: String::new(),
        }
    }

    /// Entry `index` of a list of tables, with its name.
    pub fn entry(table: &str, index: usize, name: Option<&str>) -> Self {
        Self {
            path: KeyPath::default().key(table).index(index),
            subject: match name {
                Some(name) => format!("{table} \"{}\"", excerpt(name, 60)),
                None => String::new(),
            },
        }
    }

    /// A key of this entry; dots lead deeper.
    pub fn at(&self, keys: &str) -> Self {
        let mut path = self.path.clone();
        for key in keys.split('.') {
            path = path.key(key);
        }
        Self {
            path,
            subject: self.subject.clone(),
        }
    }

    /// An element of this list.
    pub fn index(&self, index: usize) -> Self {
        Self {
            path: self.path.index(index),
            subject: self.subject.clone(),
        }
    }
}

/// Collects findings and notes while a document is checked.
pub(crate) struct Findings<'d, 'i> {
    pub document: &'d Document<'i>,
    findings: Vec<Finding>,
    /// Line and text; notes are sorted by place in the end.
    notes: Vec<(usize, String)>,
}

impl<'d, 'i> Findings<'d, 'i> {
    pub fn new(document: &'d Document<'i>) -> Self {
        Self {
            document,
            findings: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Refuses the value of a key.
    pub fn refuse(
        &mut self,
        code: &'static str,
        key: &Key,
        problem: String,
        remedy: impl Into<String>,
    ) {
        let (byte, value) = self.document.place(&key.path);
        self.push(code, key, byte, value, problem, remedy.into());
    }

    /// Refuses bytes of the file, for example a key rather than its value.
    pub fn push(
        &mut self,
        code: &'static str,
        key: &Key,
        byte: usize,
        value: String,
        problem: String,
        remedy: String,
    ) {
        let (line, column) = self.document.line_column(byte);
        self.findings.push(Finding {
            code,
            file: self.document.file.clone(),
            line,
            column,
            key: key.path.to_string(),
            subject: key.subject.clone(),
            value,
            problem,
            remedy,
        });
    }

    /// Lists something remarkable that is no error.
    pub fn note(&mut self, key: &Key, text: String) {
        let (line, _) = self.document.line_column(self.document.place(&key.path).0);
        let subject = match key.subject.as_str() {
            "" => String::new(),
            subject => format!(" ({subject})"),
        };
        self.notes
            .push((line, format!("line {line}: {}{subject}: {text}", key.path)));
    }

    /// Reports a key that should be there, at the entry that lacks it.
    pub fn missing(&mut self, key: &Key, problem: &str, remedy: &str) {
        self.refuse("E0106", key, problem.to_owned(), remedy);
    }

    /// Whether a finding stands at this key, below it, or at another spelling of it: then it is not
    /// really missing.
    pub fn has_near(&self, key: &Key) -> bool {
        let path = key.path.to_string();
        let table = path.rsplit_once('.').map_or("", |(table, _)| table);
        let stem = |name: &str| name.split('_').next().unwrap_or("").to_owned();
        let wanted = stem(path.rsplit('.').next().unwrap_or(""));
        self.findings.iter().any(|finding| {
            finding.key.starts_with(&path)
                || (finding.code == "E0105" || finding.code == "E0104")
                    && finding.key.rsplit_once('.').is_some_and(|(t, name)| {
                        t == table && crate::suggest::similar(&stem(name), &wanted)
                    })
        })
    }

    /// Findings so far.
    pub fn count(&self) -> usize {
        self.findings.len()
    }

    /// The notes, or the refusal.
    pub fn finish(mut self) -> Result<Vec<String>, ModelError> {
        if !self.findings.is_empty() {
            return Err(self.into_error());
        }
        self.notes.sort();
        Ok(self.notes.into_iter().map(|(_, text)| text).collect())
    }

    /// The refusal.
    pub fn into_error(mut self) -> ModelError {
        self.findings
            .sort_by(|a, b| (a.line, a.column, a.code).cmp(&(b.line, b.column, b.code)));
        let omitted = self.findings.len().saturating_sub(SHOWN);
        self.findings.truncate(SHOWN);
        ModelError {
            findings: self.findings,
            omitted,
            environment: false,
        }
    }
}
