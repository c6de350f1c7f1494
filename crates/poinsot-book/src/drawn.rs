//! Figures of the papers' pages, drawn by the studies that take seconds. Those of the others are committed.

use crate::error::BookError;
use crate::repository::root;
use poinsot::study::{Study, run, studies};
use std::path::PathBuf;

/// Path and text of every figure that a page shows.
///
/// # Errors
/// A study fails, or a page cannot be read.
pub fn figures() -> Result<Vec<(PathBuf, String)>, BookError> {
    let mut all = Vec::new();
    for (paper, study) in studies().filter(|s| s.1.quick) {
        all.extend(of_study(paper, study)?);
    }
    Ok(all)
}

fn of_study(paper: &str, study: &Study) -> Result<Vec<(PathBuf, String)>, BookError> {
    let pages = root().join("docs/methods");
    let page = pages.join(format!("{paper}.md"));
    let text = std::fs::read_to_string(&page).map_err(BookError::io(&page))?;
    let failed = |source| BookError::Example {
        example: format!("{paper} {}", study.name),
        source: Box::new(source),
    };
    let findings = run(study, &root().join("data")).map_err(failed)?;
    let names = |f: &poinsot_figures::Figure| format!("{paper}/{}.svg", f.name);
    let shown = findings.figures.iter().map(|f| (names(f), f.svg()));
    Ok(shown
        .filter(|(name, _)| text.contains(name))
        .filter_map(|(name, svg)| Some((pages.join(name), svg?)))
        .collect())
}
