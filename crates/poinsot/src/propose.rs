//! Proposes a `[telemetry]` table for a CSV file from its first lines.

use crate::bind::mountings;
use crate::channel_names;
use crate::error::Error;
use crate::propose_sensors::proposed_sensors;
use poinsot_formats::{INSPECTION, StatedFile};
use poinsot_model::{TelemetryMap, parse_telemetry_map, read_model, read_telemetry_map};
use poinsot_telemetry::{
    Dimension, Inspection, ReadOptions, classify, inspect_files, parse_unit, suggest,
};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes and lines of a file that are inspected.
const BYTES: u64 = 1 << 18;
const LINES: usize = 200;
/// Range of numbers that are seconds since 1970 in 2001 to 2096, also in ms, us, ns.
const UNIX: (f64, f64) = (1.0e9, 4.0e9);
const UNIX_UNITS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1.0e3), ("us", 1.0e6), ("ns", 1.0e9)];

/// The parsed first lines of a file.
struct FileHead {
    comment: Option<char>,
    delimiter: char,
    header_row: usize,
    header: Vec<String>,
    units: Option<Vec<String>>,
    first: Vec<String>,
}

/// Inspects the files of one segment, with the map of `map` or of `model`. Without a map, a `[telemetry]` table is
/// proposed; files that cannot be read otherwise are read with it.
///
/// # Errors
/// Model or map are invalid, or the files cannot be read with the proposal either.
///
/// ```
/// use poinsot::inspect;
/// use poinsot_telemetry::ReadOptions;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-propose-{}", std::process::id()));
/// # std::fs::create_dir_all(&out)?;
/// let path = out.join("imu.csv");
/// std::fs::write(&path, "t_s,wx [deg/s],wy [deg/s],wz [deg/s]\n0,1,2,3\n1,1,2,3\n2,1,2,4\n")?;
/// let found = inspect(&[path], &ReadOptions::default(), None, None)?;
/// assert!(found.proposed_map.unwrap().contains(r#"column = "wx [deg/s]""#));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspect(
    files: &[PathBuf],
    options: &ReadOptions,
    model: Option<&Path>,
    map: Option<&Path>,
) -> Result<InspectionAnswer, Error> {
    let mut options = options.clone();
    let mut own = Vec::new();
    if let Some(model) = model.map(read_model).transpose()? {
        options.mountings = mountings(&model);
        own = channel_names::of_parts(&model);
        options.map = model.telemetry;
    }
    if let Some(map) = map {
        options.map = read_telemetry_map(map)?;
    }
    let described = map.is_some() || options.map != TelemetryMap::default();
    let proposed_map = (!described).then(|| proposed_map(files, &own)).flatten();
    let inspection = match (inspect_files(files, &options), &proposed_map) {
        (Ok(inspection), _) => inspection,
        (Err(error), Some(map)) => {
            let Ok(map) = parse_telemetry_map(map, "the proposed map") else {
                return Err(error);
            };
            let proposed = ReadOptions { map, ..options };
            inspect_files(files, &proposed).map_err(|_| error)?
        }
        (Err(error), None) => return Err(error),
    };
    Ok(InspectionAnswer {
        proposed_sensors: proposed_sensors(&inspection),
        inspection,
        proposed_map,
    })
}

/// An inspection with what it proposes.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct InspectionAnswer {
    /// What was found.
    #[serde(flatten)]
    pub inspection: Inspection,
    /// The `[telemetry]` table to paste.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proposed_map: Option<String>,
    /// `[[sensor]]` tables with the noise that the data show.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proposed_sensors: Option<String>,
}

impl std::fmt::Display for InspectionAnswer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.inspection)?;
        if let Some(map) = &self.proposed_map {
            write!(
                f,
                "\n\nProposed map, for the model file or a file for --map; check the lines marked unsure:\n\n{map}"
            )?;
        }
        match &self.proposed_sensors {
            Some(sensors) => write!(f, "\n\nProposed noise of the sensors:\n\n{sensors}"),
            None => Ok(()),
        }
    }
}

/// The inspection as a file.
///
/// ```
/// use poinsot::{inspect, inspection_file};
/// use poinsot_telemetry::ReadOptions;
///
/// let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/stsat3/paper/telemetry_noisy.csv");
/// let found = inspect(&[path.into()], &ReadOptions::default(), None, None)?;
/// assert!(inspection_file(found).content.inspection.channels.iter().any(|c| c.name == "omega_x"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn inspection_file(content: InspectionAnswer) -> StatedFile<InspectionAnswer> {
    StatedFile {
        schema: INSPECTION,
        content,
    }
}

