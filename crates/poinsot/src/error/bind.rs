//! Errors of binding telemetry to a model.

use poinsot_files::{as_read, rounded};
use poinsot_model::SensorKind;

/// Why telemetry cannot be bound to a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BindError {
    /// A missing channel.
    #[error("E0301 {file}: no channel '{channel}': {why}")]
    Missing {
        /// File or files of the segment.
        file: String,
        /// Channel.
        channel: String,
        /// Purpose and remedy.
        why: String,
    },
    /// A sensor without declared noise.
    #[error(
        "E0302 model: no sensor of type '{word}' declares its noise, which every uncertainty needs; add [[sensor]] type = \"{word}\" with noise_{unit}",
        word = .kind.declared_as().word(),
        unit = .kind.unit(false)
    )]
    NoNoise {
        /// Kind of sensor.
        kind: SensorKind,
    },
    /// Too few common samples.
    #[error(
        "E0303 {file}: {found} samples have all required channels at one time, but {needed} are required; give a longer record, or files whose times overlap"
    )]
    TooFew {
        /// File or files of the segment.
        file: String,
        /// Samples found.
        found: usize,
        /// Samples needed.
        needed: usize,
    },
    /// Absolute orbital coordinates.
    #[error(
        "E0304 {file}: channel 'r': |r| = {} m at t = {time} s: absolute orbital coordinates are too large for this precision; write [environment] gravity = \"point_mass\" with gm_m3_s2 to use them relative to free fall",
        rounded(*distance, 4)
    )]
    OrbitalPosition {
        /// File or files of the segment.
        file: String,
        /// Distance, m.
        distance: f64,
        /// Time, s.
        time: f64,
    },
    /// An implausible sample.
    #[error(
        "E0306 {file}: channel '{channel}': {} at t = {time_s} s: {why}; correct the unit, or leave the cell empty where there is no sample",
        as_read(*value)
    )]
    Implausible {
        /// File or files of the segment.
        file: String,
        /// Channel.
        channel: String,
        /// Value, SI.
        value: f64,
        /// Time, s.
        time_s: f64,
        /// What is wrong with it.
        why: String,
    },
    /// Vectors in N without an attitude.
    #[error(
        "E0307 {file}: no attitude channel (q_x q_y q_z q_w), but {what} in the axes of N, whose orientation is unknown without it; add the attitude, or {remedy}"
    )]
    NoAttitude {
        /// File or files of the segment.
        file: String,
        /// Quantity given in N.
        what: String,
        /// Alternative remedy.
        remedy: &'static str,
    },
    /// A feature that the linear method does not support.
    #[error("E0305 model: {what}")]
    Unsupported {
        /// Feature and remedy.
        what: String,
    },
}
