//! Assigns the columns of a file to channels.

use crate::clock::{Clock, check_time};
use crate::conversion::{Conversion, Transform};
use crate::error::{map_of, no_match, twice};
use crate::map::{AttitudeForm, fits_path};
use crate::map_faults::resolve;
use crate::{
    AttitudeMap, ChannelName, ColumnMap, DecimalSign, Dimension, FileMap, NamedMap, OrbitFrame,
    ReadOptions, Sense, TimeFormat, Unit, classify, parse_unit, suggestions,
};
use poinsot_files::{Faults, Place, nearest};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A column that becomes a channel, or part of one.
#[derive(Debug, Clone)]
pub(crate) struct PlannedChannel {
    pub index: usize,
    pub column: String,
    pub name: ChannelName,
    pub transform: Transform,
    /// Group and index in it, if several columns give channels together.
    pub part: Option<(usize, usize)>,
    /// Which of [`Plan::choices`] has its samples; `None`: every row.
    pub choice: Option<usize>,
}

/// Result of a group of columns.
#[derive(Debug, Clone)]
pub(crate) enum Group {
    /// An attitude of a sensor.
    Attitude {
        names: [String; 4],
        form: AttitudeForm,
        sense: Sense,
    },
    /// A position and a velocity in Earth-fixed axes.
    EarthFixed,
}

/// Columns to read from one file.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    /// Names of the file's columns.
    pub header: Vec<String>,
    pub time_index: usize,
    pub time_column: String,
    pub week_index: Option<usize>,
    pub clock: Clock,
    pub channels: Vec<PlannedChannel>,
    pub groups: Vec<Group>,
    /// Filter columns with the required text.
    pub filter: Choice,
    /// The same of the rows of some channels.
    pub choices: Vec<Choice>,
    pub ignored: Vec<String>,
    /// What a reader has to know of the map and this file.
    pub notes: Vec<String>,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: bool,
}

/// Columns that have to hold these texts.
pub(crate) type Choice = Vec<(usize, String)>;

impl Plan {
    /// Whether every channel has rows of its own.
    pub(crate) fn chooses_all(&self) -> bool {
        !self.choices.is_empty() && self.channels.iter().all(|c| c.choice.is_some())
    }

    /// The columns that are read.
    pub(crate) fn used_columns(&self) -> impl Iterator<Item = usize> {
        let channels = self.channels.iter().map(|c| c.index);
        let filters = self.filter.iter().chain(self.choices.iter().flatten());
        let filter = filters.map(|f| f.0);
        let times = [self.time_index].into_iter().chain(self.week_index);
        channels.chain(filter).chain(times)
    }
}

/// Limit on the number of columns; only a damaged header has more.
const MAX_COLUMNS: usize = 65_536;

/// A header with its units row, and the columns assigned so far.
struct Planner<'a> {
    path: &'a Path,
    header: &'a [String],
    units: Option<&'a [String]>,
    options: &'a ReadOptions,
    notes: Vec<String>,
    channels: Vec<PlannedChannel>,
    groups: Vec<Group>,
    choices: Vec<Choice>,
    taken: HashSet<usize>,
    /// Columns of a joint or wheel that the map gives to others with a factor or an offset; they keep their own channel.
    shared: HashSet<usize>,
}

