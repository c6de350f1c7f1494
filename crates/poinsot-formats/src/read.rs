//! The reader of `estimate.json`.

use crate::estimate::{ESTIMATE, EstimateFile};
use poinsot_files::InputError;
use std::path::{Path, PathBuf};

/// A result file that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// There is no such file.
    #[error("there is no such file; give the folder of identify --out")]
    Missing {
        /// Path.
        path: PathBuf,
    },
    /// The system refuses it.
    #[error("{source}")]
    Io {
        /// Path.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is another format.
    #[error("{}; give the folder of identify --out", schema_found(found))]
    Schema {
        /// Path.
        path: PathBuf,
        /// Schema found; empty without one.
        found: String,
    },
    /// It has another shape.
    #[error("{why}; give an estimate.json as identify writes it")]
    Shape {
        /// Path.
        path: PathBuf,
        /// What is wrong, with line and column.
        why: String,
    },
}

fn schema_found(found: &str) -> String {
    match found {
        "" => "it has no key \"schema\"".to_owned(),
        found => format!("its schema is \"{found}\", not {ESTIMATE}"),
    }
}
/// Largest file that is read, bytes.
pub const LARGEST_RESULT: u64 = 256 << 20;

/// Reads `estimate.json`, or the folder that holds it; gives the path of the file too.
///
/// # Errors
/// The file is missing, unreadable, of another format or damaged.
pub fn read_estimate(path: &Path) -> Result<(PathBuf, EstimateFile), FormatError> {
    let path = match path.is_dir() {
        true => path.join("estimate.json"),
        false => path.to_owned(),
    };
    let bytes = match poinsot_files::read(&path, LARGEST_RESULT) {
        Ok(bytes) => bytes,
        Err(InputError::Missing(_)) => return Err(FormatError::Missing { path }),
        Err(InputError::System(source)) => return Err(FormatError::Io { path, source }),
        Err(other) => {
            let why = other.to_string();
            return Err(FormatError::Shape { path, why });
        }
    };
    let shape = |path: &Path, e: serde_json::Error| FormatError::Shape {
        path: path.to_owned(),
        why: e.to_string(),
    };
    let value: serde_json::Value = serde_json::from_slice(&bytes).map_err(|e| shape(&path, e))?;
    let found = value.get("schema").and_then(|s| s.as_str()).unwrap_or("");
    if found != ESTIMATE {
        let found = found.to_owned();
        return Err(FormatError::Schema { path, found });
    }
    // From the text once more: only then does an error have line and column.
    let file = serde_json::from_slice(&bytes).map_err(|e| shape(&path, e))?;
    Ok((path, file))
}
