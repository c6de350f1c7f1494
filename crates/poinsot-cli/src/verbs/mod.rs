//! One file per verb.

pub mod check;
pub mod completions;
pub mod identify;
pub mod inspect;
pub mod man;
pub mod predict;
pub mod report;
pub mod schema;
pub mod simulate;

use crate::arguments::Format;
use poinsot_report::FigureFormat;

/// Why a verb failed, ready for the terminal.
pub struct Failure {
    /// One line or several findings, each with its code.
    pub message: String,
    /// Exit code.
    pub exit_code: u8,
}

/// Exit code of an answer.
pub type Outcome = Result<u8, Failure>;

impl<E: Into<poinsot::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        let error = error.into();
        Self {
            exit_code: error.exit_code(),
            message: error.to_string(),
        }
    }
}

/// Says which files were written: on standard error, or as JSON on standard output.
pub fn written(paths: &[std::path::PathBuf], json: bool, quiet: bool) {
    if json {
        let names: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        print_json(&serde_json::json!({ "written": names }));
    } else if !quiet {
        for path in paths {
            eprintln!("written: {}", path.display());
        }
    }
}

/// Formats of figures, each once.
pub fn formats(wanted: &[Format]) -> Vec<FigureFormat> {
    let mut out = Vec::new();
    for format in wanted {
        let format = match format {
            Format::Svg => FigureFormat::Svg,
            Format::Png => FigureFormat::Png,
        };
        if !out.contains(&format) {
            out.push(format);
        }
    }
    out
}

/// Prints to standard output; a closed pipe is not an error.
pub fn print(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Prints a value as JSON.
pub fn print_json<T: serde::Serialize>(value: &T) {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    print(&format!("{text}\n"));
}
