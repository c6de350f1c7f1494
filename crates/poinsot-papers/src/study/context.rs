//! Input of a study: the shipped data, and the tools of the `poinsot` crate.

use poinsot_dynamics::Tree;
use poinsot_files::read_tree;
use poinsot_identify::{Estimate, Noise, Segment};
use poinsot_model::{Model, read_model};
use poinsot_spatial::InertialParameters;
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};

/// Error of a study: the error of a tool, unchanged.
pub type StudyError = Box<dyn std::error::Error + Send + Sync>;

/// A case file that a study may modify.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaseText {
    /// Path; the model's path is relative to it.
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
    /// One row per component.
    pub rows: Vec<Vec<f64>>,
    /// Largest norm over time.
    pub largest: f64,
}

/// Functions of the `poinsot` crate used by studies.
pub trait Tools: Sync {
    /// The model of a case.
    ///
    /// # Errors
    /// The model file cannot be read.
    fn vehicle(&self, case: &CaseText) -> Result<Model, StudyError>;

    /// Simulates one trial of a case with this vehicle.
    ///
    /// # Errors
    /// The case does not fit the vehicle.
    fn simulate(&self, case: &CaseText, vehicle: &Model, trial: u64) -> Result<Table, StudyError>;

    /// Reads the telemetry of one file for a model, including measured accelerations.
    ///
    /// # Errors
    /// The file cannot be read.
    fn read(&self, model: &Model, file: &Path) -> Result<Table, StudyError>;

    /// Binds telemetry to a model: samples and noise.
    ///
    /// # Errors
    /// Model and telemetry do not fit.
    fn bind(
        &self,
        model: &Model,
        tree: &Tree,
        tables: &[Table],
    ) -> Result<(Vec<Segment>, Noise), StudyError>;

    /// The estimate of a method, as from the command `identify`.
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

    /// The Cramer-Rao bound of a case with this vehicle, as from the command `predict`.
    ///
    /// # Errors
    /// The case does not fit the vehicle.
    fn bound(&self, case: &CaseText, vehicle: &Model) -> Result<Estimate, StudyError>;

    /// Differences of motion between two sets of bodies under the actuation of a case.
    ///
    /// # Errors
    /// One of them cannot be simulated.
    fn differences(
        &self,
        case: &CaseText,
        of: &[InertialParameters],
        against: &[InertialParameters],
    ) -> Result<Vec<Difference>, StudyError>;
}

/// Input of a study.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The folder `data` of the project.
    pub data: &'a Path,
    /// The tools.
    pub tools: &'a dyn Tools,
}

impl Context<'_> {
    /// A case of `data/cases`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn case(&self, name: &str) -> Result<CaseText, StudyError> {
        let path = self.data.join("cases").join(name);
        let text = read_tree(&path).map_err(|e| e.fault("E0501", &path))?;
        Ok(CaseText { path, text })
    }

    /// A model of the shipped data.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn model(&self, path: &str) -> Result<Model, StudyError> {
        Ok(read_model(self.data.join(path))?)
    }
}

impl CaseText {
    /// Replaces parts of the text of the case.
    #[must_use]
    pub fn with(mut self, changes: &[(&str, &str)]) -> Self {
        for (from, to) in changes {
            self.text = self.text.replace(from, to);
        }
        self
    }
}

/// Removes translation: attitude and rates remain.
///
/// ```
/// use poinsot_papers::study::without_translation;
/// use poinsot_telemetry::{Channel, Table};
///
/// let channel = |name: &str| Channel { name: name.to_owned(), ..Channel::default() };
/// let channels = vec![channel("omega_x"), channel("r_x"), channel("v_y")];
/// let mut tables = [Table { channels, ..Table::default() }];
/// without_translation(&mut tables);
/// assert_eq!(tables[0].channels.len(), 1);
/// ```
pub fn without_translation(tables: &mut [Table]) {
    let turns = |name: &str| !name.starts_with("r_") && !name.starts_with("v_");
    for table in tables {
        table.channels.retain(|c| turns(&c.name));
    }
}
