//! What the terminal can show: its width and colours. Where the output goes to a file or another program it
//! is plain and as wide as it needs.

use anstream::{AutoStream, ColorChoice};
use poinsot_files::error_line;
use poinsot_report::{Document, TextStyle};
use std::io::{IsTerminal, Write};

/// Exit code of a command that cannot be understood.
const USAGE: u8 = 2;

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

/// Prints what clap says: help as it is, a refusal with its lines short and safe to show.
pub fn usage_exit(usage: &clap::Error) -> u8 {
    if !usage.use_stderr() {
        usage.exit();
    }
    let text = usage.render().to_string();
    let lines: Vec<String> = text.lines().map(error_line).collect();
    let _ = writeln!(std::io::stderr(), "{}", lines.join("\n"));
    USAGE
}

/// The lines of an error, each short and safe to show, with its code marked where standard error shows colours.
pub fn error_text(message: &str) -> String {
    let lines = message.lines().map(error_line);
    let lines: Vec<String> = match AutoStream::choice(&std::io::stderr()) {
        ColorChoice::Never => lines.collect(),
        _ => lines.map(|l| poinsot_report::marked_code(&l)).collect(),
    };
    lines.join("\n")
}
