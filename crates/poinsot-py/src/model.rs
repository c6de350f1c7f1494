//! The vehicle.

use crate::fault::Fault;
use crate::value::to_toml;
use poinsot_dynamics::Tree;
use poinsot_model::{
    Joint, Model, describe, parse_model, read_model, read_telemetry_map, read_urdf, write_model,
};
use poinsot_spatial::InertialParameters;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// What messages call a model that was not read from a file.
const IN_MEMORY: &str = "<model>";

/// A checked vehicle.
#[pyclass(name = "Model", frozen, module = "poinsot._core")]
pub struct CoreModel {
    /// The vehicle.
    pub model: Model,
    /// Its kinematics.
    pub tree: Arc<Tree>,
    /// Nominal parameters of each body.
    pub nominal: Vec<InertialParameters>,
    /// The file that it was read from; `None` for a model in memory, or one that was changed.
    pub file: Option<PathBuf>,
}

impl From<Model> for CoreModel {
    fn from(model: Model) -> Self {
        Self {
            tree: Arc::new(Tree::new(&model)),
            nominal: model.nominal_parameters(),
            file: None,
            model,
        }
    }
}

impl CoreModel {
    fn from_file(model: Model, path: PathBuf) -> Self {
        Self {
            file: Some(path),
            ..model.into()
        }
    }
}

#[pymethods]
impl CoreModel {
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let model = read_model(&path).map_err(Fault::from)?;
        Ok(Self::from_file(model, path))
    }

    #[staticmethod]
    fn from_urdf(path: PathBuf) -> PyResult<Self> {
        let model = read_urdf(&path).model.map_err(Fault::from)?;
        Ok(Self::from_file(model, path))
    }

    #[staticmethod]
    #[pyo3(signature = (text, name=None))]
    fn from_text(text: &str, name: Option<&str>) -> PyResult<Self> {
        let model = parse_model(text, name.unwrap_or(IN_MEMORY));
        Ok(model.map_err(Fault::from)?.into())
    }

    #[staticmethod]
    fn from_dict(values: &Bound<'_, PyAny>) -> PyResult<Self> {
        let value = to_toml(values, "", 0)?;
        let text = toml::to_string(&value).map_err(|e| {
            Fault::argument("model", IN_MEMORY, format!("{e}"), "give a dictionary")
        })?;
        Self::from_text(&text, None)
    }

    /// The same vehicle with the `[telemetry]` table of a file.
    fn with_map(&self, path: PathBuf) -> PyResult<Self> {
        let mut model = self.model.clone();
        model.telemetry = read_telemetry_map(&path).map_err(Fault::from)?;
        Ok(model.into())
    }

    fn to_toml(&self) -> String {
        write_model(&self.model)
    }

    /// The tables of the model file.
    fn json(&self) -> PyResult<String> {
        let tables: toml::Table = write_model(&self.model).parse().unwrap_or_default();
        Ok(crate::printed::json(&tables)?)
    }

    fn write(&self, path: PathBuf) -> PyResult<()> {
        let text = write_model(&self.model);
        Ok(poinsot::write_file(&path, text.as_bytes()).map_err(Fault::from)?)
    }

    /// JSON and text of `poinsot check`.
    fn check(&self) -> PyResult<(String, String)> {
        let description = describe(&self.model);
        Ok((crate::printed::json(&description)?, description.to_string()))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.model.bodies.iter().map(|b| b.name.as_str()).collect()
    }

    /// Names of the joint coordinates, in the order of `q`.
    #[getter]
    fn coordinates(&self) -> Vec<&str> {
        let joints = self.model.moving_joints();
        joints.map(|j| j.name.as_str()).collect()
    }

    /// Units of the joint coordinates.
    #[getter]
    fn coordinate_units(&self) -> Vec<&str> {
        let unit = |j: &Joint| if j.slides() { "m" } else { "rad" };
        self.model.moving_joints().map(unit).collect()
    }

    #[getter]
    fn wheels(&self) -> Vec<&str> {
        self.model.wheels.iter().map(|w| w.name.as_str()).collect()
    }

    #[getter]
    fn thrusters(&self) -> Vec<&str> {
        let all = self.model.thrusters.iter();
        all.map(|t| t.name.as_str()).collect()
    }

    #[getter]
    fn sensors(&self) -> Vec<&str> {
        self.model.sensors.iter().map(|s| s.name.as_str()).collect()
    }

    /// Nominal parameters, ten a body.
    #[getter]
    fn parameters(&self) -> Vec<[f64; 10]> {
        self.nominal
            .iter()
            .map(InertialParameters::to_array)
            .collect()
    }
}
