//! The page of bad input and the messages of the page of error codes, from the case files of `validation/bad_input/`.

use crate::error::BookError;
use crate::library;
use poinsot::explain::{ErrorCode, error_codes};
use poinsot_testkit::faults::{Fill, SECTIONS, filled, folder, names};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// What the page shows of a case.
#[derive(Deserialize)]
struct Case {
    id: String,
    fault: String,
    exit: i32,
    #[serde(default)]
    run: Vec<String>,
    #[serde(default)]
    more: Vec<String>,
    #[serde(default)]
    fill: Vec<Fill>,
    #[serde(default)]
    printed: Vec<String>,
    /// Whether the page of error codes shows this message rather than the first one of the code.
    #[serde(default)]
    example: bool,
}

/// Heading and cases of every section.
type Sections = Vec<(&'static str, Vec<Case>)>;

/// Least exit code of a refusal.
const REFUSED: i32 = 2;

fn sections() -> Result<Sections, BookError> {
    SECTIONS.iter().map(|s| section(s.0, s.1)).collect()
}

fn section(name: &str, title: &'static str) -> Result<(&'static str, Vec<Case>), BookError> {
    let mut cases = Vec::new();
    for (_, path) in names(name).map_err(BookError::io(&folder()))? {
        let text = std::fs::read_to_string(&path).map_err(BookError::io(&path))?;
        let case = toml::from_str(&text).map_err(|e| BookError::Case {
            path,
            why: e.to_string(),
        });
        cases.push(case?);
    }
    Ok((title, cases))
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
        .replace('<', "&lt;")
        .replace('\n', " ")
}

/// A text beside the cases.
fn beside(name: &str) -> Result<String, BookError> {
    let path = folder().join(name);
    std::fs::read_to_string(&path).map_err(BookError::io(&path))
}

/// `docs/validation/bad_input.md`.
///
/// # Errors
/// A case file cannot be read.
pub fn page() -> Result<String, BookError> {
    let sections = sections()?;
    let cases: usize = sections.iter().map(|s| s.1.len()).sum();
    let mut out = beside("header.md")?.replace("{cases}", &cases.to_string());
    for (title, cases) in &sections {
        let _ = writeln!(
            out,
            "## {title}\n\n| | fault | exit | printed |\n|---|---|---|---|"
        );
        for case in cases {
            out.push_str(&row(case)?);
        }
        out.push('\n');
    }
    out.push_str(&beside("differences.md")?);
    Ok(out)
}

/// A case in its table, with the further arguments of the default command, or another command.
fn row(case: &Case) -> Result<String, BookError> {
    let quoted = |l: &String| format!("`{}`", cell(l).replace('`', "'"));
    let lines: Vec<String> = case.printed.iter().map(quoted).collect();
    let words = filled(case.run.iter().chain(&case.more), &case.fill);
    let words = words.map_err(|why| BookError::Case {
        path: folder().join(&case.id),
        why,
    })?;
    let more = match words.join(" ") {
        none if none.is_empty() => none,
        more => format!(" (`{}`)", cell(&more).replace('\u{1b}', "ESC")),
    };
    let (id, fault, exit) = (&case.id, cell(&case.fault), case.exit);
    let lines = lines.join("<br>");
    Ok(format!("| {id} | {fault}{more} | {exit} | {lines} |\n"))
}

/// A printed message, and why no input of the command causes it, where that is so.
pub type Message = (String, Option<&'static str>);

/// For each code the first complete message of the cases, or one of the library.
///
/// # Errors
/// A case file cannot be read.
pub fn messages() -> Result<BTreeMap<String, Message>, BookError> {
    let sections = sections()?;
    let mut refused: Vec<&Case> = sections.iter().flat_map(|s| &s.1).collect();
    refused.retain(|case| case.exit >= REFUSED);
    refused.sort_by_key(|case| !case.example);
    let mut all = BTreeMap::new();
    for line in refused.iter().flat_map(|case| &case.printed) {
        if let Some(code) = line.get(..5).filter(|c| c.starts_with('E')) {
            all.entry(code.to_owned()).or_insert((line.clone(), None));
        }
    }
    for (message, why) in library::messages() {
        let code = message.chars().take(5).collect();
        all.entry(code).or_insert((message, why));
    }
    Ok(all)
}

/// `docs/reference/errors.md`.
///
/// # Errors
/// A case file cannot be read.
pub fn errors() -> Result<String, BookError> {
    let messages = messages()?;
    let mut out = String::from(
        "# Error codes\n\n`poinsot explain CODE` prints these. Every error is one line: code, place, what was read, what is wrong, what to do.\n\
         The first two digits say where: 00 command, 01 model, 02 telemetry, 03 model and telemetry together, 04 and 05 methods\n\
         and simulation, 06 results. Exit code 2, but 3 for E0002 to E0006 and for what the operating system refuses, 4 for E0009.\n\
         The examples are what the program prints; a test compares them.\n\n",
    );
    for code in error_codes() {
        out.push_str(&entry(&code, messages.get(code.code)));
    }
    Ok(out)
}

/// The section of a code.
fn entry(c: &ErrorCode, message: Option<&Message>) -> String {
    let mut out = format!(
        "## {}\n\n{}\n\n- Usual cause: {}\n- What to do: {}\n",
        c.code, c.meaning, c.cause, c.remedy
    );
    if let Some((message, why)) = message {
        let note = why.map_or(String::new(), |w| format!(" ({w})"));
        let _ = writeln!(out, "- Example{note}:\n\n      {message}");
    }
    out.push('\n');
    out
}
