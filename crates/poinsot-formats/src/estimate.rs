//! `estimate.json`, the answer of `identify`.

use crate::diagnostics::DiagnosticsFile;
use crate::number::{NumberFile, TensorFile, VectorFile};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const ESTIMATE: &str = "poinsot.estimate/1";

/// The answer of `identify`. SI units, stated by the key. A number that the data and the declared priors do not determine
/// is null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EstimateFile {
    /// "poinsot.estimate/1".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// Method, for example "maximum_likelihood".
    pub method: String,
    /// Variant of the method; null without one.
    pub variant: Option<String>,
    /// "converged", "partial", "not_identifiable", "iteration_limit" or "rejected".
    pub status: String,
    /// Iterations taken; 1 for a closed form.
    #[serde(default)]
    pub iterations: usize,
    /// Name of the vehicle.
    #[serde(default)]
    pub model: String,
    /// What all times count from; absent where that is the zero of the files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epoch: Option<EpochFile>,
    /// Telemetry files.
    pub inputs: Vec<InputFile>,
    /// Bodies by name, in the order of the model.
    pub bodies: IndexMap<String, BodyFile>,
    /// Names, units and matrix of all determined mass properties and nuisances.
    pub covariance: CovarianceFile,
    /// The whole vehicle at the first sample; empty where only rotation is measured.
    #[serde(default)]
    pub system: Vec<SystemFile>,
    /// Momentum at the first sample, one entry per segment.
    pub momentum: Vec<MomentumFile>,
    /// Everything else that was estimated: biases, scales, lags, spin inertias.
    pub nuisance: IndexMap<String, NumberFile>,
    /// What the data determine and what they do not.
    pub identifiability: IdentifiabilityFile,
    /// Fit, one entry per segment.
    pub fit: Vec<SegmentFitFile>,
    /// Tests of the residuals; null of a method that makes none.
    #[serde(default)]
    pub diagnostics: Option<DiagnosticsFile>,
    /// How the answer depends on numbers that the model gives as known.
    #[serde(default)]
    pub known_numbers: KnownNumbersFile,
    /// Whether the covariance is stated and no evidence contradicts it.
    pub covariance_trustworthy: bool,
    /// Evidence against relying on the answer, most important first.
    #[serde(default)]
    pub doubts: Vec<String>,
    /// Numbers that a published method prints; null for other methods.
    #[serde(default)]
    pub method_report: Option<MethodReportFile>,
    /// Findings of the telemetry checks.
    #[serde(default)]
    pub telemetry_checks: Vec<CheckFile>,
    /// What was assumed or repaired.
    pub repairs: Vec<String>,
    /// Columns of the telemetry that were not used.
    #[serde(default)]
    pub ignored_columns: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// An instant: a date, or a count of the files where their epoch is unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EpochFile {
    /// Date and time of day in `scale`, for example "2026-03-14T18:19:00".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
    /// "UTC", "TAI", "GPS" or "TT".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<String>,
    /// Seconds of the files' own count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub own_count_s: Option<f64>,
}

/// A telemetry file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InputFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Index of the segment.
    pub segment: usize,
    /// First and last time, s.
    pub time_s: [f64; 2],
    /// Data rows read.
    pub rows: usize,
}

/// Mass properties of one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BodyFile {
    /// Mass, kg.
    pub mass_kg: NumberFile,
    /// Mass centre from the origin of the body's frame, in its axes, m.
    pub com_m: VectorFile,
    /// Inertia tensor about the mass centre, in the body's axes, kg m2.
    pub inertia_kg_m2: TensorFile,
    /// Principal moments and axes; null where the tensor is not determined.
    pub principal: Option<PrincipalFile>,
    /// The ten parameters about the origin of the body's frame.
    pub barycentric: BarycentricFile,
    /// Whether a distribution of positive mass has this tensor; null where it is not determined.
    pub physically_consistent: Option<bool>,
}

/// Principal moments and axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PrincipalFile {
    /// Moments in ascending order, kg m2.
    pub moments_kg_m2: [f64; 3],
    /// Rotation from principal axes to body axes: quaternion, Hamilton, scalar last.
    pub axes_xyzw: [f64; 4],
}

/// Mass, first moment and inertia about the origin of the body's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BarycentricFile {
    /// Mass, kg.
    pub m_kg: NumberFile,
    /// First moment of mass, kg m.
    pub mc_kg_m: VectorFile,
    /// Inertia tensor about the origin, kg m2.
    pub I_BBo_kg_m2: TensorFile,
}

/// Covariance of all determined numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CovarianceFile {
    /// Names of the rows, for example "bus.mass".
    pub names: Vec<String>,
    /// Units of the rows.
    pub units: Vec<String>,
    /// Matrix, row by row.
    pub matrix: Vec<Vec<Option<f64>>>,
}

/// The whole vehicle as one body at stated joint positions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SystemFile {
    /// Its mass properties about the base's frame.
    #[serde(flatten)]
    pub body: BodyFile,
    /// Joint positions for which they hold: `<joint>_rad` or `<joint>_m`.
    pub joint_positions: IndexMap<String, f64>,
}

/// Momentum at the first sample of a segment, in N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MomentumFile {
    /// Linear momentum, N s.
    pub linear_N_s: VectorFile,
    /// Angular momentum about the mass centre of the vehicle, N m s.
    pub angular_N_m_s: VectorFile,
}