/// A table to paste; uncertain lines are marked. `None` if the file is not text, or has standard names in SI. A column
/// named in `own` is that of a joint, wheel or thruster of the model.
///
/// ```
/// use poinsot::proposed_map;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-map-{}", std::process::id()));
/// # std::fs::create_dir_all(&out)?;
/// let path = out.join("imu.csv");
/// std::fs::write(&path, "t_s,wx [deg/s]\n0,1\n1,1\n")?;
/// assert!(proposed_map(&[path], &[]).unwrap().contains("omega_x"));
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn proposed_map(paths: &[impl AsRef<Path>], own: &[String]) -> Option<String> {
    let of = |path: &Path| proposed(path, own);
    let tables: Vec<String> = paths.iter().filter_map(|p| of(p.as_ref())).collect();
    (!tables.is_empty()).then(|| tables.join("\n"))
}

fn proposed(path: &Path, own: &[String]) -> Option<String> {
    let mut bytes = Vec::new();
    let (file, _) = poinsot_files::open(path).ok()?;
    file.take(BYTES).read_to_end(&mut bytes).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    if bytes.contains(&0) {
        return None;
    }
    let head = FileHead::of(&text)?;
    let mut out = String::from("[[telemetry.file]]\n");
    let name = path.file_name()?.to_string_lossy();
    let _ = writeln!(out, "name = {}", quoted(&name));
    let before = out.len();
    head.layout(&mut out);
    head.time(&mut out);
    head.attitude(&mut out);
    head.columns(own, &mut out);
    (out.len() > before).then_some(out)
}

impl FileHead {
    fn of(text: &str) -> Option<Self> {
        let lines: Vec<&str> = text.lines().take(LINES).collect();
        let comment = lines.first()?.chars().next().filter(|c| "#%!".contains(*c));
        let is_comment = |line: &str| comment.is_some_and(|c| line.starts_with(c));
        let body: Vec<(usize, &str)> = lines
            .iter()
            .enumerate()
            .filter(|(_, line)| !is_comment(line) && !line.trim().is_empty())
            .map(|(k, line)| (k + 1, *line))
            .collect();
        // The last complete line gives the number of fields.
        let last = body.get(body.len().checked_sub(2)?)?.1;
        let fields = |delimiter: char| last.matches(delimiter).count();
        let delimiter = [',', ';', '\t', '|']
            .into_iter()
            .max_by_key(|d| (fields(*d), *d == ','))
            .filter(|d| fields(*d) > 0)?;
        let split = |line: &str| -> Vec<String> {
            let cells = line.split(delimiter);
            cells
                .map(|c| c.trim().trim_matches('"').to_owned())
                .collect()
        };
        let width = fields(delimiter) + 1;
        let first = body
            .iter()
            .position(|(_, line)| split(line).len() == width)?;
        let (line, header) = body.get(first)?;
        let header = split(header);
        if header.iter().any(|h| h.parse::<f64>().is_ok()) {
            return None;
        }
        let mut rows = body.iter().skip(first + 1).map(|(_, line)| split(line));
        let mut row = rows.next()?;
        let is_unit = |cell: &String| parse_unit(bare(cell)).is_ok();
        let is_number = |cell: &String| cell.parse::<f64>().is_ok();
        let units = (row.iter().any(is_unit) && !row.iter().any(is_number)).then_some(row.clone());
        if units.is_some() {
            row = rows.next()?;
        }
        // Comments are skipped anywhere; other lines above the header are counted.
        let above = lines.iter().take(line.saturating_sub(1));
        let plain_above = above.filter(|l| !is_comment(l)).count();
        Some(Self {
            comment,
            delimiter,
            header_row: if plain_above > 0 { *line } else { 1 },
            header,
            units,
            first: row,
        })
    }

    fn layout(&self, out: &mut String) {
        if let Some(comment) = self.comment {
            let _ = writeln!(out, "comment = {}", quoted(&comment.to_string()));
        }
        match self.delimiter {
            ',' => {}
            '\t' => out.push_str("delimiter = \"tab\"\n"),
            other => {
                let _ = writeln!(out, "delimiter = {}", quoted(&other.to_string()));
            }
        }
        if self.header_row > 1 {
            let _ = writeln!(out, "header_row = {}", self.header_row);
        }
        if self.units.is_some() {
            out.push_str("units_row = true\n");
        }
    }

    fn cell(&self, column: usize) -> &str {
        self.first.get(column).map_or("", String::as_str)
    }

    /// The unit of a column in the units row.
    fn unit(&self, column: usize) -> Option<&str> {
        let cell = self.units.as_ref()?.get(column)?;
        parse_unit(bare(cell)).ok().map(|unit| unit.symbol)
    }

