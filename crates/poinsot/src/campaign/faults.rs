//! Faults of a plan with line numbers.

use crate::case::{KeyText, rows};
use crate::error::{Error, Fault};
use poinsot_formats::{PLAN, PlanFile};
use poinsot_model::Format;
use serde_json::Value;
use std::path::Path;
use std::sync::OnceLock;

/// The plan, with the code of its faults.
const FORMAT: Format = Format::of(PLAN, "E0541");

/// The text of a plan and its faults. A plan made by a program has no text, so its faults have no line.
pub(crate) struct PlanText {
    text: KeyText,
    faults: Vec<Fault>,
}

impl PlanText {
    pub fn new(path: &Path, text: String) -> Self {
        Self {
            text: KeyText {
                path: path.to_owned(),
                text,
            },
            faults: Vec::new(),
        }
    }

    /// Where the plan is.
    pub fn path(&self) -> &Path {
        &self.text.path
    }

    /// Parses the file.
    ///
    /// # Errors
    /// All faults of its keys.
    pub fn parse(&self) -> Result<PlanFile, Error> {
        static ROWS: OnceLock<Value> = OnceLock::new();
        let rows = ROWS.get_or_init(rows::<PlanFile>);
        let (file, faults) = self.text.parse(&FORMAT, rows)?;
        Error::none_or(faults, file)
    }

    /// Records a fault at a key such as `vary[1].number`.
    pub fn refuse(&mut self, key: &str, what: impl Into<String>, remedy: &str) {
        self.faults
            .push(self.text.fault("E0541", key, what, remedy));
    }

    /// Records an address that names no number, or not as many as are given.
    pub fn refuse_address(&mut self, key: &str, what: impl Into<String>, remedy: &str) {
        self.faults
            .push(self.text.fault("E0542", key, what, remedy));
    }

    /// Returns an error if any fault was recorded.
    ///
    /// # Errors
    /// All recorded faults.
    pub fn finish(&mut self) -> Result<(), Error> {
        self.text.none_or(std::mem::take(&mut self.faults), ())
    }
}
