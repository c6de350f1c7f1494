//! Channels of telemetry with unit, frame, sensor and time; read from CSV and Parquet.

mod channel;

pub use channel::{Channel, Source, Table};
