//! `report_data.json`: what a page draws in addition to `estimate.json`.

use crate::read::ResultFile;
use crate::truth::TrueBodyFile;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// Name of the format.
pub const REPORT_DATA: &str = "poinsot.report_data/2";

/// The file `report_data.json`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ReportData {
    /// Format.
    pub schema: String,
    /// Version of the program that wrote it.
    pub poinsot: String,
    /// The command line.
    pub command: Vec<String>,
    /// SHA-256 of the files that were written with this one, by their names in its folder; lower-case hexadecimal.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub files: IndexMap<String, String>,
    /// SHA-256 of the input files, equal to those in `estimate.json`.
    pub inputs: Vec<String>,
    /// The vehicle at the first sample.
    pub vehicle: Vehicle,
    /// Curves, one per segment.
    pub segments: Vec<Segment>,
    /// Cost (minus twice the log-likelihood, up to a constant) at the start and after every accepted step of the last fit; empty for a closed form.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub costs: Vec<f64>,
    /// True values from a `truth.json` next to the telemetry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TrueNumbers>,
    /// Why that `truth.json` is not used, or is unchecked; empty otherwise.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub truth_note: String,
}

/// True mass properties.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TrueNumbers {
    /// Bodies by name.
    pub bodies: IndexMap<String, TrueBodyFile>,
    /// The whole vehicle at the first sample, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub system: Option<TrueBodyFile>,
}

/// One segment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Segment {
    /// Name.
    pub label: String,
    /// Sensors.
    pub channels: Vec<Channel>,
    /// Angular momentum about the mass centre.
    pub momentum: Channel,
    /// Times of the motion, s.
    pub time_s: Vec<f64>,
    /// Angular velocity of the base, rad/s.
    pub omega_rad_s: Vec<[f64; 3]>,
    /// Attitude, scalar last.
    pub q_xyzw: Vec<[f64; 4]>,
    /// Joints: name, unit, positions.
    pub joints: Vec<Row>,
    /// Wheels: name, unit, speeds.
    pub wheels: Vec<Row>,
    /// Flexible modes: name, unit, amplitudes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub modes: Vec<Row>,
    /// Firings: thruster, start s, end s, force N.
    pub firings: Vec<(String, f64, f64, f64)>,
}

/// A named list of values at the times of the motion.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Row {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Values.
    pub values: Vec<f64>,
}

/// One kind of sensor: samples, their prediction and the difference, by component.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Channel {
    pub name: String,
    pub unit: String,
    pub residual_unit: String,
    pub components: Vec<String>,
    pub samples: usize,
    pub time_s: Vec<f64>,
    pub measured: Vec<Vec<f64>>,
    pub predicted: Vec<Vec<f64>>,
    pub residual: Vec<Vec<f64>>,
    pub histogram: Vec<Vec<u64>>,
    pub autocorrelation: Vec<Vec<f64>>,
}

/// The drawn vehicle: positions relative to the base origin, in base axes, m.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Vehicle {
    /// Bodies.
    pub bodies: Vec<DrawnBody>,
    /// Joints.
    pub joints: Vec<DrawnJoint>,
    /// Wheels: name, position, unit axis.
    pub wheels: Vec<Pointer>,
    /// Thrusters: name, position, unit direction of the force.
    pub thrusters: Vec<Pointer>,
    /// Sensors.
    pub sensors: Vec<DrawnSensor>,
}

/// A body with the best known numbers.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DrawnBody {
    /// Name.
    pub name: String,
    /// Origin.
    pub origin_m: [f64; 3],
    /// Rows of the rotation from body to base axes.
    pub rotation: [[f64; 3]; 3],
    /// Mass, kg.
    pub mass_kg: f64,
    /// Mass centre relative to the body's origin, in body axes, m.
    pub com_m: [f64; 3],
    /// Central inertia in body axes: xx, xy, yy, xz, yz, zz, kg m2.
    pub inertia_kg_m2: [f64; 6],
    /// Whether it was estimated.
    pub estimated: bool,
}

/// A joint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DrawnJoint {
    /// Name.
    pub name: String,
    /// Kind.
    pub kind: String,
    /// Parent body.
    pub parent: String,
    /// Child body.
    pub child: String,
    /// Position.
    pub origin_m: [f64; 3],
    /// Unit axis.
    pub axis: [f64; 3],
}

/// A named position with a direction.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Pointer {
    /// Name.
    pub name: String,
    /// Body.
    pub body: String,
    /// Position.
    pub at_m: [f64; 3],
    /// Unit vector.
    pub direction: [f64; 3],
}

/// A sensor with its declared noise.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DrawnSensor {
    /// Name.
    pub name: String,
    /// Kind.
    pub kind: String,
    /// Body.
    pub body: String,
    /// Position of a sensor that has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_m: Option<[f64; 3]>,
    /// One sigma of the first axis, SI.
    pub sigma: Option<f64>,
    /// Least significant bit, SI; zero without quantisation.
    pub quantisation: f64,
}

impl ResultFile for ReportData {
    const SCHEMA: &'static str = REPORT_DATA;
    const EARLIER: &'static [&'static str] = &["poinsot.report_data/1"];
}
