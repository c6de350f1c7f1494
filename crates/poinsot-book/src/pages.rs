//! The generated pages: the committed ones, the check that they are current, and those that only the book has.

use crate::error::BookError;
use crate::repository::{ROOT_PAGES, root};
use crate::{bad_input, commands, drawn, formats, validation, verdicts};
use std::path::PathBuf;

/// Path and text of every generated page that is committed, because pages of the repository link to it.
///
/// # Errors
/// An example fails.
pub fn committed() -> Result<Vec<(PathBuf, String)>, BookError> {
    let docs = root().join("docs");
    let mut pages = vec![
        (docs.join("reference/commands.md"), commands::page()),
        (docs.join("reference/formats.md"), formats::page()),
        (docs.join("reference/case.md"), formats::case_page()),
        (docs.join("reference/results.md"), formats::results_page()),
        (docs.join("reference/verdicts.md"), verdicts::page()),
        (docs.join("validation.md"), validation::page()?),
    ];
    for (file, page) in ROOT_PAGES {
        let up = "../".repeat(page.split('/').count());
        pages.push((docs.join(page), format!("{{{{#include {up}{file}}}}}\n")));
    }
    Ok(pages)
}

/// Path and text of every page and figure that git ignores: links of the repository lead to their sources.
///
/// # Errors
/// A case of bad input cannot be read, or a study fails.
pub fn ignored() -> Result<Vec<(PathBuf, String)>, BookError> {
    let docs = root().join("docs");
    let mut all = drawn::figures()?;
    all.push((docs.join("validation/bad_input.md"), bad_input::page()?));
    all.push((docs.join("reference/errors.md"), bad_input::errors()?));
    Ok(all)
}

/// Writes what has changed, and returns the number of written files.
///
/// # Errors
/// Writing fails.
pub fn write(files: Vec<(PathBuf, String)>) -> Result<usize, BookError> {
    let mut changed = 0;
    for (path, text) in files {
        if std::fs::read_to_string(&path).ok().as_deref() == Some(text.as_str()) {
            continue;
        }
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(BookError::io(folder))?;
        }
        std::fs::write(&path, text).map_err(BookError::io(&path))?;
        changed += 1;
    }
    Ok(changed)
}

/// Compares the committed pages instead of writing.
///
/// # Errors
/// The first page that is out of date.
pub fn check() -> Result<usize, BookError> {
    let pages = committed()?;
    for (path, text) in &pages {
        let written = std::fs::read_to_string(path).map_err(BookError::io(path))?;
        if written != *text {
            return Err(BookError::Stale(path.clone()));
        }
    }
    Ok(pages.len())
}
