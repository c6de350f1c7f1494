//! Which column of a file becomes which channel.

use crate::error::Place;
use crate::unit::nearest_unit;
use crate::{
    ChannelName, Quantity, ReadOptions, TelemetryError, Unit, classify, parse_unit, suggest,
};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A column that is not a standard name in SI, and the channel it holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnMap {
    /// Standard channel name, for example `omega_x`, `imu2.omega_x` or `time_s`.
    pub channel: String,
    /// Column in the file.
    pub column: String,
    /// Unit of that column as written, for example `deg/s`.
    pub unit: String,
}

/// A column that becomes a channel.
#[derive(Debug, Clone)]
pub(crate) struct PlannedChannel {
    pub index: usize,
    pub column: String,
    pub name: ChannelName,
    pub unit: Unit,
}

/// What to take from one file.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub time_index: usize,
    pub time_column: String,
    pub time_unit: Unit,
    pub channels: Vec<PlannedChannel>,
    /// Column and text wanted there.
    pub filter: Vec<(usize, String)>,
    pub ignored: Vec<String>,
    /// Columns in the file, and how many.
    pub width: usize,
    used_maps: Vec<usize>,
    used_filters: Vec<usize>,
}

impl Plan {
    /// Columns to choose rows by that this file does not have.
    pub(crate) fn missing_filters<'a>(
        &'a self,
        options: &'a ReadOptions,
    ) -> impl Iterator<Item = &'a str> {
        let all = options.row_filter.iter().enumerate();
        all.filter(|(k, _)| !self.used_filters.contains(k))
            .map(|(_, (column, _))| column.as_str())
    }
}

/// Column limit: no telemetry has more, a damaged header may.
const MAX_COLUMNS: usize = 65_536;

/// The standard name and unit of a map, checked against each other.
fn resolve(map: &ColumnMap) -> Result<(ChannelName, Unit), TelemetryError> {
    let fault = |why: String| TelemetryError::Map {
        channel: map.channel.clone(),
        why,
    };
    let name = classify(&map.channel).ok_or_else(|| {
        fault("not a standard channel name; write one, for example omega_x, joint1_rad, wheel1_rad_s or thr1_N".into())
    })?;
    let unit = parse_unit(&map.unit).map_err(|error| match error {
        TelemetryError::UnknownUnit { unit, .. } => TelemetryError::UnknownUnit {
            channel: map.channel.clone(),
            nearest: nearest_unit(&unit, Some(name.dimension)).to_owned(),
            unit,
        },
        other => other,
    })?;
    if unit.dimension != name.dimension {
        return Err(fault(format!(
            "unit '{}' does not measure it; give a unit that converts to {}",
            map.unit,
            name.dimension.si()
        )));
    }
    Ok((name, unit))
}

/// Every map has a standard channel and a unit of its dimension.
pub(crate) fn check_maps(options: &ReadOptions) -> Result<(), TelemetryError> {
    options
        .columns
        .iter()
        .try_for_each(|m| resolve(m).map(drop))
}

/// What to take from a file with this header.
pub(crate) fn build(
    path: &Path,
    header: &[String],
    options: &ReadOptions,
) -> Result<Plan, TelemetryError> {
    check_header(path, header)?;
    let mut time = None;
    let mut channels: Vec<PlannedChannel> = Vec::new();
    let mut used_maps = Vec::new();
    let mut taken = HashSet::new();
    for (k, map) in options.columns.iter().enumerate() {
        let Some(index) = header.iter().position(|h| *h == map.column) else {
            continue;
        };
        let (name, unit) = resolve(map)?;
        used_maps.push(k);
        taken.insert(index);
        if name.quantity == Quantity::Time {
            time = time.or(Some((index, unit)));
            continue;
        }
        if let Some(first) = channels.iter().find(|c| c.name == name) {
            return Err(TelemetryError::DuplicateChannel {
                channel: map.channel.clone(),
                first: Box::new(Place::cell(path, 0, &first.column)),
                second: Box::new(Place::cell(path, 0, &map.column)),
            });
        }
        channels.push(PlannedChannel {
            index,
            column: map.column.clone(),
            name,
            unit,
        });
    }
    let mapped = channels.len();
    let mut ignored = Vec::new();
    let filter_columns: HashSet<&str> = options.row_filter.iter().map(|f| f.0.as_str()).collect();
    for (index, column) in header
        .iter()
        .enumerate()
        .filter(|(i, _)| !taken.contains(i))
    {
        match classify(column) {
            Some(name) if name.quantity == Quantity::Time => {
                if time.is_none() {
                    time = Some((index, parse_unit("s")?));
                } else {
                    ignored.push(column.clone());
                }
            }
            Some(name)
                if is_wanted(&name, options)
                    && !channels.iter().take(mapped).any(|c| c.name == name) =>
            {
                let unit = parse_unit(name.dimension.si())?;
                channels.push(PlannedChannel {
                    index,
                    column: column.clone(),
                    name,
                    unit,
                });
            }
            _ if filter_columns.contains(column.as_str()) => {}
            _ if column.is_empty() => ignored.push(format!("(column {} without name)", index + 1)),
            _ => ignored.push(column.clone()),
        }
    }
    let Some((time_index, time_unit)) = time else {
        return Err(no_time(path, header));
    };
    let mut filter = Vec::new();
    let mut used_filters = Vec::new();
    for (k, (column, text)) in options.row_filter.iter().enumerate() {
        if let Some(index) = header.iter().position(|h| h == column) {
            filter.push((index, text.clone()));
            used_filters.push(k);
        }
    }
    channels.sort_by_key(|c| c.index);
    Ok(Plan {
        time_index,
        time_column: header.get(time_index).cloned().unwrap_or_default(),
        time_unit,
        channels,
        filter,
        ignored,
        width: header.len(),
        used_maps,
        used_filters,
    })
}

