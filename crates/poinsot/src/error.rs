//! Errors of the commands.

mod bind;
mod case;
mod simulate;
mod validate;

pub use bind::BindError;
pub use case::{CaseError, CaseFault};
pub use simulate::SimulateError;
pub use validate::ValidateError;

use poinsot_files::{InputError, StageError};
use poinsot_identify::ProblemError;
use poinsot_model::ModelError;
use poinsot_papers::MethodError;
use poinsot_telemetry::{TelemetryError, advice};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Origin of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// Arguments, model or telemetry.
    Input,
    /// Operating system: disk, permission, a limit.
    System,
    /// The program itself.
    Internal,
}

impl Error {
    /// An argument of the command line: option, value as read, what is wrong and what to do.
    pub fn usage(option: &'static str, value: impl Display, why: impl Into<String>) -> Self {
        Self::Usage {
            option,
            value: value.to_string(),
            why: why.into(),
        }
    }
}

/// Error of a command.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The model file.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A telemetry file.
    #[error(transparent)]
    Telemetry(#[from] TelemetryError),
    /// Model and telemetry do not match.
    #[error(transparent)]
    Bind(#[from] BindError),
    /// A simulation.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The plan of a campaign, or a result file that contradicts itself.
    #[error("{0}")]
    File(CaseError),
    /// The shards of a campaign.
    #[error("{code} {}: {why}", path.display())]
    Shards {
        /// Code.
        code: &'static str,
        /// File or folder.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// Invalid arguments, model or telemetry for an estimator.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A published method.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// A validation.
    #[error(transparent)]
    Validate(#[from] ValidateError),
    /// An argument of the command line.
    #[error("E0001 {option} '{value}': {why}")]
    Usage {
        /// Option.
        option: &'static str,
        /// Value as read.
        value: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// Standard output.
    #[error("E0003 standard output: {source}; free space, or write to another place")]
    Output {
        /// Error of the system.
        source: std::io::Error,
    },
    /// A bug.
    #[error(
        "E0009 internal error: {what}: this is a bug in poinsot; please report it with the command and, if possible, the input"
    )]
    Internal {
        /// Message and source location of the panic.
        what: String,
    },
    /// The files of a report.
    #[error("E0601 {}: no report or export can be made of this: {why}", path.display())]
    Report {
        /// File or folder.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// The operating system.
    #[error("E0002 {}: {what}: {source}; {}", path.display(), advice(source))]
    Io {
        /// Path.
        path: PathBuf,
        /// Attempted operation.
        what: &'static str,
        /// Error of the system.
        source: std::io::Error,
    },
    /// No thread can be started.
    #[error(
        "E0005 the system cannot start a thread: {why}; raise the limit of processes or memory (ulimit -u, ulimit -v), or end other programs"
    )]
    Threads {
        /// Error of the system.
        why: String,
    },
    /// Out of memory.
    #[error(
        "E0006 out of memory; raise the limit (ulimit -v), take fewer rows by --every, or end other programs"
    )]
    Memory,
    /// Files were partly put in place, and the earlier ones cannot be restored.
    #[error("E0004 {}: only a part of the answer is in place: {source}; move the earlier files back from {}", path.display(), kept.display())]
    Kept {
        /// The file that could not be put in place.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
        /// Folder with the earlier files.
        kept: PathBuf,
    },
}

impl From<StageError> for Error {
    fn from(error: StageError) -> Self {
        let StageError {
            path,
            what,
            source,
            kept,
        } = error;
        match kept {
            Some(kept) => Self::Kept { path, source, kept },
            None => Self::Io { path, what, source },
        }
    }
}

impl Error {
    /// Origin of the error.
    pub fn kind(&self) -> ErrorKind {
        let system = match self {
            Self::Internal { .. } => return ErrorKind::Internal,
            Self::Io { .. }
            | Self::Kept { .. }
            | Self::Threads { .. }
            | Self::Memory
            | Self::Output { .. } => true,
            Self::Telemetry(error) => error.is_environment(),
            Self::Model(error) => error.environment,
            Self::Simulate(error) => error.is_environment(),
            Self::File(error) => error.environment,
            _ => false,
        };
        match system {
            true => ErrorKind::System,
            false => ErrorKind::Input,
        }
    }
}

/// An input file of `identify` that cannot be read.
pub(crate) fn unreadable(path: &Path, error: InputError) -> Error {
    match error {
        InputError::System(source) => Error::Io {
            path: path.to_owned(),
            what: "cannot be read",
            source,
        },
        InputError::Missing(_) => Error::Report {
            path: path.to_owned(),
            why: "it is not there; write it by `poinsot identify --out DIR`".to_owned(),
        },
        other => Error::Report {
            path: path.to_owned(),
            why: format!("{other}; {}", other.remedy()),
        },
    }
}
