//! Channels of telemetry with unit, frame, sensor and time; read from CSV and Parquet.
//!
//! [`read`] reads the files of one segment into a [`Table`]: values in SI, times strictly increasing, no entry for a
//! missing sample. [`write()`] writes channels. [`inspect`] summarises a table and tests attitude and gyro against the
//! declared conventions.
//!
//! | subject | item |
//! |---|---|
//! | files and columns in memory | [`read`], [`read_parts`], [`ReadOptions`], [`Part`], [`write()`] |
//! | what is read | [`Table`], [`Channel`], [`Source`], [`poinsot_files::Faults`] |
//! | columns with other names and units | [`TelemetryMap`], [`recognise()`], [`suggestions`], [`parse_unit`], [`units`], [`classify`] |
//! | checks | [`checks`], [`inspect`], [`convention_tests`], [`check_conventions`], [`noise_level`] |
//! | other times | [`resample`], [`resample_attitude`], [`differentiate`] |
//! | other axes | [`mount`], [`Mounting`] |
//!
//! # Example
//! Two joint angles in memory, with a sample missing: every channel has its own times.
//!
//! ```
//! use poinsot_telemetry::{MemoryColumns, Part, ReadOptions, Values, read_parts, resample};
//! use std::sync::Arc;
//!
//! let numbers = |name: &str, values: &[f64]| (name.to_owned(), Values::Numbers(values.to_vec()));
//! let columns = vec![
//!     numbers("time_s", &[0.0, 0.1, 0.2, 0.3]),
//!     numbers("joint1_rad", &[0.0, 0.2, 0.4, 0.6]),
//!     numbers("joint2_rad", &[1.0, f64::NAN, 3.0, 4.0]),
//! ];
//! let part = Part::Memory(Arc::new(MemoryColumns { name: "<arrays>".to_owned(), columns }));
//! let table = read_parts(&[part], &ReadOptions::default())?;
//!
//! let (first, second) = (&table.channels[0], &table.channels[1]);
//! assert_eq!((first.unit.as_str(), first.values.len(), second.values.len()), ("rad", 4, 3));
//! // Between samples a channel is interpolated; beyond its end it has no value.
//! let [inside, beyond] = resample(first, &[0.15, 0.4], None)[..] else { unreachable!() };
//! assert!((inside.unwrap() - 0.3).abs() < 1.0e-12 && beyond.is_none());
//! # Ok::<(), poinsot_files::Faults>(())
//! ```
//!
//! # Files
//! - `read.rs`: the flow of reading. `options.rs`, `selection.rs`: options and row selection.
//! - `csv_reader.rs`, `parquet_reader.rs`, `memory.rs`: files, columns in memory, and streams. `csv_rows.rs`: rows and
//!   cells of a text.
//! - `map.rs`, `map_faults.rs`: the `[telemetry]` table. `plan.rs`: which column becomes which channel.
//! - `clock.rs`, `instant.rs`: exact dates and counts.
//! - `conversion.rs`, `derive.rs`, `mounting.rs`, `orbital.rs`: conversion to SI, body axes and inertial axes.
//! - `recognise/`: what columns with other names measure. `suggest.rs`: lines of a map for them.
//! - `channel_name.rs`: standard names. `unit.rs`: units and factors.
//! - `time_base.rs`, `quaternion.rs`: checks.
//! - `conventions.rs`, `conventions/`: what two channels measure alike, compared in every reading (`reading.rs`,
//!   `pairs.rs`), and the lines of a map that put it right (`change.rs`).
//! - `resample.rs`, `differentiate.rs`: never across a gap.
//! - `noise.rs`: noise of a channel from its own samples.
//! - `size.rs`: number of rows before reading.
//! - `intake.rs`: which rows are kept, for every reader.
//! - `parquet_column.rs`: what a column holds. `parquet_bytes.rs`, `parquet_pages.rs`: guards of the decoder.
//! - `inspect.rs`, `inspect_parts.rs`: inspection, also of files larger than memory.
//! - `writer.rs`, `error.rs` (codes E02xx).

mod assemble;
mod bytes;
mod channel;
mod channel_name;
pub mod checks;
mod clock;
mod columns;
mod content_hash;
mod conventions;
mod conversion;
mod csv_reader;
mod csv_rows;
mod cursor;
mod derive;
mod differentiate;
mod error;
mod inspect;
mod inspect_parts;
mod inspect_text;
mod instant;
mod intake;
mod map;
mod map_faults;
mod median;
mod memory;
mod mounting;
mod noise;
mod number;
mod options;
mod orbital;
mod packing;
#[cfg(feature = "parquet")]
mod parquet_bytes;
#[cfg(feature = "parquet")]
mod parquet_column;
#[cfg(feature = "parquet")]
mod parquet_pages;
#[cfg_attr(not(feature = "parquet"), path = "parquet_absent.rs")]
mod parquet_reader;
#[cfg(feature = "parquet")]
mod parquet_seal;
#[cfg(feature = "parquet")]
mod parquet_writer;
mod plan;
mod quaternion;
mod read;
mod recognise;
mod resample;
mod rotation;
mod row_columns;
mod rows;
mod selection;
mod size;
mod suggest;
mod time_base;
mod unit;
mod writer;

pub use channel::{Channel, Source, Table};
pub use channel_name::{ChannelName, classify, full_name, vector_channels};
pub use conventions::reading::Hypothesis;
pub use conventions::{
    Change, ConventionTest, Line, Repair, UNIT_FACTORS, Verdict, check_conventions,
    convention_tests, unit_mistake,
};
pub use differentiate::{differentiate, integral};
pub use error::Refused;
pub use inspect::{ChannelSummary, Inspection, inspect};
pub use inspect_parts::inspect_files;
pub use instant::{Origin, Scale};
pub use map::{
    AttitudeColumn, AttitudeMap, ColumnMap, DecimalSign, FileMap, Layout, NamedMap, OrbitFrame,
    OrbitMap, OrbitalMap, Overlap, TelemetryMap, TimeFormat, TimeMap,
};
pub use map_faults::{MapFault, map_faults};
pub use median::median_step;
pub use memory::{MemoryColumns, Part, Spooled, Values};
pub use mounting::{Mounting, mount};
pub use noise::{NoiseLevel, common_step, noise_level};
pub use options::{Encoding, MEMORY_MIB, ReadOptions};
pub use orbital::Turned;
pub use read::{read, read_parts};
pub use recognise::{Found, FoundAttitude, Kind, Recognition, recognise};
pub use resample::{GAP, resample, resample_attitude, resample_hermite};
pub use rotation::{Axes, Order, Sense};
pub use row_columns::{RowCells, RowColumn};
pub use rows::{ROWS_EXTENSION, read_rows, write_rows};
pub use suggest::suggestions;
pub use unit::{Dimension, STANDARD_GRAVITY, Unit, parse_unit, units};
pub use writer::{GROUP, RowWriter, write, write_pieces};
