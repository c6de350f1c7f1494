//! Telemetry of one segment: files, arrays, or both.

use crate::arrays::column;
use numpy::PyArray1;
use poinsot_telemetry::{Channel, MemoryColumns, Part, ReadOptions, Table, Values, read_parts};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::Arc;

/// Parts of one segment.
#[pyclass(name = "Record", frozen, module = "poinsot._core")]
pub struct CoreRecord {
    /// Files and columns.
    pub parts: Vec<Part>,
}

#[pymethods]
impl CoreRecord {
    /// A record of files; they are opened where the record is used.
    #[staticmethod]
    fn of_files(paths: Vec<PathBuf>) -> Self {
        Self {
            parts: paths.into_iter().map(Part::File).collect(),
        }
    }

    /// A record of columns: name and array each. Numbers are copied; whole nanoseconds come as integers.
    #[staticmethod]
    fn of_columns(name: String, columns: Vec<(String, Bound<'_, PyAny>)>) -> PyResult<Self> {
        let mut taken = Vec::with_capacity(columns.len());
        for (column_name, array) in columns {
            let values = column(&column_name, &array)?;
            taken.push((column_name, values));
        }
        let memory = MemoryColumns {
            name,
            columns: taken,
        };
        Ok(Self {
            parts: vec![Part::Memory(Arc::new(memory))],
        })
    }

    /// A record of the bytes of a file: CSV, packed or not, or Parquet.
    #[staticmethod]
    fn of_bytes(name: &str, bytes: &[u8]) -> Self {
        Self {
            parts: vec![Part::bytes(name, bytes.to_vec())],
        }
    }

    /// The parts of all records as one.
    #[staticmethod]
    fn join(records: Vec<Bound<'_, CoreRecord>>) -> Self {
        let parts = records.iter().flat_map(|r| r.get().parts.clone());
        Self {
            parts: parts.collect(),
        }
    }

    /// Names of the parts, as messages write them.
    #[getter]
    fn names(&self) -> Vec<String> {
        let names = self.parts.iter().map(|p| p.path().display().to_string());
        names.collect()
    }

    /// Whether all parts are files.
    #[getter]
    fn is_files(&self) -> bool {
        self.parts.iter().all(|p| matches!(p, Part::File(_)))
    }

    /// Channels with standard names: `(time_s, values)` by full name.
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parts = self.parts.clone();
        let table = crate::run::run(py, None, move || Ok(read_parts(&parts, &plain())?))?;
        let out = PyDict::new(py);
        for channel in &table.channels {
            let time = PyArray1::from_slice(py, &channel.time_s);
            let values = PyArray1::from_slice(py, &channel.values);
            out.set_item(channel.full(), (time, values))?;
        }
        Ok(out)
    }
}

/// Everything with a standard name, without a limit: it is in memory, or asked for.
fn plain() -> ReadOptions {
    ReadOptions {
        memory_mib: usize::MAX >> 20,
        ..ReadOptions::default()
    }
}

/// A table in memory as a record: channels with one time base are one part.
pub fn record_of(name: &str, table: &Table) -> CoreRecord {
    let mut bases: Vec<(&Channel, MemoryColumns)> = Vec::new();
    for channel in &table.channels {
        let column = (channel.full(), Values::Numbers(channel.values.clone()));
        match bases.iter_mut().find(|b| b.0.time_s == channel.time_s) {
            Some((_, memory)) => memory.columns.push(column),
            None => {
                let time = Values::Numbers(channel.time_s.to_vec());
                let columns = vec![("time_s".to_owned(), time), column];
                let name = name.to_owned();
                bases.push((channel, MemoryColumns { name, columns }));
            }
        }
    }
    let parts = bases.into_iter().map(|(_, m)| Part::Memory(Arc::new(m)));
    CoreRecord {
        parts: parts.collect(),
    }
}
