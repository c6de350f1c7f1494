//! One measured quantity with its own time base, and the table that holds them.

use crate::Origin;
use std::sync::Arc;

/// One scalar channel: samples of one number over time. A missing sample has no entry (never NaN).
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Standard name with SI meaning, for example `omega_x`, `joint1_rad`, `thr3_N`.
    pub name: String,
    /// Name of the sensor where the column is written `<sensor>.omega_x`; empty otherwise.
    pub sensor: String,
    /// SI unit of the values, for example `rad/s`.
    pub unit: String,
    /// Axes of the values: `body`, `inertial`, or empty for a scalar.
    pub frame: String,
    /// Times of the samples, s, strictly increasing. Channels of one file without gaps share one array.
    pub time_s: Arc<[f64]>,
    /// Values in SI, one per time.
    pub values: Vec<f64>,
}

/// The channels of one segment of telemetry, from one or several files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Channels in the order they were found.
    pub channels: Vec<Channel>,
    /// What was read, repaired and left out, in plain words.
    pub repairs: Vec<String>,
    /// Unused columns.
    pub ignored: Vec<String>,
    /// The files, in the order given.
    pub sources: Vec<Source>,
    /// What the times count from; `None` for a table that was not read from files.
    pub origin: Option<Origin>,
}

/// A file that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Path as given.
    pub path: String,
    /// SHA-256 of its bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Data rows read.
    pub rows: usize,
    /// First and last time, s.
    pub time_s: [f64; 2],
}

impl Table {
    /// The first channel with this name, of any sensor.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The channel of a named sensor.
    pub fn sensor_channel(&self, sensor: &str, name: &str) -> Option<&Channel> {
        self.channels
            .iter()
            .find(|c| c.sensor == sensor && c.name == name)
    }
}
