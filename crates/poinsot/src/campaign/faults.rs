//! Faults of a plan with line numbers.

use crate::case::CaseText;
use crate::error::{Error, Fault};
use poinsot_files::Place;
use poinsot_formats::PlanFile;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// The text of a plan and its faults. A plan made by a program has no text, so its faults have no line.
pub(crate) struct PlanText {
    pub path: PathBuf,
    text: CaseText,
    faults: Vec<Fault>,
}

impl PlanText {
    pub fn new(path: &Path, text: String) -> Self {
        Self {
            path: path.to_owned(),
            text: CaseText {
                path: path.to_owned(),
                text,
            },
            faults: Vec::new(),
        }
    }

    /// Parses the file.
    ///
    /// # Errors
    /// Invalid TOML, unknown keys, or values of a wrong type.
    pub fn parse(&self) -> Result<PlanFile, Error> {
        PlanFile::parse(&self.text.text).map_err(|faults| {
            let remedy = "correct it here; `poinsot schema plan` prints all keys";
            let told = |f| self.text.shape("E0541", f, remedy);
            Error::sorted(faults.iter().map(told).collect())
        })
    }

    /// A fault at a key such as `vary[1].number`.
    fn fault(&self, code: &'static str, key: &str, what: String, remedy: &str) -> Fault {
        let (span, found) = self.span(key);
        let mut fault = self.text.fault(code, key, span, what, remedy);
        if self.text.text.is_empty() {
            fault.place.line = 0;
        }
        if !found {
            fault.value.clear();
        }
        fault
    }

    /// Records a fault.
    pub fn refuse(&mut self, key: &str, what: impl Into<String>, remedy: &str) {
        let fault = self.fault("E0541", key, what.into(), remedy);
        self.faults.push(fault);
    }

    /// Records an address that names no number, or not as many as are given.
    pub fn refuse_address(&mut self, key: &str, what: impl Into<String>, remedy: &str) {
        let fault = self.fault("E0542", key, what.into(), remedy);
        self.faults.push(fault);
    }

    /// Returns an error if any fault was recorded.
    ///
    /// # Errors
    /// All recorded faults.
    pub fn finish(&mut self) -> Result<(), Error> {
        Error::none_or(std::mem::take(&mut self.faults), ())
    }

    /// Position of a key's value or of the nearest table above it, and whether the key exists.
    fn span(&self, key: &str) -> (Range<usize>, bool) {
        let (table, _) = DeTable::parse_recoverable(&self.text.text);
        let table = table.into_inner();
        let mut steps = key.split(['.', '[', ']']).filter(|s| !s.is_empty());
        let Some(mut value) = steps.next().and_then(|first| table.get(first)) else {
            return (0..0, false);
        };
        for step in steps {
            let next = match value.get_ref() {
                DeValue::Table(t) => t.get(step),
                DeValue::Array(a) => step.parse().ok().and_then(|k: usize| a.get(k)),
                _ => None,
            };
            match next {
                Some(next) => value = next,
                None => return (value.span(), false),
            }
        }
        (value.span(), true)
    }
}

/// A fault of a whole file or experiment, without a line.
pub(crate) fn whole_fault(code: &'static str, of: &Path, what: String, remedy: &str) -> Error {
    Error::one(code, Place::file(of), what, remedy)
}
