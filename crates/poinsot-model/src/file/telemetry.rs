use poinsot_telemetry::{Order, Sense, TimeMap};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How columns of telemetry files become channels.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct TelemetryFile {
    #[serde(flatten)]
    pub all: PartFile,
    /// Settings for the files of one name, in addition to those for all.
    pub file: Option<Vec<ExportFile>>,
}

/// Settings for the files of one name. Keys given here replace those of [telemetry]; columns, attitudes and rows are
/// added to them.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct ExportFile {
    /// Name of the files, without folder; "*" stands for any text, for example "tracker*.csv".
    #[schemars(required)]
    pub name: Option<String>,
    #[serde(flatten)]
    pub part: PartFile,
}

// Keys for all files, and for the files of one name.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct PartFile {
    /// Character between the fields of a row: "," (default), ";", "|", "tab" or "space".
    pub delimiter: Option<String>,
    /// Character at the start of a line that is a comment, for example "#". Default: no line is a comment.
    pub comment: Option<String>,
    /// Line of the header row; the lines above it are skipped. Default 1.
    pub header_row: Option<f64>,
    /// Whether the row below the header names the units. Default false.
    pub units_row: Option<bool>,
    /// What the times are. Default: the column time_s, s.
    pub time: Option<TimeMap>,
    /// Channel (standard name, SI; or <sensor>.<channel>) and its column.
    pub columns: Option<BTreeMap<String, ColumnFile>>,
    /// Attitudes in any form.
    pub attitude: Option<Vec<AttitudeFile>>,
    /// Position of the vehicle from the centre of the attracting body: the orbit of the gravity gradient.
    pub orbit: Option<OrbitColumnsFile>,
    /// Rows are kept where each of these columns has exactly this text.
    #[serde(rename = "where")]
    pub rows: Option<BTreeMap<String, String>>,
}

/// A column and what its values are: sign * (scale * x + offset) in the unit.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(crate) struct ColumnFile {
    /// Name of the column in the file.
    #[schemars(required, extend("minLength" = 1))]
    pub column: Option<String>,
    /// Unit of the column, for example "deg/s"; `poinsot units` lists all. Default: that of the units row.
    pub unit: Option<String>,
    /// 1 or -1. Default 1.
    pub sign: Option<f64>,
    /// Factor of the values. Default 1.
    pub scale: Option<f64>,
    /// Added to the scaled values, in the unit of the column. Default 0.
    pub offset: Option<f64>,
    /// Values are counts of an encoder (of a rate: counts per second), so many to one revolution. In place of a unit.
    pub counts_per_revolution: Option<f64>,
    /// The column is the on/off flag of a thruster, and on means this force, N. With a unit of time (`unit = "ms"`) the
    /// column is the duration of a pulse that begins at the time of the row; zero or empty: no pulse.
    pub nominal_N: Option<f64>,
    /// The samples are those of the rows where each of these columns has exactly this text: a table of pulses with a
    /// column that names the thruster, or one column for the values of several channels.
    #[serde(rename = "where")]
    pub rows: Option<BTreeMap<String, String>>,
}

/// An attitude in one of four forms.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AttitudeFile {
    /// Name of the sensor. Default: the only one.
    pub sensor: Option<String>,
    /// Four columns of a Hamilton quaternion, in the order that `order` says.
    pub quaternion: Option<Vec<String>>,
    /// Scalar last, "xyzw" (default), or first, "wxyz".
    pub order: Option<Order>,
    /// Nine columns of the rotation matrix, row by row.
    pub matrix: Option<Vec<String>>,
    /// Three columns of Euler angles, in the order of `sequence`.
    pub euler: Option<Vec<String>>,
    /// Axes of the three turns, each about the axis rotated by those before: "ZYX" for yaw, pitch, roll.
    pub sequence: Option<String>,
    /// Unit of the Euler angles. Default: that of the units row.
    pub unit: Option<String>,
    /// Three columns of modified Rodrigues parameters.
    pub mrp: Option<Vec<String>>,
    /// Direction of the rotation: "body_to_inertial" (default) or "inertial_to_body".
    pub sense: Option<Sense>,
    /// true: of an attitude sensor with `seen_from`. For `sense` the body from which it sees takes the place of inertial
    /// axes. Default: false.
    pub relative: Option<bool>,
}

/// Position of the vehicle from the centre of the attracting body.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OrbitColumnsFile {
    /// Columns of x, y and z. With a position sensor in the model and gravity in [environment], the positions are used
    /// relative to free fall.
    #[schemars(required)]
    pub position: Option<[String; 3]>,
    /// Unit. Default: that of the units row.
    pub unit: Option<String>,
    /// Columns of the velocity in the same axes.
    pub velocity: Option<[String; 3]>,
    /// Unit of the velocity. Default: that of the units row.
    pub velocity_unit: Option<String>,
    /// "inertial" (default), or "earth_fixed": turned to inertial axes by the Earth rotation angle.
    pub frame: Option<FrameFile>,
}

/// Axes of a position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FrameFile {
    /// Those of the attitude.
    Inertial,
    /// Turning with the Earth.
    EarthFixed,
}

/// A file with the [telemetry] table alone.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TelemetryMapFile {
    /// How columns of telemetry files become channels.
    #[schemars(required)]
    pub telemetry: Option<TelemetryFile>,
}
