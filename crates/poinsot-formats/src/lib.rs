//! Result files as types: every file has one type, which writes it, reads it and gives its JSON Schema.
//!
//! ```
//! use poinsot_formats::{NumberFile, Elements};
//!
//! let mass = NumberFile { value: Some(312.4), sigma: Some(0.2), nominal: 310.0, source: Some("data".into()) };
//! assert!(!mass.is_known());
//! let tensor = Elements { xx: 1.0, yy: 2.0, zz: 2.5, xy: 0.1, xz: 0.0, yz: -0.1 };
//! assert_eq!(tensor.named().map(|(name, _)| name), ["xx", "yy", "zz", "xy", "xz", "yz"]);
//! ```
#![allow(non_snake_case)]

mod campaign;
mod comparison;
mod design;
mod diagnostics;
mod estimate;
mod number;
mod onboard;
mod plan;
mod read;

pub use campaign::{
    BandedFile, CAMPAIGN, CampaignFile, CellFile, MethodResultFile, NumberResultFile, PairFile,
    PairNumberFile,
};
pub use comparison::{
    COMPARISON, ComparedAnswerFile, ComparedNumberFile, ComparisonFile, JointTestFile,
};
pub use design::{
    DESIGN, DesignFile, DesignVerificationFile, DesignedNumberFile, LimitUseFile, RelaxedFile,
    SearchFile, VerifiedNumberFile,
};
pub use diagnostics::{
    ChannelFile, DiagnosticsFile, DriftFile, FindingFile, LagFile, LineFile, SuspectFile, ValueFile,
};
pub use estimate::{
    BarycentricFile, BodyFile, CheckFile, CovarianceFile, DeterminedFile, ESTIMATE, EpochFile,
    EstimateFile, IdentifiabilityFile, InputFile, MethodReportFile, MomentumFile, PrincipalFile,
    ReportedNumberFile, SegmentFitFile, SensorFitFile, SystemFile, UndeterminedFile,
};
pub use number::{Elements, NumberFile, TensorFile, VectorFile, finite};
pub use onboard::{ONBOARD, OnboardBodyFile, OnboardFile};
pub use plan::{
    ChangeFile, DrawFile, ExperimentFile, MethodFile, NumbersFile, OfFile, PLAN, PlanFile,
    REPLICATES, SamplingFile, SamplingKind, ScaleFile, SettingFile, VaryFile,
};
pub use read::{FormatError, LARGEST_RESULT, read_estimate};

use schemars::schema_for;
use serde_json::Value;

/// Names of the formats that [`schema`] knows.
pub const NAMES: [&str; 6] = [
    "estimate",
    "comparison",
    "design",
    "onboard",
    "plan",
    "campaign",
];

/// JSON Schema (2020-12) of a result file by name; `None` for an unknown name.
pub fn schema(name: &str) -> Option<Value> {
    match name {
        "estimate" => Some(schema_for!(EstimateFile).to_value()),
        "comparison" => Some(schema_for!(ComparisonFile).to_value()),
        "design" => Some(schema_for!(DesignFile).to_value()),
        "onboard" => Some(schema_for!(OnboardFile).to_value()),
        "plan" => Some(schema_for!(PlanFile).to_value()),
        "campaign" => Some(schema_for!(CampaignFile).to_value()),
        _ => None,
    }
}
