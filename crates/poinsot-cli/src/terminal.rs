//! Width and colours of the terminal. Output to a file or another program is plain and unwrapped.

use crate::verbs::{Outcome, note, print_styled};
use anstream::{AutoStream, ColorChoice};
use poinsot_figures::{Document, TextStyle};
use poinsot_files::{Fault, Place, error_line};
use std::io::IsTerminal;

/// Exit code of an invalid command line.
const USAGE: u8 = 2;

/// Print style of a document on standard output. Honours `NO_COLOR`, `CLICOLOR` and `CLICOLOR_FORCE`.
pub fn style() -> TextStyle {
    let out = std::io::stdout();
    TextStyle {
        width: out.is_terminal().then(width).flatten(),
        colour: AutoStream::choice(&out) != ColorChoice::Never,
    }
}

fn width() -> Option<u16> {
    terminal_size::terminal_size().map(|(width, _)| width.0)
}

/// The document as text in the style of [`style`].
pub fn document_text(document: &Document) -> String {
    document.text(&style())
}

/// Prints a text of clap, for example the help.
///
/// # Errors
/// An invalid command line.
pub fn usage(usage: &clap::Error) -> Outcome {
    let plain = usage.render().to_string();
    let Some(text) = plain.strip_prefix("error: ") else {
        match (usage.use_stderr(), style().colour) {
            (true, _) => note(&plain),
            (false, true) => print_styled(&usage.render().ansi().to_string()),
            (false, false) => print_styled(&plain),
        }
        return Ok(u8::try_from(usage.exit_code()).unwrap_or(USAGE));
    };
    let mut parts = text.split("\n\n").map(|part| {
        let words: Vec<&str> = part.split_whitespace().collect();
        words.join(" ")
    });
    let problem = parts.next().unwrap_or_default();
    let advice: Vec<String> = parts.collect();
    Err(Fault::new("E0001", Place::default(), problem, advice.join("; ")).into())
}

/// Lines of an error, shortened and escaped; the error code is highlighted where standard error supports
/// colours.
pub fn error_text(message: &str) -> String {
    let lines = message.lines().map(error_line);
    let lines: Vec<String> = match AutoStream::choice(&std::io::stderr()) {
        ColorChoice::Never => lines.collect(),
        _ => lines.map(|l| poinsot_figures::marked_code(&l)).collect(),
    };
    lines.join("\n")
}