impl Planner<'_> {
    /// Index of a column, which is taken.
    fn find(&mut self, column: &str) -> Option<usize> {
        let index = self.header.iter().position(|h| h == column)?;
        self.taken.insert(index);
        Some(index)
    }

    fn fault(&self, channel: &str, problem: String, advice: impl Into<String>) -> Faults {
        let problem = format!("{}: {problem}", self.path.display());
        map_of("E0212", channel, problem, advice)
    }

    /// The unit of a column in the units row; `None` without a row or for an empty cell.
    fn unit_below(&self, index: usize, name: &ChannelName) -> Result<Option<Unit>, Faults> {
        let Some(text) = self.units.and_then(|u| u.get(index)) else {
            return Ok(None);
        };
        let text = text.trim().trim_matches(['[', ']', '(', ')']).trim();
        if text.is_empty() || (text == "-" && name.dimension != Dimension::One) {
            return Ok(None);
        }
        match parse_unit(text) {
            Ok(unit) if unit.dimension == name.dimension => Ok(Some(unit)),
            _ => Err(self.fault(
                &name.full(),
                format!(
                    "the units row has '{text}', which is no {}",
                    name.dimension.words()
                ),
                format!(
                    "correct it, or write unit in [telemetry], one of: {}",
                    crate::unit::list(name.dimension)
                ),
            )),
        }
    }

    /// The choice of the rows that a map names: `None` for all rows, an error value where the file lacks one of the columns.
    fn choice(&mut self, rows: &[(String, String)]) -> Result<Option<usize>, ()> {
        if rows.is_empty() {
            return Ok(None);
        }
        let place = |column: &String| self.header.iter().position(|h| h == column);
        let found = rows.iter().map(|(c, text)| Some((place(c)?, text.clone())));
        let found: Choice = found.collect::<Option<_>>().ok_or(())?;
        self.taken.extend(found.iter().map(|f| f.0));
        let own = self.choices.iter().position(|c| *c == found);
        Ok(Some(own.unwrap_or_else(|| {
            self.choices.push(found);
            self.choices.len() - 1
        })))
    }

    fn add(
        &mut self,
        index: usize,
        name: ChannelName,
        transform: Transform,
        choice: Option<usize>,
    ) -> Result<(), Faults> {
        let mut alone = self.channels.iter().filter(|c| c.part.is_none());
        if let Some(first) = alone.find(|c| c.name == name) {
            let column = self.header.get(index).map_or("", String::as_str);
            let place = |column: &str| Place::cell(self.path, 0, column);
            return Err(twice(&name.full(), &place(&first.column), &place(column)));
        }
        self.push(index, name, transform, (None, choice));
        Ok(())
    }

    /// The unit of a wheel's speed whose column is its momentum in this unit; `None` without a model.
    fn speed_unit(&mut self, unit: Unit, name: &ChannelName) -> Result<Option<Unit>, Faults> {
        let what = "the spin inertia of a wheel, over which a momentum is its speed, is not known";
        let Some(known) = &self.options.spin_inertia else {
            let note = format!("{}: not read: {what}; give --model", name.full());
            self.notes.push(note);
            return Ok(None);
        };
        let Some(spin_inertia) = known.get(&name.subject) else {
            let advice = "name a wheel of the model whose spin inertia is not estimated";
            return Err(self.fault(&name.full(), what.to_owned(), advice));
        };
        Ok(Some(Unit {
            dimension: name.dimension,
            divisor: unit.divisor * spin_inertia,
            ..unit
        }))
    }

    /// Assigns one mapped column; returns the clock if it is the time.
    fn column(&mut self, map: &ColumnMap) -> Result<Option<(usize, Clock)>, Faults> {
        let Ok(choice) = self.choice(&map.rows) else {
            return Ok(None);
        };
        let Some(index) = self.find(&map.column) else {
            return Ok(None);
        };
        let resolved = resolve(map, self.units.is_some());
        let (name, unit) = resolved.map_err(|refused| refused.of(&map.channel))?;
        let needs_unit = map.nominal_N.is_none() && map.counts_per_revolution.is_none();
        let unit = match unit {
            None if needs_unit => Some(self.unit_below(index, &name)?.ok_or_else(|| {
                let problem = format!("its units row is empty below '{}'", map.column);
                let advice = "write unit in [telemetry]";
                self.fault(&map.channel, problem, advice)
            })?),
            Some(unit) if map.is_momentum() => match self.speed_unit(unit, &name)? {
                None => return Ok(None),
                unit => unit,
            },
            unit => unit,
        };
        if let (Dimension::Time, Some(unit)) = (name.dimension, unit) {
            return Ok(Some((index, Clock::own(unit))));
        }
        let transform = Transform::of(map, Conversion::of(map, unit));
        let own = classify(&map.column).filter(|own| !own.subject.is_empty() && *own != name);
        if own.is_some() && map.is_changed() {
            self.shared.insert(index);
        }
        self.add(index, name, transform, choice)?;
        Ok(None)
    }

    /// The columns of a group, or none of them.
    fn columns(&mut self, channel: &str, columns: &[String]) -> Result<Option<Vec<usize>>, Faults> {
        let found: Vec<Option<usize>> = columns.iter().map(|c| self.find(c)).collect();
        if found.iter().all(Option::is_none) {
            return Ok(None);
        }
        match found.iter().position(Option::is_none) {
            None => Ok(Some(found.into_iter().flatten().collect())),
            Some(k) => {
                let missing = columns.get(k).cloned().unwrap_or_default();
                let problem = format!("column '{missing}' is missing from its group");
                let advice = "add it, or correct its name";
                Err(self.fault(channel, problem, advice))
            }
        }
    }

    /// The unit of the map, of the units row, or SI, in this order.
    fn unit(&self, named: Option<&str>, index: usize, name: &ChannelName) -> Result<Unit, Faults> {
        match named {
            Some(text) => parse_unit(text),
            None => match self.unit_below(index, name)? {
                Some(unit) => Ok(unit),
                None => parse_unit(name.dimension.si()),
            },
        }
    }

    fn attitude(&mut self, map: &AttitudeMap) -> Result<(), Faults> {
        let label = crate::full_name(&map.sensor, "attitude");
        let maps = map.columns();
        let columns: Vec<String> = maps.iter().map(|c| c.column.clone()).collect();
        let choices: Result<Vec<_>, ()> = maps.iter().map(|c| self.choice(&c.rows)).collect();
        let (Ok(choices), Some(found)) = (choices, self.columns(&label, &columns)?) else {
            return Ok(());
        };
        let names = map.names();
        let (Some(name), Some(form)) = (classify(&names[0]), map.form()) else {
            let problem = format!("'{}' is no name of a sensor", map.sensor);
            return Err(self.fault(&label, problem, "correct it"));
        };
        let group = self.groups.len();
        let parts = found.into_iter().zip(&maps).zip(choices);
        for (place, ((index, column), choice)) in parts.enumerate() {
            let mut name = name.clone();
            let mut unit = None;
            if matches!(form, AttitudeForm::Euler(_)) {
                name.dimension = Dimension::Angle;
                let own = column.unit.as_deref().or(map.unit.as_deref());
                unit = Some(self.unit(own, index, &name)?);
            }
            let transform = Transform::of(column, Conversion::of(column, unit));
            self.push(index, name, transform, (Some((group, place)), choice));
        }
        self.groups.push(Group::Attitude {
            names,
            form,
            sense: map.sense(),
        });
        Ok(())
    }

    /// Adds a channel that is a part of a group, or has rows of its own.
    fn push(
        &mut self,
        index: usize,
        name: ChannelName,
        transform: impl Into<Transform>,
        (part, choice): (Option<(usize, usize)>, Option<usize>),
    ) {
        self.channels.push(PlannedChannel {
            index,
            column: self.header.get(index).cloned().unwrap_or_default(),
            name,
            transform: transform.into(),
            part,
            choice,
        });
    }

    /// Assigns an ephemeris: position, and velocity if requested.
    fn orbit(&mut self, map: &FileMap) -> Result<(), Faults> {
        let Some(orbit) = &map.orbit else {
            return Ok(());
        };
        let earth_fixed = orbit.frame == Some(OrbitFrame::EarthFixed);
        let velocity = orbit.velocity.clone().unwrap_or_default();
        let all = [
            ("orbit", &orbit.position, &orbit.unit),
            ("v", &velocity, &orbit.velocity_unit),
        ];
        let asked = classify("v_x").is_some_and(|name| self.is_wanted(&name));
        let count = 1 + usize::from(orbit.velocity.is_some());
        let group = self.groups.len();
        for (k, (prefix, columns, unit)) in all.into_iter().take(count).enumerate() {
            let Some(found) = self.columns("orbit", columns)? else {
                return Ok(());
            };
            if prefix == "v" && !asked {
                // Listed as unused columns.
                self.taken.retain(|index| !found.contains(index));
                continue;
            }
            for ((place, index), axis) in found.into_iter().enumerate().zip(["x", "y", "z"]) {
                let Some(name) = classify(&format!("{prefix}_{axis}")) else {
                    continue;
                };
                let conversion = Conversion::Unit(self.unit(unit.as_deref(), index, &name)?);
                match earth_fixed {
                    true => {
                        let part = Some((group, 3 * k + place));
                        self.push(index, name, conversion, (part, None));
                    }
                    false => self.add(index, name, conversion.into(), None)?,
                }
            }
        }
        if earth_fixed {
            self.groups.push(Group::EarthFixed);
        }
        Ok(())
    }

    /// The clock that the map names, with its column, and the column of the week.
    fn mapped_time(&mut self, map: &FileMap) -> Result<(PlannedTime, Option<usize>), Faults> {
        let Some(map) = &map.time else {
            return Ok((None, None));
        };
        let Some(index) = self.find(&map.column) else {
            return Ok((None, None));
        };
        let mut clock =
            check_time(map).map_err(|wrong| self.fault("time", wrong.problem, wrong.remedy))?;
        if let (None, TimeFormat::Number | TimeFormat::GpsWeek, Some(name)) =
            (&map.unit, map.format, classify("time_s"))
            && let Some(unit) = self.unit_below(index, &name)?
        {
            clock.unit = unit;
        }
        let Some(week) = &map.week else {
            return Ok((Some((index, clock)), None));
        };
        let Some(week) = self.find(week) else {
            let problem = format!("there is no column '{week}'");
            return Err(self.fault("time", problem, "correct its name"));
        };
        Ok((Some((index, clock)), Some(week)))
    }

    /// Takes the columns that the map does not name by their own names; those that nothing asks for are returned.
    fn rest(&mut self, map: &FileMap, time: &mut PlannedTime) -> Result<Vec<String>, Faults> {
        let mut ignored = Vec::new();
        let mapped = self.channels.len();
        // Those of all rows, and those of some channels where this file lacks others of them.
        let chosen = map.columns.iter().filter(|c| !c.rows.is_empty());
        let filters = map.filters().map(|f| f.0);
        let filter_columns: HashSet<String> =
            filters.chain(chosen.map(|c| c.column.clone())).collect();
        for (index, column) in self.header.iter().enumerate() {
            let named = |all: &[PlannedChannel], name: &ChannelName| {
                all.iter().take(mapped).any(|c| c.name == *name)
            };
            let shares = || {
                let own = classify(column).filter(|_| self.shared.contains(&index));
                own.is_some_and(|name| !named(&self.channels, &name))
            };
            if self.taken.contains(&index) && !shares() {
                continue;
            }
            match classify(column) {
                Some(name) if name.dimension == Dimension::Time => {
                    if time.is_none() {
                        let unit = self.unit(None, index, &name)?;
                        *time = Some((index, Clock::own(unit)));
                    } else {
                        ignored.push(column.clone());
                    }
                }
                Some(name) if self.is_wanted(&name) && !named(&self.channels, &name) => {
                    let unit = self.unit(None, index, &name)?;
                    self.push(index, name, Conversion::Unit(unit), (None, None));
                }
                _ if filter_columns.contains(column) => {}
                _ if column.is_empty() => {
                    ignored.push(format!("(column {} without name)", index + 1));
                }
                _ => ignored.push(column.clone()),
            }
        }
        Ok(ignored)
    }

    /// Columns of a joint, wheel or thruster that the map gives to another one alone.
    fn given_away(&self) -> Vec<String> {
        let all = &self.channels;
        let note = |taker: &PlannedChannel| {
            let own = classify(&taker.column).filter(|own| !own.subject.is_empty())?;
            let gone = !all.iter().any(|c| c.name == own) && self.is_wanted(&own);
            let (own, taker) = (own.full(), taker.name.full());
            gone.then(|| {
                format!(
                    "{own} is the column of {taker}: give that a scale, offset or sign, and both have it"
                )
            })
        };
        all.iter().filter_map(note).collect()
    }

    fn is_wanted(&self, name: &ChannelName) -> bool {
        let wanted = self.options.wanted.as_ref();
        wanted.is_none_or(|set| set.contains(&name.name) || set.contains(&name.full()))
    }
}

