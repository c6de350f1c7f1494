//! The verb `identify` and its answer.

use crate::fault::Fault;
use crate::model::CoreModel;
use crate::record::CoreRecord;
use crate::run::run;
use numpy::{PyArray1, PyArray2};
use poinsot::report::report_data;
use poinsot::{
    Coordinates, IDENTIFY_MIB, Identified, Modes, Question, Reading, estimate_file, estimate_text,
    identify_records, row_step, write_result,
};
use poinsot_figures::{FigureFormat, TextStyle, WITHOUT_PNG};
use poinsot_identify::PredictedChannel;
use poinsot_report::{Detail, estimate_document, report_html};
use poinsot_telemetry::{Encoding, Part};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is asked of the telemetry, and how it is read: the options of the command.
pub struct Options {
    /// The question.
    pub question: Question,
    /// How files are read.
    pub reading: Reading,
}

impl<'py> FromPyObject<'_, 'py> for Options {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let given = &*object.cast::<PyDict>()?;
        let usual = Question::default();
        let every = entry(given, "every")?.unwrap_or(1);
        let every = row_step(every).map_err(Fault::from)?;
        let coordinates = entry(given, "coordinates")?;
        let modes = entry(given, "modes")?;
        let encoded = entry(given, "encoding")?;
        Ok(Self {
            question: Question {
                method: entry(given, "method")?.unwrap_or(usual.method),
                variant: entry(given, "variant")?,
                settings: entry(given, "settings")?.unwrap_or_default(),
                relative_accuracy: entry(given, "relative_accuracy")?
                    .unwrap_or(usual.relative_accuracy),
                coordinates: chosen(
                    "--coordinates",
                    coordinates,
                    &Coordinates::NAMES,
                    Coordinates::from_name,
                )?,
                modes: chosen("--modes", modes, &Modes::NAMES, Modes::from_name)?,
                strict: entry(given, "strict")?.unwrap_or(usual.strict),
                repair: entry(given, "repair")?.unwrap_or(usual.repair),
                policies: entry(given, "policies")?.unwrap_or_default(),
            },
            reading: Reading {
                model: None,
                map: entry(given, "map")?,
                recover: entry(given, "recover")?.unwrap_or(false),
                encoding: chosen("--encoding", encoded, &Encoding::NAMES, Encoding::from_name)?,
                time_s: entry(given, "time_s")?,
                every,
                memory_mib: entry(given, "memory_mib")?.unwrap_or(IDENTIFY_MIB),
            },
        })
    }
}

/// An entry that may be absent or `None`.
fn entry<'py, T>(given: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<T>>
where
    T: for<'a> FromPyObject<'a, 'py, Error = PyErr>,
{
    match given.get_item(name)? {
        Some(value) if !value.is_none() => Ok(Some(value.extract()?)),
        _ => Ok(None),
    }
}

/// A choice by its name, by default the usual one.
///
/// # Errors
/// There is no such choice.
pub fn chosen<T: Default>(
    option: &'static str,
    name: Option<String>,
    names: &[&str],
    of: impl Fn(&str) -> Option<T>,
) -> Result<T, Fault> {
    let Some(name) = name else {
        return Ok(T::default());
    };
    of(&name).ok_or_else(|| {
        let advice = format!("use one of {}", names.join(", "));
        Fault::argument(option, &name, "there is no such choice", advice)
    })
}

