//! What can go wrong with the book.

use std::path::{Path, PathBuf};

/// Why the book cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum BookError {
    /// The disk.
    #[error("{}: {source}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A generated page is not what the program says today.
    #[error(
        "{}: out of date; run: cargo run --release -p poinsot-book -- generate",
        .0.display()
    )]
    Stale(PathBuf),
    /// A formula.
    #[error("{page}: formula `{formula}`: {why}")]
    Formula {
        /// Page.
        page: String,
        /// As written.
        formula: String,
        /// What is wrong with it.
        why: String,
    },
    /// Links.
    #[error("broken links:\n  {}", .0.join("\n  "))]
    Links(Vec<String>),
    /// A link to a file that is not in the repository.
    #[error("{page}: link to '{target}', which is not there")]
    Missing {
        /// Page.
        page: String,
        /// As written.
        target: String,
    },
    /// The program refused an example.
    #[error("{example}: {source}")]
    Example {
        /// Name.
        example: String,
        /// Why.
        source: Box<poinsot::Error>,
    },
    /// A page has two headings of one name, so that links to it are ambiguous, or no heading.
    #[error("{0}: a page begins with one heading of the first level")]
    Heading(String),
    /// mdBook.
    #[error("mdbook: {0}")]
    Book(String),
}

impl BookError {
    /// For `map_err` on what touches a path.
    pub fn io(path: &Path) -> impl Fn(std::io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}
