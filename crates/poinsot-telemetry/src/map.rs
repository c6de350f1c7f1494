//! The `[telemetry]` table: maps columns of exported files to channels. Its words are those of the schema and the reference page,
//! which name tables and channels in brackets.
#![allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]

use crate::{Dimension, Order, Scale, Sense, parse_unit};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::path::Path;

/// How columns of telemetry files become channels.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(rename = "TelemetryFile", deny_unknown_fields)]
pub struct TelemetryMap {
    /// Map of every file.
    #[serde(flatten)]
    pub all: FileMap,
    /// The attitudes are relative to the orbital frame of a circular orbit.
    pub orbital_frame: Option<OrbitalMap>,
    /// true: the angular velocities are in inertial axes, as some simulations write them, not in those of the body; the attitude
    /// turns them. Default false.
    #[serde(skip_serializing_if = "is_usual")]
    pub inertial_rates: bool,
    /// true: the velocities are in the axes of the body, as u, v, w of flight mechanics, not in inertial ones; the attitude turns them.
    /// Default false.
    #[serde(skip_serializing_if = "is_usual")]
    pub body_velocities: bool,
    /// true: the positions are in the axes of the body; the attitude turns them. Default false.
    #[serde(skip_serializing_if = "is_usual")]
    pub body_positions: bool,
    /// Settings for the files of one name, in addition to those for all.
    #[serde(rename = "file", skip_serializing_if = "is_usual")]
    pub files: Vec<NamedMap>,
}

/// Settings for the files of one name. Keys given here replace those of [telemetry]; columns, attitudes and rows are
/// added to them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(rename = "ExportFile", deny_unknown_fields, extend("required" = ["name"]))]
pub struct NamedMap {
    /// Name of the files, without folder; "*" stands for any text, for example "tracker*.csv".
    pub name: String,
    /// Their map.
    #[serde(flatten)]
    pub map: FileMap,
}

// Keys for all files, and for the files of one name.
/// Map of one kind of file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct FileMap {
    /// Text layout.
    #[serde(flatten)]
    pub layout: Layout,
    /// What the times are. Default: the column time_s, s.
    pub time: Option<TimeMap>,
    /// Channel (standard name, SI; or <sensor>.<channel>) and its column.
    #[serde(with = "by_channel", skip_serializing_if = "is_usual")]
    #[schemars(with = "BTreeMap<String, ColumnMap>")]
    pub columns: Vec<ColumnMap>,
    /// Attitudes in any form.
    #[serde(skip_serializing_if = "is_usual")]
    pub attitude: Vec<AttitudeMap>,
    /// Position of the vehicle from the centre of the attracting body: the orbit of the gravity gradient.
    pub orbit: Option<OrbitMap>,
    /// Rows are kept where each of these columns has exactly this text.
    #[serde(rename = "where", with = "texts", skip_serializing_if = "is_usual")]
    #[schemars(with = "BTreeMap<String, String>")]
    pub row_filter: Vec<(String, String)>,
}

/// Text layout of a CSV file; `None` is the default.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Layout {
    /// Character between the fields of a row: "," (default), ";", "|", "tab" or "space" (any number of blanks).
    pub delimiter: Option<String>,
    /// Character at the start of a line that is a comment, for example "#". Default: no line is a comment.
    pub comment: Option<String>,
    /// Line of the header row; the lines above it are skipped, and "#" before its names. 0: the file has no header, and its
    /// columns are named "1", "2" and so on. Default: the first line that is no comment.
    #[schemars(extend("maximum" = 1e6, "x-advice" = "count lines from 1; 0 means that there is no header"))]
    pub header_row: Option<u64>,
    /// Sign before the decimals of a number: "." (default) or ",".
    pub decimal: Option<DecimalSign>,
    /// Whether the row below the header names the units. Default false.
    pub units_row: Option<bool>,
}

/// A character that is in no number or name.
pub(crate) fn mark(text: &str) -> Option<u8> {
    let in_number = |byte: u8| byte.is_ascii_alphanumeric() || b"\".-+\n\r".contains(&byte);
    match text {
        "tab" => Some(b'\t'),
        "space" => Some(b' '),
        _ => match text.as_bytes() {
            [byte] => Some(*byte).filter(|byte| !in_number(*byte)),
            _ => None,
        },
    }
}

/// Sign before the decimals of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "DecimalFile")]
pub enum DecimalSign {
    /// A point.
    #[serde(rename = ".")]
    Point,
    /// A comma.
    #[serde(rename = ",")]
    Comma,
}