    fn time(&self, out: &mut String) {
        let upper: Vec<String> = self.header.iter().map(|h| h.to_uppercase()).collect();
        let named = |names: &[&str]| upper.iter().position(|h| names.contains(&h.as_str()));
        if let (Some(week), Some(seconds)) = (
            named(&["WEEK", "GPS_WEEK", "GPSWEEK", "WN"]),
            named(&["TOW", "GPS_TOW", "SOW", "GPS_SECONDS"]),
        ) {
            let (week, seconds) = (&self.header[week], &self.header[seconds]);
            let _ = writeln!(
                out,
                "time = {{ column = {}, format = \"gps_week\", week = {} }}",
                quoted(seconds),
                quoted(week)
            );
            return;
        }
        let dated = (0..self.header.len()).find_map(|k| Some((k, date_format(self.cell(k))?)));
        if let Some((column, format)) = dated {
            let name = &self.header[column];
            let scale = ["TAI", "GPS", "TT"]
                .into_iter()
                .find(|s| upper[column].contains(s));
            let (scale, unsure) = match (scale, self.cell(column).ends_with('Z')) {
                (Some(scale), _) => (format!(", scale = \"{scale}\""), ""),
                (None, true) => (String::new(), ""),
                (None, false) => (
                    String::new(),
                    "   # unsure: no zone is written, UTC is assumed",
                ),
            };
            let _ = writeln!(
                out,
                "time = {{ column = {}, format = \"{format}\"{scale} }}{unsure}",
                quoted(name)
            );
            return;
        }
        let counted = |name: &String| {
            name == "time_s" || suggest(name).is_some_and(|s| s.channel == "time_s")
        };
        let Some(column) = self.header.iter().position(counted) else {
            out.push_str("# time = { column = \"...\", unit = \"s\" }   # unsure: no column looks like a time\n");
            return;
        };
        let name = &self.header[column];
        let written = suggest(name).and_then(|s| s.unit);
        let unit = self.unit(column).map(str::to_owned).or(written);
        let value: f64 = self.cell(column).parse().unwrap_or(0.0);
        let unix = UNIX_UNITS.iter().find(|(symbol, factor)| {
            let fits = (UNIX.0..UNIX.1).contains(&(value / factor));
            fits && unit.as_deref().is_none_or(|u| u == *symbol)
        });
        match (unix, unit) {
            (Some((symbol, _)), _) => {
                let _ = writeln!(
                    out,
                    "time = {{ column = {}, unit = \"{symbol}\", epoch = \"unix\" }}   # unsure: Unix time, by its size",
                    quoted(name)
                );
            }
            (None, Some(unit)) if name != "time_s" => {
                let _ = writeln!(
                    out,
                    "time = {{ column = {}, unit = \"{unit}\" }}",
                    quoted(name)
                );
            }
            (None, None) if name != "time_s" => {
                let _ = writeln!(
                    out,
                    "time = {{ column = {}, unit = \"s\" }}   # unsure: the unit",
                    quoted(name)
                );
            }
            _ => {}
        }
    }

    fn attitude(&self, out: &mut String) {
        for (names, order) in [
            (["q0", "q1", "q2", "q3"], "wxyz"),
            (["q1", "q2", "q3", "q4"], "xyzw"),
            (["qw", "qx", "qy", "qz"], "wxyz"),
        ] {
            let find = |name: &&str| {
                let plain = |h: &String| h.to_lowercase().replace(['_', ' '], "") == *name;
                self.header.iter().find(|h| plain(h))
            };
            let found: Option<Vec<&String>> = names.iter().map(find).collect();
            let Some(found) = found else { continue };
            if found.iter().all(|name| classify(name).is_some()) {
                return;
            }
            let list: Vec<String> = found.iter().map(|n| quoted(n)).collect();
            let _ = writeln!(
                out,
                "attitude = [{{ quaternion = [{}], order = \"{order}\", sense = \"body_to_inertial\" }}]   # unsure: order and sense; `identify` compares them with the gyro",
                list.join(", ")
            );
            return;
        }
    }

    fn columns(&self, own: &[String], out: &mut String) {
        let mut lines = String::new();
        let named = self.header.iter().enumerate();
        for (column, name) in named.filter(|(_, name)| !own.contains(name)) {
            if let Some(line) = self.column(column, name) {
                lines.push_str(&line);
            }
        }
        if !lines.is_empty() {
            out.push_str("\n[telemetry.file.columns]\n");
            out.push_str(&lines);
        }
    }

