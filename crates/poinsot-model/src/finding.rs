//! Collects the faults of a model file with their positions.

use crate::document::{Document, KeyPath};
use poinsot_files::{Fault, Faults, MOST_FAULTS, Place, excerpt};
use std::fmt;

/// A key with the name of its entry.
#[derive(Debug, Clone, Default)]
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
            subject: subject(table, name),
        }
    }

    /// A key of this entry; dots separate nested keys.
    pub fn at(&self, keys: &str) -> Self {
        let step = |path: KeyPath, key| path.key(key);
        self.with_path(keys.split('.').fold(self.path.clone(), step))
    }

    /// An element of this list.
    pub fn index(&self, index: usize) -> Self {
        self.with_path(self.path.index(index))
    }

    /// The key of one name, which may contain dots.
    pub fn named(&self, name: &str) -> Self {
        self.with_path(self.path.key(name))
    }

    fn with_path(&self, path: KeyPath) -> Self {
        let subject = self.subject.clone();
        Self { path, subject }
    }
}

/// An entry of a list of tables in messages.
pub(crate) fn subject(table: impl fmt::Display, name: Option<&str>) -> String {
    let named = |name| format!("{table} \"{}\"", excerpt(name, 60));
    name.map_or_else(String::new, named)
}

/// Collects findings and notes during the checks.
pub(crate) struct Findings<'d> {
    pub document: &'d Document<'d>,
    faults: Vec<Fault>,
    /// Line and text; notes are finally sorted by position.
    notes: Vec<(usize, String)>,
}

impl<'d> Findings<'d> {
    pub fn new(document: &'d Document<'d>) -> Self {
        Self {
            document,
            faults: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Reports a fault of the value at a key.
    pub fn refuse(
        &mut self,
        code: &'static str,
        key: &Key,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let (byte, value) = self.document.place(&key.path);
        self.push(code, key, byte, value, problem.into(), remedy.into());
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
        if self.is_full() {
            return;
        }
        let (line, column) = self.document.line_column(byte);
        let place = Place {
            line: line as u64,
            column: column as u64,
            subject: key.subject.clone(),
            ..Place::label(&self.document.file).key(&key.path.to_string())
        };
        let fault = Fault::new(code, place, problem, remedy);
        self.faults.push(fault.with_value(value));
    }

    /// A fault in place of a value that cannot be read.
    pub fn refused<T>(
        &mut self,
        code: &'static str,
        key: &Key,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Option<T> {
        self.refuse(code, key, problem, remedy);
        None
    }

    /// Adds a note that is not an error.
    pub fn note(&mut self, key: &Key, text: impl fmt::Display) {
        let (line, _) = self.document.line_column(self.document.place(&key.path).0);
        let subject = match key.subject.as_str() {
            "" => String::new(),
            subject => format!(" ({subject})"),
        };
        self.notes
            .push((line, format!("line {line}: {}{subject}: {text}", key.path)));
    }

    /// Whether a finding exists at this key, below it, or at another spelling of it; the key is then not missing.
    pub fn has_near(&self, key: &Key) -> bool {
        let path = key.path.to_string();
        let table = path.rsplit_once('.').map_or("", |(table, _)| table);
        let stem = |name: &str| name.split('_').next().unwrap_or("").to_owned();
        let wanted = stem(path.rsplit('.').next().unwrap_or(""));
        self.faults.iter().any(|finding| {
            finding.place.key.starts_with(&path)
                || (finding.code == "E0105" || finding.code == "E0104")
                    && finding.place.key.rsplit_once('.').is_some_and(|(t, name)| {
                        t == table && crate::suggest::similar(&stem(name), &wanted)
                    })
        })
    }

    /// Whether no more faults are kept: a file of faults alone must not take the time and memory of all.
    pub fn is_full(&self) -> bool {
        self.faults.len() >= MOST_FAULTS
    }

    /// Number of findings so far.
    pub fn count(&self) -> usize {
        self.faults.len()
    }

    /// Returns the notes, or the error.
    pub fn finish(mut self) -> Result<Vec<String>, Faults> {
        self.notes.sort();
        let notes = self.notes.into_iter().map(|(_, text)| text).collect();
        Faults::none_or(self.faults, notes)
    }

    /// The error.
    pub fn into_error(self) -> Faults {
        Faults::sorted(self.faults)
    }
}

/// The entries of a list of tables.
pub(crate) fn all<T>(list: &Option<Vec<T>>) -> &[T] {
    list.as_deref().unwrap_or_default()
}

/// What can be read of the entries of an optional list, each by its place there.
pub(crate) fn each<'f, F, T>(
    list: &'f Option<Vec<F>>,
    mut read: impl FnMut(usize, &'f F) -> Option<T>,
) -> Vec<T> {
    let entries = all(list).iter().enumerate();
    entries.filter_map(|(k, entry)| read(k, entry)).collect()
}
