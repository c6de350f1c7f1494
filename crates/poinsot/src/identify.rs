//! The command `identify`: model and telemetry to mass properties.

use crate::bind::{
    Bound, RELATIVE_ACCURACY, acceleration_channels, bind, file_label, mountings, spin_inertias,
    wanted_channels,
};
use crate::error::{Error, check_accuracy, unknown};
use crate::methods::{is_own, methods};
use crate::progress::step;
use crate::{mixups, motor_torque};
use poinsot_dynamics::Tree;
use poinsot_files::{Pace, check_memory};
use poinsot_formats::{ModelInputFile, sha256};
use poinsot_identify::{
    Coordinates, Effect, Estimate, FaultKind, Loss, Modes, Prediction, Problem, Remark, RemarkKind,
    Settings, linear, linear_predicted, maximum_likelihood_predicted, maximum_likelihood_with,
    predicted_by,
};
use poinsot_model::{
    Body, Joint, Model, TelemetryMap, read_model, read_model_text, read_telemetry_map,
};
use poinsot_papers::{Settings as MethodSettings, answered, identify_by, method};
use poinsot_telemetry::checks::{self, Check, Finding, Policies, Policy};
use poinsot_telemetry::{
    ConventionTest, Encoding, Origin, Part, ReadOptions, Source, Table, convention_tests,
    read_parts,
};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

pub(crate) mod repair;

use repair::Refusal;

/// Fraction of dropped samples above which the result is not acceptable.
const ALLOWED_LOSS: f64 = 0.2;

/// Usual memory limit for the samples of one file, MiB.
pub const IDENTIFY_MIB: usize = 64;
/// Memory of a sample in all fits of an answer and in the files that tell it, bytes; measured with 13 channels of 35,000 samples and
/// with 200 gyros of 700, and rounded up.
const OF_SAMPLE: usize = 320;

/// Most points of one curve kept for the report, and of the curves of all segments together.
const CURVE_POINTS: (usize, usize) = (1500, 3000);

/// Options of the identification.
#[derive(Debug, Clone, PartialEq)]
pub struct Question {
    /// Name of a method, see [`crate::methods::methods`].
    pub method: String,
    /// Variant of the method.
    pub variant: Option<String>,
    /// Settings of a published method, `key=value`, see [`crate::methods::methods`].
    pub settings: Vec<String>,
    /// One-sigma accuracy in natural units of a number that counts as determined.
    pub relative_accuracy: f64,
    /// Coordinates of a maximum-likelihood fit.
    pub coordinates: Coordinates,
    /// Whether flexible modes that the model does not declare are searched.
    pub modes: Modes,
    /// No repairs; every check refuses its findings, except the check for gaps.
    pub strict: bool,
    /// Lines of the map that a check or the diagnosis proposes are applied, and listed among the repairs; only of records.
    pub repair: bool,
    /// Changes of check policies, `check=policy`.
    pub policies: Vec<String>,
}

impl Question {
    /// Default options with a method.
    pub fn by(method: &str) -> Self {
        Self {
            method: method.to_owned(),
            ..Self::default()
        }
    }
}

impl Default for Question {
    fn default() -> Self {
        Self {
            method: "auto".to_owned(),
            variant: None,
            settings: Vec::new(),
            relative_accuracy: RELATIVE_ACCURACY,
            coordinates: Coordinates::default(),
            modes: Modes::default(),
            strict: false,
            repair: false,
            policies: Vec::new(),
        }
    }
}

/// Options of reading telemetry files, in addition to the model's map.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Reading {
    /// Path of the model, recorded in the result; `None` for a model in memory.
    pub model: Option<PathBuf>,
    /// File with a `[telemetry]` table that replaces the model's.
    pub map: Option<PathBuf>,
    /// Read the complete part of a damaged file.
    pub recover: bool,
    /// Encoding of CSV text.
    pub encoding: Encoding,
    /// Keep rows with times in this range, s.
    pub time_s: Option<[f64; 2]>,
    /// Keep every n-th row; 0 and 1 keep all.
    pub every: usize,
    /// Memory limit for the samples of a file, MiB; 0: default.
    pub memory_mib: usize,
}

