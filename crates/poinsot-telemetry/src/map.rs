//! The `[telemetry]` table: maps columns of exported files to channels.

use crate::{Order, Scale, Sense};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The map of all files of a run. [`Self::files`] adds entries to [`Self::all`] for matching file names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TelemetryMap {
    /// Map of every file.
    pub all: FileMap,
    /// Maps of some files: a pattern of the file name, in which `*` matches any text, and the map.
    pub files: Vec<(String, FileMap)>,
}

/// Map of one kind of file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FileMap {
    /// Text layout.
    pub layout: Layout,
    /// Column and format of the times; `None`: the column `time_s`, s.
    pub time: Option<TimeMap>,
    /// Columns that are not standard names in SI.
    pub columns: Vec<ColumnMap>,
    /// Attitudes in any form.
    pub attitude: Vec<AttitudeMap>,
    /// Position of the vehicle on its orbit.
    pub orbit: Option<OrbitMap>,
    /// Attitudes that are relative to the orbital frame.
    pub orbital: Option<OrbitalMap>,
    /// Only rows in which each of these columns holds exactly this text are kept.
    pub row_filter: Vec<(String, String)>,
}

/// Text layout of a CSV file; `None` is the default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Layout {
    /// Field separator; default: comma.
    pub delimiter: Option<u8>,
    /// Lines that start with this character are comments; default: none.
    pub comment: Option<u8>,
    /// Line of the header row, from 1; earlier lines are skipped. 0: there is none, and the columns are named 1, 2, 3 and so on.
    pub header_row: Option<u64>,
    /// Whether the row below the header holds the units.
    pub units_row: Option<bool>,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: Option<bool>,
}

/// A column that is not a standard name in SI, and its channel: `sign * (scale * x + offset)` in its unit, where x is the cell
/// after [`Self::invalid`], [`Self::signed_range`] and [`Self::wraps_at`].
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(non_snake_case)]
pub struct ColumnMap {
    /// Standard channel name, for example `omega_x`, `imu2.omega_x` or `time_s`.
    pub channel: String,
    /// Column in the file.
    pub column: String,
    /// Unit of the column, for example `deg/s`; `None`: from the units row.
    pub unit: Option<String>,
    /// Factor of the values.
    pub scale: Option<f64>,
    /// Offset of the scaled values, in the unit of the column.
    pub offset: Option<f64>,
    /// `1` or `-1`.
    pub sign: Option<f64>,
    /// Values are counts (or counts per second), this many per revolution; no unit is given then.
    pub counts_per_revolution: Option<f64>,
    /// Force of a column that is an on/off flag. If the column's unit is a time, it is the firing duration from the
    /// time of the row.
    pub nominal_N: Option<f64>,
    /// Only rows in which each of these columns holds exactly this text; empty for all rows.
    pub rows: Vec<(String, String)>,
    /// Texts or numbers that mean that there is no sample.
    pub invalid: Vec<String>,
    /// The column counts modulo this range, and its upper half are the negative numbers, as of a two's complement read as
    /// unsigned.
    pub signed_range: Option<f64>,
    /// The column begins anew at this value: its samples are continued across the jump.
    pub wraps_at: Option<f64>,
    /// Values are increments since the sample before, in the unit of the integral: the channel is their mean rate.
    pub increments: bool,
    /// Time from a command to the thrust, s.
    pub opens_late_s: Option<f64>,
    /// Time from the end of a command to the end of the thrust, s.
    pub closes_late_s: Option<f64>,
    /// What a pulse means that begins before the one before it ends; `None`: such pulses are refused.
    pub overlap: Option<Overlap>,
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

    /// A column in a unit.
    pub fn new(channel: &str, column: &str, unit: &str) -> Self {
        Self {
            channel: channel.to_owned(),
            column: column.to_owned(),
            unit: Some(unit.to_owned()),
            ..Self::default()
        }
    }
}

