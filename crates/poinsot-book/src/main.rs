//! Command line of the book: `build` it, `generate` its pages from the program, `check` both.

use clap::{Parser, Subcommand};
use poinsot_book::{BookError, links, pages, repository, site};
use std::path::PathBuf;
use std::process::ExitCode;

/// The book of Poinsot.
#[derive(Debug, Parser)]
#[command(name = "poinsot-book")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Write the pages and figures that come from the program.
    Generate,
    /// Build the book as HTML and check its links.
    Build {
        /// Folder; default target/book.
        #[arg(long)]
        out: Option<PathBuf>,
    },
    /// Fail if a committed generated page is not what the program says.
    Check,
}

fn main() -> ExitCode {
    match run(Arguments::parse().verb) {
        Ok(said) => {
            println!("{said}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}

fn run(verb: Verb) -> Result<String, BookError> {
    Ok(match verb {
        Verb::Generate => {
            let committed = pages::write(pages::committed()?)?;
            let ignored = pages::write(pages::ignored()?)?;
            format!("{committed} pages written, and {ignored} files that are not committed")
        }
        Verb::Check => format!("{} generated pages are current", pages::check()?),
        Verb::Build { out } => {
            let out = out.unwrap_or_else(|| repository::root().join("target/book"));
            site::build(&out)?;
            let found = links::check(&out)?;
            format!(
                "{}: {} pages, {} links inside, all good; {} to the outside, not followed",
                out.join("index.html").display(),
                found.pages,
                found.inside,
                found.outside
            )
        }
    })
}
