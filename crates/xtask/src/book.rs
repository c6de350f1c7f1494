//! Builds the program of the book and runs it.

use crate::fault::Fault;
use crate::repository::{build_programs, built, code, status};

/// Runs `poinsot-book` with these arguments; its exit code is that of this command.
pub fn run(arguments: &[String]) -> Result<(), Fault> {
    build_programs()?;
    let status = status(built("poinsot-book").args(arguments))?;
    status
        .success()
        .then_some(())
        .ok_or(Fault::Ended(code(status)))
}
