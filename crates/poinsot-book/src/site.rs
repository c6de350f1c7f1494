//! Builds HTML from Markdown.

use crate::error::BookError;
use crate::pages;
use crate::repository::root;
use crate::rewrite::rewrite;
use crate::summary::summary;
use mdbook_driver::MDBook;
use mdbook_driver::book::Book;
use mdbook_driver::config::Config;
use mdbook_driver::errors::Error;
use mdbook_preprocessor::{Preprocessor, PreprocessorContext};
use std::path::Path;

/// Preprocessor for formulas and links.
struct Rewriting;

impl Preprocessor for Rewriting {
    fn name(&self) -> &'static str {
        "poinsot"
    }

    fn run(&self, _: &PreprocessorContext, mut book: Book) -> Result<Book, Error> {
        let mut fault = None;
        book.for_each_chapter_mut(|chapter| {
            if let Some(page) = &chapter.source_path {
                match rewrite(page, &chapter.content) {
                    Ok(text) => chapter.content = text,
                    Err(e) => fault = Some(e),
                }
            }
        });
        match fault {
            Some(fault) => Err(fault.into()),
            None => Ok(book),
        }
    }
}

/// Makes the pages and figures that git ignores, and builds the book into a folder.
///
/// # Errors
/// A page, formula or link is invalid, a study fails, or writing fails.
pub fn build(into: &Path) -> Result<(), BookError> {
    pages::write(pages::ignored()?)?;
    let root = root();
    let fault = |e: Error| BookError::Book(format!("{e:#}"));
    let mut config = Config::from_disk(root.join("book.toml")).map_err(fault)?;
    config.build.build_dir = into.to_owned();
    let summary = mdbook_summary::parse_summary(&summary()?).map_err(fault)?;
    let mut book = MDBook::load_with_config_and_summary(root, config, summary).map_err(fault)?;
    book.with_preprocessor(Rewriting);
    book.build().map_err(fault)
}
