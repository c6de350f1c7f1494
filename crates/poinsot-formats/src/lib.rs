//! One type per file format: it writes the file, reads it and gives its JSON Schema.
//!
//! ```
//! use poinsot_formats::{Elements, NumberFile};
//!
//! let mass = NumberFile { value: Some(312.4), sigma: Some(0.2), nominal: 310.0, source: Some("data".into()) };
//! assert!(!mass.is_known());
//! let tensor = Elements { xx: 1.0, yy: 2.0, zz: 2.5, xy: 0.1, xz: 0.0, yz: -0.1 };
//! assert_eq!(tensor.named().map(|(name, _)| name), ["xx", "yy", "zz", "xy", "xz", "yz"]);
//! assert_eq!(poinsot_formats::address("gyro.bias_x", "rad/s"), "gyro.bias_rad_s.x");
//! ```
//!
//! # Files
//! - One file per format. `number.rs`, `body.rs`: numbers, vectors, tensors, bodies.
//! - `address.rs`: addresses of numbers, with their one grammar.
//! - `case.rs`, `plan.rs`: case and plan, read and written. `toml_file.rs`: all faults in the structure of a TOML file.
//! - `check.rs`: consistency of an answer. `read.rs`: the reader. `upgrade.rs`: earlier versions.
//! - `listing.rs`: answers of the commands that list, and errors as data.
#![allow(non_snake_case)]

mod address;
mod band;
mod body;
mod campaign;
pub mod case;
mod check;
mod comparison;
mod design;
mod diagnostics;
mod estimate;
mod listing;
mod number;
mod onboard;
mod plan;
mod prediction;
mod read;
mod report_data;
mod statistics;
mod toml_file;
mod truth;
mod upgrade;
mod validation;

pub use address::{Address, address, element, unknown_name};
pub use band::Band;
pub use body::{BarycentricFile, BodyFile, MassFile, PrincipalFile};
pub use campaign::{
    BandedFile, CAMPAIGN, CampaignCost, CampaignFile, CellFile, MethodResultFile, NumberResultFile,
    PairFile, PairNumberFile,
};
pub use check::{Contradiction, contradictions};
pub use comparison::{
    COMPARISON, ComparedAnswerFile, ComparedNumberFile, ComparisonFile, DIFFER_BELOW, JointTestFile,
};
pub use design::{
    DESIGN, DesignFile, DesignVerificationFile, DesignedNumberFile, LimitUseFile, RelaxedFile,
    SearchFile, VerifiedNumberFile,
};
pub use diagnostics::{
    ChannelFile, DiagnosticsFile, DriftFile, FindingFile, HeldOutFile, LagFile, LineFile,
    SuspectFile, ValueFile,
};
pub use estimate::{
    CheckFile, CovarianceFile, DeterminedFile, ESTIMATE, EpochFile, EstimateFile, EvidenceFile,
    IdentifiabilityFile, InputFile, KnownNumbersFile, MethodReportFile, ModelInputFile,
    MomentumFile, ReferenceFile, ReportedNumberFile, SegmentFitFile, SensitivityFile,
    SensorFitFile, SystemFile, UndeterminedFile,
};
pub use listing::{
    CODES, CodeFile, CodesFile, DESCRIPTION, ERROR, ErrorFile, FINDINGS, FaultFile, FindingsFile,
    FoundCellFile, FoundTableFile, INSPECTION, ListedMethodFile, ListedSettingFile, METHODS,
    MethodsFile, PaperFile, STUDIES, StatedFile, StatementFile, StudiesFile, StudyFile,
    StudyFindingsFile, UNITS, UnitFile, UnitsFile, VariantFile, WRITTEN, WrittenFile,
};
pub use number::{
    Axes, Elements, HALF_WIDTH_95, NumberFile, PredictedNumberFile, TensorFile, TrueNumberFile,
    VectorFile, finite,
};
pub use onboard::{ONBOARD, OnboardBodyFile, OnboardFile};
pub use plan::{
    ChangeFile, DrawFile, ExperimentFile, MethodFile, NumbersFile, OfFile, PLAN, PlanFile,
    REPLICATES, SamplingFile, SamplingKind, ScaleFile, SettingFile, VaryFile,
};
pub use prediction::{
    AgainstDurationFile, PREDICTION, PeakFile, PredictionFile, SigmasFile, WantedFile,
};
pub use read::{FormatError, LARGEST_RESULT, parse_estimate, read_estimate, read_truth};
pub use report_data::{
    Channel, DrawnBody, DrawnJoint, DrawnSensor, Pointer, REPORT_DATA, ReportData, Row, Segment,
    TrueNumbers, Vehicle,
};
pub use statistics::{ParameterStatistics, Statistics};
pub use toml_file::ShapeFault;
pub use truth::{
    InitialFile, JointStateFile, TRUTH, TrueBodyFile, TrueRunFile, TrueSensorFile, TruthFile,
    WheelUseFile,
};
pub use validation::{
    ComparedQuantityFile, CompletedFile, EstimateRefFile, InSigmasFile, PredictionChangeFile,
    VALIDATION, ValidationFile, ValidationLimitsFile,
};

pub use serde::Serialize;

use schemars::{JsonSchema, schema_for};
use serde_json::Value;

/// A format: its name, and its JSON Schema.
type Format = (&'static str, fn() -> Value);

fn of<T: JsonSchema>() -> Value {
    schema_for!(T).to_value()
}

/// All formats.
const FORMATS: [Format; 17] = [
    ("estimate", of::<EstimateFile>),
    ("truth", of::<TruthFile>),
    ("prediction", of::<PredictionFile>),
    ("validation", of::<ValidationFile>),
    ("comparison", of::<ComparisonFile>),
    ("design", of::<DesignFile>),
    ("onboard", of::<OnboardFile>),
    ("case", of::<case::CaseFile>),
    ("plan", of::<PlanFile>),
    ("campaign", of::<CampaignFile>),
    ("methods", of::<MethodsFile>),
    ("units", of::<UnitsFile>),
    ("codes", of::<CodesFile>),
    ("studies", of::<StudiesFile>),
    ("findings", of::<FindingsFile>),
    ("written", of::<WrittenFile>),
    ("error", of::<ErrorFile>),
];

/// Names of the formats that [`schema`] knows.
pub fn names() -> impl Iterator<Item = &'static str> {
    FORMATS.into_iter().map(|(name, _)| name)
}

/// JSON Schema (2020-12) of a result file by name; `None` for an unknown name.
pub fn schema(name: &str) -> Option<Value> {
    let found = FORMATS.into_iter().find(|(n, _)| *n == name)?;
    Some(found.1())
}
