use poinsot_telemetry::{Order, Overlap, Sense, TimeMap};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How columns of telemetry files become channels.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub(crate) struct TelemetryFile {
    #[serde(flatten)]
    pub all: PartFile,
    /// The attitudes are relative to the orbital frame of a circular orbit.
    pub orbital_frame: Option<OrbitalFile>,
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
    /// Line of the header row; the lines above it are skipped, and "#" before its names. 0: the file has no header, and its
    /// columns are named "1", "2" and so on. Default: the first line that is no comment.
    pub header_row: Option<f64>,
    /// Sign before the decimals of a number: "." (default) or ",".
    pub decimal: Option<DecimalFile>,
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

/// The frame to which attitudes are relative: x along the velocity of a circular orbit, y opposite to its normal, z down. Inertial
/// axes are then those of this frame at time zero.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct OrbitalFile {
    /// Rate of the frame, about its -y axis, rad/s.
    #[schemars(required)]
    pub rate_rad_s: Option<f64>,
    /// true: the angular velocities are relative to it too, as in logs of simulations; those of a gyro are not. Default false.
    pub rates: Option<bool>,
}

/// Sign before the decimals of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub(crate) enum DecimalFile {
    /// A point.
    #[serde(rename = ".")]
    Point,
    /// A comma.
    #[serde(rename = ",")]
    Comma,
}

/// A column and what its values are: sign * (scale * x + offset) in the unit. Several channels may share a column where all but
/// one have a sign, scale or offset: a finger that mimics another, rotors with one speed.
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
    /// Texts or numbers of the column that mean that there is no sample.
    pub invalid: Option<Vec<InvalidFile>>,
    /// The column counts modulo this range, and its upper half are the negative numbers: 65536 for 16 bits of a two's complement
    /// read as unsigned. In the numbers of the column.
    pub signed_range: Option<f64>,
    /// The column begins anew at this value (360 for an angle in deg, 65536 for a counter of 16 bits): its samples are continued
    /// across the jump. In the numbers of the column.
    pub wraps_at: Option<f64>,
    /// true: the values are increments since the sample before (angles of a gyro), and the unit is theirs. The channel is their
    /// mean rate, at the middle of the interval. Default false.
    pub increments: Option<bool>,
    /// Of a thruster: time from a command to its thrust (dead time of the valve), s. Default 0.
    pub opens_late_s: Option<f64>,
    /// Of a thruster: time from the end of a command to that of its thrust, s. Default 0.
    pub closes_late_s: Option<f64>,
    /// Of durations of pulses: what one means that begins before the one before it ends: "merged" (the valve is open until both
    /// have ended) or "replaced" (it takes the place of the one before). Default: such a pulse is refused.
    pub overlap: Option<Overlap>,
}

/// What means that there is no sample.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum InvalidFile {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

/// A column of an attitude.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum AttitudeColumnFile {
    /// Its name.
    Name(String),
    /// Its name, and what its values are.
    Column(Box<ColumnFile>),
}

/// An attitude in one of four forms.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct AttitudeFile {
    /// Name of the sensor. Default: the only one.
    pub sensor: Option<String>,
    /// Four columns of a Hamilton quaternion, in the order that `order` says; or the three of its vector part, where the scalar part
    /// is never negative. A column is a name, or a table as in `columns`.
    pub quaternion: Option<Vec<AttitudeColumnFile>>,
    /// Scalar last, "xyzw" (default), or first, "wxyz".
    pub order: Option<Order>,
    /// Nine columns of the rotation matrix, row by row.
    pub matrix: Option<Vec<AttitudeColumnFile>>,
    /// Three columns of Euler angles, in the order of `sequence`. Right ascension, declination and roll of the axis x are
    /// "ZYX" with the declination of sign -1; of the axis z, "ZYZ" with it of sign -1 and offset -90 deg.
    pub euler: Option<Vec<AttitudeColumnFile>>,
    /// Axes of the three turns, each about the axis rotated by those before: "ZYX" for yaw, pitch, roll.
    pub sequence: Option<String>,
    /// Unit of the Euler angles. Default: that of the units row.
    pub unit: Option<String>,
    /// Three columns of modified Rodrigues parameters.
    pub mrp: Option<Vec<AttitudeColumnFile>>,
    /// Direction of the rotation: "body_to_inertial" (default) or "inertial_to_body".
    pub sense: Option<Sense>,
    /// true: of an attitude sensor with `seen_from`. For `sense` the body from which it sees takes the place of inertial
    /// axes. Default: false.
    pub relative: Option<bool>,
    /// The attitude is that of the rows where each of these columns has exactly this text: a flag of validity.
    #[serde(rename = "where")]
    pub rows: Option<BTreeMap<String, String>>,
    /// Texts or numbers that mean, in any of its columns, that there is no attitude.
    pub invalid: Option<Vec<InvalidFile>>,
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
