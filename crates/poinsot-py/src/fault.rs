//! Errors of the verbs as exceptions of Python.

use poinsot_cli::Failure;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// An error line with the exit code of the command.
pub struct Fault {
    /// One line or several findings, each with its code.
    pub message: String,
    /// 2: input, 3: environment, 4: a fault of the program.
    pub exit_code: u8,
}

impl<E: Into<poinsot::Error>> From<E> for Fault {
    fn from(error: E) -> Self {
        Self::of(Failure::from(error))
    }
}

impl Fault {
    /// From what the command would print.
    pub fn of(failure: Failure) -> Self {
        Self {
            message: failure.message,
            exit_code: failure.file.exit_code,
        }
    }

    /// An argument that cannot be used.
    pub fn argument(
        option: &'static str,
        value: impl Into<String>,
        why: impl Into<String>,
    ) -> Self {
        Self::from(poinsot::Error::usage(option, value.into(), why.into()))
    }

    /// As the command would print it.
    pub fn into_failure(self) -> Failure {
        Failure::of_lines(self.message, self.exit_code)
    }

    fn exception(&self, py: Python<'_>) -> PyResult<PyErr> {
        let make = py.import("poinsot._errors")?.getattr("of")?;
        let made = make.call1((self.exit_code, self.message.as_str()))?;
        Ok(PyErr::from_value(made))
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        Python::attach(|py| {
            let plain = |_| PyRuntimeError::new_err(fault.message.clone());
            fault.exception(py).unwrap_or_else(plain)
        })
    }
}