/// What the data determine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentifiabilityFile {
    /// Unknown mass properties.
    pub parameters: usize,
    /// Directions that are identifiable under the declared noise.
    pub rank: usize,
    /// Directions that round-off alone would call identifiable.
    pub structural_rank: usize,
    /// One sigma of each direction in natural units, ascending; null where unbounded.
    pub sigmas_natural: Vec<Option<f64>>,
    /// Combinations that are determined; where they are fewer than the rank, other functions of the parameters behind them.
    pub identifiable: Vec<DeterminedFile>,
    /// Directions that are not.
    pub not_identifiable: Vec<UndeterminedFile>,
}

/// A combination that the data determine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DeterminedFile {
    /// In words.
    pub combination: String,
    /// Coefficients by parameter name; empty of a function that is not linear.
    pub coefficients: IndexMap<String, f64>,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: Option<f64>,
    /// One sigma.
    pub sigma: Option<f64>,
}

/// A direction that the data do not determine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UndeterminedFile {
    /// In words.
    pub combination: String,
    /// Coefficients by parameter name.
    pub coefficients: IndexMap<String, f64>,
    /// Why.
    pub reason: String,
    /// What would determine it.
    pub remedy: String,
    /// Values of each parameter that moves, at points of equal prediction along the direction, evenly spaced, the answer in
    /// the middle.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub walk: IndexMap<String, Vec<f64>>,
}

/// Fit of one segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SegmentFitFile {
    /// Label of the segment: its files.
    pub segment: String,
    /// Grid times.
    pub samples: usize,
    /// Chi-square per degree of freedom.
    pub chi2_per_dof: Option<f64>,
    /// Sensors by name.
    pub channels: IndexMap<String, SensorFitFile>,
}

/// Fit of one sensor in one segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensorFitFile {
    /// Root mean square of the residual, in `unit`.
    pub rms: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Chi-square per number measured.
    pub chi2_per_number: Option<f64>,
    /// Probability that a white residual is as correlated in time.
    pub whiteness_p: Option<f64>,
}

/// How the answer depends on numbers that the model gives as known. Every sigma of the answer holds their uncertainty:
/// sigma = hypot(sigma_data, sigma_known).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KnownNumbersFile {
    /// Whether every known number is taken as exact.
    #[serde(default)]
    pub exact: bool,
    /// Whether some known number has no declared source, so that it is taken as exact.
    #[serde(default)]
    pub source_assumed: bool,
    /// One sigma of numbers of the answer if every known number were exact, by name of the covariance.
    #[serde(default)]
    pub sigma_data: IndexMap<String, f64>,
    /// Uncertain known numbers on which the readings depend, the largest share of a variance first.
    #[serde(default)]
    pub sensitivities: Vec<SensitivityFile>,
}

/// What one known number does to the answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensitivityFile {
    /// Name of the known number, for example "link1.mass".
    pub number: String,
    /// Unit.
    pub unit: String,
    /// Value in the model; 0 for a small turn, 1 for a factor.
    pub value: f64,
    /// Declared one sigma.
    pub sigma: f64,
    /// Value with the data, where they bring its sigma below 0.7 of the declared one; else null.
    pub estimate: Option<f64>,
    /// One sigma of the same.
    pub estimate_sigma: Option<f64>,
    /// Step of the number for `change`: "1 %", "1 mm" or "1 mrad".
    pub step: String,
    /// Change of the numbers of the answer with that step, the readings held, by name of the covariance.
    pub change: IndexMap<String, f64>,
    /// Share of their variance.
    pub variance_share: IndexMap<String, f64>,
}

/// Numbers that a published method prints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MethodReportFile {
    /// What they are.
    pub note: String,
    /// The numbers.
    pub numbers: Vec<ReportedNumberFile>,
}

/// One number of a published method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReportedNumberFile {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: Option<f64>,
    /// One sigma.
    pub sigma: Option<f64>,
    /// Nominal value.
    pub nominal: Option<f64>,
}

/// Finding of a telemetry check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckFile {
    /// Name of the check.
    pub check: String,
    /// Channel, or the channels of a sensor as `omega_x..z`.
    pub channel: String,
    /// Samples (of a gap: gaps) concerned.
    pub count: usize,
    /// Samples of the channel.
    pub of: usize,
    /// Times of the first of them, s.
    pub first_times_s: Vec<f64>,
    /// In words.
    pub text: String,
    /// What was done: "report", "exclude" or "refuse".
    pub policy: String,
}

impl BodyFile {
    /// Mass, mass centre and inertia with name and unit.
    pub fn numbers(&self) -> Vec<(String, &'static str, NumberFile)> {
        let mut all = vec![("mass".to_owned(), "kg", self.mass_kg.clone())];
        for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
            all.push((format!("com {axis}"), "m", self.com_m.number(k)));
        }
        for (element, number) in self.inertia_kg_m2.named() {
            all.push((format!("I {element}"), "kg m²", number));
        }
        all
    }

    /// Whether any of its numbers was asked for.
    pub fn is_asked(&self) -> bool {
        self.numbers().iter().any(|(_, _, n)| !n.is_known())
    }
}

impl EstimateFile {
    /// Whether numbers were computed and are not shown, because the model contradicts the data or the fit did not settle.
    pub fn is_withheld(&self) -> bool {
        ["rejected", "iteration_limit"].contains(&self.status.as_str())
    }

    /// Method with its variant, in words.
    pub fn method_in_words(&self) -> String {
        let method = self.method.replace('_', " ");
        match &self.variant {
            Some(variant) => format!("{method} ({variant})"),
            None => method,
        }
    }
}
