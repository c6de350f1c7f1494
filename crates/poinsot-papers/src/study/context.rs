//! What a study is given: the folder of examples, and the tools of the crate above.

use poinsot_dynamics::Tree;
use poinsot_identify::{Estimate, Noise, Segment};
use poinsot_model::{Model, read_model};
use poinsot_spatial::InertialParameters;
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};

/// Why a study gives no findings: an error of a tool, as the tool gave it.
pub type StudyError = Box<dyn std::error::Error + Send + Sync>;

/// A case file that a study may change before it is run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaseText {
    /// Where it stands; the model's path is relative to it.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

/// Difference of one quantity between two motions.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// For example `base position`, `joint joint1`.
    pub name: String,
    /// Times, s.
    pub time_s: Vec<f64>,
    /// One row a component.
    pub rows: Vec<Vec<f64>>,
    /// Largest length over time.
    pub largest: f64,
}

/// What studies use of the crate above this one.
pub trait Tools: Sync {
    /// Reads and checks a case file.
    ///
    /// # Errors
    /// The file cannot be read or is not a case.
    fn case(&self, path: &Path) -> Result<CaseText, StudyError>;

    /// The vehicle of a case, as its model file has it.
    ///
    /// # Errors
    /// The model file cannot be read.
    fn vehicle(&self, case: &CaseText) -> Result<Model, StudyError>;

    /// Telemetry of one trial of a case flown by this vehicle.
    ///
    /// # Errors
    /// The case does not fit the vehicle.
    fn simulate(&self, case: &CaseText, vehicle: &Model, trial: u64) -> Result<Table, StudyError>;

    /// Telemetry of one file in the names of a model, measured accelerations included.
    ///
    /// # Errors
    /// The file cannot be read.
    fn read(&self, model: &Model, file: &Path) -> Result<Table, StudyError>;

    /// Samples and noise of telemetry.
    ///
    /// # Errors
    /// Model and telemetry do not fit.
    fn bind(
        &self,
        model: &Model,
        tree: &Tree,
        tables: &[Table],
    ) -> Result<(Vec<Segment>, Noise), StudyError>;

    /// The estimate of a method, as the command `identify` gives it.
    ///
    /// # Errors
    /// The telemetry does not suit the method.
    fn identify(
        &self,
        model: &Model,
        tables: Vec<Table>,
        method: &str,
        variant: Option<&str>,
    ) -> Result<Estimate, StudyError>;

    /// The Cramer-Rao bound of a case flown by this vehicle, as the command `predict` gives it.
    ///
    /// # Errors
    /// The case does not fit the vehicle.
    fn bound(&self, case: &CaseText, vehicle: &Model) -> Result<Estimate, StudyError>;

    /// Motion of two sets of bodies, one per body of the case's vehicle, under the actuation of a case.
    ///
    /// # Errors
    /// One of them cannot move.
    fn differences(
        &self,
        case: &CaseText,
        of: &[InertialParameters],
        against: &[InertialParameters],
    ) -> Result<Vec<Difference>, StudyError>;
}

/// What a study is given.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The folder `examples` of the project.
    pub examples: &'a Path,
    /// The tools.
    pub tools: &'a dyn Tools,
}

impl Context<'_> {
    /// A case of `examples/cases`.
    ///
    /// # Errors
    /// The file cannot be read or is not a case.
    pub fn case(&self, name: &str) -> Result<CaseText, StudyError> {
        self.tools.case(&self.examples.join("cases").join(name))
    }

    /// A model of the examples.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn model(&self, path: &str) -> Result<Model, StudyError> {
        Ok(read_model(self.examples.join(path))?)
    }
}

impl CaseText {
    /// The same case with parts of its text replaced.
    #[must_use]
    pub fn with(mut self, changes: &[(&str, &str)]) -> Self {
        for (from, to) in changes {
            self.text = self.text.replace(from, to);
        }
        self
    }
}
