//! Channels of telemetry with unit, frame, sensor and time; read from CSV and Parquet.
//!
//! [`read`] reads the files of one segment into a [`Table`]: values in SI, times strictly increasing, no entry for a
//! missing sample. [`write()`] writes channels. [`inspect`] summarises a table and tests attitude and gyro against the
//! declared conventions.

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
mod digits;
mod error;
mod hypothesis;
mod inspect;
mod inspect_parts;
mod inspect_text;
mod instant;
mod map;
mod map_faults;
mod median;
mod memory;
mod mounting;
mod noise;
mod number;
mod options;
mod packing;
#[cfg(feature = "parquet")]
mod parquet_bytes;
#[cfg(feature = "parquet")]
mod parquet_column;
#[cfg(feature = "parquet")]
mod parquet_dictionaries;
#[cfg(feature = "parquet")]
mod parquet_pages;
#[cfg_attr(not(feature = "parquet"), path = "parquet_absent.rs")]
mod parquet_reader;
#[cfg(feature = "parquet")]
mod parquet_writer;
mod plan;
mod quaternion;
mod rate_pairs;
mod read;
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
pub use channel_name::{ChannelName, Quantity, classify, full_name, vector_channels};
pub use conventions::{
    ConventionTest, Verdict, check_conventions, convention_tests, test_conventions, test_sensors,
};
pub use differentiate::differentiate;
pub use digits::{as_read, rounded};
pub use error::{Place, TelemetryError, advice};
pub use hypothesis::{Axes, GyroUnit, Hypothesis, Order, Sense};
pub use inspect::{ChannelSummary, FileSummary, Inspection, inspect};
pub use inspect_parts::inspect_files;
pub use instant::{Origin, Scale};
pub use map::{
    AttitudeForm, AttitudeMap, ColumnMap, FileMap, Layout, OrbitMap, TelemetryMap, TimeFormat,
    TimeMap,
};
pub use map_faults::{MapFault, map_faults};
pub use median::median_step;
pub use memory::{MemoryColumns, Part, Spooled, Values};
pub use mounting::{Mounting, mount};
pub use noise::{NoiseLevel, noise_level};
pub use options::{Encoding, MEMORY_MIB, ReadOptions};
pub use read::{read, read_parts};
pub use resample::{GAP, hold, resample, resample_attitude, resample_hermite};
pub use row_columns::{RowCells, RowColumn};
pub use rows::{ROWS_EXTENSION, write_rows};
pub use suggest::{Suggestion, suggest};
pub use unit::{Dimension, STANDARD_GRAVITY, Unit, parse_unit, units};
pub use writer::{write, write_staged};
