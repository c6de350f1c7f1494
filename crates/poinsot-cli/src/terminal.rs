//! What the terminal can show: its width and colours. Where the output goes to a file or another program it
//! is plain and as wide as it needs.

use anstream::{AutoStream, ColorChoice};
use poinsot_report::{Document, TextStyle};
use std::io::IsTerminal;

/// How a document is printed on standard output. `NO_COLOR`, `CLICOLOR` and `CLICOLOR_FORCE` are honoured.
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

/// A document as it is printed.
pub fn document_text(document: &Document) -> String {
    document.text(&style())
}

/// An error with its code marked, where standard error shows colours.
pub fn error_text(message: &str) -> String {
    if AutoStream::choice(&std::io::stderr()) == ColorChoice::Never {
        return message.to_owned();
    }
    let lines: Vec<String> = message.lines().map(poinsot_report::marked_code).collect();
    lines.join("\n")
}