/// A request with files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IdentifyRequest {
    /// Model file.
    pub model: PathBuf,
    /// Files of each segment.
    pub segments: Vec<Vec<PathBuf>>,
    /// Options of reading.
    pub reading: Reading,
    /// Options.
    pub question: Question,
}

impl IdentifyRequest {
    /// Default request for a model and telemetry, one segment per file.
    pub fn new<P: Into<PathBuf>>(
        model: impl Into<PathBuf>,
        telemetry: impl IntoIterator<Item = P>,
    ) -> Self {
        Self {
            model: model.into(),
            segments: telemetry.into_iter().map(|t| vec![t.into()]).collect(),
            ..Self::default()
        }
    }

    /// Sets the method.
    #[must_use]
    pub fn by(mut self, method: &str) -> Self {
        method.clone_into(&mut self.question.method);
        self
    }
}

/// The result with its inputs.
pub struct Identified {
    /// The vehicle.
    pub model: Model,
    /// The estimate.
    pub estimate: Estimate,
    /// Predicted and measured values, one entry per segment; empty if the estimated vehicle cannot be simulated.
    pub predictions: Vec<Prediction>,
    /// Files of each segment.
    pub inputs: Vec<Vec<Source>>,
    /// File of the model.
    pub model_file: Option<ModelInputFile>,
    /// File of the telemetry map.
    pub map_file: Option<ModelInputFile>,
    /// Origin of all times; `None` for tables in memory.
    pub origin: Option<Origin>,
    /// Findings of the telemetry checks.
    pub findings: Vec<Finding>,
}

/// A file of the model or of the map, with its hash.
fn hashed(path: Option<&PathBuf>) -> Result<Option<ModelInputFile>, Error> {
    let hashed = path.map(|path| {
        Ok(ModelInputFile {
            path: path.display().to_string(),
            sha256: sha256(read_model_text(path)?.as_bytes()),
        })
    });
    hashed.transpose()
}

impl Identified {
    /// Whether every requested number is determined and no evidence contradicts the answer.
    pub fn passes(&self) -> bool {
        self.estimate.passes()
    }

    /// What was repaired while reading, and what was assumed.
    pub fn repairs(&self) -> Vec<&str> {
        let kinds = [RemarkKind::Repair, RemarkKind::Assumption];
        kinds.map(|kind| self.estimate.said(kind)).concat()
    }
}

/// Identifies the unknown mass properties of a vehicle from files.
///
/// # Errors
/// Invalid arguments, model or telemetry. Undetermined numbers are part of the result, not an error.
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// # let out = std::env::temp_dir().join(format!("poinsot-identify-{}", std::process::id()));
/// let written = simulate::simulate(&folder.join("case.toml"), &out)?;
/// let request = IdentifyRequest::new(folder.join("model.toml"), [written.telemetry]);
/// let identified = identify(&request)?;
/// assert!(identified.passes());
/// // The true value is 2.5 kg m2.
/// let [.., I_zz] = identified.estimate.bodies[0].inertia;
/// assert!((I_zz.value.unwrap() - 2.5).abs() < 3.0 * I_zz.sigma.unwrap());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(request: &IdentifyRequest) -> Result<Identified, Error> {
    check_method(&request.question)?;
    policies(&request.question)?;
    let model = read_model(&request.model)?;
    let file = |path: &PathBuf| Part::File(path.clone());
    let segments = request.segments.iter();
    let records: Vec<Vec<Part>> = segments.map(|f| f.iter().map(file).collect()).collect();
    let reading = Reading {
        model: Some(request.model.clone()),
        ..request.reading.clone()
    };
    identify_records(model, &records, &reading, &request.question)
}

