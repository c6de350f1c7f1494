//! Studies of the papers: what a paper states, computed again, as tables, figures and the numbers of its page.
//!
//! A study is one function of a [`Context`]. Its paper lists it in [`crate::Method::studies`]; the command line, the tests
//! and the pages read that list. Simulation and identification belong to the crate above, so a study calls them
//! through [`Tools`], which the verb hands in.

mod context;
mod findings;
pub mod statistics;

pub use context::{CaseText, Context, Difference, StudyError, Tools};
pub use findings::{Cell, Digits, Findings, Table, decimals, figures, percent, word};

/// What a study does with its context.
pub type Run = fn(&Context) -> Result<Findings, StudyError>;

/// A study of a paper.
#[derive(Clone, Copy)]
pub struct Study {
    /// Name on the command line, unique within the paper.
    pub name: &'static str,
    /// What it computes, in one line.
    pub summary: &'static str,
    /// Whether it ends within seconds.
    pub quick: bool,
    /// The study itself.
    pub run: Run,
}

impl Study {
    /// One that ends within seconds.
    pub const fn quick(name: &'static str, summary: &'static str, run: Run) -> Self {
        Self {
            name,
            summary,
            quick: true,
            run,
        }
    }

    /// One that takes minutes.
    pub const fn slow(name: &'static str, summary: &'static str, run: Run) -> Self {
        Self {
            quick: false,
            ..Self::quick(name, summary, run)
        }
    }
}