/// Column and clock of the time, where they are known.
type PlannedTime = Option<(usize, Clock)>;

/// Assigns the columns of a file with this header and optional units row.
pub(crate) fn build(
    path: &Path,
    header: &[String],
    units: Option<&[String]>,
    options: &ReadOptions,
) -> Result<Plan, Faults> {
    let map = options.map.for_file(path);
    check_header(path, header)?;
    let mut planner = Planner {
        path,
        header,
        units,
        options,
        notes: Vec::new(),
        channels: Vec::new(),
        groups: Vec::new(),
        choices: Vec::new(),
        taken: HashSet::new(),
        shared: HashSet::new(),
    };
    let (mut time, week_index) = planner.mapped_time(&map)?;
    for column in &map.columns {
        let found = planner.column(column)?;
        time = time.or(found);
    }
    for attitude in &map.attitude {
        planner.attitude(attitude)?;
    }
    planner.orbit(&map)?;
    let ignored = planner.rest(&map, &mut time)?;
    let mut notes = planner.given_away();
    notes.append(&mut planner.notes);
    let Some((time_index, mut clock)) = time else {
        return Err(no_time(path, header, map.layout.header_row));
    };
    clock.origin = options.origin;
    let mut filter = Vec::new();
    for (column, text) in &map.row_filter {
        match planner.find(column) {
            Some(index) => filter.push((index, text.clone())),
            None => notes.push(format!(
                "no column '{column}' to choose rows by; all its rows are kept"
            )),
        }
    }
    let Planner {
        mut channels,
        groups,
        choices,
        ..
    } = planner;
    channels.sort_by_key(|c| c.index);
    Ok(Plan {
        header: header.to_vec(),
        time_index,
        time_column: header.get(time_index).cloned().unwrap_or_default(),
        week_index,
        clock,
        channels,
        groups,
        filter,
        choices,
        ignored,
        notes,
        decimal_comma: map.layout.decimal == Some(DecimalSign::Comma),
    })
}

