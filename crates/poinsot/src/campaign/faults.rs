//! Faults of a plan with line numbers.

use crate::case::{CaseError, CaseFault, CaseText};
use crate::error::Error;
use poinsot_formats::PlanFile;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// The text of a plan and its faults. A plan made by a program has no text, so its faults have no line.
pub(crate) struct PlanText {
    pub path: PathBuf,
    text: CaseText,
    faults: Vec<CaseFault>,
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
            Error::File(CaseError {
                faults: faults.iter().map(told).collect(),
                environment: false,
            })
        })
    }

    /// A fault at a key; a numeric step is a list index.
    pub fn fault(
        &self,
        code: &'static str,
        at: &[&str],
        what: impl Into<String>,
        remedy: &str,
    ) -> CaseFault {
        let (span, found) = self.span(at);
        let mut fault = self.text.fault(code, &key(at), span, what, remedy);
        if self.text.text.is_empty() {
            fault.line = 0;
        }
        if !found {
            fault.value.clear();
        }
        fault
    }

    /// Records a fault.
    pub fn refuse(
        &mut self,
        code: &'static str,
        at: &[&str],
        what: impl Into<String>,
        remedy: &str,
    ) {
        let fault = self.fault(code, at, what, remedy);
        self.faults.push(fault);
    }

    /// Returns an error if any fault was recorded.
    ///
    /// # Errors
    /// All recorded faults.
    pub fn finish(&mut self) -> Result<(), Error> {
        match std::mem::take(&mut self.faults) {
            faults if faults.is_empty() => Ok(()),
            faults => Err(Error::File(CaseError {
                faults,
                environment: false,
            })),
        }
    }

    /// Position of a key's value or of the nearest table above it, and whether the key exists.
    fn span(&self, at: &[&str]) -> (Range<usize>, bool) {
        let (table, _) = DeTable::parse_recoverable(&self.text.text);
        let table = table.into_inner();
        let Some((first, rest)) = at.split_first() else {
            return (0..0, false);
        };
        let Some(mut value) = table.get(*first) else {
            return (0..0, false);
        };
        for step in rest {
            let next = match value.get_ref() {
                DeValue::Table(t) => t.get(*step),
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

/// `vary[1].number`.
fn key(at: &[&str]) -> String {
    let mut text = String::new();
    for step in at {
        match step.parse::<usize>() {
            Ok(k) => text.push_str(&format!("[{k}]")),
            Err(_) if text.is_empty() => text.push_str(step),
            Err(_) => text.push_str(&format!(".{step}")),
        }
    }
    text
}