/// A column and what its values are: sign * (scale * x + offset) in the unit. Several channels may share a column where all but
/// one have a sign, scale or offset: a finger that mimics another, rotors with one speed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "ColumnFile", extend("required" = ["column"]))]
#[allow(non_snake_case)]
pub struct ColumnMap {
    /// Standard channel name, for example `omega_x`, `imu2.omega_x` or `time_s`.
    #[serde(skip)]
    pub channel: String,
    /// Name of the column in the file.
    #[schemars(extend("minLength" = 1))]
    pub column: String,
    /// Unit of the column, for example "deg/s"; `poinsot units` lists all. "N m s" of a wheel: its momentum relative to its body, the
    /// spin inertia of the model times the speed. Default: that of the units row.
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
    #[serde(rename = "where", with = "texts", skip_serializing_if = "is_usual")]
    #[schemars(with = "BTreeMap<String, String>")]
    pub rows: Vec<(String, String)>,
    /// Texts or numbers of the column that mean that there is no sample.
    #[serde(deserialize_with = "invalid", skip_serializing_if = "is_usual")]
    #[schemars(with = "Vec<Invalid>")]
    pub invalid: Vec<String>,
    /// The column counts modulo this range, and its upper half are the negative numbers: 65536 for 16 bits of a two's complement
    /// read as unsigned. In the numbers of the column.
    pub signed_range: Option<f64>,
    /// The column begins anew at this value (360 for an angle in deg, 65536 for a counter of 16 bits): its samples are continued
    /// across the jump. In the numbers of the column.
    pub wraps_at: Option<f64>,
    /// true: the values are increments since the sample before (angles of a gyro), and the unit is theirs. The channel is their
    /// mean rate, at the middle of the interval. Default false.
    #[serde(skip_serializing_if = "is_usual")]
    pub increments: bool,
    /// Time from the motion, or the thrust, to the time of its sample, s: positive where the times are late. Default 0.
    pub late_s: Option<f64>,
    /// Of a thruster: time from a command to its thrust (dead time of the valve), s. Default 0.
    pub opens_late_s: Option<f64>,
    /// Of a thruster: time from the end of a command to that of its thrust, s. Default 0.
    pub closes_late_s: Option<f64>,
    /// Of durations of pulses: what one means that begins before the one before it ends: "merged" (the valve is open until both
    /// have ended) or "replaced" (it takes the place of the one before). Default: such a pulse is refused.
    pub overlap: Option<Overlap>,
}

