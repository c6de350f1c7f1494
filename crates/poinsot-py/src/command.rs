//! The command `poinsot` inside of Python.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command with these words, the name of the program first, and gives its exit code. It takes over the
/// signals of the process.
#[pyfunction]
pub fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| poinsot_cli::run(words))
}