    fn column(&self, column: usize, name: &str) -> Option<String> {
        let lower = name.to_lowercase();
        let letters = lower
            .trim_end_matches(|c: char| c.is_ascii_digit())
            .trim_end_matches('_');
        if ["thr", "thruster", "jet", "valve"].contains(&letters) {
            let number: String = lower.chars().filter(char::is_ascii_digit).collect();
            return Some(format!(
                "# thr{number}_N = {{ column = {}, nominal_N = ... }}   # unsure: the force of a flag is not in the file\n",
                quoted(name)
            ));
        }
        let suggestion = suggest(name)?;
        let channel = classify(&suggestion.channel)?;
        if channel.dimension == Dimension::Time || channel.name.starts_with("q_") {
            return None;
        }
        let key = match suggestion.channel.contains('.') {
            true => quoted(&suggestion.channel),
            false => suggestion.channel.clone(),
        };
        let below = self
            .unit(column)
            .filter(|u| parse_unit(u).is_ok_and(|u| u.dimension == channel.dimension));
        let written = suggestion
            .unit
            .filter(|u| parse_unit(u).is_ok_and(|u| u.dimension == channel.dimension));
        Some(match (below, written) {
            (Some(_), _) => format!("{key} = {{ column = {} }}\n", quoted(name)),
            (None, Some(unit)) => format!(
                "{key} = {{ column = {}, unit = \"{unit}\" }}\n",
                quoted(name)
            ),
            (None, None) => format!(
                "{key} = {{ column = {}, unit = \"{}\" }}   # unsure: the unit\n",
                quoted(name),
                channel.dimension.si()
            ),
        })
    }
}

/// The format of a date, if the cell looks like one.
fn date_format(cell: &str) -> Option<&'static str> {
    let shape: String = cell
        .chars()
        .take(9)
        .map(|c| if c.is_ascii_digit() { '0' } else { c })
        .collect();
    let shape = shape.replace(['/', ':'], "-");
    if !cell.contains(':') {
        return None;
    }
    if shape.starts_with("0000-00-0") {
        Some("iso8601")
    } else if shape.starts_with("0000-000") {
        Some("day_of_year")
    } else {
        None
    }
}

fn bare(cell: &str) -> &str {
    cell.trim().trim_matches(['[', ']', '(', ')']).trim()
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_an_export_is_described_and_what_is_unsure_is_marked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("aocs.csv");
        let text = "# export\nUTC;wx;wy;wz;RW1;THR1;Q0;Q1;Q2;Q3\n-;deg/s;deg/s;deg/s;rpm;-;-;-;-;-\n\
                    2026-03-14T18:19:00.0;0.1;0.2;0.3;100;0;1;0;0;0\n2026-03-14T18:19:01.0;0.1;0.2;0.3;100;0;1;0;0;0\n\
                    2026-03-14T18:19:02.0;0.1;0.2;0.3;100;0;1;0;0;0\n";
        std::fs::write(&path, text).unwrap();
        let map = proposed_map(&[&path], &[]).unwrap();
        let wanted = "[[telemetry.file]]\nname = \"aocs.csv\"\ncomment = \"#\"\ndelimiter = \";\"\nunits_row = true\n\
            time = { column = \"UTC\", format = \"iso8601\" }   # unsure: no zone is written, UTC is assumed\n\
            attitude = [{ quaternion = [\"Q0\", \"Q1\", \"Q2\", \"Q3\"], order = \"wxyz\", sense = \"body_to_inertial\" }]   # unsure: order and sense; `identify` compares them with the gyro\n\n\
            [telemetry.file.columns]\nomega_x = { column = \"wx\" }\nomega_y = { column = \"wy\" }\nomega_z = { column = \"wz\" }\n\
            wheel1_rad_s = { column = \"RW1\" }\n\
            # thr1_N = { column = \"THR1\", nominal_N = ... }   # unsure: the force of a flag is not in the file\n";
        assert_eq!(map, wanted);
        poinsot_model::parse_telemetry_map(&map, "proposed").unwrap();
        let plain = folder.path().join("plain.csv");
        std::fs::write(&plain, "time_s,omega_x\n0,1\n1,2\n2,3\n").unwrap();
        assert_eq!(proposed_map(&[&plain], &[]), None);
        // A wheel of the model bears a name that often means a rate.
        std::fs::write(&plain, "time_s,wx_rad_s\n0,1\n1,2\n2,3\n").unwrap();
        assert!(proposed_map(&[&plain], &[]).unwrap().contains("omega_x"));
        assert_eq!(proposed_map(&[&plain], &["wx_rad_s".to_owned()]), None);
    }
}