fn check_header(path: &Path, header: &[String]) -> Result<(), Faults> {
    let fault =
        |problem: String, advice: String| Faults::one("E0205", Place::file(path), problem, advice);
    if header.len() > MAX_COLUMNS {
        let problem = format!("{} columns in the header", header.len());
        let advice = format!("leave out what is not needed, the limit is {MAX_COLUMNS}");
        return Err(fault(problem, advice));
    }
    let separators = match header {
        [_] => ";\t| ",
        // A decimal comma cuts the fields of a row without names.
        _ if no_names(header) => ";\t|",
        _ => "",
    };
    let in_all = |c: &char| header.iter().all(|name| name.contains(*c));
    if let Some(delimiter) = separators.chars().find(in_all) {
        let name = match delimiter {
            '\t' => "tab".to_owned(),
            ' ' => "space".to_owned(),
            other => other.to_string(),
        };
        let problem = format!("the columns are separated by {delimiter:?}");
        let advice = format!(
            "write [telemetry] delimiter = \"{name}\", and decimal = \",\" where numbers have a decimal comma{}",
            if no_names(header) {
                "; and header_row = 0, as the file has no header"
            } else {
                ""
            }
        );
        return Err(fault(problem, advice));
    }
    let mut seen = HashSet::new();
    for name in header.iter().filter(|h| !h.is_empty()) {
        if !seen.insert(name) {
            let (problem, advice) = match no_names(header) {
                true => ("the first row has numbers".to_owned(), NO_HEADER),
                false => (
                    format!("column '{name}' is twice in the header"),
                    "rename one",
                ),
            };
            return Err(fault(problem, advice.to_owned()));
        }
    }
    Ok(())
}

