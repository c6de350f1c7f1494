//! Width and colours of the terminal. Output to a file or another program is plain and unwrapped.

use anstream::{AutoStream, ColorChoice};
use poinsot_figures::{Document, TextStyle};
use poinsot_files::error_line;
use std::io::IsTerminal;

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