fn is_wanted(name: &ChannelName, options: &ReadOptions) -> bool {
    options
        .wanted
        .as_ref()
        .is_none_or(|set| set.contains(&name.name) || set.contains(&name.full()))
}

fn check_header(path: &Path, header: &[String]) -> Result<(), TelemetryError> {
    let fault = |why: String| TelemetryError::Header {
        place: Place::file(path),
        why,
    };
    if header.len() > MAX_COLUMNS {
        return Err(fault(format!(
            "{} columns in the header; leave out what is not needed, at most {MAX_COLUMNS} are read",
            header.len()
        )));
    }
    if let [only] = header
        && let Some(delimiter) = only.chars().find(|c| matches!(c, ';' | '\t' | '|'))
    {
        return Err(fault(format!(
            "the columns are separated by {delimiter:?}; write commas, and points in decimal numbers"
        )));
    }
    let mut seen = HashSet::new();
    for name in header.iter().filter(|h| !h.is_empty()) {
        if !seen.insert(name) {
            return Err(fault(format!(
                "column '{name}' stands twice in the header; rename one"
            )));
        }
    }
    Ok(())
}

fn no_time(path: &Path, header: &[String]) -> TelemetryError {
    let candidate = header
        .iter()
        .filter_map(|h| suggest(h).filter(|s| s.channel == "time_s"))
        .next();
    let hint = match candidate {
        Some(s) => format!(
            "; map '{}', which may be it, by [telemetry.columns] {}",
            s.column, s.toml
        ),
        None => {
            let first: Vec<&str> = header.iter().take(8).map(String::as_str).collect();
            format!(
                "; map one of [{}] by [telemetry.columns] time_s = {{ column = \"...\", unit = \"s\" }}",
                first.join(", ")
            )
        }
    };
    let hint = poinsot_files::escaped(&hint).into_owned();
    TelemetryError::NoTime {
        place: Place::file(path),
        hint,
    }
}

/// Maps and filters that no file has used yet.
pub(crate) struct Unused<'a> {
    options: &'a ReadOptions,
    maps: HashSet<usize>,
    filters: HashSet<usize>,
    columns: Vec<String>,
}

impl<'a> Unused<'a> {
    pub(crate) fn new(options: &'a ReadOptions) -> Self {
        Self {
            options,
            maps: (0..options.columns.len()).collect(),
            filters: (0..options.row_filter.len()).collect(),
            columns: Vec::new(),
        }
    }

    pub(crate) fn mark(&mut self, plan: &Plan) {
        for k in &plan.used_maps {
            self.maps.remove(k);
        }
        for k in &plan.used_filters {
            self.filters.remove(k);
        }
        self.columns.extend(plan.ignored.iter().cloned());
        self.columns
            .extend(plan.channels.iter().map(|c| c.column.clone()));
    }

    /// A mapped or filtering column must stand in one of the files.
    pub(crate) fn check(&self, paths: &[PathBuf]) -> Result<(), TelemetryError> {
        let files: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        let files = files.join(", ");
        let nearest = |column: &str| {
            self.columns
                .iter()
                .map(|c| (strsim::jaro_winkler(c, column), c))
                .filter(|c| c.0 > 0.7)
                .max_by(|a, b| a.0.total_cmp(&b.0))
                .map_or_else(
                    || {
                        let first: Vec<&str> =
                            self.columns.iter().take(8).map(String::as_str).collect();
                        format!("; name one that is there: {}", first.join(", "))
                    },
                    |c| format!("; did you mean '{}'?", c.1),
                )
        };
        if let Some(map) = self
            .maps
            .iter()
            .min()
            .and_then(|&k| self.options.columns.get(k))
        {
            return Err(TelemetryError::Map {
                channel: map.channel.clone(),
                why: format!(
                    "no column '{}' in {files}{}",
                    map.column,
                    nearest(&map.column)
                ),
            });
        }
        if let Some((column, text)) = self
            .filters
            .iter()
            .min()
            .and_then(|&k| self.options.row_filter.get(k))
        {
            return Err(TelemetryError::Filter {
                column: column.clone(),
                text: text.clone(),
                why: format!("no column '{column}' in {files}{}", nearest(column)),
            });
        }
        Ok(())
    }
}
