//! One type per file format: it writes the file, reads it and gives its JSON Schema.
//!
//! | format | type | made by |
//! |---|---|---|
//! | `estimate.json` | [`EstimateFile`] | `identify` |
//! | `truth.json` | [`TruthFile`] | `simulate` |
//! | `prediction.json` | [`PredictionFile`] | `predict` |
//! | `validation.json` | [`ValidationFile`] | `validate` |
//! | `comparison.json` | [`ComparisonFile`] | `compare` |
//! | `design.json` | [`DesignFile`] | `design` |
//! | `campaign.json` | [`CampaignFile`] | `campaign` |
//! | `case.toml`, `plan.toml` | [`case::CaseFile`], [`PlanFile`] | the user, or `design` |
//!
//! [`read_estimate`] and [`read_truth`] also read files of version 1. [`contradictions`] checks what no schema can.
//! A number is called by its [`address()`], the same in files, plans, flags and Python.
//!
//! # Example
//! The answer to the case of `crates/poinsot/doc`: a box whose six inertia elements are determined.
//!
//! ```
//! use poinsot_formats::{contradictions, parse_estimate};
//!
//! let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/estimate.json"));
//! let estimate = parse_estimate("estimate.json".as_ref(), bytes)?;
//! assert_eq!(estimate.status, "converged");
//! assert!(contradictions(&estimate).is_empty());
//! for (element, number) in estimate.bodies["bus"].inertia_kg_m2.named() {
//!     println!("I_{element} = {:?} +- {:?} kg m2", number.value, number.sigma);
//! }
//! # Ok::<(), poinsot_files::Faults>(())
//! ```
//!
//! # Files
//! - One file per format. `number.rs`, `body.rs`: numbers, vectors, tensors, bodies.
//! - `address.rs`: addresses of numbers, with their one grammar.
//! - `case.rs`, `plan.rs`: case and plan, read and written.
//! - `check.rs`: consistency of an answer. `read.rs`: the reader. `upgrade.rs`: earlier versions.
//! - `band.rs`: bands and confidence intervals of statistics of trials.
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
mod truth;
mod upgrade;
mod validation;

pub use address::{Address, address, element, unknown_name};
pub use band::{Band, BandedFile};
pub use body::{BarycentricFile, BodyFile, MassFile, PrincipalFile};
pub use campaign::{
    CAMPAIGN, Calibration, CampaignCost, CampaignFile, CellFile, MethodResultFile, NumberResultFile,
};
pub use check::contradictions;
pub use comparison::{
    COMPARISON, ComparedAnswerFile, ComparedNumberFile, ComparisonFile, DIFFER_BELOW, JointTestFile,
};
pub use design::{
    ACTIVE, DESIGN, DesignFile, DesignVerificationFile, DesignedNumberFile, FrontPointFile,
    LimitUseFile, RelaxedFile, SearchFile, ShorterFile, VerifiedNumberFile,
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
    MethodsFile, PaperFile, QuestionFile, STUDIES, StatedFile, StatementFile, StudiesFile,
    StudyFile, StudyFindingsFile, UNITS, UnitFile, UnitsFile, VariantFile, WRITTEN, WrittenFile,
};
pub use number::{
    Axes, Elements, NumberFile, PredictedNumberFile, TensorFile, TrueNumberFile, VectorFile,
    all_known, finite,
};
pub use onboard::{ONBOARD, OnboardBodyFile, OnboardFile};
pub use plan::{
    ChangeFile, DrawFile, ExperimentFile, MethodFile, NumbersFile, OfFile, PLAN, PlanFile,
    ScaleFile, SettingFile, VaryFile,
};
pub use poinsot_files::HALF_WIDTH_95;
pub use prediction::{
    AgainstDurationFile, PREDICTION, PeakFile, PredictionFile, SigmasFile, WantedFile,
};
pub use read::{
    LARGEST_RESULT, ResultFile, check_files, checksum, parse_estimate, parse_result, read_estimate,
    read_result, read_truth, result_text, sha256, sha256_of,
};
pub use report_data::{
    Channel, DrawnBody, DrawnJoint, DrawnSensor, Pointer, REPORT_DATA, ReportData, Row, Segment,
    TrueNumbers, Vehicle,
};
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
///
/// ```
/// assert!(poinsot_formats::names().any(|name| name == "estimate"));
/// ```
pub fn names() -> impl Iterator<Item = &'static str> {
    FORMATS.into_iter().map(|(name, _)| name)
}

/// JSON Schema (2020-12) of a result file by name; `None` for an unknown name.
///
/// ```
/// use poinsot_formats::schema;
///
/// assert!(schema("estimate").unwrap()["properties"]["bodies"].is_object());
/// assert!(schema("novel").is_none());
/// ```
pub fn schema(name: &str) -> Option<Value> {
    let found = FORMATS.into_iter().find(|(n, _)| *n == name)?;
    Some(found.1())
}
