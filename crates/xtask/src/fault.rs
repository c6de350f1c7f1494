//! Why a command ends with an exit code other than 0.

use std::fmt::Display;
use std::path::Path;

/// Why a command ends early, with its exit code.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The command was used wrongly, or lacks what it needs: exit code 2.
    #[error("{0}")]
    Use(String),
    /// A check failed: exit code 1.
    #[error("{0}")]
    Failed(String),
    /// A program ended with this exit code and has said why.
    #[error("exit code {0}")]
    Ended(u8),
}

impl Fault {
    /// A file or folder that cannot be read or written.
    pub fn file(path: &Path, why: impl Display) -> Self {
        Self::Failed(format!("{}: {why}", path.display()))
    }

    /// Exit code of the process.
    pub fn code(&self) -> u8 {
        match self {
            Self::Use(_) => 2,
            Self::Failed(_) => 1,
            Self::Ended(code) => *code,
        }
    }

    /// What the process prints on standard error.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Use(text) | Self::Failed(text) => Some(text),
            Self::Ended(_) => None,
        }
    }
}
