//! A problem for a method of one's own.

use crate::answer::{Options, parts};
use crate::model::CoreModel;
use crate::record::CoreRecord;
use crate::run::run;
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use poinsot::{Gated, gated};
use poinsot_identify::{EvaluatedUnknown, Evaluator, Problem};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// Model and records behind the gate of `identify`.
#[pyclass(name = "Problem", frozen, module = "poinsot._core")]
pub struct CoreProblem {
    gated: Arc<Gated>,
    relative_accuracy: f64,
    unknowns: Vec<EvaluatedUnknown>,
    nominal: Vec<f64>,
}

fn asked(gated: &Gated, relative_accuracy: f64) -> Problem<'_> {
    Problem {
        relative_accuracy,
        ..gated.bound.problem(&gated.model, &gated.tree)
    }
}

#[pymethods]
impl CoreProblem {
    #[new]
    fn new(
        py: Python<'_>,
        model: &CoreModel,
        records: Vec<Bound<'_, CoreRecord>>,
        options: Options,
    ) -> PyResult<Self> {
        let model = model.model.clone();
        let records = parts(&records);
        run(py, None, move || {
            let Options { question, reading } = options;
            let gated = gated(model, &records, &reading, &question)?;
            let accuracy = question.relative_accuracy;
            let evaluator = Evaluator::new(&asked(&gated, accuracy))?;
            let (unknowns, nominal) = (evaluator.unknowns().to_vec(), evaluator.nominal());
            Ok(Self {
                gated: Arc::new(gated),
                relative_accuracy: accuracy,
                unknowns,
                nominal,
            })
        })
    }

    /// Names of the unknowns.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.unknowns.iter().map(|u| u.name.as_str()).collect()
    }

    /// Units of the unknowns.
    #[getter]
    fn units(&self) -> Vec<&str> {
        self.unknowns.iter().map(|u| u.unit).collect()
    }

    /// Values of the model and of the first samples.
    #[getter]
    fn nominal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.nominal)
    }

    /// Assumptions and repairs.
    #[getter]
    fn repairs(&self) -> Vec<String> {
        self.gated.bound.repairs.clone()
    }

    /// Residuals, slopes, information and likelihood.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        theta: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let values = theta.as_array().to_vec();
        let gated = Arc::clone(&self.gated);
        let accuracy = self.relative_accuracy;
        let found = run(py, None, move || {
            let evaluator = Evaluator::new(&asked(&gated, accuracy))?;
            Ok(evaluator.at(&values)?)
        })?;
        let out = PyDict::new(py);
        out.set_item(
            "residual",
            PyArray1::from_slice(py, found.residuals.as_slice()),
        )?;
        out.set_item("jacobian", matrix(py, &found.jacobian)?)?;
        out.set_item("information", matrix(py, &found.information)?)?;
        let covariance = found.covariance.as_ref();
        let covariance = covariance.map(|c| matrix(py, c)).transpose()?;
        out.set_item("covariance", covariance)?;
        out.set_item("log_likelihood", found.log_likelihood)?;
        out.set_item("log_prior", found.log_prior)?;
        let sensors = found.sensors.iter().map(|s| {
            let vectors = |list: &[poinsot_spatial::Vector3]| {
                let rows: Vec<Vec<f64>> = list.iter().map(|v| vec![v.x, v.y, v.z]).collect();
                PyArray2::from_vec2(py, &rows)
            };
            let entry = PyDict::new(py);
            entry.set_item("segment", &s.segment)?;
            entry.set_item("sensor", &s.sensor)?;
            entry.set_item("unit", s.unit)?;
            entry.set_item("time_s", PyArray1::from_slice(py, &s.time_s))?;
            entry.set_item("raw", vectors(&s.raw)?)?;
            entry.set_item("white", vectors(&s.white)?)?;
            entry.set_item("first_row", s.first_row)?;
            Ok(entry)
        });
        out.set_item("sensors", sensors.collect::<PyResult<Vec<_>>>()?)?;
        Ok(out)
    }
}

/// A matrix as a C-contiguous array.
fn matrix<'py>(py: Python<'py>, m: &DMatrix<f64>) -> PyResult<Bound<'py, PyAny>> {
    // Columns of the transpose are the rows.
    let rows = PyArray1::from_slice(py, m.transpose().as_slice());
    rows.call_method1("reshape", (m.nrows(), m.ncols()))
}
