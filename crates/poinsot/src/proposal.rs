//! The `[telemetry]` table of a file by its head, with a question wherever names and data leave a choice.

use crate::file_head::{FileHead, quoted};
use poinsot_files::escaped;
use poinsot_telemetry::{
    Dimension, Found, FoundAttitude, Kind, Recognition, Unit, classify, recognise,
};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Range of numbers that are seconds since 1970 in 2001 to 2096, also in ms, us, ns.
const UNIX: (f64, f64) = (1.0e9, 4.0e9);
const UNIX_UNITS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1.0e3), ("us", 1.0e6), ("ns", 1.0e9)];

/// The value of a key that the names may not say.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Choice {
    pub key: &'static str,
    /// The value, or the likely one; empty where none is likely.
    pub word: String,
    /// Whether names or data say it.
    pub sure: bool,
    /// Whether the gyro says it.
    pub shown: bool,
    question: String,
}

impl Choice {
    fn new(key: &'static str, word: &str, sure: bool, question: impl Into<String>) -> Self {
        Self {
            key,
            word: word.to_owned(),
            sure,
            shown: false,
            question: question.into(),
        }
    }
}

/// The columns of the time, of an attitude or of a channel.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    /// `time`, `attitude` or the channel.
    pub key: String,
    pub kind: Kind,
    pub columns: Vec<String>,
    /// The sensor of an attitude; empty if there is only one.
    pub sensor: String,
    /// What is certain.
    fixed: String,
    pub choices: Vec<Choice>,
    note: &'static str,
}

impl Line {
    /// A line without choices; `fixed` is what is certain.
    fn of(key: &str, kind: Kind, columns: Vec<String>, fixed: String) -> Self {
        Self {
            key: key.to_owned(),
            kind,
            columns,
            sensor: String::new(),
            fixed,
            choices: Vec::new(),
            note: "",
        }
    }

    /// A choice by its key.
    pub fn choice(&mut self, key: &str) -> Option<&mut Choice> {
        self.choices.iter_mut().find(|choice| choice.key == key)
    }

    /// Whether a value is missing that has no likely one.
    pub fn lacks_value(&self) -> bool {
        self.choices.iter().any(|choice| choice.word.is_empty())
    }

    /// The table without its key, and the comment.
    fn text(&self, asked: bool) -> (String, String) {
        let mut keys = self.fixed.clone();
        for choice in &self.choices {
            let value = match (asked && !choice.sure, choice.word.as_str()) {
                (true, _) => quoted("?"),
                (false, "") => "...".to_owned(),
                (false, word) => quoted(word),
            };
            let comma = if keys.is_empty() { "" } else { ", " };
            let _ = write!(keys, "{comma}{} = {value}", choice.key);
        }
        let open = self.choices.iter().filter(|choice| !choice.sure);
        let open = open.map(|choice| choice.question.as_str());
        let shown = self.choices.iter().filter(|choice| choice.shown);
        let shown = shown.map(|choice| choice.key);
        let [open, shown] = [
            open.collect::<Vec<_>>().join("; "),
            shown.collect::<Vec<_>>().join(", "),
        ];
        let sign = if asked { "?" } else { "unsure:" };
        let comment = match (open.as_str(), self.note, shown.as_str()) {
            ("", "", "") => String::new(),
            ("", "", shown) => format!("   # {shown} by comparison with the gyro"),
            ("", note, _) => format!("   # {note}"),
            (open, ..) => format!("   # {sign} {open}"),
        };
        (format!("{{ {keys} }}"), escaped(&comment).to_string())
    }
}

/// The table of one file.
#[derive(Debug, Clone)]
pub(crate) struct Proposal {
    name: String,
    layout: String,
    pub lines: Vec<Line>,
    /// Columns of which nothing is known.
    pub rest: Vec<String>,
}

