//! The command `follow`: the on-board filter on rows of telemetry as they arrive.

use crate::error::Error;
use crate::identify::read_options;
use crate::onboard::OnBoard;
use poinsot_model::{Model, read_model, read_telemetry_map};
use poinsot_onboard::{Answer, Filter, Health, Sample};
use poinsot_telemetry::{Part, ReadOptions, read_parts};
use serde_json::{Value, json};
use std::path::Path;

/// Name of a batch of rows in messages.
const ROWS: &str = "rows.csv";
/// Columns of the filter: eight wheels, ten unknowns, a position.
const COLUMNS: usize = 60;
/// Samples of the first window.
const WINDOW: usize = 300;
/// Longest gap in steps of the first two samples.
const GAP: f64 = 5.0;

/// The filter of a model with what was read so far.
pub struct Follower {
    model: Model,
    on_board: OnBoard,
    filter: Option<Box<Filter<COLUMNS, WINDOW>>>,
    options: ReadOptions,
    /// Lines before the first row.
    head: String,
    /// The last row that was read, which begins the next batch.
    last: String,
    /// The beginning of a row.
    part: String,
    /// Time of the newest sample, s.
    newest: f64,
    /// Time of the last line that was given, s.
    told: f64,
    /// Shortest time between two lines, s.
    every_s: f64,
}

impl Follower {
    /// A filter for a model file, with a map in place of the model's. Lines come at most every `every_s` seconds of the record.
    ///
    /// # Errors
    /// A file cannot be read, or the filter does not support the model.
    pub fn new(model: &Path, map: Option<&Path>, every_s: f64) -> Result<Self, Error> {
        let mut model = read_model(model)?;
        if let Some(map) = map {
            model.telemetry = read_telemetry_map(map)?;
        }
        Self::of(model, every_s)
    }

    /// A filter for a model with its map. Lines come at most every `every_s` seconds of the record; infinite: none.
    ///
    /// # Errors
    /// The filter does not support the model.
    pub fn of(model: Model, every_s: f64) -> Result<Self, Error> {
        let options = ReadOptions {
            check_conventions: false,
            one_run: false,
            ..read_options(&model, &model.telemetry, false, false)
        };
        Ok(Self {
            on_board: OnBoard::new(&model, None)?,
            model,
            filter: None,
            options,
            head: String::new(),
            last: String::new(),
            part: String::new(),
            newest: f64::NEG_INFINITY,
            told: f64::NEG_INFINITY,
            every_s,
        })
    }

    /// What the filter assumes, one assumption a line.
    pub fn assumed(&self) -> &[String] {
        &self.on_board.assumed
    }

    /// Takes text that has arrived, and returns lines of JSON.
    ///
    /// # Errors
    /// The rows cannot be read.
    pub fn push(&mut self, text: &str) -> Result<Vec<String>, Error> {
        self.part.push_str(text);
        let end = self.part.rfind('\n').map_or(0, |at| at + 1);
        let rest = self.part.split_off(end);
        let lines = std::mem::replace(&mut self.part, rest);
        let mut rows = String::new();
        for line in lines.split_inclusive('\n') {
            if self.last.is_empty() && !is_row(line) {
                self.head.push_str(line);
            } else if is_row(line) {
                rows.push_str(line);
            }
        }
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let table = format!("{}{}{rows}", self.head, self.last);
        let count = self.last.lines().count() + rows.lines().count();
        let last = rows.lines().next_back().unwrap_or_default();
        self.last = format!("{last}\n");
        if count < 2 {
            return Ok(Vec::new());
        }
        let part = Part::stream(ROWS, &mut table.as_bytes());
        let part = part.map_err(|e| Error::io(Path::new(ROWS), "cannot be read", &e))?;
        self.push_parts(&[part])
    }

    /// Takes a batch of at least two rows, and returns lines of JSON. The first row is the last one of the batch before, between which
    /// and the next one wheel speeds are interpolated.
    ///
    /// # Errors
    /// The rows cannot be read.
    pub fn push_parts(&mut self, parts: &[Part]) -> Result<Vec<String>, Error> {
        let table = read_parts(parts, &self.options)?;
        self.options.origin = table.origin;
        let samples = self.on_board.samples(&self.model, &table);
        Ok(self.take(&samples))
    }

    /// A line of what is known at a time of the record, s; at its end where none is given. `None` before the second row.
    pub fn at(&self, time_s: Option<f64>) -> Option<String> {
        let line = self.line(time_s.unwrap_or(self.newest))?;
        Some(line.to_string())
    }

    /// What is known at the end.
    pub fn end(&mut self) -> Option<String> {
        self.filter.as_mut()?.flush();
        self.at(None)
    }

    fn take(&mut self, samples: &[Sample]) -> Vec<String> {
        let mut out = Vec::new();
        for pair in samples.windows(2) {
            if self.filter.is_none() {
                let configuration = &mut self.on_board.configuration;
                configuration.longest_gap_s = GAP * (pair[1].time_s - pair[0].time_s);
                configuration.stale_s = 2.0 * configuration.longest_gap_s;
                // The capacity is that of the largest configuration.
                self.filter = Filter::new(*configuration).ok().map(Box::new);
            }
            for sample in pair.iter().filter(|s| s.time_s > self.newest) {
                if let Some(filter) = &mut self.filter {
                    // A refused sample is not counted; what follows from refusals shows in the health.
                    let _ = filter.push(sample);
                }
            }
            self.newest = self.newest.max(pair[1].time_s);
            if self.newest >= self.told + self.every_s {
                self.told = self.newest;
                out.extend(self.line(self.newest).map(|line| line.to_string()));
            }
        }
        out
    }

    fn line(&self, time_s: f64) -> Option<Value> {
        let filter = self.filter.as_ref()?;
        let answer: Answer = filter.answer(time_s);
        let numbers = self.on_board.numbers(&self.model, &answer);
        let numbers = numbers.into_iter();
        let numbers = numbers.map(|n| (n.address, json!({ "value": n.value, "sigma": n.sigma })));
        let [gyro, attitude, position] = filter.counts();
        let count =
            |c: poinsot_onboard::SensorCounts| json!({ "accepted": c.accepted, "gated": c.gated });
        Some(json!({
            "time_s": time_s,
            "health": word(answer.health),
            "numbers": numbers.collect::<serde_json::Map<_, _>>(),
            "gyro": count(gyro),
            "attitude": count(attitude),
            "position": count(position),
        }))
    }
}

/// Whether a line is a row: it begins with a number.
fn is_row(line: &str) -> bool {
    let first = line.trim_start_matches([' ', '\t', '"', '+', '-', '.']);
    first.starts_with(|c: char| c.is_ascii_digit())
}

/// The health as a word.
fn word(health: Health) -> &'static str {
    match health {
        Health::Converging => "converging",
        Health::Determined => "determined",
        Health::Inconsistent => "inconsistent",
        Health::Stale => "stale",
    }
}