/// What to do where the first row has numbers.
const NO_HEADER: &str = "the file has no header: write one above the first row, such as time_s,omega_x,omega_y,omega_z; or write [telemetry] header_row = 0 and time = { column = \"1\" }, as its columns are then \"1\", \"2\" and so on";

/// Whether a header has numbers in place of names.
fn no_names(header: &[String]) -> bool {
    let mut parts = header
        .iter()
        .flat_map(|name| name.split([';', '\t', '|', ' ']));
    parts.all(|text| text.replace(',', ".").parse::<f64>().is_ok())
}

fn no_time(path: &Path, header: &[String], header_row: Option<u64>) -> Faults {
    let mut proposed = suggestions(header).into_iter();
    let (problem, advice) = match proposed.find(|line| line.starts_with("time_s = ")) {
        Some(line) => (
            "no column 'time_s'".to_owned(),
            format!(
                "map one by [telemetry.columns] {line}; `poinsot inspect FILE` without --map proposes a whole map"
            ),
        ),
        None => {
            let first: Vec<&str> = header.iter().take(8).map(String::as_str).collect();
            let advice = match (header_row, no_names(header)) {
                (Some(0), _) => {
                    "name the column of the time by its number: [telemetry] time = { column = \"1\" }"
                }
                (_, true) => NO_HEADER,
                _ => {
                    "name the column of the time: [telemetry] time = { column = \"...\", unit = \"s\" }; without one, add time_s: the row number over the sample rate"
                }
            };
            (
                format!("no column 'time_s' among [{}]", first.join(", ")),
                advice.to_owned(),
            )
        }
    };
    Faults::one("E0207", Place::file(path), problem, advice)
}

