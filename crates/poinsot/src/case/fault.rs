//! The text of a case or plan, checked against its table of keys, and its faults with line numbers.

use crate::error::{Error, Fault};
use poinsot_files::{Place, nearest};
use poinsot_formats::case::{CASE, CaseFile};
use poinsot_model::{Format, check_keys, locate, without_null};
use schemars::{JsonSchema, schema_for};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::OnceLock;

/// The case file, with the codes of its faults.
const FORMAT: Format = Format {
    range: "E0505",
    unfit: "E0507",
    ..Format::of(CASE, "E0502")
};

/// Name and text of a file of keys; gives its faults their lines.
#[derive(Debug, Clone)]
pub(crate) struct KeyText {
    pub path: PathBuf,
    pub text: String,
}

impl KeyText {
    /// The file, and the faults of its keys that leave it readable.
    ///
    /// # Errors
    /// All faults of its keys, where it cannot be read.
    pub fn parse<T: DeserializeOwned>(
        &self,
        format: &'static Format,
        rows: &'static Value,
    ) -> Result<(T, Vec<Fault>), Error> {
        let name = self.path.display().to_string();
        let checked = check_keys(&self.text, &name, format, rows);
        let mut faults = checked.err().map_or_else(Vec::new, |error| error.list);
        faults.iter_mut().for_each(|f| f.place.column = 0);
        let read = toml::from_str(&self.text).map_err(|error| {
            let before = self.text.get(..error.span().unwrap_or_default().start);
            let line = before.unwrap_or_default().matches('\n').count() as u64 + 1;
            let place = Place::file(&self.path).at(line);
            Error::one(format.kind, place, error.message(), "correct it here")
        });
        match read {
            Ok(file) => Ok((file, faults)),
            Err(_) if !faults.is_empty() => Err(Error::sorted(faults)),
            Err(error) => Err(error),
        }
    }

    /// A fault at a key, still without its line.
    pub fn fault(
        &self,
        code: &'static str,
        key: &str,
        problem: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Fault {
        Fault::new(code, Place::file(&self.path).key(key), problem, remedy)
    }

    /// The faults with their lines and values, in the order of the file.
    pub fn located(&self, mut faults: Vec<Fault>) -> Vec<Fault> {
        if !self.text.is_empty() {
            locate(&self.text, &mut faults);
        }
        faults
    }

    /// The value, or the faults.
    pub fn none_or<T>(&self, faults: Vec<Fault>, value: T) -> Result<T, Error> {
        Error::none_or(self.located(faults), value)
    }

    /// The case of this text.
    pub fn case(&self) -> Result<(CaseFile, Vec<Fault>), Error> {
        static ROWS: OnceLock<Value> = OnceLock::new();
        self.parse(&FORMAT, ROWS.get_or_init(rows::<CaseFile>))
    }
}

/// The table of keys of a format.
pub(crate) fn rows<T: JsonSchema>() -> Value {
    without_null(schema_for!(T).to_value())
}

/// Suggests the nearest known name as remedy.
pub(crate) fn did_you_mean<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> String {
    let known: Vec<&str> = known.collect();
    match nearest(name, &known) {
        Some(nearest) => format!("did you mean \"{nearest}\"?"),
        None if known.is_empty() => "remove it: it does not exist here".to_owned(),
        None => {
            let some = known.iter().take(8).map(|k| format!("\"{k}\""));
            format!("write one of {}", some.collect::<Vec<_>>().join(", "))
        }
    }
}
