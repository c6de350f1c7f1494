//! The verb `identify`: model and telemetry in, mass properties out.

use crate::bind::{acceleration_channels, bind, wanted_channels};
use crate::error::Error;
use crate::mixups;
use crate::progress::step;
use poinsot_dynamics::Tree;
use poinsot_identify::methods::{self, kim2010, ma2008, xu2017};
use poinsot_identify::{
    Coordinates, Estimate, FitOptions, Loss, Number, Prediction, Problem, Status, linear_predicted,
    maximum_likelihood_predicted, predicted_by, tensor_name,
};
use poinsot_model::{Model, TelemetryMap, read_model, read_telemetry_map};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use poinsot_telemetry::checks::{self, Check, Finding, Policies, Policy};
use poinsot_telemetry::{ColumnMap, Encoding, ReadOptions, Source, Table, read};
use std::path::{Path, PathBuf};

/// Methods by name; `auto` is linear least squares, then maximum likelihood.
pub const METHODS: [&str; 3] = ["auto", "linear", "maximum_likelihood"];

/// Variants of maximum likelihood: the loss of a reading.
pub const LOSSES: [&str; 3] = ["gaussian", "huber", "student_t"];

/// Share of samples that may be left out before the answer counts as not acceptable.
const ALLOWED_LOSS: f64 = 0.2;

/// Most points of a curve kept for the report, and of the curves of all segments together.
const CURVE_POINTS: (usize, usize) = (1500, 3000);

/// The question.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyRequest {
    /// Model file.
    pub model: PathBuf,
    /// Files of each segment.
    pub segments: Vec<Vec<PathBuf>>,
    /// File with a `[telemetry]` table that replaces the model's.
    pub map: Option<PathBuf>,
    /// One of [`METHODS`].
    pub method: String,
    /// Variant of a published method.
    pub variant: Option<String>,
    /// One-sigma accuracy in natural units that counts as identified.
    pub relative_accuracy: f64,
    /// Coordinates of the steps of a maximum-likelihood fit.
    pub coordinates: Coordinates,
    /// No repairs.
    pub strict: bool,
    /// Read what a damaged file still holds.
    pub recover: bool,
}

/// How telemetry is read and checked, beyond the model's own map.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Reading {
    /// Changes of policies, `check=policy`.
    pub policies: Vec<String>,
    /// Encoding of CSV text.
    pub encoding: Encoding,
    /// Rows outside of these times are left out, s.
    pub time_s: Option<[f64; 2]>,
    /// Each n-th row is taken; 0 and 1 take all.
    pub every: usize,
    /// Most memory for the samples of a file, MiB; 0: the usual limit.
    pub memory_mib: usize,
}

/// The answer with where it came from.
pub struct Identified {
    /// The vehicle.
    pub model: Model,
    /// The estimate.
    pub estimate: Estimate,
    /// What the estimate predicts beside what was measured, one per segment; empty where the vehicle
    /// cannot move as estimated.
    pub predictions: Vec<Prediction>,
    /// Files of each segment.
    pub inputs: Vec<Vec<Source>>,
    /// Assumptions and repairs.
    pub repairs: Vec<String>,
    /// Columns that were not used.
    pub ignored: Vec<String>,
    /// What the checks of the telemetry found.
    pub findings: Vec<Finding>,
}

impl Identified {
    /// Exit code of the command.
    pub fn exit_code(&self) -> u8 {
        self.estimate.exit_code()
    }
}

/// Identifies the unknown mass properties of a vehicle.
///
/// # Errors
/// The question cannot be asked; what the data do not determine is part of the answer.
pub fn identify(request: &IdentifyRequest) -> Result<Identified, Error> {
    identify_reading(request, &Reading::default())
}

/// The same with telemetry read and checked as told.
///
/// # Errors
/// As [`identify`]; a check found something that its policy refuses.
pub fn identify_reading(request: &IdentifyRequest, reading: &Reading) -> Result<Identified, Error> {
    check_method(request)?;
    let policies =
        Policies::new(&reading.policies, request.strict).map_err(|why| Error::Usage {
            option: "--policy",
            value: reading.policies.join(" "),
            why,
        })?;
    let mut model = read_model(&request.model)?;
    if let Some(map) = &request.map {
        model.telemetry = read_telemetry_map(map)?;
    }
    let mut options = ReadOptions {
        encoding: reading.encoding,
        time_s: reading.time_s,
        every: reading.every,
        memory_mib: reading.memory_mib,
        ..read_options(&model, &model.telemetry, request.strict, request.recover)
    };
    if let Some(wanted) = options
        .wanted
        .as_mut()
        .filter(|_| request.method == "xu2017")
    {
        wanted.extend(acceleration_channels());
    }
    let segments = request.segments.len();
    let mut tables = request
        .segments
        .iter()
        .enumerate()
        .map(|(done, files)| {
            step("reading segments", done, segments);
            read(files, &options)
        })
        .collect::<Result<Vec<Table>, _>>()?;
    refuse_twice(&tables)?;
    step("preparing", 0, 0);
    let mut findings = Vec::new();
    for table in &mut tables {
        let label = table_label(table);
        findings.extend(checks::apply(table, &label, &policies)?);
    }
    if METHODS.contains(&request.method.as_str())
        && let Some(mut finding) = mixups::times(&model, &tables)
    {
        finding.policy = policies.of(finding.check);
        if finding.policy == Policy::Refuse {
            let labels: Vec<String> = tables.iter().map(table_label).collect();
            return Err(checks::refused(&labels.join(","), &finding).into());
        }
        findings.push(finding);
    }
    let mut identified = identify_tables(model, tables, request)?;
    let label = identified.inputs.iter().flatten().map(|s| s.path.as_str());
    let label = label.collect::<Vec<_>>().join(",");
    for f in &findings {
        let share = f.count as f64 / f.of.max(1) as f64;
        if f.policy == Policy::Exclude && f.check != Check::Held && share > ALLOWED_LOSS {
            not_acceptable(&mut identified.estimate, share, &f.channel);
        }
    }
    let by_the_fit = std::mem::replace(&mut identified.findings, findings);
    against_model(&mut identified, by_the_fit, &policies, &label)?;
    Ok(identified)
}

