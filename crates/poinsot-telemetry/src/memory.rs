//! Columns in memory, treated as a file: names, units, checks and limits.

use crate::ReadOptions;
use crate::bytes::Opened;
use crate::columns::Columns;
use crate::content_hash::hex;
use crate::error::no_rows;
use crate::intake::Intake;
use crate::number::{Cell, RawCell};
use crate::plan::{self, Plan};
use crate::size::Rows;
use poinsot_files::{Faults, Place};
use sha2::{Digest, Sha256};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Values of one column, one per row.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers in the unit of the column; NaN for no sample.
    Numbers(Vec<f64>),
    /// Times in nanoseconds, which a double cannot represent.
    Nanoseconds(Vec<i64>),
}

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Nanoseconds(values) => values.len(),
        }
    }

    /// Whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn cell(&self, row: usize) -> RawCell<'_> {
        let cell = match self {
            Self::Numbers(values) => values.get(row).map(|x| RawCell::Number(*x)),
            Self::Nanoseconds(values) => values.get(row).map(|n| RawCell::Parts(*n, 1_000_000_000)),
        };
        cell.unwrap_or(RawCell::Empty)
    }
}

/// Named columns, equivalent to a file with one header row.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MemoryColumns {
    /// Name in messages, for example `<arrays>`.
    pub name: String,
    /// Name and values of each column.
    pub columns: Vec<(String, Values)>,
}

/// A stream copied to a file, or bytes.
#[derive(Debug)]
pub struct Spooled {
    name: PathBuf,
    pub(crate) opened: Opened,
}

impl PartialEq for Spooled {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

/// One telemetry source of a segment.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// A file.
    File(PathBuf),
    /// Columns in memory.
    Memory(Arc<MemoryColumns>),
    /// Content of a file in memory, or a stream.
    Stream(Arc<Spooled>),
}

impl Part {
    /// Reads a stream of CSV (compressed or not) or Parquet to its end. `name` is used in messages and for file
    /// patterns of a map.
    ///
    /// # Errors
    /// The stream cannot be read, or the disk is full.
    pub fn stream(name: &str, stream: &mut dyn io::Read) -> io::Result<Self> {
        Ok(Self::Stream(Arc::new(Spooled {
            name: name.into(),
            opened: poinsot_files::spooled(stream).and_then(Opened::stream)?,
        })))
    }

    /// The content of a file as [`Self::stream`] reads it, kept in memory: no disk is needed.
    pub fn bytes(name: &str, bytes: Vec<u8>) -> Self {
        Self::Stream(Arc::new(Spooled {
            name: name.into(),
            opened: Opened::bytes(bytes),
        }))
    }

    /// Path, or name in messages.
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Memory(columns) => Path::new(&columns.name),
            Self::Stream(stream) => &stream.name,
        }
    }
}

/// Reads the planned columns.
///
/// # Errors
/// A column differs in length from the first, a time is invalid, or the memory limit is exceeded.
pub(crate) fn read(
    memory: &MemoryColumns,
    options: &ReadOptions,
) -> Result<(Plan, Columns, String), Faults> {
    let path = Path::new(&memory.name);
    let rows = check_lengths(path, memory)?;
    if rows == 0 {
        let place = Place::file(path);
        return Err(no_rows(place));
    }
    let header: Vec<String> = memory.columns.iter().map(|c| c.0.clone()).collect();
    let plan = plan::build(path, &header, None, options)?;
    let declared = Rows::Declared(rows as u64);
    let mut intake = Intake::new(path, &plan, options);
    intake.check_ahead(declared)?;
    intake.columns.rows_read = rows;
    let mut kept = Vec::new();
    for row in 0..rows {
        let column = |index: usize| memory.columns.get(index);
        let cell = |index| column(index).map_or(RawCell::Empty, |c| c.1.cell(row));
        if intake.keeps(row as u64 + 1, cell)? {
            kept.push(row);
        }
    }
    for (k, channel) in plan.channels.iter().enumerate() {
        let Some((_, values)) = memory.columns.get(channel.index) else {
            continue;
        };
        let Values::Numbers(values) = values else {
            let place = Place::cell(path, 0, &channel.column);
            let problem = "whole nanoseconds are a time, and this column is none";
            return Err(Faults::one("E0202", place, problem, "give numbers"));
        };
        for row in &kept {
            let cell = match values.get(*row) {
                Some(x) if !x.is_nan() && intake.columns.reads(k, channel.choice) => {
                    channel.transform.number(Cell::Number(*x))
                }
                _ => Cell::Empty,
            };
            intake.columns.push(k, *row as u64 + 1, cell);
        }
    }
    intake.make_room(declared, None)?;
    let columns = intake.finished()?;
    Ok((plan, columns, sha256_of_columns(memory)))
}

