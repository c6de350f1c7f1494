//! The command `validate`: compares the motion of a model or an estimate with another model or with telemetry.
//!
//! Three comparisons. With a model, in a case: both vehicles move under the same torques, wheels and thrust. With
//! telemetry, in a case: the simulated motion and the measurements. With telemetry only: the prediction of a held-back
//! record, driven by its measured joints, wheels and thrust.

mod compared;
mod estimate;
mod file;
mod motion;
mod mover;
mod open;
mod telemetry;

use crate::case::{Case, read_case};
use crate::error::Error;
use crate::identify::{mapped, read_options, segment_files};
pub use file::{validation_csv, write_validation};
use motion::{compare_paths, path};
use open::{held_back_effect, motion_effect};
use poinsot_formats::{
    CompletedFile, EstimateRefFile, VALIDATION, ValidationFile, ValidationLimitsFile,
};
use poinsot_identify::Completion;
use poinsot_model::{Model, read_model};
use poinsot_telemetry::read;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use telemetry::{HeldBackFindings, POINTS};
#[doc(hidden)]
pub use {
    compared::Compared,
    estimate::{of_estimate, read_estimate},
    motion::compare_motion,
    mover::Mover,
    telemetry::compare_with_telemetry,
};

/// Mean square in sigmas above which a difference exceeds the declared noise.
const MISFIT: f64 = 1.5;

/// Arguments of `validate`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ValidateRequest {
    /// Model; default: the model of the case.
    pub model: Option<PathBuf>,
    /// Estimate of this model (folder or file); its numbers replace the nominal ones.
    pub estimate: Option<PathBuf>,
    /// Another model (`.toml`), or telemetry files joined by commas.
    pub against: OsString,
    /// Case; not needed for held-back telemetry.
    pub case: Option<PathBuf>,
    /// File with a `[telemetry]` table that replaces the model's.
    pub map: Option<PathBuf>,
    /// Largest acceptable difference of positions and prismatic joints, m.
    pub within_m: Option<f64>,
    /// Largest acceptable difference of attitude and revolute joints, rad.
    pub within_rad: Option<f64>,
    /// No repairs.
    pub strict: bool,
    /// Read the complete part of a damaged file.
    pub recover: bool,
}

/// Result of a validation.
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// The result file.
    pub file: ValidationFile,
    /// The histories of both sides, one entry per quantity.
    pub histories: Vec<Compared>,
}

/// Compares the motion of a model or an estimate with another model or with telemetry.
///
/// # Errors
/// Invalid files or names, or a motion that cannot be computed.
///
/// ```
/// use poinsot::validate::{ValidateRequest, validate};
///
/// let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("doc");
/// // The same model twice: the motions are equal.
/// let request = ValidateRequest {
///     case: Some(folder.join("case.toml")),
///     against: folder.join("model.toml").into(),
///     within_rad: Some(1.0e-9),
///     ..ValidateRequest::default()
/// };
/// let found = validate(&request)?;
/// assert!(found.file.verdict == "agrees" && found.file.passes());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn validate(request: &ValidateRequest) -> Result<Validation, Error> {
    check(request)?;
    let case = request.case.as_deref().map(read_case).transpose()?;
    let path = match (&request.model, &case) {
        (Some(path), _) => path.clone(),
        (None, Some(case)) => case.model.clone(),
        (None, None) => {
            let advice = "give --model, or a case that names one";
            return Err(Error::usage("--model", "", "no model is named", advice));
        }
    };
    let model = mapped(read_model(&path)?, request.map.as_deref())?;
    let estimate = request.estimate.as_deref();
    let estimate = estimate.map(read_estimate).transpose()?;
    let vehicle = estimate
        .as_ref()
        .map(|(path, read)| of_estimate(read, &model, path));
    let (mover, completion) = match vehicle.transpose()? {
        Some(vehicle) => (vehicle.mover, vehicle.completion),
        None => (Mover::of_model(model.clone()), None),
    };
    let asked = Asked {
        request,
        mover: &mover,
        model: &model,
        completion: completion.as_ref(),
    };
    let mut validation = match (
        &case,
        Path::new(&request.against).extension() == Some(OsStr::new("toml")),
    ) {
        (Some(case), true) => asked.against_model(case)?,
        (Some(case), false) => asked.against_telemetry(case)?,
        (None, false) => asked.held_back()?,
        (None, true) => {
            let advice = "give one with the torques of both vehicles";
            return Err(Error::usage("CASE", "", "no case is given", advice));
        }
    };
    let file = &mut validation.file;
    file.model = path.display().to_string();
    file.case = case.map(|case| case.path().display().to_string());
    if let (Some(path), Some((_, estimate))) = (&request.estimate, estimate) {
        if !estimate.covariance_trustworthy {
            let warning = "the covariance of the estimate is not trustworthy; see its warnings";
            file.warnings.push(warning.to_owned());
        }
        let unchecked = estimate.unchecked();
        file.warnings.extend(unchecked.map(str::to_owned));
        file.estimate = Some(EstimateRefFile {
            path: path.display().to_string(),
            covariance_trustworthy: estimate.covariance_trustworthy,
            status: estimate.status,
        });
    }
    Ok(validation)
}