/// The columns of the files that were read, against those that the map names.
pub(crate) struct Unused<'a> {
    options: &'a ReadOptions,
    /// Path and header of each file.
    files: Vec<(PathBuf, Vec<String>)>,
    /// Columns for messages: those that were left out first, and no times.
    columns: Vec<String>,
}

impl<'a> Unused<'a> {
    pub(crate) fn new(options: &'a ReadOptions) -> Self {
        Self {
            options,
            files: Vec::new(),
            columns: Vec::new(),
        }
    }

    pub(crate) fn mark(&mut self, path: &Path, plan: &Plan) {
        self.files.push((path.to_owned(), plan.header.clone()));
        let channels = plan.channels.iter().map(|c| &c.column);
        self.columns
            .extend(plan.ignored.iter().chain(channels).cloned());
    }

    /// Checks that every mapped column is in some file; reports map entries that match no file.
    pub(crate) fn check(&self, paths: &[PathBuf], repairs: &mut Vec<String>) -> Result<(), Faults> {
        let files: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        let files = files.join(", ");
        let all = &self.options.map;
        let mut maps = vec![("*", &all.all)];
        for NamedMap { name: pattern, map } in &all.files {
            if paths.iter().any(|p| fits_path(pattern, p)) {
                maps.push((pattern, map));
            } else {
                let mut unused = vec!["its entry of [[telemetry.file]]".to_owned()];
                unused.extend(map.named().into_iter().map(|c| c.channel));
                unused.dedup();
                let unused = unused.join(", ");
                repairs.push(format!(
                    "{files}: no file is named '{pattern}'; not used: {unused}"
                ));
            }
        }
        let missing = |pattern: &str, column: &String| {
            let mut own = self.files.iter().filter(|f| fits_path(pattern, &f.0));
            !own.any(|(_, header)| header.contains(column))
        };
        let why = |column: &String| format!("no column '{column}' in {files}");
        for (pattern, map) in &maps {
            let mut filters = map.filters();
            if let Some((column, text)) = filters.find(|f| missing(pattern, &f.0)) {
                let problem = why(&column);
                let advice = self.nearest(&column);
                return Err(no_match(&column, &text, problem, advice));
            }
        }
        for (pattern, map) in &maps {
            let named = map.named();
            if let Some(own) = named.iter().find(|n| missing(pattern, &n.column)) {
                let column = &own.column;
                let problem = why(column);
                let advice = self.nearest(column);
                return Err(map_of("E0212", &own.channel, problem, advice));
            }
        }
        Ok(())
    }

    fn nearest(&self, column: &str) -> String {
        let columns: Vec<&str> = self.columns.iter().map(String::as_str).collect();
        match nearest(column, &columns) {
            Some(near) => format!("did you mean '{near}'?"),
            None => format!(
                "name one that is there: {}",
                columns[..columns.len().min(8)].join(", ")
            ),
        }
    }
}