impl Proposal {
    /// The tables of the files whose heads can be read. A column named in `own` is that of a joint, wheel or thruster of
    /// the model.
    pub fn of_all(files: &[PathBuf], own: &[String]) -> Vec<Self> {
        let tables = files.iter().filter_map(|path| Self::of(path, own));
        tables.collect()
    }

    fn of(path: &Path, own: &[String]) -> Option<Self> {
        let head = FileHead::read(path)?;
        let units = head.units.clone().unwrap_or_default();
        let found = recognise(&head.header, &units);
        let mut lines: Vec<Line> = head.time(&found).into_iter().collect();
        let attitudes = found.attitudes.iter();
        lines.extend(attitudes.filter_map(|a| head.attitude(a, &found)));
        let of_attitude = |k: usize| found.attitudes.iter().any(|a| a.columns.contains(&k));
        let single = found.channels.iter().filter(|f| !of_attitude(f.column));
        let single = single.filter(|f| head.header.get(f.column).is_some_and(|n| !own.contains(n)));
        lines.extend(single.filter_map(|f| head.column(f, &found)));
        let time = lines.iter().find(|line| line.key == "time");
        let used = |name: &String| time.is_some_and(|t| t.fixed.contains(&quoted(name)));
        let known = |name: &String| name.is_empty() || classify(name).is_some() || used(name);
        let taken = |k: usize| found.channels.iter().any(|f| f.column == k);
        let rest = head.header.iter().enumerate();
        let rest = rest.filter(|(k, name)| !taken(*k) && !known(name));
        Some(Self {
            name: path.file_name()?.to_string_lossy().into_owned(),
            layout: head.layout(),
            rest: rest.map(|(_, name)| name.clone()).collect(),
            lines,
        })
    }

    /// Whether nothing differs from a file with standard names.
    pub fn is_plain(&self) -> bool {
        self.layout.is_empty() && self.lines.is_empty()
    }

    /// The table: with a mark for what is unsure, or (`asked`) a question; for files of this name, or for all files.
    pub fn text(&self, asked: bool, of_all: bool) -> String {
        let named = format!("[[telemetry.file]]\nname = {}", quoted(&self.name));
        let (head, table) = match of_all {
            true => ("[telemetry]", "telemetry"),
            false => (named.as_str(), "telemetry.file"),
        };
        let mut out = format!("{head}\n{}", self.layout);
        let of = |key: &'static str| self.lines.iter().filter(move |line| line.key == key);
        of("time").for_each(|line| write_line(line, "time", asked, &mut out));
        let attitudes: Vec<&Line> = of("attitude").collect();
        if let [one] = attitudes[..] {
            let (keys, comment) = one.text(asked);
            let _ = writeln!(out, "attitude = [{keys}]{comment}");
        } else if !attitudes.is_empty() {
            out.push_str("attitude = [\n");
            for (keys, comment) in attitudes.iter().map(|line| line.text(asked)) {
                let _ = writeln!(out, "    {keys},{comment}");
            }
            out.push_str("]\n");
        }
        let group = |line: &&Line| ["time", "attitude"].contains(&line.key.as_str());
        let columns = self.lines.iter().filter(|line| !group(line));
        for (k, line) in columns.enumerate() {
            if k == 0 {
                let _ = writeln!(out, "\n[{table}.columns]");
            }
            let key = match line.key.contains('.') {
                true => quoted(&line.key),
                false => line.key.clone(),
            };
            write_line(line, &key, asked, &mut out);
        }
        out
    }
}

/// Writes a line; without a likely value it is a comment.
fn write_line(line: &Line, key: &str, asked: bool, out: &mut String) {
    let (keys, comment) = line.text(asked);
    let sign = ["", "# "][usize::from(line.lacks_value() && !asked)];
    let _ = writeln!(out, "{sign}{key} = {keys}{comment}");
}

