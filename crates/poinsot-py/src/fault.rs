//! Errors of the verbs as exceptions of Python.

use poinsot_formats::ErrorFile;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The faults of a command.
pub struct Fault(pub poinsot::Error);

impl From<poinsot::Error> for Fault {
    fn from(error: poinsot::Error) -> Self {
        Self(error)
    }
}

impl Fault {
    /// An argument that cannot be used.
    pub fn argument(
        option: &'static str,
        value: impl std::fmt::Display,
        problem: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self(poinsot::Error::usage(option, value, problem, advice))
    }

    fn exception(&self, py: Python<'_>) -> PyResult<PyErr> {
        let make = py.import("poinsot._errors")?.getattr("of")?;
        let exit_code = ErrorFile::of(&self.0).exit_code;
        let made = make.call1((exit_code, self.0.to_string()))?;
        Ok(PyErr::from_value(made))
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        Python::attach(|py| {
            let plain = |_| PyRuntimeError::new_err(fault.0.to_string());
            fault.exception(py).unwrap_or_else(plain)
        })
    }
}
