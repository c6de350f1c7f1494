//! `estimate.json`, the result of `identify`.

use crate::body::BodyFile;
use crate::diagnostics::DiagnosticsFile;
use crate::number::{Axes, NumberFile};
use indexmap::IndexMap;
use poinsot_files::each_once;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the format.
pub const ESTIMATE: &str = "poinsot.estimate/3";

/// Begins the warning of a file that has no checksum.
pub(crate) const UNCHECKED: &str = "unchecked: ";

/// Effects of a test that are evidence against the answer.
const AGAINST: [&str; 3] = ["against_answer", "withholds_numbers", "rejects_model"];

/// The answer of `identify`. SI units, stated by the key. Null means: not determined by the data and the declared
/// priors. What was not requested, or does not apply, is absent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EstimateFile {
    /// "poinsot.estimate/3".
    pub schema: String,
    /// Version of the program.
    pub poinsot: String,
    /// Method, for example "maximum_likelihood".
    pub method: String,
    /// Variant of the method, where it has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
    /// "converged", "partial", "not_identifiable", "iteration_limit" or "rejected".
    pub status: String,
    /// Number of iterations; 1 for a closed form.
    #[serde(default)]
    pub iterations: usize,
    /// Name of the vehicle.
    #[serde(default)]
    pub model: String,
    /// Units, frames and points of all numbers.
    #[serde(default)]
    pub reference: ReferenceFile,
    /// Origin of all times. Absent for tables in memory without an epoch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epoch: Option<EpochFile>,
    /// The model file. Absent for a model that is no file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_file: Option<ModelInputFile>,
    /// File with the map of the telemetry, where it is not part of the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map_file: Option<ModelInputFile>,
    /// Telemetry files.
    pub inputs: Vec<InputFile>,
    /// Bodies by name, in the order of the model.
    pub bodies: IndexMap<String, BodyFile>,
    /// Names, units and matrix of all determined mass properties and nuisances.
    pub covariance: CovarianceFile,
    /// The whole vehicle at the first sample; empty without samples.
    #[serde(default)]
    pub system: Vec<SystemFile>,
    /// Momentum at the first sample, one entry per segment.
    pub momentum: Vec<MomentumFile>,
    /// Everything else that was estimated, by address: biases, scales, lags, spin inertias, for example
    /// "gyro.bias_rad_s.x".
    pub nuisance: IndexMap<String, NumberFile>,
    /// Identifiable and unidentifiable combinations.
    pub identifiability: IdentifiabilityFile,
    /// Fit, one entry per segment.
    pub fit: Vec<SegmentFitFile>,
    /// Tests of the residuals. Absent for a method without them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnostics: Option<DiagnosticsFile>,
    /// Sensitivity of the answer to known numbers.
    #[serde(default)]
    pub known_numbers: KnownNumbersFile,
    /// Whether the covariance is stated and no evidence contradicts it.
    pub covariance_trustworthy: bool,
    /// Evidence against the answer, most important first: the words of the rows of `evidence` against the answer, each
    /// once.
    #[serde(default)]
    pub doubts: Vec<String>,
    /// Every test that was made, most important first. Status, `doubts`, `covariance_trustworthy` and the factor on the
    /// sigmas follow from its rows. Empty in a file of an earlier version.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evidence: Vec<EvidenceFile>,
    /// Numbers that a published method prints. Absent for other methods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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

/// Origin of all times: a date, or a count of the files where their epoch is unknown. Times are in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EpochFile {
    /// Date and time of day in `scale`, for example "2026-03-14T18:19:00".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<String>,
    /// "UTC", "TAI", "GPS" or "TT".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<String>,
    /// Seconds of the files' own count; 0 where times are as in the files.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub own_count_s: Option<f64>,
}

/// Units, frames and points of all numbers of an answer. N does not rotate and is in free fall near the vehicle. B is
/// the frame of a body, with origin Bo and axes from the model. Bcm is the body's mass centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceFile {
    /// "SI": s, m, kg, rad, N. The key of a number ends in its unit.
    pub units: String,
    /// Frame of attitude and momentum: "N".
    pub inertial_frame: String,
    /// Name of the base, whose frame is that of the whole vehicle.
    pub base: String,
    /// Point and axes of `com_m`: "Bcm from Bo, axes of B".
    pub com_m: String,
    /// Point and axes of `inertia_kg_m2`: "about Bcm, axes of B, tensor elements".
    pub inertia_kg_m2: String,
    /// Point and axes of `barycentric`: "about Bo, axes of B, tensor elements".
    pub barycentric: String,
    /// Point, axes and instant of `momentum`: "angular about the vehicle's mass centre, axes of N, at the first sample".
    pub momentum: String,
    /// Convention of `*_xyzw`: "Hamilton, scalar last".
    pub quaternions: String,
}