/// The usual units of a dimension, as a question lists them.
fn list_of(dimension: Option<Dimension>) -> &'static str {
    match dimension {
        Some(Dimension::Time) => r#""s", "ms", "us" or "ns""#,
        Some(Dimension::Angle) => r#""rad" or "deg""#,
        Some(Dimension::AngularVelocity) => r#""rad/s", "deg/s" or "rpm""#,
        Some(Dimension::Length) => r#""m", "km" or "mm""#,
        Some(Dimension::Velocity) => r#""m/s", "km/s" or "mm/s""#,
        Some(Dimension::Acceleration) => r#""m/s2", "g" or "mg""#,
        Some(Dimension::Torque) => r#""N m" or "mN m""#,
        _ => "see `poinsot units`",
    }
}

impl FileHead {
    fn time(&self, all: &Recognition) -> Option<Line> {
        let line = |column: &str, more: &str, note| {
            let fixed = format!("column = {}{more}", quoted(column));
            let columns = vec![column.to_owned()];
            Line {
                note,
                ..Line::of("time", Kind::Time, columns, fixed)
            }
        };
        let upper: Vec<String> = self.header.iter().map(|h| h.to_uppercase()).collect();
        let named = |names: &[&str]| {
            let at = upper.iter().position(|h| names.contains(&h.as_str()))?;
            self.header.get(at)
        };
        if let (Some(week), Some(seconds)) = (
            named(&["WEEK", "GPS_WEEK", "GPSWEEK", "WN"]),
            named(&["TOW", "GPS_TOW", "SOW", "GPS_SECONDS"]),
        ) {
            let more = format!(", format = \"gps_week\", week = {}", quoted(week));
            return Some(line(seconds, &more, ""));
        }
        let dated = (0..self.header.len()).find_map(|k| Some((k, date_format(self.cell(k))?)));
        if let Some((column, format)) = dated {
            let written = upper.get(column).map_or("", String::as_str);
            let scale = ["TAI", "GPS", "TT"]
                .into_iter()
                .find(|s| written.contains(s));
            let (scale, note) = match (scale, self.cell(column).ends_with('Z')) {
                (Some(scale), _) => (format!(", scale = \"{scale}\""), ""),
                (None, true) => (String::new(), ""),
                (None, false) => (String::new(), "no zone is written, UTC is assumed"),
            };
            let more = format!(", format = \"{format}\"{scale}");
            return Some(line(self.header.get(column)?, &more, note));
        }
        let question = format!("unit of the times: {}", list_of(Some(Dimension::Time)));
        let Some(found) = all.channels.iter().find(|f| f.kind == Kind::Time) else {
            let choices = vec![
                Choice::new("column", "", false, "column of the time"),
                Choice::new("unit", "", false, question),
            ];
            return Some(Line {
                choices,
                ..Line::of("time", Kind::Time, Vec::new(), String::new())
            });
        };
        let name = self.header.get(found.column)?;
        let unit = found.unit.map(|unit| unit.symbol);
        let value: f64 = self.cell(found.column).parse().unwrap_or(0.0);
        let standard = name == "time_s";
        let unix = UNIX_UNITS.iter().find(|(symbol, factor)| {
            let fits = (UNIX.0..UNIX.1).contains(&(value / factor));
            fits && (standard || unit.is_none_or(|u| u == *symbol))
        });
        let (more, note, unit) = match (unix, unit) {
            (None, _) if standard => return None,
            (Some((symbol, _)), _) => (
                ", epoch = \"unix\"",
                "Unix time, by its size",
                Some(*symbol),
            ),
            (None, unit) => ("", "", unit),
        };
        let choice = Choice::new("unit", unit.unwrap_or("s"), unit.is_some(), question);
        Some(Line {
            choices: vec![choice],
            ..line(name, more, note)
        })
    }