/// The request with all inputs read.
struct Asked<'a> {
    request: &'a ValidateRequest,
    mover: &'a Mover,
    model: &'a Model,
    completion: Option<&'a Completion>,
}

impl Asked<'_> {
    fn against_model(&self, case: &Case) -> Result<Validation, Error> {
        let other = Mover::of_model(read_model(PathBuf::from(&self.request.against))?);
        let (own, theirs) = (path(case, self.mover)?, path(case, &other)?);
        let compared = compare_paths(self.model, &own, &theirs);
        let effect = self
            .completion
            .map(|c| motion_effect(case, self.model, c, &own));
        let verdict = within(&compared, self.request);
        Ok(self.answer("model", compared, verdict, effect.transpose()?))
    }

    fn against_telemetry(&self, case: &Case) -> Result<Validation, Error> {
        let table = self.table()?;
        let compared = compare_with_telemetry(case, self.mover, &table)?;
        let moved = |c| motion_effect(case, self.model, c, &path(case, self.mover)?);
        let effect = self.completion.map(moved).transpose()?;
        let judged = compared.iter().filter_map(|c| c.file.sigmas);
        let worst = judged.map(|s| s.rms * s.rms).reduce(f64::max);
        let verdict = match worst {
            Some(worst) if worst <= MISFIT => "agrees",
            Some(_) => "differs",
            None => within(&compared, self.request),
        };
        let mut validation = self.answer("telemetry_of_case", compared, verdict, effect);
        validation.file.repairs = table.repairs;
        Ok(validation)
    }

    fn held_back(&self) -> Result<Validation, Error> {
        let table = [self.table()?];
        let found = HeldBackFindings::of(self.mover, &table, Some(POINTS))?;
        let chi2 = found.chi2_per_dof();
        let effect = self
            .completion
            .map(|c| held_back_effect(self.model, c, &table, chi2));
        let verdict = match found.beyond_noise() {
            false => "agrees",
            true => "differs",
        };
        let kind = "held_back_telemetry";
        let mut validation = self.answer(kind, found.compared(), verdict, effect.transpose()?);
        validation.file.chi2_per_dof = Some(chi2);
        validation.file.warnings = found.warnings();
        let [table] = table;
        validation.file.repairs = table.repairs.into_iter().chain(found.repairs).collect();
        Ok(validation)
    }

    fn table(&self) -> Result<poinsot_telemetry::Table, Error> {
        let (model, request) = (self.model, self.request);
        let options = read_options(model, &model.telemetry, request.strict, request.recover);
        read(&segment_files(&request.against), &options)
    }

    fn answer(
        &self,
        kind: &str,
        histories: Vec<Compared>,
        verdict: &str,
        completed: Option<CompletedFile>,
    ) -> Validation {
        let open = completed.as_ref().is_some_and(|c| !c.depends_on.is_empty());
        let file = ValidationFile {
            schema: VALIDATION.to_owned(),
            poinsot: env!("CARGO_PKG_VERSION").to_owned(),
            kind: kind.to_owned(),
            verdict: if open { "undetermined" } else { verdict }.to_owned(),
            against: self.request.against.to_string_lossy().into_owned(),
            limits: ValidationLimitsFile {
                within_m: self.request.within_m,
                within_rad: self.request.within_rad,
            },
            compared: histories.iter().map(|c| c.file.clone()).collect(),
            completed,
            ..ValidationFile::default()
        };
        Validation { file, histories }
    }
}

/// Whether every position and angle stays within the given limits.
fn within(compared: &[Compared], request: &ValidateRequest) -> &'static str {
    let holds = |one: &Compared| match one.file.unit.as_str() {
        // NaN exceeds every limit.
        "m" => request.within_m.map(|limit| one.file.largest <= limit),
        "rad" => request.within_rad.map(|limit| one.file.largest <= limit),
        _ => None,
    };
    let held: Vec<bool> = compared.iter().filter_map(holds).collect();
    match (held.is_empty(), held.iter().all(|h| *h)) {
        (true, _) => "compared",
        (false, true) => "agrees",
        (false, false) => "differs",
    }
}

fn check(request: &ValidateRequest) -> Result<(), Error> {
    let limits = [
        ("--within-m", request.within_m),
        ("--within-rad", request.within_rad),
    ];
    for (option, limit) in limits {
        if let Some(x) = limit.filter(|x| *x < 0.0 || x.is_nan()) {
            let advice = "give a number of at least zero";
            let problem = "it is negative or not a number";
            return Err(Error::usage(option, x, problem, advice));
        }
    }
    Ok(())
}
