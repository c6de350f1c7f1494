//! The generated pages, and the check that the committed ones are current.

use crate::error::BookError;
use crate::repository::{ROOT_PAGES, root};
use crate::{commands, formats, validation, verdicts};
use std::path::PathBuf;

/// Path and text of every generated page.
///
/// # Errors
/// An example fails.
pub fn generated() -> Result<Vec<(PathBuf, String)>, BookError> {
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

/// Writes the changed pages and returns their paths.
///
/// # Errors
/// Writing fails.
pub fn generate() -> Result<Vec<PathBuf>, BookError> {
    let mut changed = Vec::new();
    for (path, text) in generated()? {
        if std::fs::read_to_string(&path).ok().as_deref() != Some(text.as_str()) {
            std::fs::write(&path, text).map_err(BookError::io(&path))?;
            changed.push(path);
        }
    }
    Ok(changed)
}

/// Compares the committed pages instead of writing.
///
/// # Errors
/// The first page that is out of date.
pub fn check() -> Result<usize, BookError> {
    let pages = generated()?;
    for (path, text) in &pages {
        let written = std::fs::read_to_string(path).map_err(BookError::io(path))?;
        if written != *text {
            return Err(BookError::Stale(path.clone()));
        }
    }
    Ok(pages.len())
}
