//! The verb `identify`: model and telemetry in, mass properties out.

use crate::bind::{bind, wanted_channels};
use crate::error::Error;
use poinsot_dynamics::Tree;
use poinsot_identify::methods::{self, ma2008};
use poinsot_identify::{Estimate, LinearProblem, Status, linear};
use poinsot_model::{Model, TelemetryMap, read_model, read_telemetry_map};
use poinsot_telemetry::{ColumnMap, ReadOptions, Source, Table, read};
use std::path::{Path, PathBuf};

/// Share of samples that may be left out before the answer counts as not acceptable.
const ALLOWED_LOSS: f64 = 0.2;

/// The question.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyRequest {
    /// Model file.
    pub model: PathBuf,
    /// Files of each segment.
    pub segments: Vec<Vec<PathBuf>>,
    /// File with a `[telemetry]` table that replaces the model's.
    pub map: Option<PathBuf>,
    /// `auto`, `linear`.
    pub method: String,
    /// Variant of a published method.
    pub variant: Option<String>,
    /// One-sigma accuracy in natural units that counts as identified.
    pub relative_accuracy: f64,
    /// No repairs.
    pub strict: bool,
    /// Read what a damaged file still holds.
    pub recover: bool,
}

/// The answer with where it came from.
pub struct Identified {
    /// The vehicle.
    pub model: Model,
    /// The estimate.
    pub estimate: Estimate,
    /// Files of each segment.
    pub inputs: Vec<Vec<Source>>,
    /// Assumptions and repairs.
    pub repairs: Vec<String>,
    /// Columns that were not used.
    pub ignored: Vec<String>,
}

impl Identified {
    /// Exit code of the command.
    pub fn exit_code(&self) -> u8 {
        self.estimate.status.exit_code()
    }
}

/// Identifies the unknown mass properties of a vehicle.
///
/// # Errors
/// The question cannot be asked; what the data do not determine is part of the answer.
pub fn identify(request: &IdentifyRequest) -> Result<Identified, Error> {
    let method = check_method(request)?;
    let mut model = read_model(&request.model)?;
    if let Some(map) = &request.map {
        model.telemetry = read_telemetry_map(map)?;
    }
    let options = read_options(&model, &model.telemetry, request.strict, request.recover);
    let tables = request
        .segments
        .iter()
        .map(|files| read(files, &options))
        .collect::<Result<Vec<Table>, _>>()?;
    identify_tables_by(method, model, tables, request.relative_accuracy)
}

/// How the question is answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The linear rung.
    Linear,
    /// Ma, Dang and Pham 2008.
    Ma2008(ma2008::Variant),
}

/// Identifies from tables in memory by the linear rung.
///
/// # Errors
/// As [`identify`].
pub fn identify_tables(
    model: Model,
    tables: Vec<Table>,
    relative_accuracy: f64,
) -> Result<Identified, Error> {
    identify_tables_by(Method::Linear, model, tables, relative_accuracy)
}

/// Identifies from tables in memory.
///
/// # Errors
/// As [`identify`].
pub fn identify_tables_by(
    method: Method,
    model: Model,
    tables: Vec<Table>,
    relative_accuracy: f64,
) -> Result<Identified, Error> {
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    let problem = LinearProblem {
        model: &model,
        tree: &tree,
        segments: &bound.segments,
        noise: &bound.noise,
        relative_accuracy,
    };
    let mut estimate = match method {
        Method::Linear => linear(&problem)?,
        Method::Ma2008(variant) => ma2008::identify(&problem, variant)?,
    };
    if bound.dropped > ALLOWED_LOSS {
        estimate.warnings.push(format!(
            "{:.0} % of the samples of a segment were left out (see repairs): the answer is not acceptable without a look at them",
            100.0 * bound.dropped
        ));
        if estimate.status == Status::Converged {
            estimate.status = Status::Partial;
        }
    }
    let mut repairs: Vec<String> = tables.iter().flat_map(|t| t.repairs.clone()).collect();
    repairs.extend(bound.repairs);
    let mut ignored: Vec<String> = tables.iter().flat_map(|t| t.ignored.clone()).collect();
    ignored.sort();
    ignored.dedup();
    Ok(Identified {
        model,
        estimate,
        inputs: tables.into_iter().map(|t| t.sources).collect(),
        repairs,
        ignored,
    })
}

fn check_method(request: &IdentifyRequest) -> Result<Method, Error> {
    let method = match request.method.as_str() {
        "auto" | "linear" => {
            refuse_variant(request, &[])?;
            Method::Linear
        }
        "ma2008" => Method::Ma2008(match request.variant.as_deref() {
            None | Some("unknown-momentum") => ma2008::Variant::UnknownMomentum,
            Some("known-momentum") => ma2008::Variant::KnownMomentum,
            Some(_) => {
                let published = methods::published("ma2008");
                return Err(variant_error(
                    request,
                    published.map_or(&[], |p| p.variants),
                ));
            }
        }),
        _ => {
            let names: Vec<&str> = methods::PUBLISHED.iter().map(|p| p.name).collect();
            return Err(Error::Usage {
                option: "--method",
                value: request.method.clone(),
                why: format!("known methods: auto, linear, {}", names.join(", ")),
            });
        }
    };
    if !(request.relative_accuracy > 0.0 && request.relative_accuracy.is_finite()) {
        return Err(Error::Usage {
            option: "--relative-accuracy",
            value: request.relative_accuracy.to_string(),
            why: "a positive number is needed, for example 1.0".to_owned(),
        });
    }
    Ok(method)
}

fn refuse_variant(request: &IdentifyRequest, known: &[&str]) -> Result<(), Error> {
    match request.variant {
        Some(_) => Err(variant_error(request, known)),
        None => Ok(()),
    }
}

fn variant_error(request: &IdentifyRequest, known: &[&str]) -> Error {
    let why = if known.is_empty() {
        format!("method {} has no variants; leave it out", request.method)
    } else {
        format!("variants of {}: {}", request.method, known.join(", "))
    };
    Error::Usage {
        option: "--variant",
        value: request.variant.clone().unwrap_or_default(),
        why,
    }
}

/// Options for reading telemetry that a model asks for.
pub fn read_options(model: &Model, map: &TelemetryMap, strict: bool, recover: bool) -> ReadOptions {
    ReadOptions {
        columns: map
            .columns
            .iter()
            .map(|c| ColumnMap {
                channel: c.channel.clone(),
                column: c.column.clone(),
                unit: c.unit.clone(),
            })
            .collect(),
        row_filter: map.row_filter.clone(),
        wanted: Some(wanted_channels(model)),
        strict,
        recover,
        check_conventions: true,
    }
}

/// Splits `a.csv,b.csv` into the files of one segment.
pub fn segment_files(argument: &str) -> Vec<PathBuf> {
    argument
        .split(',')
        .map(|p| Path::new(p).to_owned())
        .collect()
}