    /// `None` for an attitude with standard names.
    fn attitude(&self, found: &FoundAttitude, all: &Recognition) -> Option<Line> {
        let columns = found
            .columns
            .iter()
            .filter_map(|k| self.header.get(*k).cloned());
        let columns: Vec<String> = columns.collect();
        if columns.iter().all(|name| classify(name).is_some()) {
            return None;
        }
        let first = all
            .channels
            .iter()
            .find(|f| found.columns.first() == Some(&f.column));
        let unit = first.and_then(|f| f.unit).map(|unit| unit.symbol);
        let of = columns.join(", ");
        let mut choices = Vec::new();
        let mut ask = |key, word: &str, sure, question: String| {
            choices.push(Choice::new(key, word, sure, question));
        };
        let form = match found.kind {
            Kind::Euler => {
                let question = format!("sequence of the angles {of}, such as \"ZYX\"");
                ask("sequence", "ZYX", false, question);
                let question = format!("unit of {of}: {}", list_of(Some(Dimension::Angle)));
                ask("unit", unit.unwrap_or("rad"), unit.is_some(), question);
                "euler"
            }
            Kind::Rodrigues => "mrp",
            _ => {
                let question = format!("order of {of}: \"wxyz\" (scalar first) or \"xyzw\"");
                ask("order", "xyzw", found.named, question);
                "quaternion"
            }
        };
        let question = format!("sense of {of}: \"body_to_inertial\" or \"inertial_to_body\"");
        ask("sense", "body_to_inertial", false, question);
        let list: Vec<String> = columns.iter().map(|c| quoted(c)).collect();
        let sensor = match found.sensor.as_str() {
            "" => String::new(),
            sensor => format!("sensor = {}, ", quoted(sensor)),
        };
        let fixed = format!("{sensor}{form} = [{}]", list.join(", "));
        Some(Line {
            sensor: found.sensor.clone(),
            choices,
            ..Line::of("attitude", found.kind, columns, fixed)
        })
    }

    /// The unit of a column in the units row.
    fn below(&self, column: usize) -> Option<Unit> {
        self.units.as_ref()?.get(column).copied().flatten()
    }

    /// `None` for a column with a standard name, and for one that is no channel alone.
    fn column(&self, found: &Found, all: &Recognition) -> Option<Line> {
        let name = self.header.get(found.column)?;
        let channel = classify(&found.channel)?;
        let component = matches!(found.kind, Kind::Time | Kind::Quaternion);
        if component || found.channel == *name {
            return None;
        }
        let same = all
            .channels
            .iter()
            .filter(|f| f.kind == found.kind && f.unit == found.unit);
        let group: Vec<&str> = same
            .filter_map(|f| Some(self.header.get(f.column)?.as_str()))
            .collect();
        let (group, units) = (group.join(", "), list_of(found.kind.dimension()));
        let question = format!("unit of {group}: {units}");
        let mut choices = Vec::new();
        let mut unit =
            |word: &str, sure| choices.push(Choice::new("unit", word, sure, question.as_str()));
        match (found.kind, found.unit) {
            (Kind::Firing, _) => {}
            // The field and the direction of the sun count by their direction alone.
            (Kind::Field | Kind::Sun, _) => unit("1", true),
            (_, Some(unit)) if self.below(found.column) == Some(unit) => {}
            (_, Some(own)) => unit(own.symbol, true),
            (kind, None) => unit(kind.dimension().unwrap_or(channel.dimension).si(), false),
        }
        if matches!(found.kind, Kind::Firing | Kind::Pulse) {
            let question = format!("force of {name} while it is on, N");
            choices.push(Choice::new("nominal_N", "", false, question));
        }
        let fixed = format!("column = {}", quoted(name));
        Some(Line {
            choices,
            ..Line::of(&found.channel, found.kind, vec![name.clone()], fixed)
        })
    }
}

/// The format of a date, if the cell looks like one.
fn date_format(cell: &str) -> Option<&'static str> {
    let digit = |c: char| if c.is_ascii_digit() { '0' } else { c };
    let shape: String = cell.chars().take(9).map(digit).collect();
    let shape = shape.replace(['/', ':'], "-");
    match cell.contains(':') {
        true if shape.starts_with("0000-00-0") => Some("iso8601"),
        true if shape.starts_with("0000-000") => Some("day_of_year"),
        _ => None,
    }
}
