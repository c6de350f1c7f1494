//! The case file `poinsot.case/2`: the motion of a vehicle, its duration, and the output.
//!
//! Reading checks everything that is independent of the model. [`Case::bind`] resolves names against a model, so that
//! one case can run with several models.

mod actuators;
mod bind;
mod control;
mod describe;
mod designed;
mod fault;
mod joints;
mod limits;
mod planner;
mod sensor_output;
mod surroundings;
mod thrusters;
mod torques;
mod wanted;
mod window;

use crate::error::{Error, Fault};
pub(crate) use bind::{COMPARED, FITTED, FITTED_S, SIMULATED};
pub(crate) use describe::describe_case;
pub(crate) use fault::{KeyText, did_you_mean, rows};
use planner::Planner;
use poinsot_dynamics::{Times, Tolerance, Tree};
use poinsot_formats::case::{CASE, CASE_BEFORE, CaseFile};
pub use poinsot_formats::case::{Format, Objective};
use poinsot_formats::sha256_of;
use poinsot_model::Model;
use std::path::{Path, PathBuf};
#[doc(hidden)]
pub use {
    bind::Scenario,
    designed::{Design, Form, Moved},
    limits::{Capsule, Limits},
    sensor_output::SensorOutput,
    thrusters::{Fired, ImpulseLimit, ThrusterLimit},
    wanted::{Want, estimated_numbers},
    window::{Open, Window},
};

/// A parsed case; names are not yet resolved.
#[derive(Debug, Clone)]
pub struct Case {
    /// Model file, relative to the folder of the case.
    pub model: PathBuf,
    /// Duration, s.
    pub duration_s: f64,
    /// Rows per second.
    pub rate_hz: f64,
    /// Format of the telemetry file.
    pub format: Format,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Accuracy of the integrator.
    pub tolerance: Tolerance,
    text: KeyText,
    file: CaseFile,
}

/// Reads a case file.
///
/// # Errors
/// All faults without a model.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// assert_eq!((case.duration_s, case.rate_hz), (10.0, 5.0));
/// assert!(case.model.ends_with("model.toml"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_case(path: &Path) -> Result<Case, Error> {
    let text = poinsot_files::read_tree(path).map_err(|e| e.fault("E0501", path))?;
    parse_case(path, text)
}

/// Reads the text of a case file; `path` is used in messages and to locate the model.
///
/// # Errors
/// All faults without a model.
///
/// ```
/// use poinsot::case::parse_case;
///
/// let text = r#"
/// schema = "poinsot.case/2"
/// model = "model.toml"
/// duration_s = 60.0
///
/// [output]
/// rate_hz = 10.0
/// "#;
/// let case = parse_case("folder/case.toml".as_ref(), text.to_owned())?;
/// assert_eq!((case.model, case.duration_s), ("folder/model.toml".into(), 60.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn parse_case(path: &Path, text: String) -> Result<Case, Error> {
    let (case, faults) = shaped_case(path, text)?;
    Error::none_or(faults, case)
}

/// Reads a case with valid structure; returns also the faults found without the model.
pub(crate) fn shaped_case(path: &Path, text: String) -> Result<(Case, Vec<Fault>), Error> {
    let text = KeyText {
        path: path.to_owned(),
        text,
    };
    let (file, shape) = text.case()?;
    let mut faults = Vec::new();
    if ![CASE, CASE_BEFORE].contains(&file.schema.as_str()) {
        faults.push(text.fault(
            "E0503",
            "schema",
            "this is not the format of a case",
            format!("write schema = \"{CASE}\""),
        ));
    }
    let mut tolerance = Tolerance::default();
    if let Some(integration) = &file.integration {
        tolerance.relative = integration.relative_tolerance;
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let case = Case {
        model: folder.join(&file.model),
        duration_s: file.duration_s,
        rate_hz: file.output.rate_hz,
        format: file.output.format,
        seed: file.output.seed,
        tolerance,
        text,
        file,
    };
    let mut faults = case.text.located(faults);
    faults.extend(shape);
    Ok((case, faults))
}

impl Case {
    /// The path the case was read from.
    pub fn path(&self) -> &Path {
        &self.text.path
    }

    /// The case file.
    pub fn file(&self) -> &CaseFile {
        &self.file
    }

    /// The text of the file.
    pub fn text(&self) -> &str {
        &self.text.text
    }

    /// Every file read by the case, except the model.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let folder = self.text.path.parent().unwrap_or(Path::new(""));
        let files = self.file.files();
        files.map(|file| folder.join(file)).collect()
    }

    /// SHA-256 of every file of [`Self::inputs`].
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn inputs_sha256(&self) -> Result<Vec<String>, Error> {
        self.inputs()
            .into_iter()
            .map(|path| {
                let (file, _) = poinsot_files::open(&path).map_err(|e| e.fault("E0501", &path))?;
                sha256_of(file).map_err(|e| Error::io(&path, "cannot be read", &e))
            })
            .collect()
    }

    /// Times of the samples, s: `k / rate_hz` up to the duration.
    pub fn times(&self) -> Times<'static> {
        // The last of whole periods must not be lost to round-off.
        let last = (self.duration_s * self.rate_hz * (1.0 + 1e-12)).floor();
        Times::Even {
            rows: (1.0 + last) as usize,
            rate_hz: self.rate_hz,
        }
    }

    /// What a planner makes of the case for a model.
    ///
    /// # Errors
    /// All faults that it has found.
    fn planned<'c, T>(
        &'c self,
        model: &'c Model,
        plan: impl FnOnce(&mut Planner<'c>) -> T,
    ) -> Result<T, Error> {
        let mut planner = Planner {
            text: &self.text,
            model,
            tree: Tree::new(model),
            open: Open::default(),
            faults: Vec::new(),
        };
        let planned = plan(&mut planner);
        self.text.none_or(planner.faults, planned)
    }
}
