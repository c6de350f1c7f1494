//! Every error code with meaning, usual cause and remedy: one registry for all crates.
//!
//! A test compares it with the codes in the sources; another prints every message.

mod files;
mod questions;

use poinsot_formats::{CODES, CodeFile, CodesFile};
use poinsot_papers::Explained as Entry;
use std::fmt;

/// A stable error code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorCode {
    /// `E` and four digits. The first two give the area: 00 command, 01 model, 02 telemetry, 03 binding, 04 and 05
    /// methods and simulation, 06 results.
    pub code: &'static str,
    /// Meaning.
    pub meaning: &'static str,
    /// Usual cause.
    pub cause: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

impl fmt::Display for ErrorCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.code, self.meaning)?;
        writeln!(f, "  usual cause: {}", self.cause)?;
        writeln!(f, "  what to do:  {}", self.remedy)
    }
}

/// All codes, ascending.
pub fn error_codes() -> Vec<ErrorCode> {
    let published = poinsot_papers::METHODS.iter().flat_map(|m| m.about().codes);
    let mut all: Vec<ErrorCode> = files::CODES
        .iter()
        .chain(questions::CODES)
        .chain(published)
        .map(|&(code, meaning, cause, remedy)| ErrorCode {
            code,
            meaning,
            cause,
            remedy,
        })
        .collect();
    all.sort_by_key(|c| c.code);
    all
}

/// Codes as a file.
pub fn codes_file(codes: &[ErrorCode]) -> CodesFile {
    let code = |c: &ErrorCode| CodeFile {
        code: c.code.to_owned(),
        meaning: c.meaning.to_owned(),
        cause: c.cause.to_owned(),
        remedy: c.remedy.to_owned(),
    };
    CodesFile {
        schema: CODES.to_owned(),
        codes: codes.iter().map(code).collect(),
    }
}

/// Looks up a code, ignoring case, with or without `E`.
pub fn explain(code: &str) -> Option<ErrorCode> {
    let digits = code.trim().trim_start_matches(['E', 'e']);
    let wanted = format!("E{digits:0>4}");
    error_codes().into_iter().find(|c| c.code == wanted)
}