/// Identifies from a model and records of files or memory, one list of sources per segment.
///
/// # Errors
/// As [`identify`].
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// use poinsot_telemetry::Part;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-records-{}", std::process::id()));
/// let written = simulate::simulate(&folder.join("case.toml"), &out)?;
/// // One segment of one file. `Part::Memory` holds columns in memory.
/// let records = [vec![Part::File(written.telemetry)]];
/// let identified = identify_records(model, &records, &Reading::default(), &Question::by("linear"))?;
/// assert!(identified.passes());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify_records(
    model: Model,
    records: &[Vec<Part>],
    reading: &Reading,
    question: &Question,
) -> Result<Identified, Error> {
    check_method(question)?;
    policies(question)?;
    let files = [
        hashed(reading.model.as_ref())?,
        hashed(reading.map.as_ref())?,
    ];
    let ask = |model: &Model| {
        let tables = read_records(model, records, reading, question)?;
        checked(model.clone(), tables, question)
    };
    let pass = |model: &Model| {
        let mut tables = read_records(model, records, reading, question)?;
        gate(model, &mut tables, question).map(|_| ())
    };
    let model = mapped(model, reading.map.as_deref())?;
    let identified = repair::answered(model, question.repair, ask, pass);
    let mut identified = identified.map_err(|error| join_files(error, records.len()))?;
    [identified.model_file, identified.map_file] = files;
    if reading.every > 1 {
        distrust_thinned(&mut identified.estimate, reading.every);
    }
    Ok(identified)
}

/// The model with the map that replaces its own.
pub(crate) fn mapped(mut model: Model, map: Option<&Path>) -> Result<Model, Error> {
    if let Some(map) = map {
        model.telemetry = read_telemetry_map(map)?;
    }
    Ok(model)
}

/// Reads the tables of all records for the model.
fn read_records(
    model: &Model,
    records: &[Vec<Part>],
    reading: &Reading,
    question: &Question,
) -> Result<Vec<Table>, Refusal> {
    let mut options = ReadOptions {
        encoding: reading.encoding,
        time_s: reading.time_s,
        every: reading.every,
        memory_mib: reading.memory_mib,
        // They are compared below, where a repair can be proposed.
        check_conventions: false,
        ..read_options(model, &model.telemetry, question.strict, reading.recover)
    };
    let accelerations = method(&question.method).is_some_and(|m| m.reads_accelerations);
    if let (Some(wanted), true) = (&mut options.wanted, accelerations) {
        wanted.extend(acceleration_channels());
    }
    let mut tables = Vec::with_capacity(records.len());
    for (done, parts) in records.iter().enumerate() {
        step("reading segments", done, records.len());
        let table = read_parts(parts, &options)?;
        let mut tests = convention_tests(&table).into_iter();
        if let Some(found) = tests.find(ConventionTest::is_contradicted) {
            return Err(found.into());
        }
        // All segments use the origin of the first.
        options.origin = table.origin;
        tables.push(table);
    }
    let samples = samples(&tables);
    // A joint without a column has its position at each time of the longest channel.
    let rows = |t: &Table| t.channels.iter().map(|c| c.values.len()).max();
    let joints = model.joints.len() * tables.iter().filter_map(rows).sum::<usize>();
    let what = format!("the fits of {samples} samples");
    check_memory(&what, ((samples + joints) * OF_SAMPLE) as f64)?;
    Ok(tables)
}

/// Number of samples of all records.
fn samples(tables: &[Table]) -> usize {
    let channels = tables.iter().flat_map(|table| &table.channels);
    channels.map(|channel| channel.values.len()).sum()
}

/// Input of a separate estimator: the model and its records after the same checks as [`identify`].
pub struct Gated {
    /// The vehicle.
    pub model: Model,
    /// Its kinematics.
    pub tree: Tree,
    /// Segments and noise.
    pub bound: Bound,
}

/// Reads and checks records as [`identify`] does, and binds them to the model.
///
/// # Errors
/// As [`identify`].
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// use poinsot_telemetry::Part;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-gated-{}", std::process::id()));
/// let written = simulate::simulate(&folder.join("case.toml"), &out)?;
/// let records = [vec![Part::File(written.telemetry)]];
/// let input = gated(model, &records, &Reading::default(), &Question::default())?;
/// assert_eq!((input.tree.bodies(), input.bound.segments.len()), (1, 1));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn gated(
    model: Model,
    records: &[Vec<Part>],
    reading: &Reading,
    question: &Question,
) -> Result<Gated, Error> {
    check_method(question)?;
    let model = mapped(model, reading.map.as_deref())?;
    let tables = read_records(&model, records, reading, question);
    let mut tables = tables.map_err(|refusal| refusal.error)?;
    gate(&model, &mut tables, question).map_err(|refusal| refusal.error)?;
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    Ok(Gated { model, tree, bound })
}