/// Number of rows, equal for all columns.
fn check_lengths(path: &Path, memory: &MemoryColumns) -> Result<usize, Faults> {
    let rows = memory.columns.first().map_or(0, |c| c.1.len());
    let first = memory.columns.first().map_or("", |c| c.0.as_str());
    match memory.columns.iter().find(|c| c.1.len() != rows) {
        None => Ok(rows),
        Some((name, values)) => Err(Faults::one(
            "E0202",
            Place::cell(path, 0, name),
            format!("{} values, and column '{first}' has {rows}", values.len()),
            "give every column one value per time, NaN where there is no sample",
        )),
    }
}

/// SHA-256 of all column names and values, little-endian.
fn sha256_of_columns(memory: &MemoryColumns) -> String {
    let mut hash = Sha256::new();
    for (name, values) in &memory.columns {
        hash.update(name.as_bytes());
        hash.update([0]);
        match values {
            Values::Numbers(numbers) => numbers.iter().for_each(|x| hash.update(x.to_le_bytes())),
            Values::Nanoseconds(times) => times.iter().for_each(|t| hash.update(t.to_le_bytes())),
        }
    }
    hex(hash)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{read, read_parts};

    fn memory(columns: Vec<(&str, Values)>) -> Part {
        let columns = columns.into_iter().map(|(n, v)| (n.to_owned(), v));
        Part::Memory(Arc::new(MemoryColumns {
            name: "<arrays>".to_owned(),
            columns: columns.collect(),
        }))
    }

    fn numbers(values: &[f64]) -> Values {
        Values::Numbers(values.to_vec())
    }

    #[test]
    fn exact_memory_is_the_table_of_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rates.csv");
        let text = "time_s,omega_x,omega_y\n0.1,0.3,1\n0.2,,2\n0.3,0.1,3\n";
        std::fs::write(&path, text).unwrap();
        let options = ReadOptions::default();
        let file = read(&[&path], &options).unwrap();
        let part = memory(vec![
            ("time_s", numbers(&[0.1, 0.2, 0.3])),
            ("omega_x", numbers(&[0.3, f64::NAN, 0.1])),
            ("omega_y", numbers(&[1.0, 2.0, 3.0])),
        ]);
        let table = read_parts(&[part], &options).unwrap();
        assert_eq!(table.channels, file.channels);
        assert_eq!(table.origin, file.origin);
        assert_eq!(table.sources[0].rows, 3);
        assert_eq!(table.sources[0].sha256.len(), 64);
    }

    #[test]
    fn exact_nanoseconds_lose_nothing() {
        let start = 1_773_512_340_100_000_000_i64;
        let part = memory(vec![
            (
                "time_s",
                Values::Nanoseconds(vec![start, start + 1, start + 1_000_000_001]),
            ),
            ("omega_x", numbers(&[1.0, 2.0, 3.0])),
        ]);
        let table = read_parts(&[part], &ReadOptions::default()).unwrap();
        let times = &table.channels[0].time_s;
        assert_eq!(times.as_ref(), [0.0, 1.0e-9, 1.000_000_001]);
    }

    #[test]
    fn unit_columns_of_different_length_are_refused() {
        let part = memory(vec![
            ("time_s", numbers(&[0.0, 1.0])),
            ("omega_x", numbers(&[0.0])),
        ]);
        let error = read_parts(&[part], &ReadOptions::default()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "E0202 <arrays> column 'omega_x': 1 values, and column 'time_s' has 2; give every column one value per time, NaN where there is no sample"
        );
    }
}