/// The parts of every record.
pub fn parts(records: &[Bound<'_, CoreRecord>]) -> Vec<Vec<Part>> {
    records.iter().map(|r| r.get().parts.clone()).collect()
}

/// Identifies the unknown mass properties.
#[pyfunction]
#[pyo3(signature = (model, records, options, progress=None))]
pub fn identify(
    py: Python<'_>,
    model: &CoreModel,
    records: Vec<Bound<'_, CoreRecord>>,
    options: Options,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<CoreAnswer> {
    let (from, model) = (model.file.clone(), model.model.clone());
    let records = parts(&records);
    let identified = run(py, progress.as_ref(), move || {
        let Options { question, reading } = options;
        let reading = Reading {
            model: from,
            ..reading
        };
        Ok(identify_records(model, &records, &reading, &question)?)
    })?;
    Ok(CoreAnswer {
        identified: Arc::new(identified),
    })
}

/// An answer.
#[pyclass(name = "Answer", frozen, module = "poinsot._core")]
pub struct CoreAnswer {
    /// What the verb gave.
    pub identified: Arc<Identified>,
}

/// The entry of the report that says where the answer came from.
fn origin() -> Vec<String> {
    vec!["poinsot.identify(...)".to_owned()]
}

#[pymethods]
impl CoreAnswer {
    /// The bytes of `estimate.json`, as text.
    fn json(&self) -> PyResult<String> {
        let text = estimate_text(Path::new("estimate.json"), &self.identified);
        Ok(text.map_err(Fault::from)?)
    }

    /// What the command prints.
    #[pyo3(signature = (width=None))]
    fn text(&self, width: Option<u16>) -> String {
        let style = TextStyle {
            width,
            colour: false,
        };
        estimate_document(&estimate_file(&self.identified), Detail::Answer).text(&style)
    }

    /// Exit code of the command.
    #[getter]
    fn exit_code(&self) -> u8 {
        poinsot_cli::exit_of(self.identified.passes())
    }

    /// How far other wheel motion between samples would move the answer, sigmas; `None` where it was not tried.
    #[getter]
    fn wheel_sensitivity(&self) -> Option<f64> {
        let found = self.identified.estimate.diagnostics.as_ref()?;
        let wheels = !self.identified.model.wheels.is_empty();
        wheels.then_some(found.shift_between_readings)
    }

    /// The report, one HTML page.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let identified = Arc::clone(&self.identified);
        run(py, None, move || {
            let data = report_data(&identified, &origin());
            report_html(estimate_file(&identified), data)
                .map_err(|why| Fault::from(poinsot::Error::report("report.html".as_ref(), why, "")))
        })
    }

    /// Writes the files of the command into a folder; gives their paths.
    #[pyo3(signature = (folder, report=false, figures=Vec::new()))]
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        report: bool,
        figures: Vec<String>,
    ) -> PyResult<Vec<PathBuf>> {
        let figures = figures.iter().map(|name| figure(name));
        let figures = figures.collect::<Result<Vec<_>, _>>()?;
        let identified = Arc::clone(&self.identified);
        run(py, None, move || {
            Ok(write_result(
                &folder,
                &identified,
                &origin(),
                report,
                &figures,
            )?)
        })
    }

    /// The file of another program with the determined numbers, and what was left out.
    #[pyo3(signature = (to, onto=None, accept_unreliable=false))]
    fn export(
        &self,
        to: &str,
        onto: Option<PathBuf>,
        accept_unreliable: bool,
    ) -> PyResult<(String, Vec<String>)> {
        let to: poinsot::export::Target = to.parse().map_err(Fault::from)?;
        let file = estimate_file(&self.identified);
        let path = Path::new("<answer>");
        let onto = onto.as_deref();
        let exported = poinsot::export::export_estimate(&file, path, to, onto, accept_unreliable);
        let exported = exported.map_err(Fault::from)?;
        let named = exported.left_out.into_iter().chain(exported.no_field);
        Ok((exported.text, named.collect()))
    }

    /// Measured, predicted and residual of every sensor of every segment.
    fn predictions<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let mut out = Vec::new();
        for prediction in &self.identified.predictions {
            for channel in &prediction.channels {
                let entry = channel_dict(py, channel)?;
                entry.set_item("segment", &prediction.label)?;
                out.push(entry);
            }
        }
        Ok(out)
    }
}

fn figure(name: &str) -> Result<FigureFormat, Fault> {
    match name {
        "svg" => Ok(FigureFormat::Svg),
        "png" if FigureFormat::Png.is_built() => Ok(FigureFormat::Png),
        "png" => Err(Fault::argument("--figures", name, WITHOUT_PNG, "")),
        other => Err(Fault::argument(
            "--figures",
            other,
            "there is no such format",
            "use svg or png",
        )),
    }
}

fn channel_dict<'py>(py: Python<'py>, c: &PredictedChannel) -> PyResult<Bound<'py, PyDict>> {
    let out = PyDict::new(py);
    out.set_item("sensor", &c.name)?;
    out.set_item("unit", &c.unit)?;
    out.set_item("residual_unit", &c.residual_unit)?;
    out.set_item("components", &c.components)?;
    out.set_item("samples", c.samples)?;
    out.set_item("time_s", PyArray1::from_slice(py, &c.time_s))?;
    for (name, rows) in [
        ("measured", &c.measured),
        ("predicted", &c.predicted),
        ("residual", &c.residual),
    ] {
        out.set_item(name, PyArray2::from_vec2(py, rows)?)?;
    }
    Ok(out)
}