/// The same readings given twice would count twice, and make every sigma too small.
fn refuse_twice(tables: &[Table]) -> Result<(), Error> {
    let mut seen: Vec<&Source> = Vec::new();
    for source in tables.iter().flat_map(|t| &t.sources) {
        if let Some(first) = seen.iter().find(|s| s.sha256 == source.sha256) {
            return Err(Error::Usage {
                option: "--telemetry",
                value: source.path.clone(),
                why: format!(
                    "its content is that of {} (equal SHA-256): the same readings would count twice and make every sigma too small; give each record once",
                    first.path
                ),
            });
        }
        seen.push(source);
    }
    Ok(())
}

fn table_label(table: &Table) -> String {
    let names: Vec<&str> = table.sources.iter().map(|s| s.path.as_str()).collect();
    names.join(",")
}

/// Checks of the telemetry that need the answer.
fn against_model(
    identified: &mut Identified,
    by_the_fit: Vec<Finding>,
    policies: &Policies,
    label: &str,
) -> Result<(), Error> {
    let estimate = &identified.estimate;
    let found = mixups::units(estimate);
    for mut finding in found.into_iter().chain(by_the_fit) {
        finding.policy = policies.of(finding.check);
        if finding.policy == Policy::Refuse {
            return Err(checks::refused(label, &finding).into());
        }
        let text = format!("{}: {}", finding.check.name(), finding.text);
        identified.estimate.doubt(text.clone());
        identified.estimate.warnings.push(text);
        identified.findings.push(finding);
    }
    Ok(())
}

/// Identifies from tables in memory.
///
/// # Errors
/// As [`identify`].
pub fn identify_tables(
    model: Model,
    tables: Vec<Table>,
    request: &IdentifyRequest,
) -> Result<Identified, Error> {
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &bound.segments,
        noise: &bound.noise,
        relative_accuracy: request.relative_accuracy,
    };
    refuse_gravity(&model, request)?;
    let points = (CURVE_POINTS.1 / tables.len().max(1)).clamp(100, CURVE_POINTS.0);
    let (mut estimate, predictions) = match request.method.as_str() {
        "linear" => linear_predicted(&problem, points)?,
        "kim2010" => {
            let estimate = kim2010::identify(&problem, kim2010_variant(request)?)?;
            let predictions = predicted_by(&problem, &answered(&model, &estimate), points)?;
            (estimate, predictions)
        }
        "ma2008" => {
            let estimate = ma2008::identify(&problem, ma2008_variant(request))?;
            let predictions = predicted_by(&problem, &answered(&model, &estimate), points)?;
            (estimate, predictions)
        }
        "xu2017" => {
            let estimate = xu2017::identify(&problem, xu2017_variant(request)?)?;
            let predictions = predicted_by(&problem, &answered(&model, &estimate), points)?;
            (estimate, predictions)
        }
        _ => {
            let loss = request.variant.as_deref().and_then(Loss::from_name);
            let options = FitOptions {
                loss: loss.unwrap_or_default(),
                coordinates: request.coordinates,
                undiagnosed: false,
            };
            let (mut estimate, predictions) =
                maximum_likelihood_predicted(&problem, options, points)?;
            estimate.variant.clone_from(&request.variant);
            (estimate, predictions)
        }
    };
    let findings = match METHODS.contains(&request.method.as_str()) {
        true => mixups::rates(&problem, &tables, &estimate)
            .into_iter()
            .collect(),
        false => Vec::new(),
    };
    if bound.dropped > ALLOWED_LOSS {
        not_acceptable(&mut estimate, bound.dropped, "a segment");
    }
    let mut repairs: Vec<String> = tables.iter().flat_map(|t| t.repairs.clone()).collect();
    repairs.extend(bound.repairs);
    repairs.extend(estimate.assumptions.iter().cloned());
    let mut ignored: Vec<String> = tables.iter().flat_map(|t| t.ignored.clone()).collect();
    ignored.sort();
    ignored.dedup();
    Ok(Identified {
        model,
        estimate,
        predictions,
        inputs: tables.into_iter().map(|t| t.sources).collect(),
        repairs,
        ignored,
        findings,
    })
}

