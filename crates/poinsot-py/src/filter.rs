//! The on-board filter on rows as they arrive.

use crate::fault::Fault;
use crate::model::CoreModel;
use crate::record::CoreRecord;
use poinsot::Follower;
use pyo3::prelude::*;

/// The filter of a model with what it has read.
#[pyclass(name = "Filter", module = "poinsot._core")]
pub struct CoreFilter(Follower);

#[pymethods]
impl CoreFilter {
    #[new]
    fn new(model: &CoreModel, every_s: f64) -> PyResult<Self> {
        let follower = Follower::of(model.model.clone(), every_s);
        Ok(Self(follower.map_err(Fault::from)?))
    }

    #[getter]
    fn assumed(&self) -> Vec<String> {
        self.0.assumed().to_vec()
    }

    /// Lines of JSON, at most one every `every_s` seconds of the record. The first row is the last one of the batch before.
    fn push(&mut self, py: Python<'_>, record: &CoreRecord) -> PyResult<Vec<String>> {
        let pushed = py.detach(|| self.0.push_parts(&record.parts));
        let pushed = pushed.map_err(Fault::from)?;
        Ok(pushed.iter().map(poinsot::Followed::json).collect())
    }

    /// A line of JSON for a time, s; for the last row without one. None before the second row.
    #[pyo3(signature = (time_s=None))]
    fn at(&mut self, time_s: Option<f64>) -> Option<String> {
        Some(self.0.at(time_s)?.json())
    }

    /// The last line, after the rows that are held back.
    fn end(&mut self) -> Option<String> {
        Some(self.0.end()?.json())
    }
}
