//! Results of the commands that list or report: methods, units, error codes, studies, written files, errors.

use poinsot_files::{Fault, FaultKind, Faults};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Name and version of `methods --json`.
pub const METHODS: &str = "poinsot.methods/1";
/// Name and version of `units --json`.
pub const UNITS: &str = "poinsot.units/1";
/// Name and version of `explain --json`.
pub const CODES: &str = "poinsot.codes/1";
/// Name and version of `study --json` without the name of a study.
pub const STUDIES: &str = "poinsot.studies/1";
/// Name and version of `study PAPER NAME --json`.
pub const FINDINGS: &str = "poinsot.findings/1";
/// Name and version of `--json` for commands that write files.
pub const WRITTEN: &str = "poinsot.written/1";
/// Name and version of an error under `--json`.
pub const ERROR: &str = "poinsot.error/1";
/// Name and version of `check --json`.
pub const DESCRIPTION: &str = "poinsot.description/1";
/// Name and version of `inspect --json`.
pub const INSPECTION: &str = "poinsot.inspection/2";

/// An answer of another floor with the name of its format.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StatedFile<T> {
    /// Name and version of the format.
    pub schema: &'static str,
    /// The answer.
    #[serde(flatten)]
    pub content: T,
}

/// The methods of `identify`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MethodsFile {
    /// "poinsot.methods/1".
    pub schema: String,
    /// Methods; the first is the default.
    pub methods: Vec<ListedMethodFile>,
}

/// A method of `identify`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ListedMethodFile {
    /// Name on the command line.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Where it was published. Absent for a method of this project.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paper: Option<&'static str>,
    /// Variants; the first is the default.
    pub variants: Vec<VariantFile>,
    /// Settings, as `--set` takes them.
    pub settings: &'static [ListedSettingFile],
}

/// A variant of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct VariantFile {
    /// Name.
    pub name: &'static str,
    /// What it does.
    pub summary: &'static str,
}

/// A setting of a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ListedSettingFile {
    /// Key.
    pub key: &'static str,
    /// What it changes.
    pub summary: &'static str,
    /// Value where none is given.
    pub default: &'static str,
}

impl ListedSettingFile {
    /// A key with its summary and default.
    pub const fn new(key: &'static str, summary: &'static str, default: &'static str) -> Self {
        Self {
            key,
            summary,
            default,
        }
    }
}

/// The units that a telemetry map may name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnitsFile {
    /// "poinsot.units/1".
    pub schema: String,
    /// All units.
    pub units: Vec<UnitFile>,
}

/// A unit. Its value in SI is value * factor / divisor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnitFile {
    /// As the map names it.
    pub symbol: String,
    /// What it measures.
    pub dimension: String,
    /// Multiplies the value.
    pub factor: f64,
    /// Divides the product.
    pub divisor: f64,
    /// Unit of the result.
    pub si: String,
}

/// Error codes with cause and remedy.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CodesFile {
    /// "poinsot.codes/1".
    pub schema: String,
    /// Codes, ascending.
    pub codes: Vec<CodeFile>,
}

/// An error code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CodeFile {
    /// Code.
    pub code: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What usually causes it.
    pub cause: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

impl fmt::Display for CodeFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.code, self.meaning)?;
        writeln!(f, "  usual cause: {}", self.cause)?;
        writeln!(f, "  what to do:  {}", self.remedy)
    }
}

/// Papers with their studies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudiesFile {
    /// "poinsot.studies/1".
    pub schema: String,
    /// Papers.
    pub papers: Vec<PaperFile>,
}

/// A paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PaperFile {
    /// Name on the command line.
    pub paper: String,
    /// Where it was published.
    pub citation: String,
    /// Its studies.
    pub studies: Vec<StudyFile>,
}

/// A study of a paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyFile {
    /// Name on the command line.
    pub name: String,
    /// What it computes.
    pub summary: String,
    /// Whether it takes seconds, not minutes.
    pub quick: bool,
}

/// What studies found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FindingsFile {
    /// "poinsot.findings/1".
    pub schema: String,
    /// One entry per study.
    pub findings: Vec<StudyFindingsFile>,
}

/// What a study found: numbers with all their digits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StudyFindingsFile {
    /// Name of the paper.
    pub paper: String,
    /// Name of the study.
    pub study: String,
    /// What it computes.
    pub summary: String,
    /// Tables.
    pub tables: Vec<FoundTableFile>,
    /// Numbers compared with the paper.
    pub statements: Vec<StatementFile>,
}

/// A table of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FoundTableFile {
    /// Name.
    pub name: String,
    /// Title.
    pub title: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<FoundCellFile>>,
}

/// A cell of a table; null where there is no number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum FoundCellFile {
    /// Text.
    Word(String),
    /// A number.
    Number(Option<f64>),
    /// Two numbers.
    Pair(Option<f64>, Option<f64>),
}

/// A statement of a paper with the number found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StatementFile {
    /// What the paper states.
    pub in_the_paper: String,
    /// The number found.
    pub number: String,
}

/// Files that were written, or shards that were run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WrittenFile {
    /// "poinsot.written/1".
    pub schema: String,
    /// Paths.
    pub written: Vec<String>,
    /// Shards of a campaign. Absent for other verbs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shards: Option<u64>,
    /// Questions of the model that `init` wrote. Absent for other verbs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub questions: Option<Vec<QuestionFile>>,
}

/// A question in a model file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct QuestionFile {
    /// The lines that have it, from 1.
    pub lines: Vec<usize>,
    /// The question.
    pub text: String,
}

/// Why there is no answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ErrorFile {
    /// "poinsot.error/1".
    pub schema: String,
    /// Exit code.
    pub exit_code: u8,
    /// Faults, in the order of their places.
    pub errors: Vec<FaultFile>,
}

/// One thing that is wrong.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaultFile {
    /// Code, see `poinsot explain`.
    pub code: String,
    /// Where: file with line and column, key, or option. Absent where it has no place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// The value as read. Absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// What to do. Absent if the problem contains it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub advice: Option<String>,
}

impl WrittenFile {
    /// Files that were written.
    pub fn of<P: AsRef<std::path::Path>>(paths: &[P]) -> Self {
        let paths = paths.iter().map(|p| p.as_ref().display().to_string());
        Self {
            schema: WRITTEN.to_owned(),
            written: paths.collect(),
            ..Self::default()
        }
    }
}

impl ErrorFile {
    /// All faults, with the exit code that they give: 2 for an input, 3 for the system, 4 for the program.
    pub fn of(faults: &Faults) -> Self {
        Self {
            schema: ERROR.to_owned(),
            exit_code: match faults.kind() {
                FaultKind::Input => 2,
                FaultKind::System => 3,
                FaultKind::Internal => 4,
            },
            errors: faults.list.iter().map(FaultFile::from).collect(),
        }
    }
}

impl From<&Fault> for FaultFile {
    fn from(fault: &Fault) -> Self {
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Self {
            code: fault.code.to_owned(),
            place: some(&fault.place.to_string()),
            value: some(&fault.value),
            problem: fault.problem.clone(),
            advice: some(&fault.advice),
        }
    }
}