fn not_acceptable(estimate: &mut Estimate, share: f64, of: &str) {
    estimate.warnings.push(format!(
        "{:.0} % of the samples of {of} were left out (see repairs): the answer is not acceptable without a look at them",
        100.0 * share
    ));
    if estimate.status == Status::Converged {
        estimate.status = Status::Partial;
    }
}

/// Only maximum likelihood knows the gravity gradient.
fn refuse_gravity(model: &Model, request: &IdentifyRequest) -> Result<(), Error> {
    if !model.environment.gravity_gradient
        || matches!(request.method.as_str(), "auto" | "maximum_likelihood")
    {
        return Ok(());
    }
    Err(Error::Usage {
        option: "--method",
        value: request.method.clone(),
        why: "the model has a gravity gradient, which this method does not know; use maximum_likelihood, or take it out of [environment]".to_owned(),
    })
}

/// The vehicle as a published method says it is: what is determined, else what the method prints, else nominal.
fn answered(model: &Model, estimate: &Estimate) -> Vec<MassProperties> {
    let printed = |name: &str| {
        let report = estimate.method_report.as_ref()?;
        let found = report.numbers.iter().find(|n| n.name == name)?;
        found.number.value
    };
    let bodies = model.bodies.iter().zip(&estimate.bodies);
    bodies
        .map(|(body, answer)| {
            if !answer.asked {
                return body.nominal;
            }
            let best = |n: &Number, name: &str| {
                let printed = || printed(name).filter(|_| model.bodies.len() == 1);
                n.value.or_else(printed).unwrap_or(n.nominal)
            };
            let [xx, xy, yy, xz, yz, zz] = std::array::from_fn(|k| {
                // Kim, Choi and Oh write zx.
                let name = tensor_name(k).replace("xz", "zx");
                best(&answer.inertia[k], &format!("inertia_{name}"))
            });
            MassProperties {
                mass: best(&answer.mass, "mass"),
                p_BoBcm_B: Vector3::from(answer.com.map(|n| n.value.unwrap_or(n.nominal))),
                I_BBcm_B: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            }
        })
        .collect()
}

fn ma2008_variant(request: &IdentifyRequest) -> ma2008::Variant {
    match request.variant.as_deref() {
        Some("known-momentum") => ma2008::Variant::KnownMomentum,
        _ => ma2008::Variant::UnknownMomentum,
    }
}

fn check_method(request: &IdentifyRequest) -> Result<(), Error> {
    let name = request.method.as_str();
    let published = methods::published(name);
    if !METHODS.contains(&name) && published.is_none() {
        let mut names = METHODS.to_vec();
        names.extend(methods::PUBLISHED.iter().map(|p| p.name));
        return Err(Error::Usage {
            option: "--method",
            value: request.method.clone(),
            why: format!("there is no such method; use one of {}", names.join(", ")),
        });
    }
    let known: &[&str] = match (published, name) {
        (Some(published), _) => published.variants,
        (None, "linear") => &[],
        (None, _) => &LOSSES,
    };
    if let Some(variant) = &request.variant
        && !known.contains(&variant.as_str())
    {
        return Err(variant_error(request, known));
    }
    if !(request.relative_accuracy > 0.0 && request.relative_accuracy.is_finite()) {
        return Err(Error::Usage {
            option: "--relative-accuracy",
            value: request.relative_accuracy.to_string(),
            why: "must be a positive number; give for example 1.0".to_owned(),
        });
    }
    Ok(())
}

fn kim2010_variant(request: &IdentifyRequest) -> Result<kim2010::Variant, Error> {
    let known = methods::published("kim2010").map_or(&[][..], |p| p.variants);
    kim2010::Variant::named(request.variant.as_deref()).ok_or_else(|| variant_error(request, known))
}

fn xu2017_variant(request: &IdentifyRequest) -> Result<xu2017::Variant, Error> {
    let known = methods::published("xu2017").map_or(&[][..], |p| p.variants);
    xu2017::Variant::named(request.variant.as_deref()).ok_or_else(|| variant_error(request, known))
}

fn variant_error(request: &IdentifyRequest, known: &[&str]) -> Error {
    let why = if known.is_empty() {
        format!("method {} has no variants; leave it out", request.method)
    } else {
        format!(
            "{} has no such variant; use one of {}",
            request.method,
            known.join(", ")
        )
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
        one_run: true,
        ..ReadOptions::default()
    }
}

/// Splits `a.csv,b.csv` into the files of one segment.
pub fn segment_files(argument: &str) -> Vec<PathBuf> {
    argument
        .split(',')
        .map(|p| Path::new(p).to_owned())
        .collect()
}
