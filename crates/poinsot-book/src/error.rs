//! Errors of building the book.

use std::path::{Path, PathBuf};

/// Why the book cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BookError {
    /// Error of the operating system.
    #[error("{}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// The error.
        source: std::io::Error,
    },
    /// A generated page is out of date.
    #[error(
        "{}: out of date; run: scripts/book generate",
        .0.display()
    )]
    Stale(PathBuf),
    /// A case of bad input cannot be read.
    #[error("{}: {why}", path.display())]
    Case {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// An invalid formula.
    #[error("{page}: formula `{formula}`: {why}")]
    Formula {
        /// Page.
        page: String,
        /// As written.
        formula: String,
        /// What is wrong with it.
        why: String,
    },
    /// Broken links.
    #[error("broken links:\n  {}", .0.join("\n  "))]
    Links(Vec<String>),
    /// A link to a file missing in the repository.
    #[error("{page}: link to '{target}', which is not there")]
    Missing {
        /// Page.
        page: String,
        /// As written.
        target: String,
    },
    /// An example failed.
    #[error("{example}: {source}")]
    Example {
        /// Name.
        example: String,
        /// Error of the program.
        source: Box<poinsot::Error>,
    },
    /// A page without heading, or with two equal headings, so that links to it are ambiguous.
    #[error("{0}: a page begins with one heading of the first level")]
    Heading(String),
    /// Error of mdBook.
    #[error("mdbook: {0}")]
    Book(String),
}

impl BookError {
    /// For `map_err` of operations on a path.
    pub fn io(path: &Path) -> impl Fn(std::io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}