/// Adds to a missing-channel error that several `--telemetry` are several segments, so the channel may be in another
/// file.
fn join_files(mut error: Error, segments: usize) -> Error {
    let missing = error.list.iter_mut().filter(|f| f.code == "E0301");
    for fault in missing.filter(|_| segments > 1) {
        fault.advice += "; each --telemetry is a separate segment; join the files of one segment by commas: --telemetry a.csv,b.csv";
    }
    error
}

/// Identifies from tables in memory, one per segment. Files use this function too, so the checks are the same.
///
/// # Errors
/// As [`identify`]; a check has a finding that its policy refuses.
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// let table = simulate::simulate_case(&case, &model)?.table;
/// let identified = identify_tables(model, vec![table], &Question::default())?;
/// assert!(identified.passes());
/// // The true values are 1, 2 and 2.5 kg m2.
/// let [I_xx, _, I_yy, _, _, I_zz] = identified.estimate.bodies[0].inertia;
/// for (number, truth) in [(I_xx, 1.0), (I_yy, 2.0), (I_zz, 2.5)] {
///     assert!((number.value.unwrap() - truth).abs() < 3.0 * number.sigma.unwrap());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify_tables(
    model: Model,
    tables: Vec<Table>,
    question: &Question,
) -> Result<Identified, Error> {
    checked(model, tables, question).map_err(|refusal| refusal.error)
}

/// The same, with what would put refused tables right.
fn checked(
    model: Model,
    mut tables: Vec<Table>,
    question: &Question,
) -> Result<Identified, Refusal> {
    check_method(question)?;
    let policies = policies(question)?;
    let labels = labels(&tables);
    let findings = gate(&model, &mut tables, question)?;
    let answered = answer(model.clone(), tables, question);
    let mut identified = answered.map_err(|error| Refusal::of_fit(error, &model))?;
    for f in &findings {
        let share = f.count as f64 / f.of.max(1) as f64;
        if f.policy == Policy::Exclude && f.check != Check::Held && share > ALLOWED_LOSS {
            not_acceptable(&mut identified.estimate, share, &f.channel);
        }
    }
    // A unit that is accepted speaks against the answer, whether it was found before the fit or by it.
    let (units, findings): (Vec<_>, Vec<_>) =
        findings.into_iter().partition(|f| f.check == Check::Units);
    let mut by_the_fit = std::mem::replace(&mut identified.findings, findings);
    by_the_fit.extend(units);
    name_first(&mut identified);
    against_model(&mut identified, by_the_fit, &policies, &labels)?;
    Ok(identified)
}

/// Share of the misfit below which the first cause of the diagnosis comes after what the telemetry shows by itself.
const CAUSE: f64 = 0.9;

/// Puts that first: a lag, a placeholder.
fn name_first(identified: &mut Identified) {
    let mut own = identified.findings.iter();
    let own = own.find(|f| f.repair.is_some() && f.policy == Policy::Report);
    let found = identified.estimate.diagnostics.as_mut();
    if let (Some(own), Some(found)) = (own, found)
        && !found.findings.is_empty()
        && found.suspects.first().is_none_or(|s| s.explains < CAUSE)
    {
        let cause = poinsot_identify::Finding {
            fault: match own.check {
                Check::Lag => FaultKind::Lag,
                _ => FaultKind::Outliers,
            },
            or: Vec::new(),
            text: format!("{}: {}", own.channel, own.text),
        };
        found.findings.insert(0, cause);
    }
}