/// The times of a file. All files of a run count from one instant: with an epoch or dates from the first sample.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "TimeFile", deny_unknown_fields, extend("required" = ["column"]))]
pub struct TimeMap {
    /// Column of the time; of the seconds of the week for "gps_week".
    #[serde(default)]
    pub column: String,
    /// "number" (default), "iso8601" (2026-03-14T18:19:00.25Z, with or without zone), "day_of_year"
    /// (2026-073T18:19:00.25) or "gps_week".
    #[serde(default)]
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

/// Form of an attitude.
#[derive(Debug, Clone, PartialEq)]
pub struct AttitudeMap {
    /// Sensor; empty if there is only one.
    pub sensor: String,
    /// Form.
    pub form: AttitudeForm,
    /// Columns, in the order of the form; their channel is empty.
    pub columns: Vec<ColumnMap>,
    /// Direction of the rotation.
    pub sense: Sense,
    /// Unit of Euler angles; `None`: from the units row.
    pub unit: Option<String>,
    /// Whether it is the attitude of a body seen from another one, instead of in N.
    pub relative: bool,
}

impl AttitudeMap {
    /// Standard names of the quaternion: x, y, z, w.
    pub(crate) fn names(&self) -> [String; 4] {
        let prefix = if self.relative { "relative_q" } else { "q" };
        ["x", "y", "z", "w"].map(|axis| crate::full_name(&self.sensor, &format!("{prefix}_{axis}")))
    }
}

/// Forms of an attitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttitudeForm {
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

/// Attitudes relative to the orbital frame of a circular orbit: x along the velocity, z down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrbitalMap {
    /// Rate of the frame, about its -y axis, rad/s.
    pub rate_rad_s: f64,
    /// Whether angular velocities are relative to it too.
    pub rates: bool,
}

/// Position relative to the centre of the attracting body.
#[derive(Debug, Clone, PartialEq)]
pub struct OrbitMap {
    /// Columns of x, y, z.
    pub position: [String; 3],
    /// Unit; `None`: from the units row.
    pub unit: Option<String>,
    /// Columns of the velocity in the same axes.
    pub velocity: Option<[String; 3]>,
    /// Its unit; `None`: from the units row.
    pub velocity_unit: Option<String>,
    /// Whether the axes are Earth-fixed.
    pub earth_fixed: bool,
}

impl TelemetryMap {
    /// A map with columns and a row filter for every file.
    pub fn of(columns: Vec<ColumnMap>, row_filter: Vec<(String, String)>) -> Self {
        Self {
            all: FileMap {
                columns,
                row_filter,
                ..FileMap::default()
            },
            files: Vec::new(),
        }
    }

    pub(crate) fn for_file(&self, path: &Path) -> FileMap {
        let mut all = self.all.clone();
        let fitting = self.files.iter().filter(|(p, _)| fits_path(p, path));
        fitting.for_each(|(_, map)| all.add(map));
        all
    }

    /// All maps, with an index for those of single files.
    pub(crate) fn maps(&self) -> impl Iterator<Item = (Option<usize>, &FileMap)> {
        let files = self.files.iter().enumerate();
        std::iter::once((None, &self.all)).chain(files.map(|(k, (_, map))| (Some(k), map)))
    }
}

impl FileMap {
    fn add(&mut self, more: &Self) {
        let (all, own) = (&mut self.layout, more.layout);
        all.delimiter = own.delimiter.or(all.delimiter);
        all.comment = own.comment.or(all.comment);
        all.header_row = own.header_row.or(all.header_row);
        all.units_row = own.units_row.or(all.units_row);
        all.decimal_comma = own.decimal_comma.or(all.decimal_comma);
        self.time = more.time.clone().or(self.time.take());
        self.columns.extend(more.columns.iter().cloned());
        self.attitude.extend(more.attitude.iter().cloned());
        self.orbit = more.orbit.clone().or(self.orbit.take());
        self.orbital = more.orbital.or(self.orbital);
        self.row_filter.extend(more.row_filter.iter().cloned());
    }

    /// Every column that selects rows, with its text.
    pub(crate) fn filters(&self) -> impl Iterator<Item = &(String, String)> {
        let parts = self.attitude.iter().flat_map(|a| &a.columns);
        let own = self.columns.iter().chain(parts).flat_map(|c| &c.rows);
        self.row_filter.iter().chain(own)
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
            all.extend(attitude.columns.iter().map(|c| of(&name, c)));
        }
        let orbit = self.orbit.iter();
        let orbit = orbit.flat_map(|o| o.position.iter().chain(o.velocity.iter().flatten()));
        all.extend(orbit.map(|c| of("orbit", &ColumnMap::part(c))));
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
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = name.strip_prefix(first) else {
        return false;
    };
    let mut parts = parts.peekable();
    if parts.peek().is_none() {
        return rest.is_empty();
    }
    while let Some(part) = parts.next() {
        if parts.peek().is_none() {
            return rest.ends_with(part);
        }
        match rest.find(part) {
            Some(at) => rest = rest.get(at + part.len()..).unwrap_or_default(),
            None => return false,
        }
    }
    true
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
