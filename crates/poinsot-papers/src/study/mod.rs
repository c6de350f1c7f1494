//! Studies recompute the statements of a paper as tables, figures and numbers of its page.
//!
//! A study is a function of a [`Context`], listed in [`crate::Method::studies`]. The command line, the tests and the
//! pages use that list. Simulation and identification are in the `poinsot` crate, so a study calls them through
//! [`Tools`].

mod context;
mod findings;
pub mod statistics;

pub use context::{CaseText, Context, Difference, StudyError, Tools, without_translation};
pub(crate) use findings::curves;
pub use findings::{Cell, Digits, Findings, Table};

/// Function of a study.
pub type Run = fn(&Context) -> Result<Findings, StudyError>;

/// A study of a paper.
#[derive(Clone, Copy)]
pub struct Study {
    /// Name on the command line, unique within the paper.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Whether it takes only seconds.
    pub quick: bool,
    /// Function.
    pub run: Run,
}

impl Study {
    /// A study that takes seconds.
    pub const fn quick(name: &'static str, summary: &'static str, run: Run) -> Self {
        Self {
            name,
            summary,
            quick: true,
            run,
        }
    }

    /// A study that takes minutes.
    pub const fn slow(name: &'static str, summary: &'static str, run: Run) -> Self {
        Self {
            quick: false,
            ..Self::quick(name, summary, run)
        }
    }
}