/// All checks of telemetry before the estimation.
fn gate(model: &Model, tables: &mut [Table], question: &Question) -> Result<Vec<Finding>, Refusal> {
    let policies = policies(question)?;
    refuse_twice(tables)?;
    step("preparing", 0, 0);
    let mut findings = Vec::new();
    for table in &mut *tables {
        let label = file_label(table);
        let found = checks::apply(table, &label, &policies);
        Refusal::of_findings(&label, &found)?;
        findings.extend(found);
    }
    if is_own(&question.method)
        && let Some(finding) = mixups::of_fast_record(model, tables)
    {
        findings.push(unless_refused(finding, &policies, &labels(tables))?);
    }
    Ok(findings)
}

fn policies(question: &Question) -> Result<Policies, Error> {
    Policies::new(&question.policies, question.strict)
}

/// Duplicate samples would make every sigma too small.
fn refuse_twice(tables: &[Table]) -> Result<(), Error> {
    let twice = |value: &str, of: &str| {
        let what = format!("its content is that of {of}: the same samples would count twice");
        let advice = "give each record once";
        Err(Error::usage("--telemetry", value, what, advice))
    };
    let mut seen: Vec<&Source> = Vec::new();
    // A source without a hash is not a file.
    let files = tables.iter().flat_map(|t| &t.sources);
    for source in files.filter(|s| !s.sha256.is_empty()) {
        if let Some(first) = seen.iter().find(|s| s.sha256 == source.sha256) {
            return twice(&source.path, &format!("{} (equal SHA-256)", first.path));
        }
        seen.push(source);
    }
    // Tables in memory have no files to compare.
    let same = |a: &Table, b: &Table| !a.channels.is_empty() && a.channels == b.channels;
    for (k, table) in tables.iter().enumerate() {
        if let Some(first) = tables[..k].iter().position(|other| same(other, table)) {
            let name = |k: usize| format!("segment {}", k + 1);
            return twice(&name(k), &name(first));
        }
    }
    Ok(())
}

/// Wheels may have changed speed between the selected rows.
fn distrust_thinned(estimate: &mut Estimate, every: usize) {
    let found = estimate.diagnostics.as_ref();
    let shift = found.map_or(0.0, |d| d.shift_between_readings);
    if shift == 0.0 {
        return;
    }
    let sensitive = shift > Settings::default().sensitivity_sigmas;
    let not = if sensitive { "" } else { "not " };
    let row = Remark::test(
        "sensitivity to the wheel motion between the selected rows",
        Effect::AgainstAnswer.if_failed(sensitive),
        format!(
            "the estimate is {not}sensitive to the wheel motion between the selected rows ({shift:.1} sigma)"
        ),
    );
    estimate.add(row.statistic("change of the estimate, sigma", shift));
    if sensitive {
        estimate.add(Remark::warning(format!(
            "--every {every} leaves out wheel samples, which changes the estimate by {shift:.1} sigma: the covariance is not trustworthy; use more rows"
        )));
    }
}

fn labels(tables: &[Table]) -> String {
    let all: Vec<String> = tables.iter().map(file_label).collect();
    all.join(",")
}

/// The finding under its policy.
fn unless_refused(
    mut finding: Finding,
    policies: &Policies,
    label: &str,
) -> Result<Finding, Refusal> {
    finding.policy = policies.of(finding.check);
    Refusal::of_findings(label, std::slice::from_ref(&finding))?;
    Ok(finding)
}

/// Checks of the telemetry that need the result.
fn against_model(
    identified: &mut Identified,
    by_the_fit: Vec<Finding>,
    policies: &Policies,
    label: &str,
) -> Result<(), Refusal> {
    let estimate = &identified.estimate;
    let found = mixups::units(&identified.model, estimate);
    for finding in found.into_iter().chain(by_the_fit) {
        let finding = unless_refused(finding, policies, label)?;
        let text = format!("{}: {}", finding.check.name(), finding.text);
        let row = Remark::test(finding.check.name(), Effect::AgainstAnswer, text.clone());
        identified.estimate.add(row);
        identified.estimate.add(Remark::warning(text));
        identified.findings.push(finding);
    }
    Ok(())
}