/// Whether a value equals its default.
fn is_usual<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Columns by channel.
mod by_channel {
    use super::{BTreeMap, ColumnMap, Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(all: &[ColumnMap], writer: S) -> Result<S::Ok, S::Error> {
        writer.collect_map(all.iter().map(|own| (&own.channel, own)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(reader: D) -> Result<Vec<ColumnMap>, D::Error> {
        let all = BTreeMap::<String, ColumnMap>::deserialize(reader)?.into_iter();
        Ok(all
            .map(|(channel, own)| ColumnMap { channel, ..own })
            .collect())
    }
}

/// Texts by column.
mod texts {
    use super::{BTreeMap, Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(
        all: &[(String, String)],
        writer: S,
    ) -> Result<S::Ok, S::Error> {
        writer.collect_map(all.iter().map(|(column, text)| (column, text)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        reader: D,
    ) -> Result<Vec<(String, String)>, D::Error> {
        Ok(BTreeMap::deserialize(reader)?.into_iter().collect())
    }
}

/// What means that there is no sample.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "InvalidFile")]
enum Invalid {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

fn invalid<'de, D: Deserializer<'de>>(reader: D) -> Result<Vec<String>, D::Error> {
    let text = |one: Invalid| match one {
        Invalid::Number(x) => x.to_string(),
        Invalid::Text(text) => text,
    };
    Ok(Vec::deserialize(reader)?.into_iter().map(text).collect())
}

/// What a pulse means that begins before the one before it ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OverlapFile")]
pub enum Overlap {
    /// The valve is open until both have ended.
    Merged,
    /// It takes the place of the one before.
    Replaced,
}

impl ColumnMap {
    /// A column of a group, whose unit is that of the group.
    pub fn part(column: &str) -> Self {
        Self {
            column: column.to_owned(),
            ..Self::default()
        }
    }

    /// Whether the values are changed beyond their unit.
    pub fn is_changed(&self) -> bool {
        self.scale.or(self.offset).or(self.sign).is_some()
    }

    /// Whether the values are the momentum of a wheel, by its unit; the speed is that over the spin inertia.
    pub fn is_momentum(&self) -> bool {
        let unit = self.unit.as_deref().and_then(|u| parse_unit(u).ok());
        unit.is_some_and(|unit| unit.dimension == Dimension::AngularMomentum)
    }

    /// A column in a unit.
    pub fn new(channel: &str, column: &str, unit: &str) -> Self {
        Self {
            channel: channel.to_owned(),
            unit: Some(unit.to_owned()),
            ..Self::part(column)
        }
    }
}

/// The times of a file. All files of a run count from one instant: with an epoch or dates from the first sample.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(rename = "TimeFile", deny_unknown_fields, extend("required" = ["column"]))]
pub struct TimeMap {
    /// Column of the time; of the seconds of the week for "gps_week".
    pub column: String,
    /// "number" (default), "iso8601" (2026-03-14T18:19:00.25Z, with or without zone), "day_of_year"
    /// (2026-073T18:19:00.25) or "gps_week".
    pub format: TimeFormat,
    /// Column of the GPS week, counted from 1980 without rollover.
    pub week: Option<String>,
    /// Unit of numbers. Default s.
    pub unit: Option<String>,
    /// What numbers count from: "unix", "gps", or a date and time. Default: unknown.
    pub epoch: Option<String>,
    /// Time scale of dates. Default "UTC".
    pub scale: Option<Scale>,
}

/// How times are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "TimeFormatFile")]
pub enum TimeFormat {
    /// Numbers.
    #[default]
    Number,
    /// Year, month, day: `2026-03-14T18:19:00.25Z`; the zone is optional.
    Iso8601,
    /// Year and day of the year: `2026-073T18:19:00.25`.
    DayOfYear,
    /// GPS week and seconds of the week.
    GpsWeek,
}

/// An attitude in one of four forms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "AttitudeFile")]
pub struct AttitudeMap {
    /// Name of the sensor. Default: the only one.
    #[serde(skip_serializing_if = "is_usual")]
    pub sensor: String,
    /// Four columns of a Hamilton quaternion, in the order that `order` says; or the three of its vector part, where the scalar part
    /// is never negative. A column is a name, or a table as in `columns`.
    pub quaternion: Option<Vec<AttitudeColumn>>,
    /// Scalar last, "xyzw" (default), or first, "wxyz".
    pub order: Option<Order>,
    /// Nine columns of the rotation matrix, row by row.
    pub matrix: Option<Vec<AttitudeColumn>>,
    /// Three columns of Euler angles, in the order of `sequence`. Right ascension, declination and roll of the axis x are
    /// "ZYX" with the declination of sign -1; of the axis z, "ZYZ" with it of sign -1 and offset -90 deg.
    pub euler: Option<Vec<AttitudeColumn>>,
    /// Axes of the three turns, each about the axis rotated by those before: "ZYX" for yaw, pitch, roll.
    pub sequence: Option<String>,
    /// Unit of the Euler angles. Default: that of the units row.
    pub unit: Option<String>,
    /// Three columns of modified Rodrigues parameters.
    pub mrp: Option<Vec<AttitudeColumn>>,
    /// Direction of the rotation: "body_to_inertial" (default) or "inertial_to_body".
    pub sense: Option<Sense>,
    /// true: of an attitude sensor with `seen_from`. For `sense` the body from which it sees takes the place of inertial
    /// axes. Default: false.
    #[serde(skip_serializing_if = "is_usual")]
    pub relative: bool,
    /// The attitude is that of the rows where each of these columns has exactly this text: a flag of validity.
    #[serde(rename = "where", with = "texts", skip_serializing_if = "is_usual")]
    #[schemars(with = "BTreeMap<String, String>")]
    pub rows: Vec<(String, String)>,
    /// Time from the attitude to the time of its sample, s: positive where the times are late. Default 0.
    pub late_s: Option<f64>,
    /// Texts or numbers that mean, in any of its columns, that there is no attitude.
    #[serde(deserialize_with = "invalid", skip_serializing_if = "is_usual")]
    #[schemars(with = "Vec<Invalid>")]
    pub invalid: Vec<String>,
}

/// A column of an attitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "AttitudeColumnFile")]
pub enum AttitudeColumn {
    /// Its name.
    Name(String),
    /// Its name, and what its values are.
    Column(Box<ColumnMap>),
}

impl AttitudeMap {
    /// The lists of columns that are given, by the names of the forms.
    pub(crate) fn given(&self) -> Vec<(&'static str, &[AttitudeColumn])> {
        let all = [
            ("quaternion", &self.quaternion),
            ("matrix", &self.matrix),
            ("euler", &self.euler),
            ("mrp", &self.mrp),
        ];
        let given = all.into_iter();
        given
            .filter_map(|(name, list)| Some((name, list.as_deref()?)))
            .collect()
    }

    /// The form; `None` without exactly one, or without the sequence of Euler angles.
    pub(crate) fn form(&self) -> Option<AttitudeForm> {
        match self.given()[..] {
            [("quaternion", [_, _, _])] => Some(AttitudeForm::VectorPart),
            [("quaternion", _)] => {
                Some(AttitudeForm::Quaternion(self.order.unwrap_or(Order::Xyzw)))
            }
            [("matrix", _)] => Some(AttitudeForm::Matrix),
            [("mrp", _)] => Some(AttitudeForm::Mrp),
            [_] => {
                let axis = |c: char| "XYZ".find(c.to_ascii_uppercase());
                let axes: Option<Vec<usize>> =
                    self.sequence.as_deref()?.chars().map(axis).collect();
                axes?.try_into().ok().map(AttitudeForm::Euler)
            }
            _ => None,
        }
    }

    /// The columns in the order of the form, each with what holds for all of them; their channel is empty.
    pub(crate) fn columns(&self) -> Vec<ColumnMap> {
        let map = |column: &AttitudeColumn| {
            let mut map = match column {
                AttitudeColumn::Name(column) => ColumnMap::part(column),
                AttitudeColumn::Column(own) => (**own).clone(),
            };
            map.late_s = self.late_s.or(map.late_s);
            map.rows.extend(self.rows.iter().cloned());
            map.invalid.extend(self.invalid.iter().cloned());
            map
        };
        self.given()
            .into_iter()
            .flat_map(|(_, list)| list)
            .map(map)
            .collect()
    }

    /// Direction of the rotation.
    pub(crate) fn sense(&self) -> Sense {
        self.sense.unwrap_or(Sense::BodyToInertial)
    }

    /// Standard names of the quaternion: x, y, z, w.
    pub(crate) fn names(&self) -> [String; 4] {
        let prefix = if self.relative { "relative_q" } else { "q" };
        ["x", "y", "z", "w"].map(|axis| crate::full_name(&self.sensor, &format!("{prefix}_{axis}")))
    }
}

/// Forms of an attitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AttitudeForm {
    /// Hamilton quaternion.
    Quaternion(Order),
    /// The vector part of a quaternion whose scalar part is not negative.
    VectorPart,
    /// Rotation matrix, row by row.
    Matrix,
    /// Intrinsic angles about these axes (0, 1, 2).
    Euler([usize; 3]),
    /// Modified Rodrigues parameters, `tan(angle / 4)` along the axis.
    Mrp,
}

impl AttitudeForm {
    /// Number of columns of the form.
    pub fn width(self) -> usize {
        match self {
            Self::Quaternion(_) => 4,
            Self::Matrix => 9,
            Self::Euler(_) | Self::Mrp | Self::VectorPart => 3,
        }
    }
}

/// The frame to which attitudes are relative: x along the velocity of a circular orbit, y opposite to its normal, z down. Inertial
/// axes are then those of this frame at time zero.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "OrbitalFile", extend("required" = ["rate_rad_s"]))]
pub struct OrbitalMap {
    /// Rate of the frame, about its -y axis, rad/s.
    pub rate_rad_s: f64,
    /// true: the angular velocities are relative to it too, as in logs of simulations; those of a gyro are not. Default false.
    #[serde(skip_serializing_if = "is_usual")]
    pub rates: bool,
}

/// Position of the vehicle from the centre of the attracting body.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[schemars(rename = "OrbitColumnsFile", extend("required" = ["position"]))]
pub struct OrbitMap {
    /// Columns of x, y and z. With a position sensor in the model and gravity in [environment], the positions are used
    /// relative to free fall.
    pub position: [String; 3],
    /// Unit. Default: that of the units row.
    pub unit: Option<String>,
    /// Columns of the velocity in the same axes.
    pub velocity: Option<[String; 3]>,
    /// Unit of the velocity. Default: that of the units row.
    pub velocity_unit: Option<String>,
    /// "inertial" (default), or "earth_fixed": turned to inertial axes by the Earth rotation angle.
    pub frame: Option<OrbitFrame>,
}

/// Axes of a position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "FrameFile")]
pub enum OrbitFrame {
    /// Those of the attitude.
    Inertial,
    /// Turning with the Earth.
    EarthFixed,
}

impl TelemetryMap {
    /// Whether the columns of a wheel are its momentum.
    ///
    /// ```
    /// use poinsot_telemetry::{ColumnMap, TelemetryMap};
    ///
    /// let mut map = TelemetryMap::default();
    /// map.all.columns.push(ColumnMap::new("rw1_rad_s", "H1", "N m s"));
    /// assert!(map.has_momentum("rw1") && !map.has_momentum("rw2"));
    /// ```
    pub fn has_momentum(&self, wheel: &str) -> bool {
        let is_own = |c: &ColumnMap| c.channel.strip_suffix("_rad_s") == Some(wheel);
        let mut all = self.maps().flat_map(|(_, map)| &map.columns);
        all.any(|c| is_own(c) && c.is_momentum())
    }

    pub(crate) fn for_file(&self, path: &Path) -> FileMap {
        let mut all = self.all.clone();
        let fitting = self.files.iter().filter(|own| fits_path(&own.name, path));
        fitting.for_each(|own| all.add(&own.map));
        all
    }

    /// All maps, with an index for those of single files.
    pub(crate) fn maps(&self) -> impl Iterator<Item = (Option<usize>, &FileMap)> {
        let files = self.files.iter().enumerate();
        std::iter::once((None, &self.all)).chain(files.map(|(k, own)| (Some(k), &own.map)))
    }
}

impl FileMap {
    fn add(&mut self, more: &Self) {
        let (all, own) = (&mut self.layout, more.layout.clone());
        all.delimiter = own.delimiter.or(all.delimiter.take());
        all.comment = own.comment.or(all.comment.take());
        all.header_row = own.header_row.or(all.header_row);
        all.units_row = own.units_row.or(all.units_row);
        all.decimal = own.decimal.or(all.decimal);
        self.time = more.time.clone().or(self.time.take());
        self.columns.extend(more.columns.iter().cloned());
        self.attitude.extend(more.attitude.iter().cloned());
        self.orbit = more.orbit.clone().or(self.orbit.take());
        self.row_filter.extend(more.row_filter.iter().cloned());
    }

    /// Every column that selects rows, with its text.
    pub(crate) fn filters(&self) -> impl Iterator<Item = (String, String)> {
        let parts = self.attitude.iter().flat_map(AttitudeMap::columns);
        let own = self
            .columns
            .iter()
            .cloned()
            .chain(parts)
            .flat_map(|c| c.rows);
        self.row_filter.iter().cloned().chain(own)
    }

    /// Every column named in the map, with its purpose as the channel.
    pub(crate) fn named(&self) -> Vec<ColumnMap> {
        let of = |channel: &str, column: &ColumnMap| ColumnMap {
            channel: channel.to_owned(),
            ..column.clone()
        };
        let mut all = self.columns.clone();
        let time = self.time.iter();
        let time = time.flat_map(|t| std::iter::once(&t.column).chain(&t.week));
        all.extend(time.map(|c| of("time", &ColumnMap::part(c))));
        for attitude in &self.attitude {
            let name = crate::full_name(&attitude.sensor, "attitude");
            all.extend(attitude.columns().iter().map(|c| of(&name, c)));
        }
        let orbit = self.orbit.iter();
        let orbit = orbit.flat_map(|o| o.position.iter().chain(o.velocity.iter().flatten()));
        all.extend(orbit.map(|c| of("orbit", &ColumnMap::part(c))));
        all.retain(|own| !own.column.is_empty());
        all
    }
}

/// Whether the name of a file matches a pattern.
pub(crate) fn fits_path(pattern: &str, path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    fits(pattern, &name)
}

/// Whether a name matches a pattern in which `*` matches any text.
fn fits(pattern: &str, name: &str) -> bool {
    let Some((first, later)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let (inner, last) = later.rsplit_once('*').unwrap_or(("", later));
    let mut inner = inner.split('*');
    let rest = name.strip_prefix(first);
    let rest =
        rest.and_then(|rest| inner.try_fold(rest, |rest, part| Some(rest.split_once(part)?.1)));
    rest.is_some_and(|rest| rest.ends_with(last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_patterns_of_names() {
        for (pattern, name, fit) in [
            ("*", "a.csv", true),
            ("tracker*.csv", "tracker_7.csv", true),
            ("tracker*.csv", "tracker.csv.gz", false),
            ("*_orbit*", "2026_orbit_a.csv", true),
            ("a.csv", "a.csv", true),
            ("a.csv", "ba.csv", false),
            ("a*a", "a", false),
        ] {
            assert_eq!(fits(pattern, name), fit, "{pattern} {name}");
        }
    }
}
