//! One file per verb.

pub mod campaign;
pub mod check;
pub mod compare;
pub mod completions;
pub mod design;
pub mod explain;
pub mod export;
pub mod follow;
pub mod identify;
pub mod import;
pub mod init;
pub mod inspect;
pub mod man;
pub mod methods;
pub mod predict;
pub mod report;
pub mod schema;
pub mod simulate;
pub mod study;
pub mod sweep;
pub mod units;
pub mod validate;

use std::sync::OnceLock;

use crate::arguments::Print;
use crate::progress::{clear, suspended};
use poinsot::Error;
use poinsot_figures::{Document, FigureFormat, WITHOUT_PNG};
use poinsot_files::{Fault, Place, error_line, escaped_lines, json_escaped};
use poinsot_formats::{ResultFile, WrittenFile, result_text};
use std::io::IsTerminal;
use std::path::PathBuf;

/// Exit code of a command, or its failure.
pub type Outcome = Result<u8, Error>;

/// Exit code of an invalid command line.
const USAGE: u8 = 2;

/// Exit code of a result (docs/reference/interface.md): 0 if it passes, 1 otherwise.
pub fn exit_of(passes: bool) -> u8 {
    u8::from(!passes)
}

/// Command line, recorded in results.
static WORDS: OnceLock<Vec<String>> = OnceLock::new();

/// Stores the command line; the first word is replaced by the program's name.
pub fn remember(words: &[std::ffi::OsString]) {
    let words = words
        .iter()
        .skip(1)
        .map(|w| w.to_string_lossy().into_owned());
    let command = std::iter::once("poinsot".to_owned()).chain(words).collect();
    // Set once: a process runs one command.
    let _ = WORDS.set(command);
}

/// The stored command line.
pub fn command_line() -> &'static [String] {
    WORDS.get().map_or(&[], Vec::as_slice)
}

/// Options of reading telemetry.
pub fn reading(rows: &crate::arguments::Rows) -> Result<poinsot_telemetry::ReadOptions, Error> {
    Ok(poinsot_telemetry::ReadOptions {
        encoding: poinsot_telemetry::Encoding::from_name(&rows.encoding).unwrap_or_default(),
        time_s: rows.time_s,
        every: poinsot::row_step(rows.every)?,
        memory_mib: rows.memory_mib.unwrap_or(poinsot_telemetry::MEMORY_MIB),
        ..Default::default()
    })
}

/// Prints a text of clap, for example the help.
///
/// # Errors
/// An invalid command line.
pub fn usage(usage: &clap::Error) -> Outcome {
    let plain = usage.render().to_string();
    let Some(text) = plain.strip_prefix("error: ") else {
        match (usage.use_stderr(), crate::terminal::style().colour) {
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

/// Prints one line on standard error; a closed stream is ignored.
pub fn note(line: &str) {
    use std::io::Write;
    let _ = suspended(|| writeln!(std::io::stderr(), "{}", error_line(line)));
}

/// The line that a person types after a question; none at the end of the input. From the first question on no progress is shown.
pub fn asked(question: &str) -> Option<String> {
    clear();
    print(question);
    std::io::stdin().lines().next()?.ok()
}

/// Prints an answer: as JSON, as text, or not.
pub fn shown(how: &Print, json: impl FnOnce(), text: impl FnOnce()) {
    match how {
        Print { json: true, .. } => json(),
        Print { quiet: true, .. } => {}
        _ => text(),
    }
}

/// Shows a result, lists the written files, and gives the exit code.
pub fn ended<T: ResultFile>(
    how: &Print,
    file: &T,
    document: impl FnOnce(&T) -> Document,
    (written, passes): (&[PathBuf], bool),
) -> Outcome {
    let text = || print_document(&document(file));
    shown(how, || print_result(file), text);
    noted(written, how.quiet);
    Ok(exit_of(passes))
}

/// Lists the written files: on standard error, or as JSON on standard output.
pub fn written(paths: &[PathBuf], json: bool, quiet: bool) {
    match json {
        true => print_json(&WrittenFile::of(paths)),
        false => noted(paths, quiet),
    }
}

/// Writes a text to a file and lists that, or prints it: unchanged into a file or pipe, escaped on a terminal.
pub fn delivered(text: &str, out: Option<&PathBuf>, json: bool, quiet: bool) -> Result<(), Error> {
    match out {
        Some(path) => {
            poinsot::write_file(path, text.as_bytes())?;
            written(std::slice::from_ref(path), json, quiet);
        }
        None if std::io::stdout().is_terminal() => print(text),
        None => print_styled(text),
    }
    Ok(())
}

/// Lists the written files on standard error.
pub fn noted(paths: &[PathBuf], quiet: bool) {
    for path in paths.iter().filter(|_| !quiet) {
        note(&format!("written: {}", path.display()));
    }
}

/// Requested figure formats without duplicates.
pub fn formats(wanted: &[String]) -> Result<Vec<FigureFormat>, Error> {
    let all = [FigureFormat::Svg, FigureFormat::Png].into_iter();
    let asked = |f: &FigureFormat| wanted.iter().any(|name| name == f.extension());
    let out: Vec<FigureFormat> = all.filter(asked).collect();
    match out.iter().find(|f| !f.is_built()) {
        Some(f) => Err(Error::usage("--figures", f.extension(), WITHOUT_PNG, "")),
        None => Ok(out),
    }
}

/// First error of writing to standard output.
static REFUSED: OnceLock<std::io::Error> = OnceLock::new();

/// Prints to standard output. A closed pipe is ignored; other errors are returned by [`printed`].
pub fn print(text: &str) {
    print_styled(&escaped_lines(text));
}

/// Prints a document; text from files is escaped before colours are added.
pub fn print_document(document: &Document) {
    print_styled(&crate::terminal::document_text(document));
}

/// Prints to standard output without escapes.
pub fn print_styled(text: &str) {
    is_printed(text);
}

/// Prints as [`print_styled`]; false where standard output takes no more.
pub fn is_printed(text: &str) -> bool {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    let done = suspended(|| out.write_all(text.as_bytes()).and_then(|()| out.flush()));
    let Err(error) = done else { return true };
    if error.kind() != ErrorKind::BrokenPipe {
        let _ = REFUSED.set(error);
    }
    false
}

/// Returns the exit code, or the error of an earlier write to standard output.
pub fn printed(code: u8) -> Outcome {
    match REFUSED.get() {
        None => Ok(code),
        Some(source) => Err(Error::output(source)),
    }
}

/// Prints a result as the text of its file.
pub fn print_result<T: ResultFile>(file: &T) {
    print_styled(&result_text(file, true).unwrap_or_default());
}

/// Prints a value as JSON.
pub fn print_json<T: serde::Serialize>(value: &T) {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    print_styled(&format!("{}\n", json_escaped(&text)));
}