/// The result for checked tables.
fn answer(model: Model, tables: Vec<Table>, question: &Question) -> Result<Identified, Error> {
    let tree = Tree::new(&model);
    let bound = bind(&model, &tree, &tables)?;
    let pace = Pace::new(format!("the fits of {} samples", samples(&tables)));
    let problem = Problem {
        relative_accuracy: question.relative_accuracy,
        pace: Some(&pace),
        ..bound.problem(&model, &tree)
    };
    refuse_unsupported(problem.model, question)?;
    let points = (CURVE_POINTS.1 / tables.len().max(1)).clamp(100, CURVE_POINTS.0);
    let predicted = match question.method.as_str() {
        "linear" => linear_predicted(&problem, points),
        name if method(name).is_some() => {
            estimate_by(&problem, question, true).and_then(|estimate| {
                let predictions = predicted_by(&problem, &answered(&model, &estimate), points)?;
                Ok((estimate, predictions))
            })
        }
        _ => maximum_likelihood_predicted(&problem, settings(question, true), points),
    };
    pace.over()?;
    let (mut estimate, predictions) = predicted?;
    if is_own(&question.method) {
        estimate.variant.clone_from(&question.variant);
    }
    known_as_exact(&model, &mut estimate);
    taken_as_constant(&model, &mut estimate);
    let findings = motor_torque::contradictions((&model, &tree), &tables, &bound);
    if bound.dropped > ALLOWED_LOSS {
        not_acceptable(&mut estimate, bound.dropped, "a segment");
    }
    let origin = tables.first().and_then(|t| t.origin);
    let counted = origin.filter(|o| o.date().is_some() || o.own_zero_s() != 0.0);
    let counted = counted.map(|o| format!("times count from {o}"));
    let repairs = tables.iter().flat_map(|t| t.repairs.clone());
    let repairs = counted.into_iter().chain(repairs).chain(bound.repairs);
    let ignored: BTreeSet<String> = tables.iter().flat_map(|t| t.ignored.clone()).collect();
    let ignored = ignored.into_iter();
    estimate.add_all(repairs.map(|words| Remark::new(RemarkKind::Repair, words)));
    estimate.add_all(ignored.map(|words| Remark::new(RemarkKind::Ignored, words)));
    Ok(Identified {
        model,
        estimate,
        predictions,
        origin,
        model_file: None,
        map_file: None,
        inputs: tables.into_iter().map(|t| t.sources).collect(),
        findings,
    })
}

/// Warns if a method assumes uncertain known numbers exact.
fn known_as_exact(model: &Model, estimate: &mut Estimate) {
    let uncertain = model.uncertain().next().is_some();
    estimate.known_numbers.exact = !uncertain;
    if uncertain && estimate.method != "maximum_likelihood" {
        estimate.add(Remark::assumption(
            "assumed: known numbers exact, because this method ignores their uncertainties; its sigmas include sensor noise only",
        ));
    }
}

/// Says of each body whose numbers are declared to change that they do not here.
fn taken_as_constant(model: &Model, estimate: &mut Estimate) {
    let forgets = |b: &&Body| b.prior.is_some_and(|p| p.forget_s.is_some());
    for body in model.bodies.iter().filter(forgets) {
        estimate.add(Remark::assumption(format!(
            "assumed: the numbers of '{}' stay over all records; forget_s is for the on-board filter",
            body.name
        )));
    }
}

fn not_acceptable(estimate: &mut Estimate, share: f64, of: &str) {
    let percent = 100.0 * share;
    let left_out = format!("{percent:.0} % of the samples of {of} were left out");
    estimate.add(Remark::warning(format!(
        "{left_out}; check the repairs before you use the answer"
    )));
    let row = Remark::test("samples left out", Effect::MakesPartial, left_out);
    estimate.add(row.statistic("share of the samples", share));
}

/// Only maximum likelihood supports the gravity gradient and bodies that lose mass.
fn refuse_unsupported(model: &Model, question: &Question) -> Result<(), Error> {
    if matches!(question.method.as_str(), "auto" | "maximum_likelihood") {
        return Ok(());
    }
    let loses_mass = model.thrusters.iter().any(|t| t.propellant.is_some());
    let [what, place] = if model.environment.gravity_gradient {
        ["a gravity gradient", "it out of [environment]"]
    } else if loses_mass {
        ["propellant use", "specific_impulse_s out of the thrusters"]
    } else if !model.modes.is_empty() {
        ["flexible modes", "[[mode]] out of it"]
    } else if model.joints.iter().any(Joint::is_passive) {
        [
            "joints that springs move",
            "spring_damper out of them and lock them",
        ]
    } else {
        return Ok(());
    };
    let what = format!("the model has {what}, which this method does not support");
    let advice = format!("use maximum_likelihood, or take {place}");
    Err(Error::usage("--method", &question.method, what, advice))
}

