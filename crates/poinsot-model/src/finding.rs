//! Faults of a model file with their positions, reported together.

use crate::document::{Document, KeyPath};
use poinsot_files::excerpt;
use std::fmt;

/// Number of findings listed; the rest is counted.
const SHOWN: usize = 20;

/// One fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Stable code, `E0101` and up; see `poinsot explain`.
    pub code: &'static str,
    /// File as given.
    pub file: String,
    /// Line, from one; zero if the file could not be read.
    pub line: usize,
    /// Column in characters, from one.
    pub column: usize,
    /// Key path, for example `body[2].inertia_kg_m2.xx`; list indices start at zero.
    pub key: String,
    /// Name of the entry, for example `body "link2"`; empty if it has none.
    pub subject: String,
    /// The value as written; empty if there is none.
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

/// An invalid model file: at most 20 findings sorted by position; others are counted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelError {
    /// The findings, never empty.
    pub findings: Vec<Finding>,
    /// Number of further findings.
    pub omitted: usize,
    /// Whether the environment (disk, permission) failed, not the file.
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
    /// Error for a file that cannot be read.
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

/// A key with the name of its entry.
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

    /// A key of this entry; dots separate nested keys.
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

/// Collects findings and notes during the checks.
pub(crate) struct Findings<'d, 'i> {
    pub document: &'d Document<'i>,
    findings: Vec<Finding>,
    /// Line and text; notes are finally sorted by position.
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

    /// Reports a fault of the value at a key.
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

    /// Reports a fault at a byte range, for example at a key instead of its value.
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

    /// Adds a note that is not an error.
    pub fn note(&mut self, key: &Key, text: String) {
        let (line, _) = self.document.line_column(self.document.place(&key.path).0);
        let subject = match key.subject.as_str() {
            "" => String::new(),
            subject => format!(" ({subject})"),
        };
        self.notes
            .push((line, format!("line {line}: {}{subject}: {text}", key.path)));
    }

    /// Reports a missing key at its entry.
    pub fn missing(&mut self, key: &Key, problem: &str, remedy: &str) {
        self.refuse("E0106", key, problem.to_owned(), remedy);
    }

    /// Whether a finding exists at this key, below it, or at another spelling of it; the key is then not missing.
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

    /// Number of findings so far.
    pub fn count(&self) -> usize {
        self.findings.len()
    }

    /// Returns the notes, or the error.
    pub fn finish(mut self) -> Result<Vec<String>, ModelError> {
        if !self.findings.is_empty() {
            return Err(self.into_error());
        }
        self.notes.sort();
        Ok(self.notes.into_iter().map(|(_, text)| text).collect())
    }

    /// The error.
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
