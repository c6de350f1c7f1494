//! Errors of telemetry files; their codes are stable.

use poinsot_files::{StageError, escaped, rounded};
use std::fmt;
use std::path::{Path, PathBuf};

/// Position in a file: `run7.csv:1842 column 'omega_x'`, `run7.parquet row 12 column 'omega_x'`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// Path as given.
    pub path: PathBuf,
    /// Line of a CSV file (1 = header), or row of a Parquet file or of columns in memory (1 = first); 0 for the whole
    /// file.
    pub row: u64,
    /// The column as named in the file; empty for the whole row.
    pub column: String,
}

impl Place {
    pub(crate) fn file(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            ..Self::default()
        }
    }

    /// The same place in another row.
    pub(crate) fn at(&self, row: u64) -> Self {
        Self {
            row,
            ..self.clone()
        }
    }

    pub(crate) fn row(path: &Path, row: u64) -> Self {
        Self {
            path: path.to_owned(),
            row,
            column: String::new(),
        }
    }

    pub(crate) fn cell(path: &Path, row: u64, column: &str) -> Self {
        Self {
            path: path.to_owned(),
            row,
            column: column.to_owned(),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", escaped(&self.path.display().to_string()))?;
        let parquet = (self.path.extension()).is_some_and(|e| e == "parquet" || e == "pq");
        let memory = self.path.to_string_lossy().starts_with('<');
        match (self.row, parquet || memory) {
            (0, _) => {}
            (row, true) => write!(f, " row {row}")?,
            (row, false) => write!(f, ":{row}")?,
        }
        if !self.column.is_empty() {
            write!(f, " column '{}'", escaped(&self.column))?;
        }
        Ok(())
    }
}

/// Why telemetry could not be read, checked or written. One line: code, place, value, fault, remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TelemetryError {
    /// Error of the operating system.
    #[error("E0201 {place}: {what}: {source}; {}", advice(source), place = path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Attempted operation.
        what: &'static str,
        /// The error.
        source: std::io::Error,
    },
    /// The bytes are not UTF-8 text, or not a file of a known kind.
    #[error("E0202 {place}: {}", escaped(why))]
    Format {
        /// Place.
        place: Place,
        /// What is wrong and what to do.
        why: String,
    },
    /// A cell is not a finite number.
    #[error("E0203 {place}: '{value}' {}", escaped(why))]
    Number {
        /// Place.
        place: Place,
        /// The cell as read, shortened.
        value: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// A row has too many or too few fields.
    #[error("E0204 {place}: {actual} fields where the header has {expected}{hint}")]
    Ragged {
        /// Place.
        place: Place,
        /// Fields in the row.
        actual: usize,
        /// Columns in the header.
        expected: usize,
        /// A likely cause and what to do; begins with a separator.
        hint: &'static str,
    },
    /// The header names no column, or one twice, or looks like another format.
    #[error("E0205 {place}: {}", escaped(why))]
    Header {
        /// Place.
        place: Place,
        /// What is wrong and what to do.
        why: String,
    },
    /// The file ends inside its last row.
    #[error(
        "E0206 {place}: the file ends inside this row ({}); use --recover to keep the rows before it",
        escaped(why)
    )]
    Truncated {
        /// Place.
        place: Place,
        /// Evidence.
        why: String,
    },
    /// No column holds the time.
    #[error("E0207 {place}: no column 'time_s'{hint}")]
    NoTime {
        /// The file.
        place: Place,
        /// A suitable mapping; begins with a separator.
        hint: String,
    },
    /// Times are not strictly increasing, or a row has none.
    #[error("E0208 {place}: {}", escaped(why))]
    Time {
        /// Place.
        place: Place,
        /// What is wrong and what to do.
        why: String,
    },
    /// The sampling interval is not plausible.
    #[error(
        "E0209 {place}: the median step is {} s, outside 1e-5 to 1e5 s{}; map it by [telemetry.columns] time_s = {{ column = \"{column}\", unit = \"{}\" }}",
        rounded(*median_s, 4),
        if unit.is_empty() { String::new() } else { format!(": its unit is likely {unit}") },
        if unit.is_empty() { "..." } else { unit },
        column = escaped(&place.column)
    )]
    TimeUnit {
        /// The time column.
        place: Place,
        /// Median step as read, s.
        median_s: f64,
        /// The likely unit, or empty.
        unit: &'static str,
    },
    /// One channel is in two places.
    #[error(
        "E0210 channel '{channel}' is in {first} and again in {second}; leave one out, or name the sensors: '<sensor>.{}'",
        escaped(channel.rsplit('.').next().unwrap_or_default()),
        channel = escaped(channel)
    )]
    DuplicateChannel {
        /// The channel.
        channel: String,
        /// First place.
        first: Box<Place>,
        /// Second place.
        second: Box<Place>,
    },
    /// An unknown unit.
    #[error(
        "E0211 unit '{}' is not known; did you mean '{nearest}'? `poinsot units` lists all",
        escaped(unit)
    )]
    UnknownUnit {
        /// As written.
        unit: String,
        /// The nearest known unit.
        nearest: String,
    },
    /// An invalid map.
    #[error("{code} map of channel '{}': {}", escaped(channel), escaped(why))]
    Map {
        /// `E0210`, `E0211` or `E0212`: see `poinsot explain`.
        code: &'static str,
        /// The channel that is mapped.
        channel: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// A row filter without column or without matching row.
    #[error(
        "E0213 where {} = '{}': {}",
        escaped(column),
        escaped(text),
        escaped(why)
    )]
    Filter {
        /// The column.
        column: String,
        /// The required text.
        text: String,
        /// What is wrong and what to do.
        why: String,
    },
    /// A quaternion is not of unit norm, or lacks a component.
    #[error("E0214 {place}: {}", escaped(why))]
    Quaternion {
        /// Place.
        place: Place,
        /// What is wrong and what to do.
        why: String,
    },
    /// Attitude and gyro contradict the declared conventions.
    #[error(
        "E0215 attitude '{attitude}' and gyro '{gyro}' contradict the declared {declared}: residual {} rad/s, but {} rad/s with {best}; correct the map or the file",
        rounded(*declared_residual, 4),
        rounded(*best_residual, 4),
        attitude = escaped(attitude),
        gyro = escaped(gyro)
    )]
    Convention {
        /// The attitude channels, for example `q_x..q_w`.
        attitude: String,
        /// The gyro channels, for example `omega_x..z`.
        gyro: String,
        /// The declared convention.
        declared: String,
        /// RMS of attitude rate minus gyro under the declared convention, rad/s.
        declared_residual: f64,
        /// The convention that fits best.
        best: String,
        /// Its residual, rad/s.
        best_residual: f64,
    },
    /// Error of the Parquet decoder.
    #[error(
        "E0216 {place}: {}; write the file again, or convert it to CSV",
        escaped(why)
    )]
    Parquet {
        /// Place.
        place: Place,
        /// Message of the decoder.
        why: String,
    },
    /// The file has no rows.
    #[error("E0217 {place}: no data rows after the header; give a file with samples")]
    Empty {
        /// The file.
        place: Place,
    },
    /// A repair is needed, but `--strict` forbids it.
    #[error(
        "E0218 {place}: {}: --strict allows no repair; correct the file or leave out --strict",
        escaped(repair)
    )]
    Strict {
        /// Place.
        place: Place,
        /// The required repair.
        repair: String,
    },
    /// A finding of a check whose policy is to refuse.
    #[error(
        "E0220 {file}: channel '{channel}': {check}: {what}; correct it, or accept it by --policy {check}={lenient} (without --strict)",
        channel = escaped(channel),
        what = escaped(what)
    )]
    Check {
        /// File or files of the segment.
        file: String,
        /// Channel or sensor.
        channel: String,
        /// Name of the check.
        check: &'static str,
        /// What was found.
        what: String,
        /// A policy that accepts it.
        lenient: &'static str,
    },
    /// More samples than the memory limit allows.
    #[error(
        "E0221 {place}: up to {samples} samples in {channels} channels are requested, but {fit} fit into {mib} MiB of memory; use --every {every}, --time-s FROM,TO, or a larger --memory-mib"
    )]
    TooLarge {
        /// The file.
        place: Place,
        /// Upper bound of the requested samples.
        samples: u64,
        /// Samples that fit.
        fit: usize,
        /// Channels read.
        channels: usize,
        /// The limit, MiB.
        mib: usize,
        /// Row step that would fit.
        every: u64,
    },
    /// Channels that cannot be written.
    #[error("E0219 {place}: {}", escaped(why))]
    Write {
        /// The file to be written.
        place: Place,
        /// What is wrong and what to do.
        why: String,
    },
}

