//! Faults of a case file, with their positions.

use std::fmt;

/// One fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaseFault {
    /// Stable code, see `poinsot explain`.
    pub code: &'static str,
    /// File as given.
    pub file: String,
    /// Line, from one; zero if the file could not be read.
    pub line: usize,
    /// Key, for example `joint_motion[2].time_s`.
    pub key: String,
    /// The value as written, shortened.
    pub value: String,
    /// What is wrong.
    pub problem: String,
    /// What to do.
    pub remedy: String,
}

impl fmt::Display for CaseFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.code, self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        write!(f, ": ")?;
        if !self.key.is_empty() {
            write!(f, "{}", self.key)?;
            if !self.value.is_empty() {
                write!(f, " = {}", self.value)?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}; {}", self.problem, self.remedy)
    }
}

/// An invalid case file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CaseError {
    /// Faults in the order of the checks, never empty.
    pub faults: Vec<CaseFault>,
    /// Whether the system (disk, permission) failed, not the file.
    pub environment: bool,
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, fault) in self.faults.iter().enumerate() {
            if k > 0 {
                writeln!(f)?;
            }
            write!(f, "{fault}")?;
        }
        Ok(())
    }
}

impl std::error::Error for CaseError {}
