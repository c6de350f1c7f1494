//! Faults of telemetry files that several modules report; their codes are stable.

use poinsot_files::{Fault, FaultKind, Faults, Place, io_advice};
use std::io;
use std::path::Path;

/// E0201: error of the operating system.
pub(crate) fn unreadable(path: &Path, what: &str, source: &io::Error) -> Faults {
    let fault = Fault::new(
        "E0201",
        Place::file(path),
        format!("{what}: {source}"),
        io_advice(source),
    );
    let kind = match source.kind() {
        io::ErrorKind::NotFound => FaultKind::Input,
        _ => FaultKind::System,
    };
    fault.of_kind(kind).into()
}

/// E0203: a cell is not a usable number.
pub(crate) fn number(place: Place, value: String, problem: &str, advice: &str) -> Faults {
    let fault = Fault::new("E0203", place, problem, advice);
    fault.with_value(value).into()
}

/// E0210: one channel is in two places.
pub(crate) fn twice(channel: &str, first: &Place, second: &Place) -> Faults {
    let name = channel.rsplit('.').next().unwrap_or_default();
    let problem = format!("channel '{channel}' is in {first} and again in {second}");
    let advice = format!("leave one out, or name the sensors: '<sensor>.{name}'");
    Faults::one("E0210", Place::default(), problem, advice)
}

/// E0212, or another code of a map: the entry of a channel.
pub(crate) fn map_of(
    code: &'static str,
    channel: &str,
    problem: impl Into<String>,
    advice: impl Into<String>,
) -> Faults {
    let place = Place::default().key(&format!("map of channel '{channel}'"));
    Faults::one(code, place, problem, advice)
}

/// E0213: a row filter without column or without matching row.
pub(crate) fn no_match(
    column: &str,
    text: &str,
    problem: String,
    advice: impl Into<String>,
) -> Faults {
    let place = Place::default().key(&format!("where {column}"));
    let fault = Fault::new("E0213", place, problem, advice);
    fault.with_value(format!("'{text}'")).into()
}

/// Advice for a damaged Parquet file.
pub(crate) const WRITE_AGAIN: &str = "write the file again, or convert it to CSV";

/// E0216: error of the Parquet decoder.
pub(crate) fn parquet(place: Place, problem: impl Into<String>) -> Faults {
    Faults::one("E0216", place, problem, WRITE_AGAIN)
}

/// E0217: the file has no rows.
pub(crate) fn no_rows(place: Place) -> Faults {
    let problem = "no data rows after the header";
    Faults::one("E0217", place, problem, "give a file with samples")
}

/// E0218: a repair is needed, but `--strict` forbids it.
pub(crate) fn not_strict(place: Place, repair: &str) -> Faults {
    let problem = format!("{repair}: --strict allows no repair");
    let advice = "correct the file or leave out --strict";
    Faults::one("E0218", place, problem, advice)
}

/// A cell as shown in errors: control characters escaped, at most 40 characters.
pub(crate) fn shown(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    let mut short: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if text.chars().count() > 40 {
        short.push_str("...");
    }
    short
}

/// A fault of a key of one entry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// Code of the fault.
    pub code: &'static str,
    /// The key; empty for the entry itself.
    pub key: &'static str,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub remedy: String,
}

impl Refused {
    /// The fault in the map of a channel.
    pub(crate) fn of(self, channel: &str) -> Faults {
        map_of(self.code, channel, self.problem, self.remedy)
    }
}

/// Refuses what the value of a key means: E0212.
pub(crate) fn refuse<T>(
    key: &'static str,
    problem: impl Into<String>,
    remedy: impl Into<String>,
) -> Result<T, Refused> {
    refuse_as("E0212", key, problem, remedy)
}

pub(crate) fn refuse_as<T>(
    code: &'static str,
    key: &'static str,
    problem: impl Into<String>,
    remedy: impl Into<String>,
) -> Result<T, Refused> {
    Err(Refused {
        code,
        key,
        problem: problem.into(),
        remedy: remedy.into(),
    })
}