impl ReferenceFile {
    /// The conventions of the program, for a vehicle with this base.
    pub fn of_base(base: &str) -> Self {
        Self {
            units: "SI".to_owned(),
            inertial_frame: "N".to_owned(),
            base: base.to_owned(),
            com_m: "Bcm from Bo, axes of B".to_owned(),
            inertia_kg_m2: "about Bcm, axes of B, tensor elements".to_owned(),
            barycentric: "about Bo, axes of B, tensor elements".to_owned(),
            momentum: "angular about the vehicle's mass centre, axes of N, at the first sample"
                .to_owned(),
            quaternions: "Hamilton, scalar last".to_owned(),
        }
    }
}

impl Default for ReferenceFile {
    fn default() -> Self {
        Self::of_base("")
    }
}

/// A model file, or a file with a map of telemetry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelInputFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
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

/// Covariance of all determined numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CovarianceFile {
    /// Addresses of the rows, for example "bus.com_m.x", "gyro.bias_rad_s.x".
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
    /// Their joint positions: `<joint>_rad` or `<joint>_m`.
    pub joint_positions: IndexMap<String, f64>,
}

/// Momentum at the first sample of a segment, in N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MomentumFile<N = NumberFile> {
    /// Linear momentum, N s.
    pub linear_N_s: Axes<N>,
    /// Angular momentum about the mass centre of the vehicle, N m s.
    pub angular_N_m_s: Axes<N>,
}

/// What the data determine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IdentifiabilityFile {
    /// Unknown mass properties.
    pub parameters: usize,
    /// Directions that are identifiable under the declared noise.
    pub rank: usize,
    /// Identifiable directions with respect to round-off alone.
    pub structural_rank: usize,
    /// One sigma of each direction in natural units, ascending; null where unbounded.
    pub sigmas_natural: Vec<Option<f64>>,
    /// Determined combinations. If they are fewer than the rank, other functions of the parameters follow.
    pub identifiable: Vec<DeterminedFile>,
    /// Directions that are not.
    pub not_identifiable: Vec<UndeterminedFile>,
}

/// A combination that the data determine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DeterminedFile {
    /// In words.
    pub combination: String,
    /// Coefficients by the address of the parameter; empty of a function that is not linear.
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
    /// Coefficients by the address of the parameter.
    pub coefficients: IndexMap<String, f64>,
    /// Why.
    pub reason: String,
    /// What would determine it.
    pub remedy: String,
    /// Values of the changed unknowns at evenly spaced points of equal prediction along the direction. The answer is in
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
    /// Chi-square per number measured. Absent if the method does not weight this sensor separately.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chi2_per_number: Option<f64>,
    /// p-value of a white residual. Absent where it is not tested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whiteness_p: Option<f64>,
}

/// Sensitivity of the answer to known numbers. Every sigma of the answer includes their uncertainty: sigma =
/// hypot(sigma_data, sigma_known).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KnownNumbersFile {
    /// Whether every known number is exact.
    #[serde(default)]
    pub exact: bool,
    /// Whether some known number has no declared source and is assumed to come from a drawing.
    #[serde(default)]
    pub source_assumed: bool,
    /// One sigma of numbers of the answer if every known number were exact, by address.
    #[serde(default)]
    pub sigma_data: IndexMap<String, f64>,
    /// Uncertain known numbers that affect the measurements, largest share of a variance first.
    #[serde(default)]
    pub sensitivities: Vec<SensitivityFile>,
    /// Covariance of those numbers after the data, in their order and units; empty in files of earlier versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<Vec<Option<f64>>>,
}

/// Effect of one known number on the answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SensitivityFile {
    /// Address of the known number, for example "link1.mass_kg".
    pub number: String,
    /// Unit.
    pub unit: String,
    /// Value in the model; 0 for a small turn, 1 for a factor.
    pub value: f64,
    /// Declared one sigma.
    pub sigma: f64,
    /// Estimated value, if the data reduce its sigma below 0.7 of the declared one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate: Option<f64>,
    /// One sigma of the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimate_sigma: Option<f64>,
    /// Step of the number for `change`: "1 %", "1 mm" or "1 mrad".
    pub step: String,
    /// Change of the numbers of the answer with that step and fixed measurements, by address.
    pub change: IndexMap<String, f64>,
    /// Share of their variance that would go if this number were known exactly; shares of numbers that err together overlap.
    pub variance_share: IndexMap<String, f64>,
}