/// The estimate of a method, without curves for a report; `diagnose` searches for causes of a misfit.
pub(crate) fn estimate_by(
    problem: &Problem,
    question: &Question,
    diagnose: bool,
) -> Result<Estimate, Error> {
    let variant = question.variant.as_deref();
    Ok(match question.method.as_str() {
        "linear" => linear(problem)?,
        name if let Some(published) = method(name) => {
            identify_by(published, problem, variant, &question.settings)?
        }
        _ => maximum_likelihood_with(problem, settings(question, diagnose))?,
    })
}

/// Settings of a maximum-likelihood fit.
fn settings(question: &Question, diagnose: bool) -> Settings {
    let loss = question.variant.as_deref().and_then(Loss::from_name);
    Settings {
        loss: loss.unwrap_or_default(),
        coordinates: question.coordinates,
        modes: question.modes,
        undiagnosed: !diagnose,
        ..Settings::default()
    }
}

pub(crate) fn check_method(question: &Question) -> Result<(), Error> {
    let methods = methods();
    let Some(method) = methods.iter().find(|m| m.name == question.method) else {
        let names = methods.iter().map(|m| m.name);
        return Err(unknown("--method", &question.method, "method", names));
    };
    let known: Vec<&str> = method.variants.iter().map(|v| v.name).collect();
    if let Some(variant) = &question.variant
        && !known.contains(&variant.as_str())
    {
        let (what, advice) = match known.is_empty() {
            true => ("variants", "leave it out".to_owned()),
            false => ("such variant", format!("use one of {}", known.join(", "))),
        };
        let problem = format!("method {} has no {what}", question.method);
        return Err(Error::usage("--variant", variant, problem, advice));
    }
    MethodSettings::parse(&question.settings)?.check(method.name, method.settings)?;
    check_accuracy(question.relative_accuracy)
}

/// Options of reading telemetry for a model.
///
/// ```
#[doc = include_str!("../doc/case.txt")]
/// let options = identify::read_options(&model, &model.telemetry, false, false);
/// assert!(options.check_conventions && options.wanted.unwrap().contains("omega_x"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_options(model: &Model, map: &TelemetryMap, strict: bool, recover: bool) -> ReadOptions {
    ReadOptions {
        map: map.clone(),
        wanted: Some(wanted_channels(model)),
        mountings: mountings(model),
        spin_inertia: Some(spin_inertias(model)),
        strict,
        recover,
        check_conventions: true,
        one_run: true,
        ..ReadOptions::default()
    }
}

/// Every which row is read, as an option says it.
///
/// # Errors
/// Zero.
///
/// ```
/// assert!(poinsot::row_step(10).is_ok_and(|every| every == 10) && poinsot::row_step(0).is_err());
/// ```
pub fn row_step(every: usize) -> Result<usize, Error> {
    let problem = "the number of rows must be at least 1";
    let advice = "give 1 for all, 10 for every tenth";
    match every {
        0 => Err(Error::usage("--every", "0", problem, advice)),
        every => Ok(every),
    }
}

/// Splits `a.csv,b.csv` into the files of one segment.
///
/// ```
/// use poinsot::segment_files;
///
/// assert_eq!(segment_files("attitude.csv,gyro.csv").len(), 2);
/// ```
pub fn segment_files(argument: impl AsRef<OsStr>) -> Vec<PathBuf> {
    let argument = argument.as_ref();
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let names = argument.as_bytes().split(|byte| *byte == b',');
        names.map(|name| OsStr::from_bytes(name).into()).collect()
    }
    #[cfg(not(unix))]
    {
        let names = argument.to_string_lossy();
        names.split(',').map(PathBuf::from).collect()
    }
}
