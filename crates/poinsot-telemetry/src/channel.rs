//! A measured quantity with its time base, and the table of channels.

use crate::Origin;
use crate::channel_name::{components, full_name};
use schemars::JsonSchema;
use serde::Serialize;
use std::sync::Arc;

/// One scalar channel: samples of one number over time. A missing sample has no entry (never NaN).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Channel {
    /// Standard name with SI meaning, for example `omega_x`, `joint1_rad`, `thr3_N`.
    pub name: String,
    /// Name of the sensor in a column `<sensor>.omega_x`; empty otherwise.
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
    /// What was read, repaired and dropped.
    pub repairs: Vec<String>,
    /// Unused columns.
    pub ignored: Vec<String>,
    /// The files, in the order given.
    pub sources: Vec<Source>,
    /// Origin of the times; `None` for a table not read from files.
    pub origin: Option<Origin>,
}

/// A file of the table.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Source {
    /// As named.
    pub path: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Data rows.
    pub rows: usize,
    /// First and last time, s.
    pub time_s: [f64; 2],
}

impl Channel {
    /// Name with the sensor, as in a column.
    pub fn full(&self) -> String {
        full_name(&self.sensor, &self.name)
    }
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
            .find(|c| c.name == name && c.sensor == sensor)
    }

    /// Places of the components of every vector or quaternion with this prefix, one list a sensor.
    pub(crate) fn vectors(&self, prefix: &str) -> Vec<Vec<usize>> {
        let channels = &self.channels;
        let place = |sensor: &str, axis: &str| {
            let name = format!("{prefix}_{axis}");
            let own = |c: &Channel| c.sensor == sensor && c.name == name;
            channels.iter().position(own)
        };
        let axes = components(prefix).iter();
        let of = |c: &Channel| axes.clone().map(|axis| place(&c.sensor, axis)).collect();
        let first = format!("{prefix}_x");
        let firsts = channels.iter().filter(|c| c.name == first);
        firsts.filter_map(of).collect()
    }

    /// The channels of a vector: of this sensor, or of the first that has all of them.
    pub(crate) fn vector(&self, sensor: Option<&str>, prefix: &str) -> Option<Vec<&Channel>> {
        let all = self.vectors(prefix).into_iter();
        let all = all.map(|places| self.at(&places));
        let own = |of: &Vec<&Channel>| {
            let first = of.first().map(|c| c.sensor.as_str());
            sensor.is_none() || first == sensor
        };
        all.into_iter().find(own)
    }

    /// The channels at these places.
    pub(crate) fn at(&self, places: &[usize]) -> Vec<&Channel> {
        places
            .iter()
            .filter_map(|k| self.channels.get(*k))
            .collect()
    }
}