/// One test of the answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EvidenceFile {
    /// Name of the test, for example "residual of the gyro".
    pub test: String,
    /// Name of the statistic, for example "chi-square". Absent for a test without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub statistic: Option<String>,
    /// Value of the statistic. Absent for a test without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Degrees of freedom of the statistic, or how many numbers were compared. Absent for a test without them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degrees_of_freedom: Option<usize>,
    /// Probability of a statistic at least as large if model and declared noise are correct. Absent for a test without
    /// a p-value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p: Option<f64>,
    /// "none", "widens_sigmas", "makes_partial", "against_answer", "withholds_numbers" or "rejects_model". The last
    /// three are evidence against the answer.
    pub effect: String,
    /// Factor on every sigma that this test requires; 1 if none. Every sigma has the largest factor of all rows. Absent
    /// if unbounded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_factor: Option<f64>,
    /// Result in words.
    pub words: String,
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
    /// Number of samples (of a gap: gaps).
    pub count: usize,
    /// Samples of the channel.
    pub of: usize,
    /// Times of the first ones, s.
    pub first_times_s: Vec<f64>,
    /// In words.
    pub text: String,
    /// What was done: "report", "exclude" or "refuse".
    pub policy: String,
}

impl EvidenceFile {
    /// Whether the row is evidence against the answer.
    pub fn is_against_answer(&self) -> bool {
        AGAINST.contains(&self.effect.as_str())
    }
}

impl SensitivityFile {
    /// The number of the answer that it changes most, with its share of that number's variance.
    pub fn most_sensitive(&self) -> Option<(&str, f64)> {
        let shares = self.variance_share.iter();
        let largest = shares.max_by(|a, b| a.1.total_cmp(b.1))?;
        Some((largest.0.as_str(), *largest.1))
    }
}

impl CovarianceFile {
    /// Unit of the number with this address.
    pub fn unit_of(&self, address: &str) -> Option<&str> {
        self.units.get(self.place(address)?).map(String::as_str)
    }

    /// Covariance of two numbers by their addresses; `None` where one of them has no row.
    pub fn between(&self, one: &str, other: &str) -> Option<f64> {
        let row = self.matrix.get(self.place(one)?)?;
        row.get(self.place(other)?).copied().flatten()
    }

    fn place(&self, address: &str) -> Option<usize> {
        self.names.iter().position(|name| name == address)
    }
}

impl EstimateFile {
    /// Whether numbers are withheld because the model contradicts the data or the fit did not converge.
    pub fn is_withheld(&self) -> bool {
        ["rejected", "iteration_limit"].contains(&self.status.as_str())
    }

    /// Evidence against the answer in words, most important first: of the rows, or of `doubts` in a file without rows.
    pub fn evidence_against(&self) -> Vec<&str> {
        if self.evidence.is_empty() {
            return self.doubts.iter().map(String::as_str).collect();
        }
        let rows = self.evidence.iter().filter(|row| row.is_against_answer());
        each_once(rows.map(|row| row.words.as_str()))
    }

    /// Why its numbers must not be relied on; empty if they may.
    pub fn unreliable(&self) -> Vec<String> {
        let against: Vec<String> = self
            .evidence_against()
            .iter()
            .map(|w| w.to_string())
            .collect();
        let mut why = match (
            against.is_empty(),
            self.is_withheld(),
            self.covariance_trustworthy,
        ) {
            (true, true, _) => vec![format!("its status is {}", self.status)],
            (true, false, false) => vec!["its covariance is not trustworthy".to_owned()],
            _ => against,
        };
        why.extend(self.unchecked().map(str::to_owned));
        why
    }

    /// The warning that it was read without a checksum.
    pub fn unchecked(&self) -> Option<&str> {
        let mut all = self.warnings.iter().map(String::as_str);
        all.find(|w| w.starts_with(UNCHECKED))
    }

    /// Method and variant as text.
    pub fn method_in_words(&self) -> String {
        let method = self.method.replace('_', " ");
        match &self.variant {
            Some(variant) => format!("{method} ({variant})"),
            None => method,
        }
    }
}
