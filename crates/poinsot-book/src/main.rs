//! Writes the pages of `docs/` that come from the program, or checks them.

#![allow(non_snake_case)]

mod commands;
mod formats;
mod validation;
mod verdicts;

use clap::Parser;
use minijinja::{Environment, Value, path_loader};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Why the pages cannot be made, in words.
type Fault = Box<dyn Error>;

/// Writes the pages of the book that come from the program.
#[derive(Debug, Parser)]
#[command(name = "poinsot-book")]
struct Arguments {
    /// Fail if a committed page is not what the program says, instead of writing it.
    #[arg(long)]
    check: bool,
}

/// A page, by its path in `docs`.
struct Made {
    name: String,
    text: String,
}

fn main() -> ExitCode {
    match write(Arguments::parse().check) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn write(check: bool) -> Result<(), Fault> {
    for page in pages()? {
        if check {
            current(&page)?;
        } else {
            put(&page)?;
        }
    }
    Ok(())
}

/// A file of the repository.
fn repository(name: &str) -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.join("../..").join(name)
}

/// The text of a file of the repository.
fn read(name: &str) -> Result<String, Fault> {
    let path = repository(name);
    fs::read_to_string(&path).map_err(|why| format!("{}: {why}", path.display()).into())
}

/// The pages, each by the template of its name in `pages/`.
fn pages() -> Result<Vec<Made>, Fault> {
    let contexts = [
        ("reference/commands.md", commands::commands()),
        (
            "reference/formats.md",
            formats::format("model", "top level"),
        ),
        ("reference/case.md", formats::format("case", "Keys")),
        ("reference/results.md", formats::results()),
        ("reference/verdicts.md", verdicts::verdicts()),
        ("validation.md", validation::validation()?),
    ];
    let mut templates = Environment::new();
    templates.set_trim_blocks(true);
    templates.set_loader(path_loader(repository("crates/poinsot-book/pages")));
    let made = |(name, context): (&str, Value)| {
        let template = templates.get_template(name.trim_start_matches("reference/"))?;
        let (name, text) = (name.to_owned(), template.render(context)?);
        Ok(Made { name, text })
    };
    contexts.into_iter().map(made).collect()
}

fn current(page: &Made) -> Result<(), Fault> {
    let name = format!("docs/{}", page.name);
    if read(&name)? == page.text {
        return Ok(());
    }
    Err(format!("{name}: out of date; run: scripts/book generate").into())
}

fn put(made: &Made) -> Result<(), Fault> {
    Ok(fs::write(repository("docs").join(&made.name), &made.text)?)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn cli_committed_pages_are_what_the_program_says() {
        for page in pages().unwrap() {
            current(&page).unwrap();
        }
    }
}
