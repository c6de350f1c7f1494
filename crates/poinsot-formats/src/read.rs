//! Reader of result files, from disk or from memory.

use crate::estimate::{ESTIMATE, EstimateFile};
use crate::truth::{TRUTH, TruthFile};
use crate::upgrade;
use poinsot_files::InputError;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A result file that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// File not found.
    #[error("there is no such file; give the folder of identify --out")]
    Missing {
        /// Path.
        path: PathBuf,
    },
    /// Error of the operating system.
    #[error("{source}")]
    Io {
        /// Path.
        path: PathBuf,
        /// The error.
        source: std::io::Error,
    },
    /// The file has another format.
    #[error("{}; give the folder of identify --out", schema_found(found))]
    Schema {
        /// Path.
        path: PathBuf,
        /// Schema found; empty if absent.
        found: String,
    },
    /// The file does not match the structure of its format.
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
/// Size limit of a file, bytes.
pub const LARGEST_RESULT: u64 = 256 << 20;

/// A format and its previous version.
trait Versioned: DeserializeOwned {
    const SCHEMA: &'static str;
    const EARLIER: &'static str;
    fn upgrade(file: &mut Value);
}

impl Versioned for EstimateFile {
    const SCHEMA: &'static str = ESTIMATE;
    const EARLIER: &'static str = "poinsot.estimate/1";
    fn upgrade(file: &mut Value) {
        upgrade::estimate_1(file);
    }
}

impl Versioned for TruthFile {
    const SCHEMA: &'static str = TRUTH;
    const EARLIER: &'static str = "poinsot.truth/1";
    fn upgrade(file: &mut Value) {
        upgrade::truth_1(file);
    }
}

/// Reads `estimate.json`, or the folder that holds it; returns also the path of the file.
///
/// # Errors
/// The file is missing, unreadable, of another format or damaged.
///
/// ```
/// use poinsot_formats::read_estimate;
///
/// // The folder of `identify --out`, or the file in it.
/// let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/doc");
/// let (path, estimate) = read_estimate(folder.as_ref())?;
/// assert!(path.ends_with("estimate.json"));
/// let I_zz = &estimate.bodies["bus"].inertia_kg_m2.zz;
/// let (value, sigma) = (I_zz.value.unwrap(), I_zz.sigma.unwrap());
/// // The true value is 2.5 kg m2.
/// assert!((value - 2.5).abs() < 3.0 * sigma);
/// # Ok::<(), poinsot_formats::FormatError>(())
/// ```
pub fn read_estimate(path: &Path) -> Result<(PathBuf, EstimateFile), FormatError> {
    let path = match path.is_dir() {
        true => path.join("estimate.json"),
        false => path.to_owned(),
    };
    let file = read(&path)?;
    Ok((path, file))
}

/// Reads the bytes of an `estimate.json`; errors name it `path`.
///
/// # Errors
/// The file has another format or is damaged.
///
/// ```
/// use poinsot_formats::parse_estimate;
///
/// let bytes = include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/estimate.json"));
/// let estimate = parse_estimate("estimate.json".as_ref(), bytes)?;
/// assert_eq!(estimate.status, "converged");
/// assert!(parse_estimate("estimate.json".as_ref(), b"{}").is_err());
/// # Ok::<(), poinsot_formats::FormatError>(())
/// ```
pub fn parse_estimate(path: &Path, bytes: &[u8]) -> Result<EstimateFile, FormatError> {
    parse(path, bytes)
}

/// Reads a `truth.json`.
///
/// # Errors
/// The file is missing, unreadable, of another format or damaged.
///
/// ```
/// use poinsot_formats::read_truth;
///
/// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/ma2008/traj1/truth.json");
/// let truth = read_truth(path.as_ref())?;
/// assert_eq!(truth.bodies["base"].mass.mass_kg.value, 1000.0);
/// # Ok::<(), poinsot_formats::FormatError>(())
/// ```
pub fn read_truth(path: &Path) -> Result<TruthFile, FormatError> {
    read(path)
}

fn read<T: Versioned>(path: &Path) -> Result<T, FormatError> {
    match poinsot_files::read(path, LARGEST_RESULT) {
        Ok(bytes) => parse(path, &bytes),
        Err(InputError::Missing(_)) => Err(FormatError::Missing {
            path: path.to_owned(),
        }),
        Err(InputError::System(source)) => Err(FormatError::Io {
            path: path.to_owned(),
            source,
        }),
        Err(other) => Err(FormatError::Shape {
            path: path.to_owned(),
            why: other.to_string(),
        }),
    }
}

fn parse<T: Versioned>(path: &Path, bytes: &[u8]) -> Result<T, FormatError> {
    let shape = |e: serde_json::Error| FormatError::Shape {
        path: path.to_owned(),
        why: e.to_string(),
    };
    let mut value: Value = serde_json::from_slice(bytes).map_err(shape)?;
    let found = value.get("schema").and_then(Value::as_str).unwrap_or("");
    if found == T::SCHEMA {
        // Parse the text again: only then does the error have line and column.
        return serde_json::from_slice(bytes).map_err(shape);
    }
    if found != T::EARLIER {
        return Err(FormatError::Schema {
            path: path.to_owned(),
            found: found.to_owned(),
        });
    }
    T::upgrade(&mut value);
    if let Some(schema) = value.get_mut("schema") {
        *schema = T::SCHEMA.into();
    }
    serde_json::from_value(value).map_err(shape)
}
