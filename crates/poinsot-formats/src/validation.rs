//! `validation.json`: comparison of the motion of a model or estimate with another model or telemetry.

use crate::read::ResultFile;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const VALIDATION: &str = "poinsot.validation/3";

/// The motion of a model or an estimate against another model or telemetry.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValidationFile {
    /// "poinsot.validation/3".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// "model", "telemetry_of_case" or "held_back_telemetry".
    pub kind: String,
    /// "compared", "agrees", "differs" or "undetermined".
    pub verdict: String,
    /// Path of the model.
    pub model: String,
    /// The estimate whose numbers replace those of the model. Absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate: Option<EstimateRefFile>,
    /// What it was compared with.
    pub against: String,
    /// Path of the case. Absent for held-back telemetry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// Limits that were given.
    pub limits: ValidationLimitsFile,
    /// Chi-square per degree of freedom. Absent where no telemetry was fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chi2_per_dof: Option<f64>,
    /// One entry per quantity.
    pub compared: Vec<ComparedQuantityFile>,
    /// How undetermined numbers of the estimate were completed. Absent where it determines every number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub completed: Option<CompletedFile>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// What was assumed or repaired.
    pub repairs: Vec<String>,
    /// SHA-256 of the files that were written with this one, by their names in its folder; lower-case hexadecimal.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub files: IndexMap<String, String>,
}

impl ValidationFile {
    /// Whether both motions agree, with a reliable estimate.
    pub fn passes(&self) -> bool {
        let failed = matches!(self.verdict.as_str(), "differs" | "undetermined");
        self.estimate
            .as_ref()
            .is_none_or(|e| e.covariance_trustworthy)
            && !failed
    }
}

/// An estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EstimateRefFile {
    /// Path as given.
    pub path: String,
    /// Its status.
    pub status: String,
    /// Whether the covariance of the estimate is trustworthy.
    #[serde(default = "relied_on")]
    pub covariance_trustworthy: bool,
}

/// Default for files of earlier versions.
fn relied_on() -> bool {
    true
}

/// Limits that were given.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ValidationLimitsFile {
    /// Largest acceptable difference of positions, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within_m: Option<f64>,
    /// Largest acceptable difference of attitude and joint angles, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub within_rad: Option<f64>,
}

/// Differences of one quantity.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedQuantityFile {
    /// Name of the quantity.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Times compared.
    pub samples: usize,
    /// Largest difference.
    pub largest: f64,
    /// Its time, s.
    pub largest_at_s: f64,
    /// Root mean square.
    pub rms: f64,
    /// The same in sigma of the sensor. Absent where nothing was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigmas: Option<InSigmasFile>,
}

/// Differences in sigma of the declared noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InSigmasFile {
    /// Root mean square.
    pub rms: f64,
    /// Largest.
    pub largest: f64,
    /// p-value of a white residual. Absent where it is not tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whiteness_p: Option<f64>,
}

/// How undetermined numbers of an estimate were completed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CompletedFile {
    /// Numbers that the estimate determines.
    pub determined: usize,
    /// Directions that it does not.
    pub open: usize,
    /// Distance of the completed numbers from the nominal ones, natural units.
    pub distance_natural: f64,
    /// Variation of undetermined directions, natural units.
    pub open_moved_by_natural: f64,
    /// Changes of the prediction with them.
    pub prediction_changes: Vec<PredictionChangeFile>,
    /// Quantities of the prediction that depend on them.
    pub depends_on: Vec<String>,
}

/// Change of one quantity of the prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictionChangeFile {
    /// Name of the quantity.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Largest change.
    pub largest: f64,
}

impl ResultFile for ValidationFile {
    const SCHEMA: &'static str = VALIDATION;
    const EARLIER: &'static [&'static str] = &["poinsot.validation/2"];
}