impl TelemetryError {
    /// Error code, for `poinsot explain`.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io { .. } => "E0201",
            Self::Format { .. } => "E0202",
            Self::Number { .. } => "E0203",
            Self::Ragged { .. } => "E0204",
            Self::Header { .. } => "E0205",
            Self::Truncated { .. } => "E0206",
            Self::NoTime { .. } => "E0207",
            Self::Time { .. } => "E0208",
            Self::TimeUnit { .. } => "E0209",
            Self::DuplicateChannel { .. } => "E0210",
            Self::UnknownUnit { .. } => "E0211",
            Self::Map { code, .. } => code,
            Self::Filter { .. } => "E0213",
            Self::Quaternion { .. } => "E0214",
            Self::Convention { .. } => "E0215",
            Self::Parquet { .. } => "E0216",
            Self::Empty { .. } => "E0217",
            Self::Strict { .. } => "E0218",
            Self::Write { .. } => "E0219",
            Self::Check { .. } => "E0220",
            Self::TooLarge { .. } => "E0221",
        }
    }

    /// Whether the environment (disk, permission) failed, not the content of the file.
    pub fn is_environment(&self) -> bool {
        matches!(self, Self::Io { source, .. } if source.kind() != std::io::ErrorKind::NotFound)
    }
}

impl From<StageError> for TelemetryError {
    fn from(error: StageError) -> Self {
        Self::Io {
            path: error.path,
            what: error.what,
            source: error.source,
        }
    }
}

/// Advice for an error of the operating system.
///
/// ```
/// use std::io::{Error, ErrorKind};
///
/// assert_eq!(poinsot_telemetry::advice(&Error::from(ErrorKind::NotFound)), "check the path");
/// ```
pub fn advice(source: &std::io::Error) -> &'static str {
    use std::io::ErrorKind as Kind;
    match source.kind() {
        Kind::NotFound => "check the path",
        Kind::PermissionDenied => "correct the permission, or name another place",
        Kind::StorageFull | Kind::QuotaExceeded => "free space, or write to another place",
        Kind::ReadOnlyFilesystem => "write to another place",
        Kind::IsADirectory => "move the folder at this path, or name another place",
        Kind::AlreadyExists | Kind::NotADirectory => {
            "move the file at this path, or name another folder"
        }
        Kind::InvalidData | Kind::UnexpectedEof => "name a whole file of the right kind",
        _ => "check the path, the disk and its permissions",
    }
}

/// A cell as shown in errors: control characters escaped, at most 40 characters.
pub(crate) fn shown(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(cell);
    let mut short: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if text.chars().count() > 40 {
        short.push_str("...");
    }
    short
}
